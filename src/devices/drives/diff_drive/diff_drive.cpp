#include "devices/drives/diff_drive/diff_drive.h"

#include <algorithm>
#include <cmath>

#include "base/prefetch.h"
#include "base/text.h"

namespace sandlot::diff_drive {
namespace {

using kinematics::DriveVelocity;
using kinematics::WheelSpeeds;

/// A velocity motor this strong reaches its speed in one step whatever hangs on it: wheels on the ideal level
/// carry no load, so the value has no other meaning.
constexpr double kinematic_effort_Nm = 1e6;

double mean(std::span<const Wheel> wheels, std::span<const JointState> joints, double JointState::*what) {
  double sum = 0;
  for (const Wheel& wheel : wheels) sum += wheel.sign * (joints[wheel.joint.index].*what);
  return sum / static_cast<double>(wheels.size());
}

/// Moves the odometry on by the wheels' turns since the last call.
void count_wheels(Drive& drive, std::span<const JointState> joints) {
  State& state = drive.state;
  const double left_rad = mean(drive.left, joints, &JointState::position);
  const double right_rad = mean(drive.right, joints, &JointState::position);
  if (left_rad == state.left_rad && right_rad == state.right_rad) return;
  state.X_OD = kinematics::integrate(drive.geometry, state.X_OD, left_rad - state.left_rad,
                                     right_rad - state.right_rad);
  state.left_rad = left_rad;
  state.right_rad = right_rad;
}

/// Velocity of D in B, from the truth about the base.
DriveVelocity velocity_of_axle(const Drive& drive, const Context& context) {
  const BodyState& base = context.engine.states()[drive.base.index];
  const Vec3 v_B = rotate_inverse(base.X_WB.q, base.V_WB.linear);
  const double omega = rotate_inverse(base.X_WB.q, base.V_WB.angular).z;
  return {v_B.x - omega * drive.dy_m, omega};
}

maneuver::Limits maneuver_limits(const Spec& spec) {
  return {.speed_mps = spec.max_linear_speed_mps,
          .turning_rate_radps = spec.max_angular_speed_radps,
          .acceleration_mps2 = spec.max_linear_acceleration_mps2,
          .angular_acceleration_radps2 = spec.max_angular_acceleration_radps2};
}

/// Velocity that the wheels' speeds amount to.
DriveVelocity measured(const Drive& drive, std::span<const JointState> joints) {
  return drive.geometry.forward(
      {mean(drive.left, joints, &JointState::velocity), mean(drive.right, joints, &JointState::velocity)});
}

void take_command(Drive& drive, Level level, const Context& context) {
  const Topic<msg::Twist>& slot = *drive.command[level];
  State& state = drive.state;
  if (slot.count != state.taken[level]) {
    state.taken[level] = slot.count;
    state.command_time = slot.stamp;
    maneuver::end(drive.late);
    // A message may hold anything; what is not a number has no effect.
    const auto sane = [](double x) { return std::isfinite(x) ? x : 0.0; };
    state.command_mps = sane(slot.message.linear.x);
    state.command_radps = sane(slot.message.angular.z);
  }
  if (!maneuver::is_new(drive.late, *drive.maneuver.command)) return;
  const auto joints = context.engine.joint_states();
  count_wheels(drive, joints);
  const DriveVelocity moving = measured(drive, joints);
  maneuver::begin(drive.late, *drive.maneuver.command, maneuver_limits(*drive.spec), state.X_OD,
                  {moving.v_mps, 0, moving.omega_radps}, drive.left.size() + drive.right.size());
}

/// Setpoint of the drive in this tick: the command within all limits.
DriveVelocity goal(const Drive& drive, const Context& context) {
  const Spec& spec = *drive.spec;
  const Time age = context.now - context.tick - drive.state.command_time;
  DriveVelocity command{drive.state.command_mps, drive.state.command_radps};
  if (maneuver::in_force(drive.late))
    command = {drive.late->maneuver.setpoint.x, drive.late->maneuver.setpoint.turn};
  else if (spec.command_timeout_s > 0 && age.s() > spec.command_timeout_s) return {};
  const DriveVelocity wanted{
      std::clamp(command.v_mps, -spec.max_linear_speed_mps, spec.max_linear_speed_mps),
      std::clamp(command.omega_radps, -spec.max_angular_speed_radps, spec.max_angular_speed_radps)};
  return drive.geometry.forward(limited(drive.geometry.inverse(wanted), drive.max_wheel_speed_radps));
}

/// Moves a maneuver on, and looks for motors that do not turn.
void take_odometry(Drive& drive, Level level, const Context& context) {
  maneuver::State& maneuver = drive.late->maneuver;
  const auto joints = context.engine.joint_states();
  const double tick_s = context.tick.s(), radius_m = drive.geometry.wheel_radius_m;
  // Against what was requested in the tick that has passed.
  const DriveVelocity wanted = level == ideal
                                   ? goal(drive, context)
                                   : DriveVelocity{drive.state.setpoint_mps, drive.state.setpoint_radps};
  const WheelSpeeds speeds = drive.geometry.inverse(wanted);
  std::size_t motor = 0;
  for (const auto* wheels : {&drive.left, &drive.right})
    for (const Wheel& wheel : *wheels)
      maneuver::watch_motor(maneuver, motor++,
                            (wheels == &drive.left ? speeds.left_radps : speeds.right_radps) * radius_m,
                            joints[wheel.joint.index].velocity * radius_m, tick_s);
  if (maneuver.in_force) maneuver::step(maneuver, maneuver_limits(*drive.spec), drive.state.X_OD, tick_s);
}

double towards(double from, double to, double step) { return from + std::clamp(to - from, -step, step); }

void drive_wheels(const Drive& drive, WheelSpeeds speeds, bool kinematic, std::vector<JointTarget>& targets) {
  const auto side = [&](std::span<const Wheel> wheels, double radps) {
    for (const Wheel& wheel : wheels)
      targets.push_back({.joint = wheel.joint,
                         .mode = JointTarget::Mode::velocity,
                         .velocity = wheel.sign * radps,
                         .max_effort = kinematic
                                           ? kinematic_effort_Nm
                                           : std::min(drive.spec->max_wheel_effort_Nm, wheel.max_effort)});
  };
  side(drive.left, speeds.left_radps);
  side(drive.right, speeds.right_radps);
}

/// Asks for the memory of what a drive that acts soon points to.
void expect(const Drive& drive, std::uint32_t levels) {
  prefetch(drive.command[levels >> ideal & 1 ? ideal : contact], 1);
  prefetch(&drive.maneuver.command->count, 1);
  for (const auto* const wheels : {&drive.left, &drive.right}) prefetch(wheels->data(), wheels->size());
}

/// The wheels follow what the base really does, so that a robot held by a wall does not count turns.
void roll_wheels(const Drive& drive, std::vector<RollTarget>& targets) {
  const double per_m = 1 / drive.geometry.wheel_radius_m, half_m = 0.5 * drive.geometry.wheel_separation_m;
  const auto side = [&](std::span<const Wheel> wheels, double y_m) {
    for (const Wheel& wheel : wheels)
      targets.push_back({.wheel = wheel.joint,
                         .base = drive.base,
                         .per_vx = wheel.sign * per_m,
                         .per_wz = -wheel.sign * per_m * y_m});
  };
  side(drive.left, drive.dy_m + half_m);
  side(drive.right, drive.dy_m - half_m);
}

bool is_ideal(std::uint32_t levels) { return levels >> ideal & 1; }

/// Exactly one level, and one that the engine has.
Status check_levels(std::uint32_t levels, const Capabilities& engine) {
  if (levels != 1u << ideal && levels != 1u << contact)
    return Error{"a differential drive runs at exactly one level", "give 'ideal' or 'contact'"};
  if (levels == 1u << contact && !engine.contact_drives)
    return Error{"the engine '" + std::string(engine.name) + "' has no wheels that drive by contact",
                 "use the level 'ideal' or the engine 'rigid'"};
  if (levels == 1u << ideal && !engine.ideal_drives)
    return Error{"the engine '" + std::string(engine.name) + "' has no ideal drives",
                 "use the level 'contact'"};
  return {};
}

}  // namespace

void Drive::actuate(PoolView<Drive> pool, const Context& context) {
  constexpr std::size_t ahead = 3;
  for (std::size_t i = 0; i < pool.due.size(); ++i) {
    if (i + ahead < pool.due.size()) expect(pool.all[pool.due[i + ahead]], pool.levels[pool.due[i + ahead]]);
    const std::uint32_t index = pool.due[i];
    Drive& drive = pool.all[index];
    const Level level = is_ideal(pool.levels[index]) ? ideal : contact;
    if (drive.spec->odometry || drive.late) count_wheels(drive, context.engine.joint_states());
    take_command(drive, level, context);
    if (drive.late) take_odometry(drive, level, context);
    const DriveVelocity wanted = goal(drive, context);
    if (is_ideal(pool.levels[index])) {
      // v_B = v_D + omega x r_DB with r_DB = -(dx, dy), so that D itself moves along x.
      context.actuation.drives.push_back(
          {.base = drive.base,
           .vx_mps = wanted.v_mps + wanted.omega_radps * drive.dy_m,
           .vy_mps = -wanted.omega_radps * drive.dx_m,
           .wz_radps = wanted.omega_radps,
           .max_accel_mps2 = drive.spec->max_linear_acceleration_mps2,
           .max_angular_accel_radps2 = drive.spec->max_angular_acceleration_radps2});
      if (drive.energy) drive.energy->ride(context.actuation.drives.back());
      if (drive.engine.rolls) roll_wheels(drive, context.actuation.rolls);
    } else if (drive.state.release) {
      context.actuation.drives.push_back({.base = drive.base, .active = false});
      drive.state.release = 0;
    }
    if (drive.energy && !is_ideal(pool.levels[index])) drive.energy->turn_joints();
  }
}

void Drive::pre_substep(PoolView<Drive> pool, const Context& context, double h_s) {
  // Nothing to do in a swarm: found out without a look at each of them.
  if (context.engine.capabilities().rolls && std::all_of(pool.levels.begin(), pool.levels.end(), is_ideal))
    return;
  for (const std::uint32_t index : pool.due) {
    Drive& drive = pool.all[index];
    if (is_ideal(pool.levels[index])) {
      if (drive.engine.rolls) continue;
      // They lag by one sub-step; the angle they are behind by does not grow and is made up when the base
      // stops.
      drive_wheels(drive, drive.geometry.inverse(velocity_of_axle(drive, context)), true,
                   context.actuation.joints);
      continue;
    }
    const DriveVelocity wanted = goal(drive, context);
    drive.state.setpoint_mps = towards(drive.state.setpoint_mps, wanted.v_mps,
                                       drive.spec->max_linear_acceleration_mps2 * h_s);
    drive.state.setpoint_radps = towards(drive.state.setpoint_radps, wanted.omega_radps,
                                         drive.spec->max_angular_acceleration_radps2 * h_s);
    drive_wheels(drive, drive.geometry.inverse({drive.state.setpoint_mps, drive.state.setpoint_radps}), false,
                 context.actuation.joints);
  }
}

void Drive::sense(PoolView<Drive> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Drive& drive = pool.all[index];
    if (drive.late) maneuver::publish(*drive.maneuver.progress, drive.late->maneuver, context.now);
    if (!drive.spec->odometry) continue;
    const auto joints = context.engine.joint_states();  // not before: engines make them on demand
    count_wheels(drive, joints);
    Topic<msg::Odometry>& topic = *drive.odometry[is_ideal(pool.levels[index]) ? ideal : contact];
    const Pose X_BD{{drive.dx_m, drive.dy_m, 0}, {}};
    topic.message.pose.pose = X_BD * to_pose(drive.state.X_OD) * inverse(X_BD);
    const DriveVelocity moving = measured(drive, joints);
    topic.message.twist.twist.linear = {moving.v_mps + moving.omega_radps * drive.dy_m,
                                        -moving.omega_radps * drive.dx_m, 0};
    topic.message.twist.twist.angular = {0, 0, moving.omega_radps};
    topic.publish(context.now);
  }
}

