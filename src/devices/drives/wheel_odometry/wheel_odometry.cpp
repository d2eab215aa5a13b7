#include "devices/drives/wheel_odometry/wheel_odometry.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::wheel_odometry {
namespace {

enum Level : std::uint32_t { odometry_level, pose_level };
constexpr std::uint64_t pose_use = 1;  // of the device's stream

/// The joints of one side; `sum_B` gathers their origins in B.
Result<std::vector<Wheel>> wheels(const DeviceBuild& build, const std::vector<std::string>& names,
                                  const char* key, Vec3& sum_B) {
  const model::Model& model = *build.instance.model;
  if (names.empty()) return build.error(key, "no wheel joint is named", "name one, or a list of them");
  std::vector<Wheel> out;
  for (const std::string& name : names) {
    SL_ASSIGN(const std::uint32_t index, build.joint_index(name, key));
    const model::Joint& joint = model.joints[index];
    if (joint.type != model::JointType::revolute && joint.type != model::JointType::continuous)
      return build.error(key, "joint '" + name + "' does not turn",
                         "a wheel needs a revolute or continuous joint");
    const Pose X_BJ = inverse(model.links.front().X_ML) * model.links[joint.child].X_ML * joint.X_CJ;
    const Vec3 axis_B = rotate(X_BJ.q, joint.axis_J);
    if (std::abs(axis_B.y) < 0.9)
      return build.error(key, "the axis of joint '" + name + "' does not lie across the robot",
                         "wheels turn about the y axis of the first link");
    sum_B += X_BJ.p;
    out.push_back({build.joints[index].index, axis_B.y > 0 ? 1.0 : -1.0});
  }
  return out;
}

double mean_angle(std::span<const Wheel> wheels, std::span<const JointState> joints) {
  double sum = 0;
  for (const Wheel& wheel : wheels) sum += wheel.sign * joints[wheel.joint].position;
  return sum / static_cast<double>(wheels.size());
}

/// P' = F P F^T + G Q G^T for a way d at the heading t, with variances of d and of the turn.
void propagate(std::array<double, 6>& P, double d, double t, double var_d, double var_a) {
  const auto [s, c] = math::sincos(t);
  const double fx = -d * s, fy = d * c;       // dx/dheading, dy/dheading
  const double gx = 0.5 * fx, gy = 0.5 * fy;  // of the turn: half of it has happened half way
  const auto [xx, xy, xt, yy, yt, tt] = P;
  P[0] = xx + 2 * fx * xt + fx * fx * tt + c * c * var_d + gx * gx * var_a;
  P[1] = xy + fy * xt + fx * yt + fx * fy * tt + c * s * var_d + gx * gy * var_a;
  P[2] = xt + fx * tt + gx * var_a;
  P[3] = yy + 2 * fy * yt + fy * fy * tt + s * s * var_d + gy * gy * var_a;
  P[4] = yt + fy * tt + gy * var_a;
  P[5] = tt + var_a;
}

void set_covariance(std::array<double, 36>& pose, const std::array<double, 6>& P) {
  const auto [xx, xy, xt, yy, yt, tt] = P;
  pose[0] = xx, pose[7] = yy, pose[35] = tt;
  pose[1] = pose[6] = xy;
  pose[5] = pose[30] = xt;
  pose[11] = pose[31] = yt;
}

/// B from the axle's centre.
kinematics::PlanarPose base_of(const Odometer& o, const kinematics::PlanarPose& axle) {
  const auto [s, c] = math::sincos(axle.theta_rad);
  return {axle.x_m - c * o.dx_m + s * o.dy_m, axle.y_m - s * o.dx_m - c * o.dy_m, axle.theta_rad};
}

/// Reckons with B's true motion since the previous sample.
void publish_pose(Odometer& o, std::uint64_t sample, Time since, const Context& context) {
  const PoseSpec& spec = o.spec.pose;
  PoseState& state = o.state.pose;
  const Pose& X_WB = context.engine.states()[o.base].X_WB;
  const double yaw = yaw_of(X_WB.q);
  if (!state.begun) state.seen_W = {X_WB.p.x, X_WB.p.y, yaw};
  state.begun = true;
  const double dx_W = X_WB.p.x - state.seen_W.x_m, dy_W = X_WB.p.y - state.seen_W.y_m;
  const auto [s0, c0] = math::sincos(state.seen_W.theta_rad);
  const double dx = c0 * dx_W + s0 * dy_W, dy = c0 * dy_W - s0 * dx_W, way = math::hypot(dx, dy);
  const double turn = math::wrap_angle(yaw - state.seen_W.theta_rad);
  state.seen_W = {X_WB.p.x, X_WB.p.y, yaw};

  const double e2 = o.spec.errors * o.spec.errors;
  const double var_d = e2 * spec.distance_walk * spec.distance_walk * way;
  const double var_a = e2 * (spec.heading_walk * spec.heading_walk * way +
                             spec.turn_walk * spec.turn_walk * std::abs(turn));
  double stretch = 1, bend = 0;
  // The way's own direction in B: robots that move sideways have errors along it, too.
  const double course = way > 0 ? math::atan2(dy, dx) : 0;
  propagate(state.covariance, way, state.reported_O.theta_rad + course, var_d, var_a);
  if (var_d > 0 || var_a > 0) {
    Stream random = Stream(context.seed, o.key, Purpose::noise, sample).fork(pose_use);
    const double along = std::sqrt(var_d) * random.normal();
    bend = std::sqrt(var_a) * random.normal();
    if (way > 0) stretch += along / way;
  }
  const auto [s, c] = math::sincos(state.reported_O.theta_rad + 0.5 * bend);
  state.reported_O.x_m += stretch * (c * dx - s * dy);
  state.reported_O.y_m += stretch * (s * dx + c * dy);
  state.reported_O.theta_rad += turn + bend;

  msg::Odometry& message = o.pose->message;
  message.pose.pose = kinematics::to_pose(state.reported_O);
  set_covariance(message.pose.covariance, state.covariance);
  // As means over the interval, in B half way.
  const double dt_s = since.s();
  const auto half = math::sincos(0.5 * turn);
  message.twist.twist = {
      {stretch * (half.cos * dx + half.sin * dy) / dt_s, stretch * (half.cos * dy - half.sin * dx) / dt_s, 0},
      {0, 0, (turn + bend) / dt_s}};
  message.twist.covariance[0] = message.twist.covariance[7] = var_d / (dt_s * dt_s);
  message.twist.covariance[35] = var_a / (dt_s * dt_s);
  o.pose->publish(context.now);
}

}  // namespace

