#include "devices/joints/dc_motor/dc_motor.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/math.h"

namespace sandlot::dc_motor {
namespace {

Status check_levels(std::uint32_t levels) {
  if (std::popcount(levels) == 1) return {};
  return Error{"a DC motor runs at exactly one level",
               "give 'velocity', 'position', 'voltage', 'pwm' or 'effort'"};
}

Level active(std::uint32_t levels) { return static_cast<Level>(std::countr_zero(levels)); }

/// Joint angle as the controller measures it.
double seen_angle(const Spec& spec, double angle_rad) {
  if (spec.encoder_counts == 0) return angle_rad;
  const double per_rad = spec.encoder_counts * spec.gear_ratio / math::tau;
  return std::floor(angle_rad * per_rad) / per_rad;
}

/// The controller's turn, if it has come.
void run_loop(Motor& motor, Level level, const JointState& joint, double h_s) {
  const Spec& spec = motor.spec;
  State& state = motor.state;
  // Half a nanosecond: sums of sub-steps differ from the period by rounding.
  if (state.loop_since_s > 0 && state.loop_due_s > 0.5e-9) return;
  const double seen = seen_angle(spec, joint.position);
  const double since = state.loop_since_s > 0 ? state.loop_since_s : 0;
  double rate = joint.velocity;
  if (spec.encoder_counts > 0) rate = since > 0 ? (seen - state.seen_rad) / since : 0;
  const double period = spec.loop_rate_hz > 0 ? 1 / spec.loop_rate_hz : h_s;
  const double step = since > 0 ? since : period;
  if (level == velocity) {
    const double most = spec.max_acceleration * step;
    state.target += std::clamp(state.command - state.target, -most, most);
    // The first run after a start or a switch has no earlier speed to compare with.
    const double acceleration = since > 0 ? (rate - state.seen_rad_s) / since : 0;
    state.volts = state.pid.step(spec.velocity, state.target - rate, acceleration, spec.supply_voltage_V,
                                 step);
  } else {
    state.volts = state.pid.step(spec.position, state.target - seen, rate, spec.supply_voltage_V, step);
  }
  state.seen_rad = seen;
  state.seen_rad_s = since > 0 ? rate : joint.velocity;
  state.loop_since_s = 0;
  state.loop_due_s = std::max(0.0, state.loop_due_s) + period;
  if (spec.loop_rate_hz == 0) state.loop_due_s = 0;
}

Winding power(const Motor& motor, Level level, double motor_speed, double h_s) {
  const State& state = motor.state;
  if (!state.powered) return {.fixed = true};
  if (level == effort) return winding_for_torque(motor.spec, state.target, state.current_A, motor_speed, h_s);
  return winding_on_voltage(motor.spec, state.volts, state.current_A, motor_speed, h_s);
}

void take_command(Motor& motor, Level level, const JointState& joint) {
  const Topic<msg::Float64>& slot = *motor.command[level];
  State& state = motor.state;
  if (slot.count == state.taken[level]) return;
  state.taken[level] = slot.count;
  if (!std::isfinite(slot.message.data)) return;  // a message may hold anything; the old command stays
  if (!state.powered) state.target = joint.velocity;
  state.powered = 1;
  state.command = slot.message.data;
  if (level != velocity) state.target = state.command;
}

}  // namespace

Result<Motor> Motor::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(check_levels(build.levels));
  if (!build.engine.joints)
    return Error{"the engine '" + std::string(build.engine.name) + "' does not simulate joints",
                 "use the engine 'rigid'"};
  SL_ASSIGN(const std::uint32_t index, build.joint_index(spec.joint, "joint"));
  const model::JointType type = build.instance.model->joints[index].type;
  if (type != model::JointType::revolute && type != model::JointType::continuous) {
    return build.error("joint", "joint '" + spec.joint + "' does not turn",
                       "a DC motor needs a revolute or continuous joint");
  }
  Motor motor{std::move(spec)};
  motor.joint = build.joints[index];
  motor.energy = build.energy;
  const char* const names[] = {"velocity", "position", "voltage", "pwm", "effort"};
  for (std::uint32_t level = 0; level < level_count; ++level) {
    motor.command[level] = build.accept<msg::Float64>(level, names[level]);
    motor.message[level] = build.publish<msg::MotorState>(level, names[level]);
    motor.message[level]->message.header.frame_id = build.frame_id();
  }
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
    const Spec& spec = motor.spec;
    State& state = motor.state;
    const Level level = active(pool.levels[index]);
    const JointState& joint = joints[motor.joint.index];
    if (state.powered) {
      if (level == velocity || level == position) run_loop(motor, level, joint, h_s);
      if (level == voltage) state.volts = state.target;
      if (level == pwm) state.volts = state.target * spec.supply_voltage_V;
    }
    motor.winding = power(motor, level, spec.gear_ratio * joint.velocity, h_s);
    context.actuation.joints.push_back(motor_target(spec, motor.winding, motor.joint, joint.velocity));
  }
}