void Drive::release(const Context& context) {
  context.actuation.drives.push_back({.base = base, .active = false});
  for (const auto* side : {&left, &right})
    for (const Wheel& wheel : *side) context.actuation.joints.push_back({.joint = wheel.joint});
}

Status Drive::switch_level(std::uint32_t before, std::uint32_t after, const Context& context) {
  SL_TRY(check_levels(after, engine));
  if (before == after) return {};
  take_command(*this, is_ideal(before) ? ideal : contact, context);
  if (is_ideal(after)) {
    state.release = 0;
  } else {
    const DriveVelocity moving = velocity_of_axle(*this, context);
    state.setpoint_mps = moving.v_mps;
    state.setpoint_radps = moving.omega_radps;
    state.release = 1;
  }
  return {};
}

namespace {

/// Pose of a joint's frame in the model frame, in the declared pose.
Pose X_MJ(const model::Model& model, const model::Joint& joint) {
  return model.links[joint.child].X_ML * joint.X_CJ;
}

/// Radius of the largest round collision shape of a wheel link; 0 when there is none.
double wheel_radius_m(const model::Link& link) {
  double radius_m = 0;
  for (const model::Collision& collision : link.collisions) {
    if (const auto* sphere = std::get_if<Sphere>(&collision.shape))
      radius_m = std::max(radius_m, sphere->radius_m);
    if (const auto* cylinder = std::get_if<Cylinder>(&collision.shape))
      radius_m = std::max(radius_m, cylinder->radius_m);
    if (const auto* barrel = std::get_if<Barrel>(&collision.shape))
      radius_m = std::max(radius_m, barrel->radius_m);
    if (const auto* capsule = std::get_if<Capsule>(&collision.shape))
      radius_m = std::max(radius_m, capsule->radius_m);
  }
  return radius_m;
}

struct Side {
  std::vector<Wheel> wheels;
  Vec3 centre_B;        ///< mean of the joint origins
  double radius_m = 0;  ///< mean over the wheels that have one
};

Result<Side> resolve_side(const DeviceBuild& build, std::span<const std::string> names, const char* key) {
  const model::Model& model = *build.instance.model;
  if (names.empty()) return build.error(key, "a side needs at least one wheel joint", "");
  const Pose X_BM = inverse(model.links[0].X_ML);
  Side side;
  double round_wheels = 0;
  for (const std::string& name : names) {
    SL_ASSIGN(const std::uint32_t index, build.joint_index(name, key));
    const model::Joint& joint = model.joints[index];
    if (joint.type != model::JointType::continuous && joint.type != model::JointType::revolute)
      return build.error(key, "joint '" + name + "' does not turn",
                         "a wheel needs a revolute or continuous joint");
    const Pose X_BJ = X_BM * X_MJ(model, joint);
    const double across = rotate(X_BJ.q, joint.axis_J).y;
    if (std::abs(across) < 0.9)
      return build.error(key, "the axis of joint '" + name + "' does not lie across the robot",
                         "wheels turn about the y axis of the base");
    side.wheels.push_back(
        {build.joints[index], across > 0 ? 1.0 : -1.0, joint.max_effort, joint.max_velocity});
    side.centre_B += X_BJ.p / static_cast<double>(names.size());
    if (const double radius_m = wheel_radius_m(model.links[joint.child]); radius_m > 0) {
      side.radius_m += radius_m;
      ++round_wheels;
    }
  }
  if (round_wheels > 0) side.radius_m /= round_wheels;
  return side;
}

}  // namespace

