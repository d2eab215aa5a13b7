#include "devices/drives/wheeled_base.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "kinematics/kabsch.h"
#include "kinematics/swerve.h"

namespace sandlot::wheeled {
namespace {

using kinematics::Direction;
using kinematics::motion_of_point;
using kinematics::PlanarMotion;
using Joints = std::span<const JointState>;

/// A velocity motor this strong reaches its speed in one step whatever hangs on it: wheels on the ideal level
/// carry no load, so the value has no other meaning.
constexpr double kinematic_effort_Nm = 1e6;
/// On rails the steering only has to look right, and its reaction must not shake the base: it is turned
/// gently.
constexpr double ideal_steering_radps2 = 200, ideal_steering_gain = 20;
/// Slower than this a wheel's direction of motion is rounding.
constexpr double standing_mps = 1e-3;
/// Gain of the steering's position loop [1/s].
constexpr double steering_gain = 50;

double angle_of(const Drive& drive, std::size_t i, Joints joints) {
  const Wheel& wheel = drive.base.wheels[i];
  if (!wheel.has_joint) return drive.state.wheels[i].virtual_rad;
  return wheel.sign * joints[wheel.joint.index].position;
}
double speed_of(const Drive& drive, std::size_t i, Joints joints) {
  const Wheel& wheel = drive.base.wheels[i];
  if (!wheel.has_joint) return drive.state.wheels[i].virtual_radps;
  return wheel.sign * joints[wheel.joint.index].velocity;
}
double angle_of(const Pivot& pivot, Joints joints) { return pivot.sign * joints[pivot.joint.index].position; }

/// Edges that an encoder has counted at an angle.
double edges(int ticks, double angle_rad) { return std::floor(angle_rad * ticks / math::tau); }

/// Points the wheels along `steering(pivot index)`.
template <class Steering>
void point_wheels(Base& base, Steering&& steering) {
  for (std::size_t i = 0; i < base.wheels.size(); ++i) {
    const Wheel& wheel = base.wheels[i];
    if (wheel.pivot < 0) continue;
    base.geometry[i].along = kinematics::direction(wheel.heading_rad +
                                                   steering(static_cast<std::size_t>(wheel.pivot)));
  }
}
/// On rails the wheels stand as commanded, wherever their joints are on the way there.
double steering_of(const Drive& drive, std::size_t p, Level level, Joints joints) {
  return level == ideal ? drive.state.pivots[p].target_rad : angle_of(drive.base.pivots[p], joints);
}
void point_wheels_as_they_stand(Drive drive, Level level, Joints joints) {
  point_wheels(drive.base, [&](std::size_t p) { return steering_of(drive, p, level, joints); });
}

/// The motion that the wheels' speeds amount to.
PlanarMotion measured(Drive drive, Level level, Joints joints) {
  Base& base = drive.base;
  point_wheels_as_they_stand(drive, level, joints);
  for (std::size_t i = 0; i < base.wheels.size(); ++i) base.turns[i] = speed_of(drive, i, joints);
  return kinematics::chassis_motion(base.geometry, base.turns, base.pivot_x_m).motion;
}

/// Moves the odometry on by the wheels' turns since the last call.
void count_wheels(Drive drive, Level level, Joints joints) {
  Base& base = drive.base;
  State& state = drive.state;
  bool moved = false;
  for (std::size_t i = 0; i < base.wheels.size(); ++i) {
    double angle = angle_of(drive, i, joints);
    if (const int ticks = drive.spec.encoder_ticks; ticks > 0)
      angle = edges(ticks, angle) * math::tau / ticks;
    base.turns[i] = angle - state.wheels[i].counted_rad;
    moved = moved || base.turns[i] != 0;
    state.wheels[i].counted_rad = angle;
  }
  // While the steering moves, its mean over the step is what the wheels rolled along.
  point_wheels(base, [&](std::size_t p) {
    return 0.5 * (state.pivots[p].counted_rad + steering_of(drive, p, level, joints));
  });
  for (std::size_t p = 0; p < base.pivots.size(); ++p)
    state.pivots[p].counted_rad = steering_of(drive, p, level, joints);
  if (!moved) return;
  const kinematics::Estimate step = drive.spec.odometry == Odometry::kabsch
                                        ? kinematics::rolled(base.geometry, base.turns)
                                        : kinematics::chassis_motion(base.geometry, base.turns,
                                                                     base.pivot_x_m);
  state.X_OD = kinematics::integrate(state.X_OD, step.motion);
  state.residual_m = step.residual;
}

/// Velocity of D in B, from the truth about the base.
PlanarMotion true_velocity(const Drive& drive, const Context& context) {
  const BodyState& base = context.engine.states()[drive.base.body.index];
  const Vec3 v_B = rotate_inverse(base.X_WB.q, base.V_WB.linear);
  const double turn = rotate_inverse(base.X_WB.q, base.V_WB.angular).z;
  const Direction v = motion_of_point({v_B.x, v_B.y, turn}, drive.base.dx_m, drive.base.dy_m);
  return {v.x, v.y, turn};
}

// --- commands ---

/// Element k of a list that a message may have left short; NaN when it is not there or no number.
double element(const std::vector<double>& list, std::size_t k) {
  return k < list.size() && std::isfinite(list[k]) ? list[k] : std::nan("");
}

/// Index of joint number k of a message among wheels and pivots; past their end when there is none.
std::size_t place_of(const Base& base, const msg::JointState& message, std::size_t k) {
  if (message.name.empty()) return k;
  const std::string& name = message.name[k];
  for (std::size_t i = 0; i < base.wheels.size(); ++i)
    if (base.wheels[i].name == name) return i;
  for (std::size_t p = 0; p < base.pivots.size(); ++p)
    if (base.pivots[p].name == name) return base.wheels.size() + p;
  return base.wheels.size() + base.pivots.size();
}

void take_wheel_command(Drive drive, const msg::JointState& message, Joints joints) {
  Base& base = drive.base;
  State& state = drive.state;
  if (!state.by_wheels) {  // what the message leaves out begins at rest
    for (WheelState& wheel : state.wheels) wheel.command = 0, wheel.by_effort = 0;
    for (std::size_t p = 0; p < base.pivots.size(); ++p)
      state.pivots[p].target_rad = angle_of(base.pivots[p], joints);
  }
  state.by_wheels = 1;
  const std::size_t all = base.wheels.size() + base.pivots.size();
  const std::size_t count = message.name.empty() ? all : message.name.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = place_of(base, message, k);
    if (at >= all) continue;
    if (at >= base.wheels.size()) {
      const Pivot& pivot = base.pivots[at - base.wheels.size()];
      if (const double angle = element(message.position, k); !std::isnan(angle))
        state.pivots[at - base.wheels.size()].target_rad = std::clamp(angle * pivot.sign, pivot.lower,
                                                                      pivot.upper);
      continue;
    }
    WheelState& wheel = state.wheels[at];
    const double speed = element(message.velocity, k), effort = element(message.effort, k);
    if (std::isnan(speed) && std::isnan(effort)) continue;
    wheel.by_effort = std::isnan(speed) ? 1 : 0;
    wheel.command = base.wheels[at].sign * (wheel.by_effort ? effort : speed);
  }
}

/// Reaction time of the PI loops on v and w, and how near to a goal they come against friction.
constexpr double loop_response_s = 0.1, loop_near_m = 2.5e-3, loop_near_rad = 5e-3;

maneuver::Limits maneuver_limits(const Drive& drive, Level level) {
  const Common& spec = drive.spec;
  const Base& base = drive.base;
  maneuver::Limits limits{.speed_mps = spec.max_linear_speed_mps,
                          .turning_rate_radps = spec.max_angular_speed_radps,
                          .acceleration_mps2 = spec.max_linear_acceleration_mps2,
                          .angular_acceleration_radps2 = spec.max_angular_acceleration_radps2};
  if (level != ideal && spec.control)
    limits.edge_m = loop_near_m, limits.edge_rad = loop_near_rad, limits.response_s = loop_response_s;
  if (base.car) limits.max_curvature_pm = base.car->max_curvature();
  if (spec.encoder_ticks > 0)
    for (const kinematics::Wheel& wheel : base.geometry) {
      const double edge_rad = math::tau / spec.encoder_ticks;
      const double lever = std::abs(kinematics::wheel_turn(wheel, {0, 0, 1}));
      limits.edge_m = std::max(limits.edge_m, edge_rad * wheel.radius_m);
      if (lever > 0) limits.edge_rad = std::max(limits.edge_rad, edge_rad / lever);
    }
  return limits;
}

void take_commands(Drive drive, Level level, Joints joints) {
  State& state = drive.state;
  const Topic<msg::Twist>& velocity = *drive.base.command[level];
  if (velocity.count != state.taken[level]) {
    state.taken[level] = velocity.count;
    state.command_time = velocity.stamp;
    state.by_wheels = 0;
    maneuver::end(drive.late);
    // A message may hold anything; what is not a number has no effect.
    const auto sane = [](double x) { return std::isfinite(x) ? x : 0.0; };
    state.command = {sane(velocity.message.linear.x), sane(velocity.message.linear.y),
                     sane(velocity.message.angular.z)};
  }
  const Topic<msg::JointState>& wheels = *drive.base.wheel_command[level];
  if (wheels.count != state.taken_wheels[level]) {
    state.taken_wheels[level] = wheels.count;
    state.command_time = wheels.stamp;
    maneuver::end(drive.late);
    take_wheel_command(drive, wheels.message, joints);
  }
  if (const maneuver::Slot& slot = *drive.base.maneuver.command; maneuver::is_new(drive.late, slot)) {
    state.by_wheels = 0;
    state.command = {};
    maneuver::begin(drive.late, slot, maneuver_limits(drive, level), state.X_OD,
                    measured(drive, level, joints), drive.base.wheels.size());
  }
}

bool timed_out(const Drive& drive, const Context& context) {
  const Time age = context.now - context.tick - drive.state.command_time;
  return drive.spec.command_timeout_s > 0 && age.s() > drive.spec.command_timeout_s;
}

/// Ratio of the wheels' needed speed to their largest one; at most 1 when they can follow.
double overload(const Base& base, const PlanarMotion& motion) {
  double most = 0;
  for (std::size_t i = 0; i < base.wheels.size(); ++i) {
    const kinematics::Wheel& w = base.geometry[i];
    double speed = 0;
    if (base.wheels[i].pivot >= 0) {  // it will be turned that way
      const Direction u = motion_of_point(motion, w.x_m, w.y_m);
      speed = std::sqrt(u.x * u.x + u.y * u.y) / w.radius_m;
    } else {
      speed = std::abs(kinematics::wheel_turn(w, motion));
    }
    if (speed > 0)
      most = std::max(most, base.wheels[i].max_speed > 0 ? speed / base.wheels[i].max_speed : 1e300);
  }
  return most;
}

/// Setpoint of the drive in this tick: the command within all limits.
PlanarMotion goal(Drive drive, const Context& context) {
  const Common& spec = drive.spec;
  Base& base = drive.base;
  const bool on_maneuver = maneuver::in_force(drive.late);
  if (!on_maneuver && timed_out(drive, context)) return {};
  PlanarMotion m = on_maneuver ? drive.late->maneuver.setpoint : drive.state.command;
  if (drive.state.by_wheels) {
    point_wheels(base, [&](std::size_t p) { return drive.state.pivots[p].target_rad; });
    for (std::size_t i = 0; i < base.wheels.size(); ++i)
      base.turns[i] = drive.state.wheels[i].by_effort ? 0 : drive.state.wheels[i].command;
    m = kinematics::chassis_motion(base.geometry, base.turns, base.pivot_x_m).motion;
  }
  if (base.car) m = base.car->possible(m);
  if (base.pivot_x_m) m.y = -m.turn * *base.pivot_x_m;
  const double speed = math::hypot(m.x, m.y);
  if (speed > spec.max_linear_speed_mps) {
    const double scale = spec.max_linear_speed_mps / speed;
    m.x *= scale, m.y *= scale;
    if (base.car) m.turn *= scale;  // the same curve
  }
  m.turn = std::clamp(m.turn, -spec.max_angular_speed_radps, spec.max_angular_speed_radps);
  if (const double over = overload(base, m); over > 1) m = {m.x / over, m.y / over, m.turn / over};
  return m;
}

double towards(double from, double to, double step) { return from + std::clamp(to - from, -step, step); }

// --- steering ---

/// The point whose motion a pivot's wheel follows: that of the first wheel it steers.
Direction steered_point(const Base& base, std::size_t pivot) {
  for (std::size_t i = 0; i < base.wheels.size(); ++i)
    if (base.wheels[i].pivot == static_cast<int>(pivot)) return {base.geometry[i].x_m, base.geometry[i].y_m};
  return {base.pivots[pivot].x_m - base.dx_m, base.pivots[pivot].y_m - base.dy_m};
}
double heading_of(const Base& base, std::size_t pivot) {
  for (const Wheel& wheel : base.wheels)
    if (wheel.pivot == static_cast<int>(pivot)) return wheel.heading_rad;
  return 0;
}

/// Tells a pivot to turn its wheel into this direction of motion, or backwards into it.
void aim(Drive drive, std::size_t p, Direction u, Joints joints) {
  const Pivot& pivot = drive.base.pivots[p];
  PivotState& state = drive.state.pivots[p];
  const kinematics::SteeringLimits limits{pivot.lower, pivot.upper};
  const kinematics::Steering to = kinematics::steer_towards(math::atan2(u.y, u.x) - heading_of(drive.base, p),
                                                            {angle_of(pivot, joints), state.backward != 0},
                                                            limits);
  state.target_rad = to.angle_rad;
  state.backward = to.backward;
}

void aim_all(Drive drive, const PlanarMotion& now, const PlanarMotion& later, Joints joints) {
  for (std::size_t p = 0; p < drive.base.pivots.size(); ++p) {
    const Direction at = steered_point(drive.base, p);
    for (const PlanarMotion* motion : {&now, &later}) {
      const Direction u = motion_of_point(*motion, at.x, at.y);
      if (u.x * u.x + u.y * u.y < standing_mps * standing_mps) continue;
      aim(drive, p, u, joints);
      break;
    }
  }
}

void turn_pivots(const Drive& drive, bool kinematic, double h_s, Joints joints,
                 std::vector<JointTarget>& targets) {
  for (std::size_t p = 0; p < drive.base.pivots.size(); ++p) {
    const Pivot& pivot = drive.base.pivots[p];
    const double error = drive.state.pivots[p].target_rad - angle_of(pivot, joints);
    const double most = std::min(drive.spec.max_steering_speed_radps, pivot.max_speed);
    const double gain = std::min(kinematic ? ideal_steering_gain : steering_gain, 0.5 / h_s);
    double speed = std::clamp(gain * error, -most, most);
    if (kinematic)
      speed = towards(pivot.sign * joints[pivot.joint.index].velocity, speed, ideal_steering_radps2 * h_s);
    targets.push_back({.joint = pivot.joint,
                       .mode = JointTarget::Mode::velocity,
                       .velocity = pivot.sign * speed,
                       .max_effort = kinematic
                                         ? kinematic_effort_Nm
                                         : std::min(drive.spec.max_steering_effort_Nm, pivot.max_effort)});
  }
}

/// The curve that a car's steering stands for now.
double present_curvature(const Base& base, Joints joints) {
  double left = 0, right = 0;
  for (std::size_t p = 0; p < base.pivots.size(); ++p)
    (base.pivots[p].y_m > base.dy_m ? left : right) = angle_of(base.pivots[p], joints);
  return base.car->curvature({left, right});
}

// --- motors ---

double full_effort(const Drive& drive, const Wheel& wheel) {
  return std::min(drive.spec.max_wheel_effort_Nm, wheel.max_effort);
}

void request_speed(Drive drive, std::size_t i, double radps, Joints joints,
                   std::vector<JointTarget>& targets) {
  const Wheel& wheel = drive.base.wheels[i];
  radps = std::clamp(radps, -wheel.max_speed, wheel.max_speed);
  double most = full_effort(drive, wheel);
  if (const auto& motor = drive.spec.motor) {
    // Torque that battery and winding give at this speed, in the direction in which the wheel is to be
    // pushed.
    const double now = speed_of(drive, i, joints), sign = radps >= now ? 1 : -1;
    const double back_emf = motor->torque_constant * motor->gear_ratio * now;
    const double current = std::clamp(
        (motor->supply_voltage_V - sign * back_emf) / (motor->resistance_Ohm + motor->supply_resistance_Ohm),
        0.0, motor->max_current_A);
    most = std::min(most, motor->gear_ratio * motor->gear_efficiency * motor->torque_constant * current);
  }
  drive.base.running[i].on_voltage = false;
  targets.push_back({.joint = wheel.joint,
                     .mode = JointTarget::Mode::velocity,
                     .velocity = wheel.sign * radps,
                     .max_effort = most});
}

/// @param effort  a torque, or with a motor the share of the voltage
void request_effort(Drive drive, std::size_t i, double effort, double h_s, Joints joints,
                    std::vector<JointTarget>& targets) {
  const Wheel& wheel = drive.base.wheels[i];
  Base::Running& running = drive.base.running[i];
  running.on_voltage = drive.spec.motor.has_value();
  if (const auto& motor = drive.spec.motor) {
    const double speed = joints[wheel.joint.index].velocity;
    running.winding = winding_on_voltage(*motor,
                                         wheel.sign * std::clamp(effort, -1.0, 1.0) * motor->supply_voltage_V,
                                         drive.state.wheels[i].current_A, motor->gear_ratio * speed, h_s);
    return targets.push_back(motor_target(*motor, running.winding, wheel.joint, speed));
  }
  const double most = full_effort(drive, wheel);
  targets.push_back({.joint = wheel.joint,
                     .mode = JointTarget::Mode::effort,
                     .effort = wheel.sign * std::clamp(effort, -most, most)});
}

/// RoBIOS' loops: shares of the full effort, spread over the wheels as they move the chassis.
void run_loops(Drive drive, double h_s, Joints joints, std::vector<JointTarget>& targets) {
  const Control& c = *drive.spec.control;
  Base& base = drive.base;
  State& state = drive.state;
  const PlanarMotion now = measured(drive, contact, joints);
  const Gains linear{.p = c.vv, .i = c.vv / c.tv, .anti_windup_s = c.tv};
  const Gains angular{.p = c.vw, .i = c.vw / c.tw, .anti_windup_s = c.tw};
  PlanarMotion push;
  push.x = state.loop_x.step(linear, state.setpoint.x - now.x, 0, 1, h_s);
  if (!base.car && !base.pivot_x_m) push.y = state.loop_y.step(linear, state.setpoint.y - now.y, 0, 1, h_s);
  if (!base.car) push.turn = state.loop_turn.step(angular, state.setpoint.turn - now.turn, 0, 1, h_s);
  double lever = 1e-9;
  for (const kinematics::Wheel& w : base.geometry)
    lever = std::max(lever, std::abs(w.radius_m * kinematics::wheel_turn(w, {0, 0, 1})));
  push.turn /= lever;
  for (std::size_t i = 0; i < base.wheels.size(); ++i) {
    if (!base.wheels[i].driven) continue;
    const kinematics::Wheel& w = base.geometry[i];
    const double share = std::clamp(w.radius_m * kinematics::wheel_turn(w, push), -1.0, 1.0);
    const double full = drive.spec.motor ? 1 : full_effort(drive, base.wheels[i]);
    request_effort(drive, i, share * full, h_s, joints, targets);
  }
}

/// Moves the setpoint towards the goal as fast as the accelerations allow.
void ramp(Drive drive, const PlanarMotion& wanted, double h_s) {
  const Common& spec = drive.spec;
  PlanarMotion& set = drive.state.setpoint;
  const double most = spec.max_linear_acceleration_mps2 * h_s;
  const double dx = wanted.x - set.x, dy = wanted.y - set.y, change = std::sqrt(dx * dx + dy * dy);
  const double part = change > most ? most / change : 1;
  set = {set.x + part * dx, set.y + part * dy,
         towards(set.turn, wanted.turn, spec.max_angular_acceleration_radps2 * h_s)};
  if (part == 1) set.x = wanted.x, set.y = wanted.y;
}

/// Moves a maneuver on, and looks for motors that do not turn.
void take_odometry(Drive drive, Level level, const Context& context, Joints joints) {
  if (!drive.late) return;
  maneuver::State& maneuver = drive.late->maneuver;
  const double tick_s = context.tick.s();
  // Against what was requested in the tick that has passed.
  const PlanarMotion wanted = level == ideal ? goal(drive, context) : drive.state.setpoint;
  point_wheels_as_they_stand(drive, level, joints);
  for (std::size_t i = 0; i < drive.base.wheels.size(); ++i) {
    const kinematics::Wheel& wheel = drive.base.geometry[i];
    const WheelState& own = drive.state.wheels[i];
    double radps = drive.state.by_wheels ? own.command : kinematics::wheel_turn(wheel, wanted);
    if (!drive.base.wheels[i].driven || (drive.state.by_wheels && own.by_effort && level == ideal)) radps = 0;
    maneuver::watch_motor(maneuver, i, radps * wheel.radius_m, speed_of(drive, i, joints) * wheel.radius_m,
                          tick_s);
  }
  if (maneuver.in_force) maneuver::step(maneuver, maneuver_limits(drive, level), drive.state.X_OD, tick_s);
}

/// Moves the setpoint and sets the steering's targets.
void follow(Drive drive, const PlanarMotion& wanted, double h_s, Joints joints) {
  State& state = drive.state;
  PlanarMotion& set = state.setpoint;
  if (drive.base.car) {
    if (wanted.x != 0) state.curvature = wanted.turn / wanted.x;
    set = {towards(set.x, wanted.x, drive.spec.max_linear_acceleration_mps2 * h_s), 0, 0};
    set.turn = present_curvature(drive.base, joints) * set.x;
    aim_all(drive, {1, 0, state.curvature}, {}, joints);
    return;
  }
  ramp(drive, wanted, h_s);
  aim_all(drive, set, wanted, joints);
}

/// The engine turns the joints of wheels that nobody steers: per velocity of the base they always turn alike.
bool engine_rolls(const Base& base) { return base.engine.rolls && base.pivots.empty(); }

void roll_wheels(const Base& base, std::vector<RollTarget>& targets) {
  for (std::size_t i = 0; i < base.wheels.size(); ++i) {
    const Wheel& wheel = base.wheels[i];
    if (!wheel.has_joint) continue;
    const auto per = [&](PlanarMotion of_base) {
      return wheel.sign *
             kinematics::wheel_turn(base.geometry[i], kinematics::seen_from(of_base, -base.dx_m, -base.dy_m));
    };
    targets.push_back({wheel.joint, base.body, per({1, 0, 0}), per({0, 1, 0}), per({0, 0, 1})});
  }
}

void move_ideal_wheels(Drive drive, const Context& context, double h_s) {
  const Joints joints = context.engine.joint_states();
  Base& base = drive.base;
  std::vector<JointTarget>& targets = context.actuation.joints;
  // The wheels follow what the base really does, so that a robot held by a wall does not count turns. They
  // lag by one sub-step; the angle they are behind by does not grow and is made up when the base stops.
  const bool by_engine = engine_rolls(base);
  if (by_engine &&
      std::all_of(base.wheels.begin(), base.wheels.end(), [](const Wheel& w) { return w.has_joint; }))
    return;
  const PlanarMotion moving = true_velocity(drive, context);
  if (!base.pivots.empty()) {
    // The steering follows what the rails aim for: the base feels it turn, so following the truth would be a
    // loop.
    ramp(drive, goal(drive, context), h_s);
    if (!drive.state.by_wheels) aim_all(drive, drive.state.setpoint, {}, joints);
    turn_pivots(drive, true, h_s, joints, targets);
    point_wheels_as_they_stand(drive, ideal, joints);
  }
  for (std::size_t i = 0; i < base.wheels.size(); ++i) {
    const double radps = kinematics::wheel_turn(base.geometry[i], moving);
    WheelState& state = drive.state.wheels[i];
    if (!base.wheels[i].has_joint) state.virtual_radps = radps, state.virtual_rad += radps * h_s;
    else if (!by_engine)
      targets.push_back({.joint = base.wheels[i].joint,
                         .mode = JointTarget::Mode::velocity,
                         .velocity = base.wheels[i].sign * radps,
                         .max_effort = kinematic_effort_Nm});
  }
}

}  // namespace

