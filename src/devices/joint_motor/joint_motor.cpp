#include "devices/joint_motor/joint_motor.h"

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

/// Where the reference starts when `level` takes over.
double present(Level level, const JointState& joint) {
  return level == velocity ? joint.velocity : level == position ? joint.position : joint.effort;
}

void take_command(Motor& motor, Level level, const JointState& joint) {
  const Topic<msg::Float64>& slot = *motor.command[level];
  State& state = motor.state;
  if (slot.count == state.taken[level]) return;
  state.taken[level] = slot.count;
  if (!std::isfinite(slot.message.data)) return;  // a message may hold anything; the old command stays
  if (!state.powered) {
    state.powered = 1;
    state.reference = present(level, joint);
    state.previous_velocity = joint.velocity;
  }
  state.command = slot.message.data;
}

double towards(double from, double to, double step) { return from + std::clamp(to - from, -step, step); }

double servo(Motor& motor, Level level, const JointState& joint, double h_s) {
  State& state = motor.state;
  const double limit = motor.effort_limit(), fastest = motor.velocity_limit();
  switch (level) {
    case velocity: {
      state.reference = std::clamp(state.command, -fastest, fastest);
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
    const Node* const node = build.decl.config.find("joint");
    return Error{"joint '" + spec.joint + "' cannot be driven",
                 "a motor needs a revolute, continuous or prismatic joint",
                 node ? node->place() : build.decl.place, "/joint"};
  }
  Motor motor{std::move(spec)};
  motor.joint = build.joints[index];
  const bool bounded = joint.type != JointType::continuous;
  motor.lower = bounded ? joint.lower : -1e16;
  motor.upper = bounded ? joint.upper : 1e16;
  motor.joint_effort = joint.max_effort;
  motor.joint_velocity = joint.max_velocity;
  motor.command[velocity] = build.accept<msg::Float64>(velocity, "velocity");
  motor.command[position] = build.accept<msg::Float64>(position, "position");
  motor.command[effort] = build.accept<msg::Float64>(effort, "effort");
  return motor;
}

void Motor::actuate(PoolView<Motor> pool, const Context& context) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Motor& motor = pool.all[index];
    take_command(motor, active(pool.levels[index]), joints[motor.joint.index]);
  }
}

void Motor::pre_substep(PoolView<Motor> pool, const Context& context, double h_s) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Motor& motor = pool.all[index];
    if (!motor.state.powered) continue;
    const double effort_wanted = servo(motor, active(pool.levels[index]), joints[motor.joint.index], h_s);
    context.actuation.joints.push_back(
        {.joint = motor.joint, .mode = JointTarget::Mode::effort, .effort = effort_wanted});
  }
}

Status Motor::switch_level(std::uint32_t before, std::uint32_t after, const Context& context) {
  SL_TRY(check_levels(after));
  if (before == after) return {};
  const JointState& now = context.engine.joint_states()[joint.index];
  const Level level = active(after);
  // With no error left the PID's output is integral - d * rate: start it at the effort of now. Without an integral
  // gain nothing would ever take that value away again.
  const Gains& gains = level == position ? spec.position : spec.velocity;
  state.pid.integral = gains.i == 0        ? 0
                       : level == position ? now.effort + gains.d * now.velocity
                                           : now.effort;
  state.previous_velocity = now.velocity;
  state.command = state.reference = present(level, now);
  return {};
}

namespace {
constexpr LevelInfo levels[] = {
    {"velocity", "", msg::Float64::ros_type, "Follows a speed [rad/s or m/s]."},
    {"position", "", msg::Float64::ros_type, "Follows an angle or length [rad or m]."},
    {"effort", "", msg::Float64::ros_type, "Applies a torque or force [Nm or N]."},
};
}  // namespace

constinit const Kind kind = make_kind<Motor>({
    .name = "joint_motor",
    .help = "Motor with a servo loop on one joint: speed, angle or effort.",
    .levels = levels,
});

}  // namespace sandlot::joint_motor