Result<Drive> Drive::create(const DeviceBuild& build, SharedSpec<Spec> spec) {
  SL_TRY(check_levels(build.levels, build.engine));
  SL_ASSIGN(Side left, resolve_side(build, spec->left_joint, "left_joint"));
  SL_ASSIGN(Side right, resolve_side(build, spec->right_joint, "right_joint"));
  for (const Wheel& wheel : left.wheels)
    for (const Wheel& other : right.wheels)
      if (wheel.joint == other.joint)
        return Error{"a joint cannot be on both sides", "", build.decl.place, "/right_joint"};

  Drive drive{std::move(spec)};
  drive.base = build.bodies[0];
  drive.engine = build.engine;
  drive.geometry.wheel_separation_m = drive.spec->wheel_separation_m.value_or(left.centre_B.y -
                                                                              right.centre_B.y);
  if (std::abs(drive.geometry.wheel_separation_m) < 1e-3)
    return Error{"the left and the right wheels have no distance between them",
                 "move them apart, left to +y and right to -y, or give wheel_separation", build.decl.place};
  if (drive.geometry.wheel_separation_m < 0)
    return Error{"the left wheels are not to the left of the right ones",
                 "exchange left_joint and right_joint, or give wheel_separation", build.decl.place};
  drive.geometry.wheel_radius_m = drive.spec->wheel_radius_m.value_or(
      std::max(left.radius_m, right.radius_m));
  if (drive.geometry.wheel_radius_m <= 0)
    return Error{"the wheels have no round collision shape", "give wheel_radius", build.decl.place};
  drive.dx_m = 0.5 * (left.centre_B.x + right.centre_B.x);
  drive.dy_m = 0.5 * (left.centre_B.y + right.centre_B.y);
  drive.left = std::move(left.wheels);
  drive.right = std::move(right.wheels);
  drive.energy = build.energy;
  if (drive.energy) {
    drive.energy->can_ride();
    for (const auto* wheels : {&drive.left, &drive.right})
      for (const Wheel& wheel : *wheels) drive.energy->can_turn(wheel.joint);
  }
  drive.max_wheel_speed_radps = 1e16;
  for (const auto* wheels : {&drive.left, &drive.right})
    for (const Wheel& wheel : *wheels)
      drive.max_wheel_speed_radps = std::min(drive.max_wheel_speed_radps, wheel.max_speed);

  const std::string& robot = build.instance.name;
  for (const Level level : {ideal, contact}) {
    const char* const name = level == ideal ? "ideal" : "contact";
    drive.command[level] = build.accept<msg::Twist>(level, name);
    if (!drive.spec->odometry) continue;
    drive.odometry[level] = build.publish<msg::Odometry>(level, name);
    drive.odometry[level]->message.header.frame_id = robot + "/odom";
    drive.odometry[level]->message.child_frame_id = robot + "/" + build.instance.model->links[0].name;
  }
  drive.maneuver = maneuver::make_topics(build);
  return drive;
}

namespace {
constexpr LevelInfo levels[] = {
    {"ideal", msg::Odometry::ros_type, msg::Twist::ros_type, "The base moves as commanded, as if on rails."},
    {"contact", msg::Odometry::ros_type, msg::Twist::ros_type,
     "Motors turn the wheels, friction moves the robot."},
};
// Names and file names of the plugins of Gazebo, Ignition and Gazebo classic.
constexpr const char* sdf_types[] = {
    "plugin:DiffDrive",
    "plugin:gz-sim-diff-drive-system",
    "plugin:ignition-gazebo-diff-drive-system",
    "plugin:gazebo_ros_diff_drive",
    "plugin:DiffDrivePlugin",
    "plugin:SkidSteerDrive",
    "plugin:SkidSteerDrivePlugin",
    "plugin:gazebo_ros_skid_steer_drive",
};
}  // namespace

constinit const Kind kind = make_kind<Drive>({
    .name = "diff_drive",
    .help = "Differential drive with odometry: speed and turning rate in, wheel speeds out.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names, TF, covariances, limits of the jerk",
});

}  // namespace sandlot::diff_drive
