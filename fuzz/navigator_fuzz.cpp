/// Any maps, goals, poses, velocities and scans to a navigator of each chassis, and states with bytes changed: it answers each step with a
/// status and a finite command within its limits, a failure has a reason, and a state that restore() takes can be gone on with.
///
/// The first eight bytes choose map and spec; then come orders of one byte each with what they need.
#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/check.h"
#include "input.h"
#include "navigation/navigator/navigator.h"

namespace {

using namespace sandlot;
namespace nav = navigation;

using fuzz::Input;

/// Robots with a footprint of a few cells in maps of at most 40 cells a side: hybrid A* looks at all of a map before it gives up.
std::optional<nav::Navigator> navigator_of(Input& in) {
  const std::uint8_t flags = in.byte(), width = in.byte(), height = in.byte(), walls = in.byte();
  nav::NavigatorSpec spec;
  spec.chassis = static_cast<nav::Chassis>(flags % 4);
  const int most = spec.chassis <= nav::Chassis::omni ? 40 : 24;
  spec.radius_m = 0.15;
  if (flags & 4) spec.footprint_m = {{{0.2, 0.15}, {-0.1, 0.15}, {-0.1, -0.15}, {0.2, -0.15}}};
  if (flags & 8) spec.limits.backward_mps = 0;
  spec.turning_radius_m = 0.4;
  spec.area_m = 1 + width % 4;
  spec.resolution_m = 0.1;
  spec.window_m = 2;
  spec.time_limit_s = 60;
  spec.obstacles.persistence_s = 1 + in.byte() % 8;
  spec.patience_s = in.byte() % 4;
  spec.recovery.wait_s = in.byte() % 2;
  std::optional<nav::GridMap> map;
  if (flags & 16) {
    map.emplace();
    map->geometry = {1 + width % most, 1 + height % most, 0.1, {-1, -1, flags & 32 ? 0.5 : 0}};
    if (flags & 64) map->geometry = {width, height, in.number(), {in.number(), in.number(), in.number()}};
    // Small: of a wrong size, or larger than what can be planned in, it is refused, or answered in time.
    const std::size_t cells = static_cast<std::size_t>(map->geometry.width) *
                              static_cast<std::size_t>(map->geometry.height);
    std::uint32_t bits = 2463534242U ^ walls;
    for (std::size_t i = 0; i < std::min<std::size_t>(cells, 1600); ++i) {
      bits ^= bits << 13, bits ^= bits >> 17, bits ^= bits << 5;
      map->occupancy.push_back((bits & 255) < walls / 16U ? std::int8_t{100}
                               : (bits >> 8 & 255) < 4    ? std::int8_t{-1}
                                                          : std::int8_t{0});
    }
  }
  auto made = nav::Navigator::make(spec, 0.1, std::move(map));
  if (!made) {
    SL_CHECK(!made.error().what.empty());
    return {};
  }
  return std::move(*made);
}

msg::LaserScan scan_of(Input& in) {
  msg::LaserScan scan;
  const std::uint8_t how = in.byte();
  const std::size_t beams = how % 32;
  scan.angle_min = how < 224 ? -3 : static_cast<float>(in.number());
  scan.angle_increment = how < 224 ? 0.2F : static_cast<float>(in.number());
  scan.range_min = how < 240 ? 0.02F : static_cast<float>(in.number());
  scan.range_max = how < 240 ? 5 : static_cast<float>(in.number());
  for (std::size_t i = 0; i < beams; ++i) scan.ranges.push_back(static_cast<float>(in.number()));
  return scan;
}

nav::Pose2 pose(Input& in) { return {in.number(), in.number(), in.number()}; }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in(data, size);
  auto made = navigator_of(in);
  if (!made) return 0;
  nav::Navigator& navigator = *made;
  const nav::NavigatorSpec spec;
  nav::Pose2 X{-0.5, -0.5, 0.3};
  for (int orders = 0; !in.empty() && orders < 60; ++orders) {
    const std::uint8_t order = in.byte();
    switch (order % 8) {
      case 0: {
        const Status set = navigator.set_goal({pose(in), (order & 8) != 0});
        SL_CHECK(set || !set.error().what.empty());
        break;
      }
      case 1: navigator.cancel(); break;
      case 2: {
        ByteWriter w;
        write(w, navigator.state());
        std::vector<std::byte> bytes(w.bytes().begin(), w.bytes().end());
        for (int changes = in.byte() % 4; changes > 0; --changes)
          bytes[static_cast<std::size_t>(in.byte() << 8 | in.byte()) % bytes.size()] = std::byte{in.byte()};
        nav::NavigatorState forged;
        ByteReader r(bytes);
        read(r, forged);
        if (!r.ok() || r.remaining() > 0 || !navigator.restore(std::move(forged))) return 0;
        break;
      }
      case 3: X = pose(in); break;
      default: {
        nav::NavigatorInput input;
        if (order != 255) input.X_MB = X;
        const msg::LaserScan scan = order & 8 ? scan_of(in) : msg::LaserScan{};
        if (order & 8) input.scan = &scan;
        if (order & 16) input.velocity = nav::PlanarTwist{in.number(), in.number(), in.number()};
        if (order & 32) input.pose_std_m = in.number(), input.scan_age_s = in.number();
        if (order & 64)
          input.X_BL = {{in.number(), in.number(), 0.2}, {in.number(), 0, in.number(), in.number()}};
        const nav::NavigatorStep step = navigator.step(input);
        const nav::PlanarTwist& v = step.command;
        // 1e-9: rounding of samples between the limits.
        SL_CHECK(v.vx_mps <= spec.limits.speed_mps + 1e-9 && v.vx_mps >= -spec.limits.speed_mps - 1e-9);
        SL_CHECK(std::abs(v.vy_mps) <= spec.limits.speed_mps + 1e-9);
        SL_CHECK(std::abs(v.w_radps) <= spec.limits.turn_radps + 1e-9);
        SL_CHECK(step.status != nav::NavStatus::failed || !navigator.state().reason.empty());
        SL_CHECK(std::isfinite(step.feedback.distance_remaining_m));
        SL_CHECK(std::isfinite(step.feedback.estimated_time_remaining_s));
        for (const nav::PathPose& p : navigator.plan()) SL_CHECK(nav::is_finite(p.pose));
        if (nav::is_finite(X)) X = nav::driven(X, v, 0.1);
      }
    }
  }
  return 0;
}
