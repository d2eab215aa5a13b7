/// infrared: light that carries packets of data along a free straight line.
///
/// Strength   irradiance [W/m^2] = I cos^m(a) / d^2, with I the radiant intensity [W/sr] on the emitter's axis, a the angle from
///            it, d the distance, and m the order of the emitter's lens; nothing behind the emitter. m = 0 radiates evenly
///            all round. Nearer than 1 cm it stays that of 1 cm. The receiver makes the angle of incidence of it.
/// Blocked    by any body in the straight line, also by the sender's and the receiver's own, but for those that carry the devices.
/// Time       distance / speed of light, so that it arrives in the tick in which it was sent.
/// Limits     no reflection; no ambient light; no air time: packets do not collide and are never damaged.
/// Cost       a grid finds the receivers in range; one ray for each that is lit.
/// Source     J. M. Kahn, J. R. Barry, Wireless Infrared Communications, Proc. IEEE 85 (1997), eq. 10: generalised Lambertian
///            emitters.
#include <algorithm>
#include <limits>
#include <vector>

#include "base/math.h"
#include "media/medium.h"
#include "media/packet.h"
#include "media/places.h"
#include "physics/parallel.h"

namespace sandlot::media::infrared {
namespace {

struct Spec {
  double range_m = 5;
  double least_Wpm2 = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"range", "m", "Distance beyond which nothing arrives.", 0, 1e4, Field::tunable}, s.range_m);
    visit(Field{"least", "W/m^2", "Irradiance below which nothing arrives.", 0, 1e6, Field::tunable},
          s.least_Wpm2);
  }
};

struct State {
  std::uint64_t sent = 0, delivered = 0, blocked = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"sent", "1", "Packets sent."}, s.sent);
    visit(Field{"delivered", "1", "Packets that arrived, each receiver counted."}, s.delivered);
    visit(Field{"blocked", "1", "Packets held up by something in the straight line."}, s.blocked);
  }
};

/// Whom one emission lights. Kept for its memory.
struct Lit {
  std::vector<std::uint32_t> receivers;
  std::vector<Vec3> directions;
  std::vector<double> distances_m, strengths_Wpm2;
  std::vector<float> hit_m;
  std::vector<std::uint32_t> hit_bodies;
};

struct Infrared {
  using Spec = infrared::Spec;
  using State = infrared::State;
  Spec spec;
  State state;
  Places places;
  std::vector<Lit> lit;

  Status init(const ElementBuild&) { return {}; }

  /// Finds whom an emission lights, and what stands between. Called in parallel.
  void look(const Emission& emission, const MediumContext& context, Lit& to) const {
    constexpr double nearest_m = 0.01;
    to.directions.clear();
    to.distances_m.clear();
    to.strengths_Wpm2.clear();
    to.receivers.clear();
    const std::span<const std::byte> bytes = context.buffer.bytes(emission);
    const auto packet = read_packet({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    if (!packet) return;
    const double order = packet->head().lambertian_order;
    places.find_within(emission.point_W, spec.range_m, to.receivers);
    double farthest_m = 0;
    const auto is_dark = [&](std::uint32_t index) {
      const Receiver& receiver = context.receivers[index];
      if (receiver.key == emission.emitter || !places.hears(index, emission.channel)) return true;
      const Vec3 way_W = places.point(index) - emission.point_W;
      const double distance_m = norm(way_W);
      if (!(distance_m <= spec.range_m)) return true;
      const Vec3 direction_W = distance_m > 0 ? way_W * (1 / distance_m) : Vec3{1, 0, 0};
      double intensity_Wpsr = emission.strength;
      if (order > 0) {
        const double cosine = dot(emission.direction_W, direction_W);
        if (!(cosine > 0)) return true;
        intensity_Wpsr *= math::pow(cosine, order);
      }
      const double squared_m2 = std::max(distance_m, nearest_m) * std::max(distance_m, nearest_m);
      const double strength_Wpm2 = intensity_Wpsr / squared_m2;
      if (!(strength_Wpm2 > 0 && strength_Wpm2 >= spec.least_Wpm2)) return true;
      to.directions.push_back(direction_W);
      to.distances_m.push_back(distance_m);
      to.strengths_Wpm2.push_back(strength_Wpm2);
      farthest_m = std::max(farthest_m, distance_m);
      return false;
    };
    std::erase_if(to.receivers, is_dark);
    to.hit_m.assign(to.receivers.size(), std::numeric_limits<float>::infinity());
    to.hit_bodies.assign(to.receivers.size(), no_body);
    if (!(farthest_m > 0)) return;
    const RayJob job{.X_WS = {emission.point_W, {}},
                     .directions = to.directions,
                     .max_m = farthest_m,
                     .ignore_body = emission.body.index,
                     .distance_m = to.hit_m,
                     .body = to.hit_bodies};
    context.rays.cast({&job, 1});
  }

  void send(const Emission& emission, const MediumContext& context, const Lit& to) {
    constexpr double light_mps = 299'792'458;
    ++state.sent;
    const std::span<const std::byte> bytes = context.buffer.bytes(emission);
    const auto* const first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    for (std::size_t i = 0; i < to.receivers.size(); ++i) {
      const Receiver& receiver = context.receivers[to.receivers[i]];
      if (to.hit_m[i] < to.distances_m[i] && to.hit_bodies[i] != receiver.body.index) {
        ++state.blocked;
        continue;
      }
      ++state.delivered;
      receiver.inbox->put({.at = emission.at + Time::from_s(to.distances_m[i] / light_mps),
                           .emitter = emission.emitter,
                           .channel = emission.channel,
                           .strength = to.strengths_Wpm2[i],
                           .direction_W = to.directions[i] * -1.0},
                          {first, bytes.size()});
    }
  }

  /// In blocks, so that memory stays bounded.
  void deliver(const MediumContext& context) {
    constexpr std::size_t most_at_once = 64;
    if (context.emissions.empty()) return;
    places.update(context);
    for (std::size_t first = 0; first < context.emissions.size(); first += most_at_once) {
      const auto block = context.emissions.subspan(first,
                                                   std::min(most_at_once, context.emissions.size() - first));
      lit.resize(std::max(lit.size(), block.size()));
      parallel_for(block.size(), 2, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) look(block[i], context, lit[i]);
      });
      for (std::size_t i = 0; i < block.size(); ++i) send(block[i], context, lit[i]);
    }
  }
};

}  // namespace

extern const MediumKind kind;
constinit const MediumKind kind = make_medium<Infrared>({
    .name = "infrared",
    .help = "Light that carries packets of data along a free straight line.",
});

}  // namespace sandlot::media::infrared
