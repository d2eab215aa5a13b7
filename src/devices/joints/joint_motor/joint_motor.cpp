#include "devices/joints/joint_motor/joint_motor.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sandlot::joint_motor {
namespace {

Status check_levels(std::uint32_t levels) {
  if (std::popcount(levels) == 1) return {};
  return Error{"a joint motor runs at exactly one level", "give 'velocity', 'position' or 'effort'"};
}

Level active(std::uint32_t levels) { return static_cast<Level>(std::countr_zero(levels)); }

/// Start of the reference when `level` takes over.
double present(Level level, const JointState& joint) {
  return level == velocity ? joint.velocity : level == position ? joint.position : joint.effort;
}

void take_command(Motor& motor, Level level, const JointState& joint) {
  const Topic<msg::Float64>& slot = *motor.command[level];
  State& state = motor.state;
  if (slot.count == state.taken[level]) return;
  state.taken[level] = slot.count;
  if (!std::isfinite(slot.message.data)) return;  // a message may hold anything; the old command stays
  if (state.powered == stopped) return;
  if (state.powered == waiting) {
    state.powered = following;
    state.reference = present(level, joint);
    state.previous_velocity = joint.velocity;
  }
  state.command = motor.in_units(level, slot.message.data);
}

double towards(double from, double to, double step) { return from + std::clamp(to - from, -step, step); }

/// The new servo loop begins where the joint is, at the effort of now. With no error left the PID's output is
/// integral - d * rate; without an integral gain nothing would ever take that value away again.
void hand_over(Motor& motor, Level level, const JointState& now) {
  State& state = motor.state;
  const Gains& gains = level == position ? motor.spec.position : motor.spec.velocity;
  state.pid.integral = gains.i == 0        ? 0
                       : level == position ? now.effort + gains.d * now.velocity
                                           : now.effort;
  state.previous_velocity = now.velocity;
  state.command = state.reference = present(level, now);
}

/// Follows the parameter `active`.
void start_or_stop(Motor& motor, Level level, const JointState& joint, std::vector<JointTarget>& targets) {
  State& state = motor.state;
  if (!motor.spec.active && state.powered != stopped) {
    if (state.powered == following) targets.push_back({.joint = motor.joint});
    state.powered = stopped;
  } else if (motor.spec.active && state.powered == stopped) {
    state.powered = following;
    JointState free = joint;
    free.effort = 0;  // whatever another motor put in: this one begins with none
    hand_over(motor, level, free);
  }
}

double cut(double x, std::array<double, 2> range) { return std::clamp(x, range[0], range[1]); }

/// Effort that the joint's safety limits allow at its speed of now.
double safe_effort(const Motor& motor, const JointState& joint, double wanted) {
  if (!motor.safety || motor.safety->k_velocity == 0) return wanted;
  const auto [lowest, highest] = motor.speeds_at(joint.position);
  const double limit = motor.effort_limit(), k = motor.safety->k_velocity;
  const double down = std::clamp(-k * (joint.velocity - lowest), -limit, limit);
  const double up = std::clamp(-k * (joint.velocity - highest), -limit, limit);
  return std::clamp(wanted, down, up);
}

/// Speed that the engine itself shall hold, for servo `exact`.
JointTarget exact_target(Motor& motor, Level level, const JointState& joint, double h_s) {
  State& state = motor.state;
  const double fastest = motor.velocity_limit();
  const std::array<double, 2> speeds = motor.speeds_at(joint.position);
  double speed = 0;
  if (level == velocity) {
    speed = state.reference = cut(state.command, speeds);
  } else {
    state.reference = towards(state.reference, std::clamp(state.command, motor.lower, motor.upper),
                              fastest * h_s);
    speed = cut(0.2 * (state.reference - joint.position) / h_s, speeds);
  }
  return {.joint = motor.joint,
          .mode = JointTarget::Mode::velocity,
          .velocity = speed,
          .max_effort = motor.effort_limit()};
}

double servo(Motor& motor, Level level, const JointState& joint, double h_s) {
  State& state = motor.state;
  const double limit = motor.effort_limit(), fastest = motor.velocity_limit();
  switch (level) {
    case velocity: {
      state.reference = cut(state.command, motor.speeds_at(joint.position));
      const double rate = (joint.velocity - state.previous_velocity) / h_s;
      state.previous_velocity = joint.velocity;
      return state.pid.step(motor.spec.velocity, state.reference - joint.velocity, rate, limit, h_s);
    }
    case position:
      state.reference = towards(state.reference, std::clamp(state.command, motor.lower, motor.upper),
                                fastest * h_s);
      return state.pid.step(motor.spec.position, state.reference - joint.position, joint.velocity, limit,
                            h_s);
    case effort: break;
  }
  state.reference = std::clamp(state.command, -limit, limit);
  return state.reference;
}

}  // namespace

std::array<double, 2> Motor::speeds_at(double position) const {
  const double fastest = velocity_limit();
  if (!safety || safety->k_position == 0) return {-fastest, fastest};
  const auto allowed = [&](double limit) {
    return std::clamp(-safety->k_position * (position - limit), -fastest, fastest);
  };
  return {allowed(safety->soft_lower), allowed(safety->soft_upper)};
}

double Motor::in_units(Level level, double given) const {
  if (spec.commands == Commands::si) return given;
  const double share = std::clamp(given, -1.0, 1.0);
  if (level == velocity) return share * velocity_limit();
  if (level == effort) return share * effort_limit();
  if (spec.commands == Commands::centred) return 0.5 * (upper + lower) + share * 0.5 * (upper - lower);
  return share > 0 ? share * upper : -share * lower;
}

