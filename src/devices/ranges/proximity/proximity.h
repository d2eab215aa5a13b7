#pragma once
/// Ring of short-range infra-red proximity sensors about a small robot.
///
/// Frame    sensor frame S: x forward, y left, z up, in the middle of the ring. Sensor i sits on a circle of
///          `radius` in S's xy plane at the angle first_angle + i * spacing, counter-clockwise positive, and
///          looks straight outwards.
/// Output   level `proximity`: sensor_msgs/LaserScan, one beam per sensor. `intensities`: the readings, 0
///          nothing in reach, 1 as near as can be. `ranges`: distances from S's origin as everybody draws
///          them, so from `radius` to radius + range; +inf: nothing in reach. With d the distance from the
///          sensor, `response`
///            linear          reading = 1 - d / range
///            inverse_square  reading = min(1, (saturation / d)^2), as reflected light falls off
/// Time     the end of the tick, all sensors at once.
/// Noise    noise/range_noise.h on d; the reading follows from the distance that was shown.
/// Housing  rays start at the sensors, so what lies within the ring is not seen; nor is the link that carries
///          it.
/// Limits   a ray per sensor: no beam width, colour, ambient light or cross-talk. Sensors sit at even
///          spacings.
/// Cost     `sensors` ray casts per sample, all rings of a world in batches, in parallel; no allocation.
/// Errors   a bad spec: place and path of the key.
/// Source   the reading's form: general knowledge of reflective infra-red sensors; noise/range_noise.h.
#include <memory>
#include <vector>

#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/range_noise.h"

namespace sandlot::proximity {

enum class Response : std::uint8_t { linear, inverse_square };
inline std::span<const EnumName<Response>> enum_names(Response) {
  static constexpr EnumName<Response> names[] = {{"linear", Response::linear},
                                                 {"inverse_square", Response::inverse_square}};
  return names;
}

struct Spec {
  int sensors = 24;
  double radius_m = 0.085;
  double range_m = 0.1;
  double first_angle_rad = 0;
  double spacing_rad = 0;
  Response response = Response::linear;
  double saturation_m = 0.01;
  double rate_hz = 0;
  RangeNoiseSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"sensors", "1", "Number of sensors.", 1, 10'000}, s.sensors);
    visit(Field{"radius", "m", "Radius of the circle of sensors.", 0, 100}, s.radius_m);
    visit(Field{"range", "m", "Farthest measured distance.", 1e-3, 100}, s.range_m);
    visit(Field{"first_angle", "rad", "Angle of sensor 0.", -6.3, 6.3}, s.first_angle_rad);
    visit(Field{"spacing", "rad", "Angle from one sensor to the next; 0: evenly all round.", 0, 6.3},
          s.spacing_rad);
    visit(Field{"response", "", "Relation between distance and reading."}, s.response);
    visit(Field{"saturation", "m", "Distance below which the reading is 1; response inverse_square.", 1e-6,
                100},
          s.saturation_m);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"noise", "m", "Errors of the distances."}, s.noise);
    visit(errors_field, s.errors);
  }
};

struct State {
  RangeNoise noise;

  static void fields(auto& s, auto&& visit) { visit(Field{"noise", "m", "State of the errors."}, s.noise); }
};

struct Ring {
  using Spec = proximity::Spec;
  using State = proximity::State;
  SharedSpec<Spec> spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link that carries it
  Pose X_LS;
  std::shared_ptr<const std::vector<Vec3>> directions_S;  ///< shared by rings that look alike
  Topic<msg::LaserScan>* scan = nullptr;

  static Result<Ring> create(const DeviceBuild& build, SharedSpec<Spec> spec);
  static void sense(PoolView<Ring> pool, const Context& context);
};

/// The reading of one sensor. @param d_m  distance from the sensor; +inf: nothing in reach
float reading(const Spec& spec, float d_m);

extern const Kind kind;

}  // namespace sandlot::proximity
