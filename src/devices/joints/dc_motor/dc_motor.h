#pragma once
/// Brushed DC motor with gear, power stage and controller on one joint.
///
///   winding   L di/dt = V - R i - k N w          k: torque constant [Nm/A] = back-EMF constant [V s/rad]
///   shaft     torque on the joint = N eta k i - N^2 (J dw/dt + b w) - N c sign(w)
///
/// with the gear ratio N, the joint's speed w, rotor inertia J, viscous friction b and Coulomb friction c,
/// the last three on the motor's side of the gear. eta is the gear's efficiency; where the load drives the
/// motor it counts as 1 / eta.
///
/// Levels   `velocity` (the default): a PID loop to a speed [rad/s]. `position`: to an angle [rad]. Both put
///          out a voltage; they run at `loop_rate` and see what the encoder shows: counts, and the counts
///          since the last run. `voltage` [V] and `pwm` [-1, 1] drive the power stage directly; `effort` [Nm
///          on the joint] drives the current that gives this torque, as far as voltage and current limit
///          reach. Each takes a std_msgs/Float64. Exactly one level is active; a switch keeps the electrical
///          state and the voltage, and the loop starts again.
/// Output   sandlot_msgs/MotorState on each level: target, true speed of the joint, torque on the joint
///          before Coulomb friction, mean voltage at the terminals and current in the winding over the last
///          sub-step.
/// Power    the power stage is an ideal bridge on a supply of `supply_voltage` behind `supply_resistance`: at
///          duty d the motor sees d V_s behind R + d^2 R_s. More than `max_current` is chopped. Until its
///          first command it is open: the motor coasts, with its friction and inertia.
/// Time     the winding is integrated exactly over each sub-step for constant voltage and speed (L = 0: at
///          once), with the speed that the sub-step ends with: the mean current is affine in it, so back-EMF
///          is an implicit damping and no step is too long. Inertia and friction are the engine's
///          (physics/engine.h, JointTarget).
/// Noise    quantisation by the encoder.
/// Energy   draws terminal voltage times current from the robot's battery, and gives it back while it brakes; what
///          `supply_resistance` costs is not drawn: that of the battery stands for it.
/// Limits   no iron losses, saturation, temperature, commutation ripple, gear play or elasticity; regenerated
///          current flows back into the supply.
/// Cost     one exponential per sub-step if L > 0, no allocation.
/// Errors   a joint that is not there or does not turn; an engine without simulated joints.
/// Source   P. Corke, Robotics, Vision and Control (2011), sec. 9.1 (motor, gear, friction, reflected
///          inertia); controller: devices/pid.h. Figures: docs/motors.md.
#include <array>

#include "devices/kind.h"
#include "devices/motor.h"
#include "devices/pid.h"
#include "messages/messages.h"

namespace sandlot::dc_motor {

struct Spec : MotorSpec {
  std::string joint;
  int encoder_counts = 0;
  double loop_rate_hz = 0.0;
  double max_acceleration = 1e9;  ///< [rad/s^2]
  Gains velocity{.p = 1.0, .i = 10.0};
  Gains position{.p = 10.0};
  double rate_hz = 0.0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joint", "", "Name of the revolute or continuous joint.", 0, 0, Field::required, 1000},
          s.joint);
    MotorSpec::fields(s, visit);
    visit(Field{"encoder_counts", "1",
                "Encoder counts per turn of the motor; 0: the loop sees the true angle and speed.", 0, 1e7},
          s.encoder_counts);
    visit(Field{"loop_rate", "Hz", "Rate of the controller; 0: once per physics step.", 0, 1e6},
          s.loop_rate_hz);
    visit(Field{"max_acceleration", "rad/s^2", "Acceleration of the target speed at level velocity.", 0, 1e9,
                Field::tunable},
          s.max_acceleration);
    visit(Field{"velocity", "", "Gains of level velocity: V per rad/s."}, s.velocity);
    visit(Field{"position", "", "Gains of level position: V per rad."}, s.position);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

enum Level : std::uint32_t { velocity, position, voltage, pwm, effort };
constexpr std::size_t level_count = 5;

struct State {
  std::array<std::uint64_t, level_count> taken{};  ///< per level: commands seen so far
  std::uint8_t powered = 0;                        ///< 1: the power stage is on
  double command = 0;                              ///< in the active level's unit
  double target = 0;                               ///< on its way to the command
  double volts = 0;                                ///< setpoint of the bridge
  double current_A = 0;                            ///< in the winding, at the end of the sub-step
  double mean_current_A = 0, terminal_V = 0;       ///< over the last sub-step
  double loop_due_s = 0;                           ///< until the controller runs again
  double loop_since_s = 0;                         ///< since it ran; 0: it has not
  double seen_rad = 0;                             ///< the angle it saw then
  double seen_rad_s = 0;                           ///< and the speed
  Pid pid;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen per level."}, s.taken);
    visit(Field{"powered", "1", "Whether the power stage is on (1)."}, s.powered);
    visit(Field{"command", "", "Command in force."}, s.command);
    visit(Field{"target", "", "Present target of the controller."}, s.target);
    visit(Field{"volts", "V", "Voltage requested from the power stage."}, s.volts);
    visit(Field{"current", "A", "Current in the winding."}, s.current_A);
    visit(Field{"mean_current", "A", "Mean current over the last sub-step."}, s.mean_current_A);
    visit(Field{"terminal_voltage", "V", "Mean terminal voltage over the last sub-step."}, s.terminal_V);
    visit(Field{"loop_due", "s", "Time until the next run of the controller."}, s.loop_due_s);
    visit(Field{"loop_since", "s", "Time since the last run of the controller."}, s.loop_since_s);
    visit(Field{"seen", "rad", "Angle at the last run of the controller."}, s.seen_rad);
    visit(Field{"seen_speed", "rad/s", "Speed at the last run of the controller."}, s.seen_rad_s);
    visit(Field{"pid", "", "State of the controller."}, s.pid);
  }
};

struct Motor {
  using Spec = dc_motor::Spec;
  using State = dc_motor::State;
  Spec spec;
  State state;

  JointId joint;
  EnergyMeter* energy = nullptr;
  Winding winding;  ///< of the running sub-step
  std::array<Topic<msg::Float64>*, level_count> command{};
  std::array<Topic<msg::MotorState>*, level_count> message{};

  static Result<Motor> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Motor> pool, const Context& context);
  static void pre_substep(PoolView<Motor> pool, const Context& context, double h_s);
  static void post_substep(PoolView<Motor> pool, const Context& context, double h_s);
  static void sense(PoolView<Motor> pool, const Context& context);
  void release(const Context& context);
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::dc_motor