void actuate(Drive drive, std::uint32_t levels, const Context& context) {
  Base& base = drive.base;
  const Joints joints = context.engine.joint_states();
  const Level level = active(levels);
  count_wheels(drive, level, joints);
  take_commands(drive, level, joints);
  take_odometry(drive, level, context, joints);
  if (drive.state.handover & hand_wheels)
    for (const Wheel& wheel : base.wheels)
      if (wheel.has_rollers) context.actuation.wheels.push_back({wheel.joint, level == rollers});
  if (level == ideal) {
    const PlanarMotion of_base = kinematics::seen_from(goal(drive, context), base.dx_m, base.dy_m);
    context.actuation.drives.push_back(
        {.base = base.body,
         .vx_mps = of_base.x,
         .vy_mps = of_base.y,
         .wz_radps = of_base.turn,
         .max_accel_mps2 = drive.spec.max_linear_acceleration_mps2,
         .max_angular_accel_radps2 = drive.spec.max_angular_acceleration_radps2});
    if (base.energy) base.energy->ride(context.actuation.drives.back());
    if (engine_rolls(base)) roll_wheels(base, context.actuation.rolls);
  } else if (drive.state.handover & hand_base) {
    context.actuation.drives.push_back({.base = base.body, .active = false});
    for (const Wheel& wheel : base.wheels)  // those without a motor were turned by the ideal level
      if (!wheel.driven) context.actuation.joints.push_back({.joint = wheel.joint});
  }
  if (base.energy && level != ideal && !drive.spec.motor) base.energy->turn_joints();
  drive.state.handover = 0;
}