void Motor::post_substep(PoolView<Motor> pool, const Context& context, double h_s) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Motor& motor = pool.all[index];
    State& state = motor.state;
    const Flow flow = flow_after(motor.spec, motor.winding, state.current_A,
                                 joints[motor.joint.index].velocity);
    state.mean_current_A = flow.mean_A;
    state.terminal_V = flow.terminal_V;
    state.current_A = flow.current_A;
    if (motor.energy) motor.energy->draw(flow.mean_A * flow.terminal_V * h_s);
    if (!state.powered) continue;
    state.loop_since_s += h_s;
    state.loop_due_s -= h_s;
  }
}

void Motor::sense(PoolView<Motor> pool, const Context& context) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Motor& motor = pool.all[index];
    Topic<msg::MotorState>& topic = *motor.message[active(pool.levels[index])];
    topic.message.target = motor.state.target;
    topic.message.velocity = joints[motor.joint.index].velocity;
    topic.message.torque = joints[motor.joint.index].effort;
    topic.message.voltage = motor.state.terminal_V;
    topic.message.current = motor.state.mean_current_A;
    topic.publish(context.now);
  }
}

void Motor::release(const Context& context) { context.actuation.joints.push_back({.joint = joint}); }

Status Motor::switch_level(std::uint32_t before, std::uint32_t after, const Context& context) {
  SL_TRY(check_levels(after));
  if (before == after) return {};
  const JointState& now = context.engine.joint_states()[joint.index];
  state.loop_since_s = state.loop_due_s = 0;
  // The new level goes on with what it finds until its first command.
  switch (active(after)) {
    case velocity:
      state.target = now.velocity;
      state.pid.integral = spec.velocity.i > 0 ? state.volts : 0;
      break;
    case position:
      state.target = now.position;
      state.pid.integral = spec.position.i > 0 ? state.volts + spec.position.d * now.velocity : 0;
      break;
    case voltage: state.target = state.volts; break;
    case pwm: state.target = spec.supply_voltage_V > 0 ? state.volts / spec.supply_voltage_V : 0; break;
    case effort:
      state.target = spec.gear_ratio * spec.gear_efficiency * spec.torque_constant * state.current_A;
      break;
  }
  state.command = state.target;
  return {};
}

namespace {
constexpr LevelInfo levels[] = {
    {"velocity", msg::MotorState::ros_type, msg::Float64::ros_type, "A PID loop follows a speed [rad/s]."},
    {"position", msg::MotorState::ros_type, msg::Float64::ros_type, "A PID loop follows an angle [rad]."},
    {"voltage", msg::MotorState::ros_type, msg::Float64::ros_type, "A voltage at the power stage [V]."},
    {"pwm", msg::MotorState::ros_type, msg::Float64::ros_type, "A share of the supply voltage, -1 to 1."},
    {"effort", msg::MotorState::ros_type, msg::Float64::ros_type,
     "A torque on the joint [Nm], by the current."},
};
constexpr Preset presets[] = {
    {"maxon_re30_24v",
     "Maxon RE 30, 60 W, 24 V (310007), with the numbers of its catalogue; friction from the no-load current "
     "of 0.164 A, "
     "max_current is the stall current.",
     "{supply_voltage: 24, resistance: 0.611, inductance: 1.19e-4, torque_constant: 0.0259,"
     " rotor_inertia: 3.35e-6, friction: 0.00425, max_current: 39.3}"},
    {"maxon_amax22_12v_gp22",
     "Maxon A-max 22, 5 W, 12 V (110121), with the numbers of its catalogue; friction from the no-load "
     "current of 0.0168 A. "
     "Planetary gear GP 22, 19:1, and encoder of 500 lines: general knowledge.",
     "{supply_voltage: 12, resistance: 5.39, inductance: 3.62e-4, torque_constant: 0.0109,"
     " rotor_inertia: 4.36e-7, friction: 1.83e-4, gear_ratio: 19.2, gear_efficiency: 0.84, max_current: 2.23,"
     " encoder_counts: 2000}"},
    {"faulhaber_2224_6v",
     "Faulhaber 2224 006 SR: general knowledge of its data sheet; friction from the no-load current of 0.029 "
     "A. Encoder of 512 "
     "lines.",
     "{supply_voltage: 6, resistance: 1.94, inductance: 4.5e-5, torque_constant: 0.00692,"
     " rotor_inertia: 2.7e-7, friction: 2.0e-4, encoder_counts: 2048}"},
};
}  // namespace

constinit const Kind kind = make_kind<Motor>({
    .name = "dc_motor",
    .help = "DC motor with gear, power stage, encoder and speed controller on one joint.",
    .levels = levels,
    .presets = presets,
});

}  // namespace sandlot::dc_motor