Result<Odometer> Odometer::create(const DeviceBuild& build, Spec spec) {
  Odometer o{std::move(spec)};
  o.key = build.key;
  o.base = build.bodies.front().index;
  Vec3 sum_B;
  SL_ASSIGN(o.left, wheels(build, o.spec.left_joint, "left_joint", sum_B));
  SL_ASSIGN(o.right, wheels(build, o.spec.right_joint, "right_joint", sum_B));
  const auto count = static_cast<double>(o.left.size() + o.right.size());
  o.dx_m = sum_B.x / count;
  o.dy_m = sum_B.y / count;
  o.state.X_OD = {o.dx_m, o.dy_m, 0};
  o.odometry = build.publish<msg::Odometry>(odometry_level, "odometry");
  o.pose = build.publish<msg::Odometry>(pose_level, "pose");
  for (auto* const topic : {o.odometry, o.pose}) {
    topic->message.header.frame_id = build.instance.name + "/odom";
    topic->message.child_frame_id = build.instance.name + "/" + build.instance.model->links.front().name;
  }
  return o;
}

void Odometer::sense(PoolView<Odometer> pool, const Context& context) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Odometer& o = pool.all[index];
    if (pool.levels[index] >> pose_level & 1) publish_pose(o, pool.sample[index], pool.since[index], context);
    if (!(pool.levels[index] >> odometry_level & 1)) continue;
    const Spec& spec = o.spec;
    State& state = o.state;
    const double left_rad = mean_angle(o.left, joints), right_rad = mean_angle(o.right, joints);
    const double e = spec.errors;
    const auto believed = [e](double size, double error) { return size * (1 + std::max(-0.5, e * error)); };
    const double left_m = believed(spec.wheel_radius_m, spec.left_error) * (left_rad - state.left_rad);
    const double right_m = believed(spec.wheel_radius_m, spec.right_error) * (right_rad - state.right_rad);
    state.left_rad = left_rad;
    state.right_rad = right_rad;
    double d = 0.5 * (left_m + right_m);
    double a = (right_m - left_m) / believed(spec.wheel_separation_m, spec.separation_error);
    const double var_d = e * e * (spec.alpha_3 * std::abs(d) + spec.alpha_4 * std::abs(a));
    const double var_a = e * e * (spec.alpha_1 * std::abs(a) + spec.alpha_2 * std::abs(d));
    if (var_d > 0 || var_a > 0) {
      propagate(state.covariance, d, state.X_OD.theta_rad + 0.5 * a, var_d, var_a);
      Stream random(context.seed, o.key, Purpose::noise, pool.sample[index]);
      d += std::sqrt(var_d) * random.normal();
      a += std::sqrt(var_a) * random.normal();
    }
    state.X_OD = kinematics::along_arc(state.X_OD, d, a);

    msg::Odometry& message = o.odometry->message;
    message.pose.pose = kinematics::to_pose(base_of(o, state.X_OD));
    set_covariance(message.pose.covariance, state.covariance);
    const double dt_s = pool.since[index].s(), v = d / dt_s, w = a / dt_s;
    message.twist.twist = {{v + w * o.dy_m, -w * o.dx_m, 0}, {0, 0, w}};
    message.twist.covariance[0] = var_d / (dt_s * dt_s);
    message.twist.covariance[35] = var_a / (dt_s * dt_s);
    o.odometry->publish(context.now);
  }
}

