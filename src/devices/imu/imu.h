#pragma once
/// Inertial measurement unit: three gyroscopes, three accelerometers and the orientation computed from them.
///
/// Frame    sensor frame S: the link's frame moved by the device's own pose. Rates and accelerations are given in S.
/// Output   level `imu`: sensor_msgs/Imu. angular_velocity [rad/s]. linear_acceleration: the specific force [m/s^2],
///          acceleration of S's origin less gravity, so (0, 0, 9.81) at rest. orientation of S in the frame that
///          `reference` names. Covariances are those of the noise configured,
///          at the factor `errors` of the start.
/// Time     rates and forces are means over the interval since the previous sample, as integrating sensors show them:
///          per sub-step h the velocity of S's origin changes by dv and S turns by dq;
///
///            f = 1/T sum R_m^T (dv - g h)        w = 1/T sum rotation_vector(dq)
///
///          with R_m the orientation half way. The orientation is that at the end of the tick. The first sample of a
///          device has no interval: it shows the present rate and a force without acceleration.
/// Noise    noise/channel_noise.h, for each axis of gyro and accel. The orientation is exact.
/// Limits   no errors of the axes' directions, temperature, vibration between sub-steps, filter delays. East is the world's x
///          axis. Setting a robot's pose while it moves shows as a blow in the sample that covers it.
/// Cost     a few rotations and one arc tangent per sub-step; six noise channels per sample; no allocation.
/// Errors   a bad spec: place and path of the key.
/// Source   D. Titterton, J. Weston, Strapdown Inertial Navigation Technology, 2nd ed. (2004), sec. 3.5 (specific
///          force), ch. 11 (increments of velocity and angle). REP 145.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/channel_noise.h"

namespace sandlot::imu {

enum class Reference : std::uint8_t { start, world, custom };
inline std::span<const EnumName<Reference>> enum_names(Reference) {
  static constexpr EnumName<Reference> names[] = {
      {"start", Reference::start}, {"world", Reference::world}, {"custom", Reference::custom}};
  return names;
}

/// One error model per axis of S.
struct AxesSpec {
  ChannelNoiseSpec x, y, z;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "", "About or along x."}, s.x);
    visit(Field{"y", "", "About or along y."}, s.y);
    visit(Field{"z", "", "About or along z."}, s.z);
  }
};
struct Axes {
  ChannelNoise x, y, z;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "", "About or along x."}, s.x);
    visit(Field{"y", "", "About or along y."}, s.y);
    visit(Field{"z", "", "About or along z."}, s.z);
  }
};

struct Spec {
  double rate_hz = 100.0;
  Reference reference = Reference::world;
  Vec3 reference_rpy_rad;
  AxesSpec gyro, accel;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(
        Field{
            "reference", "",
            "Frame of the orientation: the world, the sensor's own at the start, or custom (reference_rpy)."},
        s.reference);
    visit(Field{"reference_rpy", "rad", "Roll, pitch, yaw of the custom reference frame in the world.", -1e4,
                1e4},
          s.reference_rpy_rad);
    visit(Field{"gyro", "rad/s", "Errors of the gyroscopes."}, s.gyro);
    visit(Field{"accel", "m/s^2", "Errors of the accelerometers."}, s.accel);
    visit(errors_field, s.errors);
  }
};

struct State {
  Vec3 v_W;              ///< [m/s] of S's origin when the running sub-step began
  Quat q_WS;             ///< then
  double running_s = 0;  ///< length of the sub-step that is not yet counted; 0: none
  double counted_s = 0;  ///< T so far
  Vec3 velocity_S;       ///< [m/s] sum of R_m^T (dv - g h)
  Vec3 turn_S;           ///< [rad] sum of the rotation vectors
  Axes gyro, accel;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"v", "m/s", "Velocity when the running sub-step began."}, s.v_W);
    visit(Field{"q", "1", "Orientation then."}, s.q_WS);
    visit(Field{"running", "s", "Length of the sub-step that is not counted yet."}, s.running_s);
    visit(Field{"counted", "s", "Time covered since the previous sample."}, s.counted_s);
    visit(Field{"velocity", "m/s", "Specific force integrated since then."}, s.velocity_S);
    visit(Field{"turn", "rad", "Rate integrated since then."}, s.turn_S);
    visit(Field{"gyro", "rad/s", "Errors of the gyroscopes."}, s.gyro);
    visit(Field{"accel", "m/s^2", "Errors of the accelerometers."}, s.accel);
  }
};

struct Imu {
  using Spec = imu::Spec;
  using State = imu::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link
  Pose X_LS;
  Vec3 gravity_mps2;
  Quat q_RW;  ///< world in the orientation's reference frame
  Topic<msg::Imu>* message = nullptr;

  static Result<Imu> create(const DeviceBuild& build, Spec spec);
  static void pre_substep(PoolView<Imu> pool, const Context& context, double h_s);
  static void sense(PoolView<Imu> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::imu
