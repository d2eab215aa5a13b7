#pragma once
/// Motor with a servo loop on one joint.
///
/// Levels   `velocity` (the default): follows a speed. `position`: follows an angle (prismatic: a length). `effort`:
///          applies a torque (force). Each takes a std_msgs/Float64. Exactly one level is active.
/// Control  PID (pid.h) from the error to an effort, once per physics sub-step. The reference moves towards the
///          command at no more than max_velocity; position commands are cut to the joint's limits, efforts to the
///          smaller of max_effort and the joint's own.
/// Output   none; a wheel_encoder shows the joint's state.
/// Time     a command acts from the tick it arrives in. Before the first one the joint is free.
/// Switch   the new level starts at the present angle, speed or effort and holds it until its first command; an
///          integral (if the gains have one) starts where the effort continues without a jump.
/// Noise    none: the loop sees the true angle and speed.
/// Limits   no electrical dynamics, back-EMF, gear play or thermal limit.
/// Cost     one PID step per sub-step, no allocation.
/// Errors   a joint that is not there or has no single degree of freedom; an engine without simulated joints.
/// Source   pid.h.
#include <array>

#include "devices/joint_motor/pid.h"
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::joint_motor {

struct Spec {
  std::string joint;
  Gains velocity{.p = 1.0};
  Gains position{.p = 10.0, .d = 1.0};
  double max_effort = 1e9;    ///< [Nm] or [N]
  double max_velocity = 1e9;  ///< [rad/s] or [m/s]

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joint", "", "Name of the revolute, continuous or prismatic joint.", 0, 0, Field::required,
                1000},
          s.joint);
    visit(Field{"velocity", "", "Gains of level velocity: Nm per rad/s (prismatic: N per m/s)."}, s.velocity);
    visit(Field{"position", "", "Gains of level position: Nm per rad (prismatic: N per m)."}, s.position);
    visit(Field{"max_effort", "", "Largest effort [Nm or N]; the joint's own limit holds too.", 0, 1e9,
                Field::tunable},
          s.max_effort);
    visit(Field{"max_velocity", "", "Fastest reference [rad/s or m/s]; the joint's own limit holds too.", 0,
                1e9, Field::tunable},
          s.max_velocity);
  }
};

enum Level : std::uint32_t { velocity, position, effort };

struct State {
  std::array<std::uint64_t, 3> taken{};  ///< per level: commands seen so far
  std::uint8_t powered = 0;              ///< 0 until the first command: the joint is free
  double command = 0;                    ///< in the active level's unit
  double reference = 0;                  ///< on its way to the command
  double previous_velocity = 0;          ///< for the rate of level velocity
  Pid pid;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Commands seen per level."}, s.taken);
    visit(Field{"powered", "1", "0: the joint is free."}, s.powered);
    visit(Field{"command", "", "Command in force."}, s.command);
    visit(Field{"reference", "", "Where the reference is now."}, s.reference);
    visit(Field{"previous_velocity", "", "Joint speed one sub-step ago."}, s.previous_velocity);
    visit(Field{"pid", "", "Servo loop."}, s.pid);
  }
};

struct Motor {
  using Spec = joint_motor::Spec;
  using State = joint_motor::State;
  Spec spec;
  State state;

  JointId joint;
  double lower = 0, upper = 0;  ///< of the joint
  double joint_effort = 0, joint_velocity = 0;
  std::array<Topic<msg::Float64>*, 3> command{};

  static Result<Motor> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Motor> pool, const Context& context);
  static void pre_substep(PoolView<Motor> pool, const Context& context, double h_s);
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context);

  double effort_limit() const { return std::min(spec.max_effort, joint_effort); }
  double velocity_limit() const { return std::min(spec.max_velocity, joint_velocity); }
};

extern const Kind kind;

}  // namespace sandlot::joint_motor