void pre_substep(Drive drive, std::uint32_t levels, const Context& context, double h_s) {
  if (active(levels) == ideal) return move_ideal_wheels(drive, context, h_s);
  Base& base = drive.base;
  State& state = drive.state;
  const Joints joints = context.engine.joint_states();
  std::vector<JointTarget>& targets = context.actuation.joints;
  if (state.by_wheels) {
    const bool stop = timed_out(drive, context);
    for (std::size_t i = 0; i < base.wheels.size(); ++i) {
      if (!base.wheels[i].driven) continue;
      const double command = stop ? 0 : state.wheels[i].command;
      if (state.wheels[i].by_effort) request_effort(drive, i, command, h_s, joints, targets);
      else request_speed(drive, i, command, joints, targets);
    }
    // A velocity command that comes next begins where the wheels are.
    state.setpoint = measured(drive, contact, joints);
    return turn_pivots(drive, false, h_s, joints, targets);
  }
  follow(drive, goal(drive, context), h_s, joints);
  if (drive.spec.control) {
    run_loops(drive, h_s, joints, targets);
  } else {
    point_wheels_as_they_stand(drive, contact, joints);
    for (std::size_t i = 0; i < base.wheels.size(); ++i)
      if (base.wheels[i].driven)
        request_speed(drive, i, kinematics::wheel_turn(base.geometry[i], state.setpoint), joints, targets);
  }
  turn_pivots(drive, false, h_s, joints, targets);
}