void Odometer::go_to(const kinematics::PlanarPose& X_OB, const std::array<double, 6>& covariance) {
  const auto [s, c] = math::sincos(X_OB.theta_rad);
  state.X_OD = {X_OB.x_m + c * dx_m - s * dy_m, X_OB.y_m + s * dx_m + c * dy_m, X_OB.theta_rad};
  state.pose.reported_O = X_OB;
  state.covariance = state.pose.covariance = covariance;
}

Result<Odometer::Trigger::Response> Odometer::reset(const Trigger::Request&, const Context&) {
  go_to({}, {});
  return Trigger::Response{true, "the odometry is at zero"};
}

Result<Odometer::SetPose::Response> Odometer::set_pose(const SetPose::Request& request, const Context&) {
  const msg::PoseWithCovarianceStamped& given = request.pose;
  const std::string& frame = odometry->message.header.frame_id;
  if (!given.header.frame_id.empty() && given.header.frame_id != frame)
    return Error{"the pose is in '" + given.header.frame_id.substr(0, 60) + "'",
                 "give it in '" + frame + "'"};
  const Pose& pose_OB = given.pose.pose;
  const std::array<double, 36>& P = given.pose.covariance;
  constexpr double most = 1e9;  // what is larger would overflow soon
  if (!is_finite(pose_OB) || norm(pose_OB.q) < 1e-6 || norm(pose_OB.p) > most)
    return Error{"the pose is not finite"};
  if (!std::all_of(P.begin(), P.end(), [](double x) { return std::abs(x) <= most; }))
    return Error{"the covariance is not finite"};
  if (P[0] < 0 || P[7] < 0 || P[35] < 0) return Error{"the covariance has a negative variance"};
  go_to({pose_OB.p.x, pose_OB.p.y, yaw_of(normalised(pose_OB.q))}, {P[0], P[1], P[5], P[7], P[11], P[35]});
  return SetPose::Response{};
}

/// A level that takes over alone goes on from where the other one is.
Status Odometer::switch_level(std::uint32_t before, std::uint32_t after, const Context& context) {
  const std::uint32_t fresh = after & ~before;
  const bool had_odometry = before >> odometry_level & 1, had_pose = before >> pose_level & 1;
  if (fresh >> odometry_level & 1) {
    const auto joints = context.engine.joint_states();
    state.left_rad = mean_angle(left, joints);
    state.right_rad = mean_angle(right, joints);
    if (had_pose && state.pose.begun) {
      const auto [s, c] = math::sincos(state.pose.reported_O.theta_rad);
      state.X_OD = {state.pose.reported_O.x_m + c * dx_m - s * dy_m,
                    state.pose.reported_O.y_m + s * dx_m + c * dy_m, state.pose.reported_O.theta_rad};
      state.covariance = state.pose.covariance;
    }
  }
  if (fresh >> pose_level & 1) {
    state.pose.begun = false;
    if (had_odometry) {
      state.pose.reported_O = base_of(*this, state.X_OD);
      state.pose.covariance = state.covariance;
    }
  }
  return {};
}

namespace {
constexpr DeviceService services[] = {
    device_service<Odometer, Odometer::Trigger, &Odometer::reset>("reset",
                                                                  "Sets pose and covariance to zero."),
    device_service<Odometer, Odometer::SetPose, &Odometer::set_pose>(
        "set_pose", "Sets pose and covariance in the odometry's frame."),
};
constexpr LevelInfo levels[] = {
    {"odometry", msg::Odometry::ros_type, "", "Pose and velocity estimated from the wheels."},
    {"pose", msg::Odometry::ros_type, "", "Pose and velocity with the errors of a good odometry."},
};
}  // namespace

constinit const Kind kind = make_kind<Odometer>({
    .name = "wheel_odometry",
    .help = "Dead reckoning from the wheels, with systematic and random errors.",
    .levels = levels,
    .services = services,
});

}  // namespace sandlot::wheel_odometry