Status Motor::check_scale(std::uint32_t levels) const {
  constexpr double unlimited = 1e9;
  if (spec.commands == Commands::si) return {};
  const Level level = active(levels);
  const bool limited = level == position ? lower > -unlimited && upper < unlimited
                       : level == effort ? effort_limit() < unlimited
                                         : velocity_limit() < unlimited;
  if (limited) return {};
  return Error{"commands of joint '" + spec.joint + "' are shares of a limit that it does not have",
               level == position ? "limit the joint in its model"
               : level == effort ? "give max_effort"
                                 : "give max_velocity",
               {},
               "/commands"};
}

Result<Motor> Motor::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(check_levels(build.levels));
  if (!build.engine.joints)
    return Error{"the engine '" + std::string(build.engine.name) + "' does not simulate joints",
                 "use the engine 'rigid'"};
  SL_ASSIGN(const std::uint32_t index, build.joint_index(spec.joint, "joint"));
  const model::Joint& joint = build.instance.model->joints[index];
  using model::JointType;
  if (joint.type != JointType::revolute && joint.type != JointType::continuous &&
      joint.type != JointType::prismatic) {
    return build.error("joint", "joint '" + spec.joint + "' cannot be driven",
                       "a motor needs a revolute, continuous or prismatic joint");
  }
  Motor motor{std::move(spec)};
  motor.joint = build.joints[index];
  motor.energy = build.energy;
  if (motor.energy) motor.energy->can_turn(motor.joint);
  const bool bounded = joint.type != JointType::continuous;
  motor.lower = bounded ? joint.lower : -1e16;
  motor.upper = bounded ? joint.upper : 1e16;
  motor.safety = joint.safety;
  if (joint.safety && joint.safety->k_position > 0) {
    motor.lower = std::max(motor.lower, joint.safety->soft_lower);
    motor.upper = std::max(motor.lower, std::min(motor.upper, joint.safety->soft_upper));
  }
  motor.joint_effort = joint.max_effort;
  motor.joint_velocity = joint.max_velocity;
  SL_TRY(motor.check_scale(build.levels));
  if (!motor.spec.active) {
    motor.state.powered = stopped;
  } else if (motor.spec.initial_command) {
    motor.state.powered = following;
    motor.state.command = motor.in_units(active(build.levels), *motor.spec.initial_command);
  }
  motor.command[velocity] = build.accept<msg::Float64>(velocity, "velocity");
  motor.command[position] = build.accept<msg::Float64>(position, "position");
  motor.command[effort] = build.accept<msg::Float64>(effort, "effort");
  return motor;
}

void Motor::actuate(PoolView<Motor> pool, const Context& context) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Motor& motor = pool.all[index];
    const Level level = active(pool.levels[index]);
    const JointState& joint = joints[motor.joint.index];
    start_or_stop(motor, level, joint, context.actuation.joints);
    take_command(motor, level, joint);
    if (motor.energy && motor.state.powered == following) motor.energy->turn_joints();
  }
}

void Motor::pre_substep(PoolView<Motor> pool, const Context& context, double h_s) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Motor& motor = pool.all[index];
    if (motor.state.powered != following) continue;
    const Level level = active(pool.levels[index]);
    const JointState& joint = joints[motor.joint.index];
    if (motor.spec.servo == Servo::exact && level != effort) {
      context.actuation.joints.push_back(exact_target(motor, level, joint, h_s));
      continue;
    }
    const double effort_wanted = safe_effort(motor, joint, servo(motor, level, joint, h_s));
    context.actuation.joints.push_back(
        {.joint = motor.joint, .mode = JointTarget::Mode::effort, .effort = effort_wanted});
  }
}

void Motor::release(const Context& context) {
  if (state.powered == following) context.actuation.joints.push_back({.joint = joint});
}

Status Motor::switch_level(std::uint32_t before, std::uint32_t after, const Context& context) {
  SL_TRY(check_levels(after));
  if (before == after) return {};
  SL_TRY(check_scale(after));
  hand_over(*this, active(after), context.engine.joint_states()[joint.index]);
  return {};
}

namespace {
constexpr LevelInfo levels[] = {
    {"velocity", "", msg::Float64::ros_type, "Follows a speed [rad/s or m/s]."},
    {"position", "", msg::Float64::ros_type, "Follows an angle or length [rad or m]."},
    {"effort", "", msg::Float64::ros_type, "Applies a torque or force [Nm or N]."},
};
constexpr const char* sdf_types[] = {"plugin:JointController",
                                     "plugin:gz-sim-joint-controller-system",
                                     "plugin:ignition-gazebo-joint-controller-system",
                                     "plugin:JointPositionController",
                                     "plugin:gz-sim-joint-position-controller-system",
                                     "plugin:ignition-gazebo-joint-position-controller-system",
                                     "plugin:ApplyJointForce",
                                     "plugin:gz-sim-apply-joint-force-system",
                                     "plugin:ignition-gazebo-apply-joint-force-system"};
}  // namespace

constinit const Kind kind = make_kind<Motor>({
    .name = "joint_motor",
    .help = "Motor with a servo loop on one joint: speed, angle or effort.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names, cmd_offset, limits of the integral, a list of joints in one plugin",
});

}  // namespace sandlot::joint_motor
