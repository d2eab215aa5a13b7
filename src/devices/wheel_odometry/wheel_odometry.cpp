#include "devices/wheel_odometry/wheel_odometry.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::wheel_odometry {
namespace {

/// The joints of one side; `sum_B` gathers their origins in B.
Result<std::vector<Wheel>> wheels(const DeviceBuild& build, const std::vector<std::string>& names,
                                  const char* key, Vec3& sum_B) {
  const model::Model& model = *build.instance.model;
  const auto at = [&](std::string what, std::string fix) {
    const Node* const node = build.decl.config.find(key);
    return Error{std::move(what), std::move(fix),
                 node && node->place().file ? node->place() : build.decl.place, std::string("/") + key};
  };
  if (names.empty()) return at("no wheel joint is named", "name one, or a list of them");
  std::vector<Wheel> out;
  for (const std::string& name : names) {
    SL_ASSIGN(const std::uint32_t index, build.joint_index(name, key));
    const model::Joint& joint = model.joints[index];
    if (joint.type != model::JointType::revolute && joint.type != model::JointType::continuous)
      return at("joint '" + name + "' does not turn", "a wheel needs a revolute or continuous joint");
    const Pose X_BJ = inverse(model.links.front().X_ML) * model.links[joint.child].X_ML * joint.X_CJ;
    const Vec3 axis_B = rotate(X_BJ.q, joint.axis_J);
    if (std::abs(axis_B.y) < 0.9)
      return at("the axis of joint '" + name + "' does not lie across the robot",
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

}  // namespace

Result<Odometer> Odometer::create(const DeviceBuild& build, Spec spec) {
  Odometer o{std::move(spec)};
  o.key = build.key;
  Vec3 sum_B;
  SL_ASSIGN(o.left, wheels(build, o.spec.left_joint, "left_joint", sum_B));
  SL_ASSIGN(o.right, wheels(build, o.spec.right_joint, "right_joint", sum_B));
  const auto count = static_cast<double>(o.left.size() + o.right.size());
  o.dx_m = sum_B.x / count;
  o.dy_m = sum_B.y / count;
  o.state.X_OD = {o.dx_m, o.dy_m, 0};
  o.odometry = build.publish<msg::Odometry>(0, "odometry");
  o.odometry->message.header.frame_id = build.instance.name + "/odom";
  o.odometry->message.child_frame_id = build.instance.name + "/" + build.instance.model->links.front().name;
  return o;
}

void Odometer::sense(PoolView<Odometer> pool, const Context& context) {
  const auto joints = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Odometer& o = pool.all[index];
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
    const auto [s, c] = math::sincos(state.X_OD.theta_rad);
    message.pose.pose = kinematics::to_pose({state.X_OD.x_m - c * o.dx_m + s * o.dy_m,
                                             state.X_OD.y_m - s * o.dx_m - c * o.dy_m, state.X_OD.theta_rad});
    const auto [xx, xy, xt, yy, yt, tt] = state.covariance;
    auto& pose = message.pose.covariance;
    pose[0] = xx, pose[7] = yy, pose[35] = tt;
    pose[1] = pose[6] = xy;
    pose[5] = pose[30] = xt;
    pose[11] = pose[31] = yt;
    const double dt_s = pool.since[index].s(), v = d / dt_s, w = a / dt_s;
    message.twist.twist = {{v + w * o.dy_m, -w * o.dx_m, 0}, {0, 0, w}};
    message.twist.covariance[0] = var_d / (dt_s * dt_s);
    message.twist.covariance[35] = var_a / (dt_s * dt_s);
    o.odometry->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"odometry", msg::Odometry::ros_type, "", "Pose and velocity reckoned from the wheels."},
};
}  // namespace

constinit const Kind kind = make_kind<Odometer>({
    .name = "wheel_odometry",
    .help = "Dead reckoning from the wheels, with systematic and random errors.",
    .levels = levels,
});

}  // namespace sandlot::wheel_odometry
