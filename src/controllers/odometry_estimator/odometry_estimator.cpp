#include "controllers/odometry_estimator/odometry_estimator.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::odometry_estimator {
namespace {

constexpr Time gyro_timeout = Time::from_s(0.5);

/// P' = F P F^T + G Q G^T.
void propagate(std::array<double, 6>& P, double d, double phi, double var_d, double var_a) {
  const auto [s, c] = math::sincos(phi);
  const double fx = -d * s, fy = d * c, gx = 0.5 * fx, gy = 0.5 * fy;
  const auto [xx, xy, xt, yy, yt, tt] = P;
  P = {xx + 2 * fx * xt + fx * fx * tt + c * c * var_d + gx * gx * var_a,
       xy + fy * xt + fx * yt + fx * fy * tt + c * s * var_d + gx * gy * var_a,
       xt + fx * tt + gx * var_a,
       yy + 2 * fy * yt + fy * fy * tt + s * s * var_d + gy * gy * var_a,
       yt + fy * tt + gy * var_a,
       tt + var_a};
}

}  // namespace

Status OdometryEstimator::init(const Description& robot, Outputs& out) {
  SL_ASSIGN(odometry, robot.reading<msg::Odometry>(spec.odometry));
  const bool has_imu = std::any_of(robot.readings.begin(), robot.readings.end(),
                                   [](const auto& entry) { return entry.type == msg::Imu::ros_type; });
  if (has_imu || !spec.imu.empty()) {
    SL_ASSIGN(imu, robot.reading<msg::Imu>(spec.imu));
    q_BS = robot.pose(*imu).q;
  }
  estimate = out.publish<msg::Odometry>("estimate");
  return {};
}

void OdometryEstimator::step(const Observation& obs, Command& cmd) {
  if (imu)
    if (const auto seen = obs.get(*imu); seen.fresh) turn(seen.message, seen.stamp);
  if (const auto seen = obs.get(odometry); seen.fresh) {
    move(seen.message, seen.stamp);
    cmd.publish(estimate, out_);
  }
}

bool OdometryEstimator::fits() const {
  const auto is_time = [](Time t) { return t.ns >= 0 && t.ns <= std::int64_t{1} << 61; };
  bool finite = true;
  for (const double x : {state.x_m, state.y_m, state.heading_rad, state.seen_x_m, state.seen_y_m,
                         state.seen_rad, state.gyro_radps, state.gyro_rad})
    finite = finite && std::abs(x) < 1e12;
  for (const double x : state.covariance) finite = finite && std::isfinite(x);
  return finite && is_time(state.seen_at) && is_time(state.gyro_at);
}

/// Adds what the gyroscope turned since its previous message.
void OdometryEstimator::turn(const msg::Imu& message, Time stamp) {
  const double rate_radps = rotate(q_BS, message.angular_velocity).z;
  if (state.has_gyro) state.gyro_rad += 0.5 * (state.gyro_radps + rate_radps) * (stamp - state.gyro_at).s();
  state.gyro_radps = rate_radps;
  state.gyro_at = stamp;
  state.has_gyro = 1;
}

/// Moves the estimate by what the odometry moved since its previous message.
void OdometryEstimator::move(const msg::Odometry& message, Time stamp) {
  const Pose& seen = message.pose.pose;
  const double yaw = yaw_of(seen.q);
  double var_d = 0, var_a = 0, dt_s = 0;
  if (stamp - state.gyro_at > gyro_timeout) state.has_gyro = 0;
  if (state.begun) {
    const auto [s, c] = math::sincos(state.seen_rad);
    const double x = seen.p.x - state.seen_x_m, y = seen.p.y - state.seen_y_m;
    const double dx = c * x + s * y, dy = c * y - s * x, d = std::sqrt(dx * dx + dy * dy);
    const double wheels = math::wrap_angle(yaw - state.seen_rad);
    const double a = state.has_gyro ? state.gyro_rad : wheels;
    dt_s = (stamp - state.seen_at).s();
    var_d = spec.distance_variance * d;
    var_a = state.has_gyro ? spec.gyro_density * spec.gyro_density * dt_s
                           : spec.heading_variance * d + spec.turn_variance * std::abs(a);
    const double phi = state.heading_rad + 0.5 * (a - wheels) + (d > 0 ? math::atan2(dy, dx) : 0);
    propagate(state.covariance, d, phi, var_d, var_a);
    const auto way = math::sincos(phi);
    state.x_m += d * way.cos;
    state.y_m += d * way.sin;
    state.heading_rad = math::wrap_angle(state.heading_rad + a);
  } else {
    state.x_m = seen.p.x;
    state.y_m = seen.p.y;
    state.heading_rad = yaw;
  }
  state.begun = 1;
  state.seen_x_m = seen.p.x;
  state.seen_y_m = seen.p.y;
  state.seen_rad = yaw;
  state.seen_at = stamp;
  state.gyro_rad = 0;

  msg::Odometry& out = out_;
  out.header.frame_id = message.header.frame_id;
  out.child_frame_id = message.child_frame_id;
  out.pose.pose = {{state.x_m, state.y_m, seen.p.z}, quat_from_axis_angle({0, 0, 1}, state.heading_rad)};
  auto& P = out.pose.covariance;
  const auto [xx, xy, xt, yy, yt, tt] = state.covariance;
  P[0] = xx, P[7] = yy, P[35] = tt;
  P[1] = P[6] = xy;
  P[5] = P[30] = xt;
  P[11] = P[31] = yt;
  out.twist.twist = message.twist.twist;
  if (state.has_gyro) out.twist.twist.angular.z = state.gyro_radps;
  out.twist.covariance[0] = dt_s > 0 ? var_d / (dt_s * dt_s) : 0;
  out.twist.covariance[35] = dt_s > 0 ? var_a / (dt_s * dt_s) : 0;
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<OdometryEstimator>({
    .name = "odometry_estimator",
    .help = "Publishes an estimate of the pose, with covariance, from odometry and gyroscope.",
});

}  // namespace sandlot::controllers::odometry_estimator
