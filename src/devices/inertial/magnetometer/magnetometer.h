#pragma once
/// Magnetometer and compass.
///
///   reading = M (R^T B + hard)     M: soft iron, symmetric; R: orientation of the sensor; B: the world's field
///
/// Frame    sensor frame S: the link's frame moved by the device's own pose. B is the world's
///          <magnetic_field>.
/// Levels   `field` (the default): sensor_msgs/MagneticField [T] in S. `heading`: std_msgs/Float64, the
///          direction of S's x axis about the vertical [rad], counter-clockwise from the world's x, in (-pi,
///          pi]: computed from the reading, with exact roll and pitch. Both may be active.
/// Time     the end of the tick.
/// Noise    noise/channel_noise.h for each axis.
/// Limits   one field for the whole world: no fields of motors, currents or walls; the heading knows the
///          declination.
/// Cost     three channels per sample, one arc tangent for the heading, no allocation.
/// Errors   a heading where the field has no horizontal part.
/// Source   P. D. Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd
///          ed. (2013), sec. 6.1.1 (hard and soft iron, heading from a levelled reading).
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/channel_noise.h"

namespace sandlot::magnetometer {

struct Spec {
  ChannelNoiseSpec x, y, z;
  Vec3 hard_iron_T;
  Vec3 soft_iron{1, 1, 1}, soft_iron_cross;
  double rate_hz = 50;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "T", "Errors along x."}, s.x);
    visit(Field{"y", "T", "Errors along y."}, s.y);
    visit(Field{"z", "T", "Errors along z."}, s.z);
    visit(
        Field{"hard_iron", "T", "Field of magnets that move with the sensor, in the sensor's frame.", -1, 1},
        s.hard_iron_T);
    visit(Field{"soft_iron", "1", "Diagonal of the soft-iron matrix: xx, yy, zz.", -100, 100}, s.soft_iron);
    visit(Field{"soft_iron_cross", "1", "Elements of the soft-iron matrix off the diagonal: xy, xz, yz.",
                -100, 100},
          s.soft_iron_cross);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelNoise x, y, z;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "T", "Errors along x."}, s.x);
    visit(Field{"y", "T", "Errors along y."}, s.y);
    visit(Field{"z", "T", "Errors along z."}, s.z);
  }
};

struct Magnetometer {
  using Spec = magnetometer::Spec;
  using State = magnetometer::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  Quat q_LS;
  Vec3 field_T;            ///< in W
  double declination = 0;  ///< [rad] of the horizontal field from the world's x
  Topic<msg::MagneticField>* field = nullptr;
  Topic<msg::Float64>* heading = nullptr;

  static Result<Magnetometer> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Magnetometer> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::magnetometer
