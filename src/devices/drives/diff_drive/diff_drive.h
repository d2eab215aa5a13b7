#pragma once
/// Differential drive: a speed and a turning rate in, two sides of wheels and odometry out.
///
/// Frame    B: the canonical link. D: centre of the axle, the mean of the wheel joints' origins, axes as B.
///          Commands are velocities of D in D; other components of the Twist are ignored.
/// Levels   `ideal` (the default): the base moves on rails at the commanded velocity with limited
///          acceleration, on every engine; the wheels turn as if they rolled. `contact`: the wheels are
///          driven with at most max_wheel_effort each, and friction decides the motion; needs an engine with
///          contact_drives. Exactly one level is active. A switch keeps odometry, command and velocity.
/// Command  geometry_msgs/Twist, or a piece of way (devices/drives/maneuver.h), which needs no `odometry: true`: from the first
///          one on the odometry is counted.
/// Output   nav_msgs/Odometry of B on both levels, from the angles of the wheel joints alone: frame
///          "<robot>/odom", child "<robot>/<canonical link>". Pose: from where B stood when the drive was
///          built. Twist: velocity of B in B. Slip on level `contact` makes it wrong, as on a real robot.
/// Time     odometry is integrated in every tick on exact arcs (kinematics/differential.h) and published at
///          `rate`. A command acts from the tick it arrives in; after `command_timeout` without a new one the
///          drive stops.
/// Energy   draws its mechanical work (devices/energy.h): on rails, or of its wheels' motors.
/// Limits   no motor model, no systematic errors of radius and separation, no covariance (zeros).
/// Cost     one arc per tick and drive, none without odometry; no allocation. On an engine that rolls wheels
///          itself (Capabilities::rolls) the level `ideal` costs nothing per sub-step.
/// Errors   joints that are not there, do not turn or lie along the robot; a level the engine lacks.
/// Source   kinematics/differential.h.
#include <array>
#include <optional>

#include "devices/drives/maneuver.h"
#include "devices/kind.h"
#include "kinematics/differential.h"
#include "messages/messages.h"

namespace sandlot::diff_drive {

struct Spec {
  std::vector<std::string> left_joint, right_joint;
  std::optional<double> wheel_radius_m, wheel_separation_m;  ///< unset: from the model's wheels
  double max_linear_speed_mps = 1.0;
  double max_angular_speed_radps = 3.0;
  double max_linear_acceleration_mps2 = 2.0;
  double max_angular_acceleration_radps2 = 10.0;
  double max_wheel_effort_Nm = 5.0;
  double command_timeout_s = 0.0;
  double rate_hz = 50.0;
  bool odometry = true;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned required = Field::required, tunable = Field::tunable;
    visit(Field{"left_joint", "", "Wheel joint on the left side, or a list of them.", 0, 0, required, 100},
          s.left_joint);
    visit(Field{"right_joint", "", "Wheel joint on the right side, or a list of them.", 0, 0, required, 100},
          s.right_joint);
    visit(Field{"wheel_radius", "m", "Radius of the wheels; not given: that of their collision shapes.", 1e-4,
                100},
          s.wheel_radius_m);
    visit(Field{"wheel_separation", "m",
                "Distance between left and right wheels; not given: from the joints.", 1e-3, 1000},
          s.wheel_separation_m);
    visit(Field{"max_linear_speed", "m/s", "Largest speed; faster commands are cut.", 0, 1e9, tunable},
          s.max_linear_speed_mps);
    visit(Field{"max_angular_speed", "rad/s", "Largest turning rate; faster commands are cut.", 0, 1e9,
                tunable},
          s.max_angular_speed_radps);
    visit(Field{"max_linear_acceleration", "m/s^2", "Largest acceleration, speeding up and braking.", 0, 1e9,
                tunable},
          s.max_linear_acceleration_mps2);
    visit(Field{"max_angular_acceleration", "rad/s^2",
                "Largest angular acceleration, speeding up and braking.", 0, 1e9, tunable},
          s.max_angular_acceleration_radps2);
    visit(Field{"max_wheel_effort", "Nm", "Largest effort of each wheel's motor at level contact.", 0, 1e9,
                tunable},
          s.max_wheel_effort_Nm);
    visit(Field{"command_timeout", "s", "Time without a command after which the robot stops; 0: never.", 0,
                1e6, tunable},
          s.command_timeout_s);
    visit(Field{"rate", "Hz", "Odometry messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"odometry", "",
                "Whether the odometry is computed and published; false saves time in large swarms."},
          s.odometry);
  }
};

enum Level : std::uint32_t { ideal, contact };

struct State {
  std::array<std::uint64_t, 2> taken{};  ///< per level: commands seen so far
  double command_mps = 0, command_radps = 0;
  Time command_time;
  double setpoint_mps = 0, setpoint_radps = 0;  ///< of D, on its way to the command; level contact
  std::uint8_t release = 0;                     ///< the base is still on rails of the level `ideal` left
  double left_rad = 0, right_rad = 0;           ///< mean wheel angles that the odometry has counted
  kinematics::PlanarPose X_OD;                  ///< odometry of the axle's centre

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen per level."}, s.taken);
    visit(Field{"command_linear", "m/s", "Speed of the command in force."}, s.command_mps);
    visit(Field{"command_angular", "rad/s", "Turning rate of the command in force."}, s.command_radps);
    visit(Field{"command_time", "ns", "Time of the last command."}, s.command_time);
    visit(Field{"setpoint_linear", "m/s", "Speed requested from the wheels."}, s.setpoint_mps);
    visit(Field{"setpoint_angular", "rad/s", "Turning rate requested from the wheels."}, s.setpoint_radps);
    visit(Field{"release", "1", "Whether the base is to be released to its wheels (1)."}, s.release);
    visit(Field{"left", "rad", "Angle counted at the left wheel."}, s.left_rad);
    visit(Field{"right", "rad", "Angle counted at the right wheel."}, s.right_rad);
    visit(Field{"odometry", "m", "Odometry of the axle's centre."}, s.X_OD);
  }
};

/// One wheel: its joint and which way round the joint turns.
struct Wheel {
  JointId joint;
  double sign = 1;                       ///< +1: a positive angle rolls forward
  double max_effort = 0, max_speed = 0;  ///< of the joint
};

struct Drive {
  using Spec = diff_drive::Spec;
  using State = diff_drive::State;
  SharedSpec<Spec> spec;
  State state;
  Boxed<maneuver::Late> late;

  BodyId base;
  EnergyMeter* energy = nullptr;
  Capabilities engine;
  kinematics::Differential geometry;
  double dx_m = 0, dy_m = 0;  ///< D in B
  double max_wheel_speed_radps = 0;
  std::vector<Wheel> left, right;
  std::array<Topic<msg::Twist>*, 2> command{};
  std::array<Topic<msg::Odometry>*, 2> odometry{};
  maneuver::Topics maneuver;

  bool fits() const { return maneuver::fits(late, left.size() + right.size()); }
  static Result<Drive> create(const DeviceBuild& build, SharedSpec<Spec> spec);
  static void actuate(PoolView<Drive> pool, const Context& context);
  static void pre_substep(PoolView<Drive> pool, const Context& context, double h_s);
  static void sense(PoolView<Drive> pool, const Context& context);
  void release(const Context& context);
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context);
};

/// SDF plugin to spec keys (from_sdf.cpp).
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics);

extern const Kind kind;

}  // namespace sandlot::diff_drive
