#pragma once
/// Inertial measurement unit: three gyroscopes, three accelerometers and the orientation computed from them.
///
/// Frame    sensor frame S: the link's frame moved by the device's own pose. Rates and accelerations are
///          given in S.
/// Levels   `imu` (the default) and `pose`, one or both.
/// Output   level `imu`: sensor_msgs/Imu. angular_velocity [rad/s]. linear_acceleration: the specific force
///          [m/s^2], acceleration of S's origin less gravity, so (0, 0, 9.81) at rest. orientation of S in
///          the frame that `reference` names. Covariances are those of the noise configured,
///          at the factor `errors` of the start.
///          Level `pose`: geometry_msgs/PoseWithCovarianceStamped of the canonical link in `world`, as
///          estimated by an inertial navigation that was right when the level became active and has had
///          nothing but its sensors since:
///
///            dv = velocity_walk sqrt(dt) n,  dp = v dt + its integral        std(p) = velocity_walk sqrt(t^3 / 3)
///            turn about the vertical: std = yaw_walk sqrt(t)
///
///          for each of x, y, z; roll and pitch, which gravity keeps right, are true. No sub-step is
///          integrated for it.
/// Time     rates and forces are means over the interval since the previous sample, as integrating sensors
///          show them: per sub-step h the velocity of S's origin changes by dv and S turns by dq;
///
///            f = 1/T sum R_m^T (dv - g h)        w = 1/T sum rotation_vector(dq)
///
///          with R_m the orientation half way. The orientation is that at the end of the tick. The first
///          sample of a device has no interval: it shows the present rate and a force without acceleration.
/// Noise    noise/channel_noise.h, for each axis of gyro and accel, and of the orientation: small turns about the axes of its
///          reference frame, after the true one. z is the heading's error, as magnets and iron make it; x and y are those of
///          levelling. Without keys the orientation is exact and its covariance 0.
/// Services calibrate (std_srvs/Trigger): sets the offsets of the gyroscopes so that they read zero now, as averaging at rest
///          does: mean, mean_std and the bias of this moment are gone, the bias drifts on from there. Refused while the unit
///          turns. Errors given as stages stay.
/// Limits   the orientation's errors do not depend on the orientation, as those of a magnet on board do, nor on accelerations.
///          No errors of the axes' directions, temperature, vibration between sub-steps, filter delays. East
///          is the world's x axis. Setting a robot's pose while it moves shows as a blow in the sample that
///          covers it.
/// Cost     a few rotations and one arc tangent per sub-step; nine noise channels per sample; no allocation.
/// Errors   a bad spec: place and path of the key.
/// Source   D. Titterton, J. Weston, Strapdown Inertial Navigation Technology, 2nd ed. (2004), sec. 3.5
///          (specific force), ch. 11 (increments of velocity and angle). REP 145.
#include <array>

#include "devices/kind.h"
#include "messages/device_services.h"
#include "messages/messages.h"
#include "noise/axes_noise.h"

namespace sandlot::imu {

enum class Reference : std::uint8_t { start, world, custom };
inline std::span<const EnumName<Reference>> enum_names(Reference) {
  static constexpr EnumName<Reference> names[] = {
      {"start", Reference::start}, {"world", Reference::world}, {"custom", Reference::custom}};
  return names;
}

/// Errors of the level pose.
struct PoseSpec {
  double velocity_walk = 0, yaw_walk = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"velocity_walk", "m/s/sqrt(s)", "Growth of the velocity's error.", 0, 1e3, Field::tunable},
          s.velocity_walk);
    visit(Field{"yaw_walk", "rad/sqrt(s)", "Growth of the heading's error.", 0, 10, Field::tunable},
          s.yaw_walk);
  }
};

struct PoseState {
  Vec3 velocity_mps, position_m;     ///< errors
  double yaw_rad = 0;                ///< error
  std::array<double, 3> variance{};  ///< of velocity, position along each axis, and heading
  double covariance = 0;             ///< of velocity and position
  bool begun = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"velocity", "m/s", "Error of the velocity."}, s.velocity_mps);
    visit(Field{"position", "m", "Error of the position."}, s.position_m);
    visit(Field{"yaw", "rad", "Error of the heading."}, s.yaw_rad);
    visit(Field{"variance", "", "Variances of velocity, position and heading."}, s.variance);
    visit(Field{"covariance", "m^2/s", "Covariance between velocity and position."}, s.covariance);
    visit(Field{"begun", "", "Whether a pose has been reported."}, s.begun);
  }
};

struct Spec {
  double rate_hz = 100.0;
  Reference reference = Reference::world;
  Vec3 reference_rpy_rad;
  AxesNoiseSpec gyro, accel, orientation;
  PoseSpec pose;
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
    visit(Field{"orientation", "rad", "Errors of the orientation, about the axes of its reference frame."},
          s.orientation);
    visit(Field{"pose_error", "", "Errors of the level pose."}, s.pose);
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
  AxesNoise gyro, accel, orientation;
  PoseState pose;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"v", "m/s", "Velocity at the start of the current sub-step."}, s.v_W);
    visit(Field{"q", "1", "Orientation at the start of the current sub-step."}, s.q_WS);
    visit(Field{"running", "s", "Length of the sub-step that is not counted yet."}, s.running_s);
    visit(Field{"counted", "s", "Time covered since the previous sample."}, s.counted_s);
    visit(Field{"velocity", "m/s", "Specific force integrated since the previous sample."}, s.velocity_S);
    visit(Field{"turn", "rad", "Rate integrated since the previous sample."}, s.turn_S);
    visit(Field{"gyro", "rad/s", "Errors of the gyroscopes."}, s.gyro);
    visit(Field{"accel", "m/s^2", "Errors of the accelerometers."}, s.accel);
    visit(Field{"orientation", "rad", "Errors of the orientation."}, s.orientation);
    visit(Field{"pose", "", "State of the level pose."}, s.pose);
  }
};

struct Imu {
  using Spec = imu::Spec;
  using State = imu::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link
  std::uint32_t base = 0;  ///< of the canonical link
  Pose X_LS;
  Vec3 gravity_mps2;
  Quat q_RW;  ///< world in the orientation's reference frame
  Topic<msg::Imu>* message = nullptr;
  Topic<msg::PoseWithCovarianceStamped>* pose = nullptr;

  static Result<Imu> create(const DeviceBuild& build, Spec spec);
  Result<msg::std_srvs::Trigger::Response> calibrate(const msg::std_srvs::Trigger::Request&,
                                                     const Context& context);
  static void pre_substep(PoolView<Imu> pool, const Context& context, double h_s);
  static void sense(PoolView<Imu> pool, const Context& context);
  /// A level that becomes active starts again: `imu` with an interval of its own, `pose` at the true pose.
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::imu
