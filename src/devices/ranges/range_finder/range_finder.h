#pragma once
/// Range finder that measures one distance: an infra-red beam or the cone of a sonar.
///
/// Frame    sensor frame S: it looks along x. Rays leave S's origin: one along x, and on ring k of `rings` 6
///          k rays, evenly about x, at the angle k / rings * fov / 2 from it.
/// Output   level `range`: sensor_msgs/Range, the nearest distance that any ray met [m]. +inf: nothing within
///          max_range. -inf: nearer than min_range. Never NaN. Convention of ROS REP 117.
/// Time     the end of the tick.
/// Noise    noise/range_noise.h, on the distance shown.
/// Housing  as laser_scanner: the link that carries it is never seen.
/// Limits   no echo from grazing faces that a real sonar would lose, no cross-talk, no dependence on colour
///          or temperature; a thing thinner than the gap between two rays may be missed.
/// Cost     1 + 3 rings (rings + 1) ray casts per sample, no allocation.
/// Errors   a bad spec: place and path of the key.
/// Source   ROS REP 117; noise/range_noise.h.
#include <vector>

#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/range_noise.h"

namespace sandlot::range_finder {

enum class Radiation : std::uint8_t { ultrasound = msg::Range::ultrasound, infrared = msg::Range::infrared };
inline std::span<const EnumName<Radiation>> enum_names(Radiation) {
  static constexpr EnumName<Radiation> names[] = {{"ultrasound", Radiation::ultrasound},
                                                  {"infrared", Radiation::infrared}};
  return names;
}

struct Spec {
  Radiation radiation = Radiation::ultrasound;
  double fov_rad = 0.5;
  int rings = 3;
  double min_range_m = 0.02;
  double max_range_m = 4.0;
  double rate_hz = 20.0;
  RangeNoiseSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"radiation", "", "Type of radiation."}, s.radiation);
    visit(Field{"fov", "rad", "Opening angle of the cone, edge to edge.", 0, 3.14}, s.fov_rad);
    visit(Field{"rings", "1", "Number of rings of rays that sample the cone; 0: a single ray.", 0, 50},
          s.rings);
    visit(Field{"min_range", "m", "Nearest measured distance; a nearer obstacle reads -inf.", 0, 1e4},
          s.min_range_m);
    visit(Field{"max_range", "m", "Farthest measured distance; a farther obstacle reads +inf.", 1e-3, 1e4},
          s.max_range_m);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"noise", "m", "Errors of the distance."}, s.noise);
    visit(errors_field, s.errors);
  }
};

struct State {
  RangeNoise noise;

  static void fields(auto& s, auto&& visit) { visit(Field{"noise", "m", "State of the errors."}, s.noise); }
};

struct Finder {
  using Spec = range_finder::Spec;
  using State = range_finder::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link that carries it
  Pose X_LS;
  std::vector<Vec3> directions_S;
  std::vector<float> distance_m;  ///< of the sample being taken
  Topic<msg::Range>* range = nullptr;

  static Result<Finder> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Finder> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::range_finder