void sense(Drive drive, std::uint32_t levels, const Context& context) {
  Base& base = drive.base;
  const Joints joints = context.engine.joint_states();
  const Level level = active(levels);
  count_wheels(drive, level, joints);
  Topic<msg::Odometry>& odometry = *base.odometry[level];
  const Pose X_BD{{base.dx_m, base.dy_m, 0}, {}};
  odometry.message.pose.pose = X_BD * to_pose(drive.state.X_OD) * inverse(X_BD);
  const PlanarMotion of_base = kinematics::seen_from(measured(drive, level, joints), base.dx_m, base.dy_m);
  odometry.message.twist.twist.linear = {of_base.x, of_base.y, 0};
  odometry.message.twist.twist.angular = {0, 0, of_base.turn};
  odometry.publish(context.now);

  msg::JointState& message = base.wheel_message[level]->message;
  const std::size_t n = base.wheels.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Wheel& wheel = base.wheels[i];
    message.position[i] = wheel.sign * drive.state.wheels[i].counted_rad;
    message.velocity[i] = wheel.sign * speed_of(drive, i, joints);
    message.effort[i] = wheel.has_joint ? joints[wheel.joint.index].effort : 0;
    if (base.ticks[level]) {
      const double shown = edges(drive.spec.encoder_ticks, angle_of(drive, i, joints));
      base.ticks[level]->message.data[i] = std::isnan(shown)
                                               ? 0
                                               : static_cast<std::int64_t>(std::clamp(shown, -9e18, 9e18));
    }
  }
  for (std::size_t p = 0; p < base.pivots.size(); ++p) {
    const JointState& joint = joints[base.pivots[p].joint.index];
    message.position[n + p] = joint.position;
    message.velocity[n + p] = joint.velocity;
    message.effort[n + p] = joint.effort;
  }
  base.wheel_message[level]->publish(context.now);
  if (base.ticks[level]) base.ticks[level]->publish(context.now);
  if (drive.late) maneuver::publish(*base.maneuver.progress, drive.late->maneuver, context.now);
}

Status switch_level(Drive drive, std::uint32_t before, std::uint32_t after, const Context& context) {
  SL_TRY(check_levels(drive.base, after));
  if (before == after) return {};
  State& state = drive.state;
  take_commands(drive, active(before), context.engine.joint_states());
  if (active(before) == ideal) {
    state.setpoint = true_velocity(drive, context);
    state.loop_x = state.loop_y = state.loop_turn = {};
    state.handover |= hand_base;
  }
  if (active(before) == rollers || active(after) == rollers) state.handover |= hand_wheels;
  return {};
}

}  // namespace sandlot::wheeled
