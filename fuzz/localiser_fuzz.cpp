/// Any scans, odometry, mounts and first poses at any times to the particle filter, and states with bytes changed: it answers each with an
/// outcome, its particles and its estimate are finite and as many as the spec allows, and a state that passes fits() can be gone on with.
#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/check.h"
#include "input.h"
#include "navigation/localisation/amcl.h"

namespace {

using namespace sandlot;
namespace nav = navigation;
namespace amcl = navigation::amcl;

using fuzz::Input;

/// Room of 2 m x 2 m with a pillar, whose wall is unknown at one place.
const amcl::Model& model() {
  static const amcl::Model made = [] {
    nav::GridMap map{{20, 20, 0.1, {-1, -1, 0}}, std::vector<std::int8_t>(400, 0)};
    for (int i = 0; i < 20; ++i)
      for (const nav::Cell c : {nav::Cell{i, 0}, nav::Cell{i, 19}, nav::Cell{0, i}, nav::Cell{19, i}})
        map.occupancy[map.geometry.index(c)] = 100;
    map.occupancy[map.geometry.index({5, 14})] = 100;
    map.occupancy[map.geometry.index({0, 3})] = -1;
    amcl::Spec spec;
    spec.min_particles = 20;
    spec.max_particles = 60;
    spec.max_beams = 8;
    spec.recovery_candidates = 2;
    spec.update_min_d_m = spec.update_min_a_rad = 0.01;
    auto result = amcl::Model::make(spec, map);
    SL_CHECK(result);
    return std::move(*result);
  }();
  return made;
}

msg::LaserScan scan_of(Input& in) {
  msg::LaserScan scan;
  const std::uint8_t how = in.byte();
  scan.angle_min = how < 240 ? -1.5F : static_cast<float>(in.number());
  scan.angle_max = how < 240 ? 1.5F : static_cast<float>(in.number());
  const std::size_t beams = how % 16;
  scan.angle_increment = how < 240 ? (beams > 1 ? 3.0F / static_cast<float>(beams - 1) : 0)
                                   : static_cast<float>(in.number());
  scan.range_max = how % 32 == 31 ? static_cast<float>(in.number()) : 5;
  for (std::size_t i = 0; i < beams; ++i) scan.ranges.push_back(static_cast<float>(in.number()));
  return scan;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in(data, size);
  amcl::State state = amcl::begin(in.byte());
  amcl::Workspace work(model());
  Time now;
  for (int orders = 0; !in.empty() && orders < 200; ++orders) {
    switch (const std::uint8_t order = in.byte(); order % 8) {
      case 0: amcl::spread(model(), state); break;
      case 1: {
        nav::Covariance3 covariance{};
        if (order & 8) {
          for (double& each : covariance) each = in.number();
        } else {
          covariance[0] = covariance[4] = covariance[8] = 0.01 * in.byte();
        }
        const Status set = amcl::set_pose(model(), state, {in.number(), in.number(), in.number()},
                                          covariance);
        SL_CHECK(set || !set.error().what.empty());
        break;
      }
      case 2: {
        ByteWriter w;
        write(w, state);
        std::vector<std::byte> bytes(w.bytes().begin(), w.bytes().end());
        for (int changes = in.byte() % 4; changes > 0; --changes)
          bytes[static_cast<std::size_t>(in.byte() << 8 | in.byte()) % bytes.size()] = std::byte{in.byte()};
        amcl::State forged;
        ByteReader r(bytes);
        read(r, forged);
        if (!r.ok() || r.remaining() > 0 || !forged.fits(model())) return 0;
        state = std::move(forged);
        break;
      }
      default: {
        now = order == 255 ? Time{in.whole()} : now + Time{(order / 8 - 4) * std::int64_t{20'000'000}};
        msg::LaserScan scan = scan_of(in);
        scan.header.stamp = now;
        const Time odometry = order & 16 ? now : Time{now.ns / 2};
        const Pose X_BL{{in.number() / 8, 0, 0.2},
                        order % 8 == 7 ? Quat{in.number(), in.number(), 0, 0} : Quat{}};
        amcl::update(model(), state, work, {odometry, {in.number(), in.number(), in.number()}, X_BL}, scan);
      }
    }
    SL_CHECK(state.fits(model()) && state.particles.size() <= 60);
    const nav::Pose2 at = amcl::pose_at(state, {0.1, 0.2, 0.3});
    SL_CHECK(!state.estimate.known || nav::is_finite(at));
  }
  return 0;
}
