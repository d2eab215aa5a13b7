#pragma once
/// Motor with a servo loop on one joint.
///
/// Levels   `velocity` (the default): follows a speed. `position`: follows an angle (prismatic: a length).
///          `effort`: applies a torque (force). Each takes a std_msgs/Float64. Exactly one level is active.
/// Control  servo `pid`: PID (devices/pid.h) from the error to an effort, once per physics sub-step. Servo
///          `exact`: the engine holds the joint to the speed with what effort it takes up to the limit; on
///          level position that speed closes a fifth of the error in each sub-step. The reference moves
///          towards the command at no more than max_velocity; position commands are cut to the joint's
///          limits, efforts to the smaller of max_effort and the joint's own.
/// Safety   where the joint has safety limits (model/joint.h), position commands are cut to its soft limits, speeds to
///          those that its position allows, and with gains efforts to those that its speed allows.
/// Scale    `commands: si` (the default) takes rad, m, rad/s, Nm ... `share` takes -1 to 1 of the limit on
///          that side (0 stays 0; LpzRobots' OneAxisServo), `centred` of the way from the middle between the
///          joint's limits to them; of speeds and efforts both are shares of max_velocity and max_effort.
///          What lies beyond is cut.
/// Output   none; a wheel_encoder shows the joint's state.
/// Time     a command acts from the tick it arrives in. Before the first one the joint is free, unless there
///          is an `initial_command`.
/// Stopping the tunable `active: false` sets the joint free; commands that come then are dropped. When it is
/// started
///          again it holds the angle, speed (level effort: nothing) it finds, until its next command.
/// Switch   the new level starts at the present angle, speed or effort and holds it until its first command;
///          an integral (if the gains have one) starts where the effort continues without a jump.
/// Noise    none: the loop sees the true angle and speed.
/// Energy   draws its mechanical work (devices/energy.h).
/// Limits   no electrical dynamics, back-EMF, gear play or thermal limit.
/// Cost     one PID step per sub-step, no allocation.
/// Errors   a joint that is not there or has no single degree of freedom; an engine without simulated joints;
///          shares of a limit that there is not.
/// Source   devices/pid.h.
#include <array>

#include "devices/kind.h"
#include "devices/pid.h"
#include "messages/messages.h"

namespace sandlot::joint_motor {

enum class Servo : std::uint8_t { pid, exact };
inline std::span<const EnumName<Servo>> enum_names(Servo) {
  static constexpr EnumName<Servo> names[] = {{"pid", Servo::pid}, {"exact", Servo::exact}};
  return names;
}

enum class Commands : std::uint8_t { si, share, centred };
inline std::span<const EnumName<Commands>> enum_names(Commands) {
  static constexpr EnumName<Commands> names[] = {
      {"si", Commands::si}, {"share", Commands::share}, {"centred", Commands::centred}};
  return names;
}

struct Spec {
  std::string joint;
  bool active = true;
  Servo servo = Servo::pid;
  Commands commands = Commands::si;
  std::optional<double> initial_command;
  Gains velocity{.p = 1.0};
  Gains position{.p = 10.0, .d = 1.0};
  double max_effort = 1e9;    ///< [Nm] or [N]
  double max_velocity = 1e9;  ///< [rad/s] or [m/s]

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joint", "", "Name of the revolute, continuous or prismatic joint.", 0, 0, Field::required,
                1000},
          s.joint);
    visit(Field{"active", "", "Whether the motor is on; false: the joint is free.", 0, 1, Field::tunable},
          s.active);
    visit(Field{"servo", "", "Control of speed and position: by gains, or exactly up to the largest effort."},
          s.servo);
    visit(Field{"commands", "",
                "Unit of commands: SI units, or -1 to 1 of the limits, with 0 at 0 or in the middle."},
          s.commands);
    visit(Field{"initial_command", "", "Command in force before the first one arrives.", -1e9, 1e9},
          s.initial_command);
    visit(Field{"velocity", "", "Gains of level velocity: Nm per rad/s (prismatic: N per m/s)."}, s.velocity);
    visit(Field{"position", "", "Gains of level position: Nm per rad (prismatic: N per m)."}, s.position);
    visit(Field{"max_effort", "", "Largest effort [Nm or N], within the joint's own limit.", 0, 1e9,
                Field::tunable},
          s.max_effort);
    visit(Field{"max_velocity", "", "Largest reference speed [rad/s or m/s], within the joint's own limit.",
                0, 1e9, Field::tunable},
          s.max_velocity);
  }
};

enum Level : std::uint32_t { velocity, position, effort };
enum Power : std::uint8_t { waiting, following, stopped };

struct State {
  std::array<std::uint64_t, 3> taken{};  ///< per level: commands seen so far
  std::uint8_t powered = 0;              ///< a Power
  double command = 0;                    ///< in the active level's unit
  double reference = 0;                  ///< on its way to the command
  double previous_velocity = 0;          ///< for the rate of level velocity
  Pid pid;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen per level."}, s.taken);
    visit(Field{"powered", "1", "State of power. 0: free until a command, 1: following, 2: stopped."},
          s.powered);
    visit(Field{"command", "", "Command in force."}, s.command);
    visit(Field{"reference", "", "Present position of the reference."}, s.reference);
    visit(Field{"previous_velocity", "", "Joint speed one sub-step ago."}, s.previous_velocity);
    visit(Field{"pid", "", "State of the servo loop."}, s.pid);
  }
};

struct Motor {
  using Spec = joint_motor::Spec;
  using State = joint_motor::State;
  Spec spec;
  State state;

  JointId joint;
  EnergyMeter* energy = nullptr;
  double lower = 0, upper = 0;  ///< of the joint
  double joint_effort = 0, joint_velocity = 0;
  std::optional<model::SafetyLimits> safety;  ///< of the joint
  std::array<Topic<msg::Float64>*, 3> command{};

  static Result<Motor> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Motor> pool, const Context& context);
  static void pre_substep(PoolView<Motor> pool, const Context& context, double h_s);
  void release(const Context& context);
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context);

  /// A command as it came, in the level's unit.
  double in_units(Level level, double command) const;
  /// Limit of which commands are shares, where they are.
  Status check_scale(std::uint32_t levels) const;
  double effort_limit() const { return std::min(spec.max_effort, joint_effort); }
  double velocity_limit() const { return std::min(spec.max_velocity, joint_velocity); }
  /// Lowest and highest speed that the limits and the joint's position allow.
  std::array<double, 2> speeds_at(double position) const;
};

/// Gazebo's JointController, JointPositionController and ApplyJointForce as keys of the spec.
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics);

extern const Kind kind;

}  // namespace sandlot::joint_motor
