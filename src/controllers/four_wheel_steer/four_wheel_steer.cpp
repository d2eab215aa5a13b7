#include "controllers/four_wheel_steer/four_wheel_steer.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::four_wheel_steer {
namespace {

using Report = msg::FourWheelSteerState;
static_assert(static_cast<std::uint8_t>(Mode::stop) == Report::stop &&
              static_cast<std::uint8_t>(Mode::crab) == Report::crab &&
              static_cast<std::uint8_t>(Mode::spin) == Report::spin &&
              static_cast<std::uint8_t>(Mode::turn) == Report::turn);
static_assert(static_cast<std::uint8_t>(Phase::standing) == Report::standing &&
              static_cast<std::uint8_t>(Phase::steering) == Report::steering &&
              static_cast<std::uint8_t>(Phase::driving) == Report::driving &&
              static_cast<std::uint8_t>(Phase::braking) == Report::braking);

/// Joint angles beyond this are not measurements.
constexpr double largest_angle_rad = 1e9;
/// Longest time that one step of the governor covers.
constexpr double longest_step_s = 0.25;

/// P' = F P F^T + Q, with Q = var_d in both directions of the plane and var_a of the heading.
/// @param dx, dy  displacement in the world
void propagate(std::array<double, 6>& P, double dx, double dy, double var_d, double var_a) {
  const double fx = -dy, fy = dx;  // derivatives of the new place by the heading
  const auto [xx, xy, xt, yy, yt, tt] = P;
  P = {xx + 2 * fx * xt + fx * fx * tt + var_d,
       xy + fy * xt + fx * yt + fx * fy * tt,
       xt + fx * tt,
       yy + 2 * fy * yt + fy * fy * tt + var_d,
       yt + fy * tt,
       tt + var_a};
}

msg::Twist twist_of(const Motion& v) { return {{v.x, v.y, 0}, {0, 0, v.turn}}; }

}  // namespace

Status FourWheelSteer::check_wheels() const {
  const std::size_t n = spec.wheels_m.size();
  const auto check_length = [&](const std::vector<std::string>& list, const char* key) -> Status {
    if (list.size() == n) return {};
    return Error{
        "there are " + std::to_string(n) + " wheels and " + std::to_string(list.size()) + " names in " + key,
        "name one for each of the wheels",
        {},
        std::string("/") + key};
  };
  SL_TRY(check_length(spec.steering, "steering"));
  SL_TRY(check_length(spec.drive, "drive"));
  SL_TRY(check_length(spec.steering_joint, "steering_joint"));
  SL_TRY(check_length(spec.wheel_joint, "wheel_joint"));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (std::abs(spec.wheels_m[i][0] - spec.wheels_m[k][0]) < 1e-6 &&
          std::abs(spec.wheels_m[i][1] - spec.wheels_m[k][1]) < 1e-6)
        return Error{"two wheels are at one place", "give each wheel a place of its own", {}, "/wheels"};
  if (!(spec.limits.steering_lower_rad < spec.limits.steering_upper_rad))
    return Error{"the range of steering is empty",
                 "steering_lower must be below steering_upper",
                 {},
                 "/steering_lower"};
  if (spec.limits.aligned_rad > spec.limits.steer_first_rad)
    return Error{"aligned is larger than steer_first",
                 "it drives off at an error that must not stop it",
                 {},
                 "/aligned"};
  return {};
}

Status FourWheelSteer::init(const Description& robot, Outputs& out) {
  SL_TRY(check_wheels());
  SL_ASSIGN(velocity_, robot.reading<msg::Twist>(spec.velocity));
  SL_ASSIGN(joints_, robot.reading<msg::JointState>(spec.joint_states));
  const std::size_t n = spec.wheels_m.size();
  std::vector<Wheel> wheels;
  Vec2 middle;
  for (std::size_t i = 0; i < n; ++i) {
    SL_ASSIGN(steering_.emplace_back(), robot.actuator<msg::Float64>(spec.steering[i]));
    SL_ASSIGN(drive_.emplace_back(), robot.actuator<msg::Float64>(spec.drive[i]));
    wheels.push_back({spec.wheels_m[i][0], spec.wheels_m[i][1], spec.wheel_radius_m});
    middle = middle + (1 / static_cast<double>(n)) * Vec2{wheels[i].x_m, wheels[i].y_m};
  }
  double squares = 0;
  for (const Wheel& wheel : wheels) {
    const Vec2 off = Vec2{wheel.x_m, wheel.y_m} - middle;
    squares += dot(off, off);
  }
  arm_m_ = std::sqrt(squares / static_cast<double>(n));
  governor_ = Governor(std::move(wheels), spec.limits);
  if (robot.control_period_s > 0) period_s_ = robot.control_period_s;
  odometry_ = out.publish<msg::Odometry>("odometry");
  report_ = out.publish<Report>("state");
  odometry_out_.header.frame_id = robot.robot + "/odom";
  odometry_out_.child_frame_id = robot.robot + "/" + spec.base_frame;
  state_out_.header.frame_id = odometry_out_.child_frame_id;
  state_out_.wheels.resize(n);
  for (auto* list : {&steering_now_, &wheel_now_, &rate_now_, &turned_, &headed_, &state.steering_rad,
                     &state.wheel_rad, &state.rate_radps, &orders_.rate_radps})
    list->assign(n, 0);
  state.setting = governor_.start(state.steering_rad);
  return {};
}

bool FourWheelSteer::fits() const {
  const auto is_angle = [](double x) { return std::abs(x) < largest_angle_rad; };
  const auto is_time = [](Time t) { return t.ns >= 0 && t.ns <= std::int64_t{1} << 61; };
  const std::size_t n = spec.wheels_m.size();
  bool finite = std::abs(state.x_m) < 1e12 && std::abs(state.y_m) < 1e12 && is_angle(state.heading_rad);
  for (const double x : state.covariance) finite = finite && std::isfinite(x);
  for (const double x : state.rate_radps) finite = finite && std::isfinite(x);
  for (const double x : {state.measured.x, state.measured.y, state.measured.turn, state.residual_m})
    finite = finite && std::isfinite(x);
  return finite && governor_.fits(state.setting) && state.steering_rad.size() == n &&
         state.wheel_rad.size() == n && state.rate_radps.size() == n &&
         std::all_of(state.steering_rad.begin(), state.steering_rad.end(), is_angle) &&
         std::all_of(state.wheel_rad.begin(), state.wheel_rad.end(), is_angle) && is_time(state.joints_at) &&
         is_time(state.stepped_at);
}

/// Fills what the joints are at now. @return whether the message has them all
bool FourWheelSteer::read_joints(const msg::JointState& message) {
  // Lists of a message may be shorter than its names.
  const std::size_t known = std::min(message.name.size(), message.position.size());
  const auto find = [&](const std::string& joint) -> std::optional<std::size_t> {
    for (std::size_t k = 0; k < known; ++k)
      if (message.name[k] == joint && std::abs(message.position[k]) < largest_angle_rad) return k;
    return std::nullopt;
  };
  for (std::size_t i = 0; i < spec.wheels_m.size(); ++i) {
    const auto steering = find(spec.steering_joint[i]), wheel = find(spec.wheel_joint[i]);
    if (!steering || !wheel) return false;
    steering_now_[i] = message.position[*steering];
    wheel_now_[i] = message.position[*wheel];
    const bool has_rate = *wheel < message.velocity.size() && std::isfinite(message.velocity[*wheel]);
    rate_now_[i] = has_rate ? message.velocity[*wheel] : 0;
  }
  return true;
}

/// Moves the odometry by what the joints turned since the joint states before.
void FourWheelSteer::move(double dt_s) {
  const double most_rad = 2 * spec.limits.max_wheel_speed_radps * dt_s;
  bool plausible = true;
  for (std::size_t i = 0; i < turned_.size(); ++i) {
    turned_[i] = wheel_now_[i] - state.wheel_rad[i];
    headed_[i] = 0.5 * (steering_now_[i] + state.steering_rad[i]);
    plausible = plausible && std::abs(turned_[i]) <= most_rad;
  }
  if (!plausible) std::fill(turned_.begin(), turned_.end(), 0.0);
  const Fit fit = rolled(governor_.wheels(), turned_, headed_);
  const auto [s, c] = math::sincos(state.heading_rad);
  const double dx = c * fit.x_m - s * fit.y_m, dy = s * fit.x_m + c * fit.y_m;
  const double told_apart_m = spec.wheel_radius_m * spec.encoder_resolution_rad;
  const double d = std::sqrt(dx * dx + dy * dy),
               square = fit.rmsd_m * fit.rmsd_m +
                        told_apart_m * told_apart_m / (6 * static_cast<double>(turned_.size()));
  const double var_d = spec.distance_variance * d + square;
  const double var_a = spec.heading_variance * d + spec.turn_variance * std::abs(fit.turn_rad) +
                       square / (arm_m_ * arm_m_);
  propagate(state.covariance, dx, dy, var_d, var_a);
  state.x_m += dx;
  state.y_m += dy;
  state.heading_rad = math::wrap_angle(state.heading_rad + fit.turn_rad);
  state.measured = velocity_of(fit, dt_s);
  state.residual_m = fit.rmsd_m;
  auto& twist = odometry_out_.twist.covariance;
  twist[0] = twist[7] = var_d / (dt_s * dt_s);
  twist[35] = var_a / (dt_s * dt_s);
}

void FourWheelSteer::fill_odometry() {
  odometry_out_.pose.pose = {{state.x_m, state.y_m, 0}, quat_from_axis_angle({0, 0, 1}, state.heading_rad)};
  auto& P = odometry_out_.pose.covariance;
  const auto [xx, xy, xt, yy, yt, tt] = state.covariance;
  P[0] = xx, P[7] = yy, P[35] = tt;
  P[1] = P[6] = xy;
  P[5] = P[30] = xt;
  P[11] = P[31] = yt;
  odometry_out_.twist.twist = twist_of(state.measured);
}

Motion FourWheelSteer::command(const Observation& obs) const {
  const auto seen = obs.get(velocity_);
  const Time timeout = Time::from_s(spec.timeout_s);
  if (!seen.valid || obs.now() - seen.stamp > timeout || obs.now() - state.joints_at > timeout) return {};
  return {seen.message.linear.x, seen.message.linear.y, seen.message.angular.z};
}

void FourWheelSteer::step(const Observation& obs, Command& cmd) {
  const auto seen = obs.get(joints_);
  bool moved = false;
  if (seen.fresh && read_joints(seen.message)) {
    const double dt_s = (seen.stamp - state.joints_at).s();
    if (state.begun && dt_s > 0) {
      move(dt_s);
      moved = true;
    }
    if (!state.begun) {
      state.setting = governor_.start(steering_now_);
      state.stepped_at = obs.now() - Time::from_s(period_s_);
    }
    state.begun = 1;
    state.joints_at = seen.stamp;
    state.steering_rad = steering_now_;
    state.wheel_rad = wheel_now_;
    state.rate_radps = rate_now_;
  }
  if (!state.begun) return;
  if (moved) {
    fill_odometry();
    cmd.publish(odometry_, odometry_out_);
  }

  const double dt_s = std::clamp((obs.now() - state.stepped_at).s(), 1e-6, longest_step_s);
  state.stepped_at = obs.now();
  governor_.set(spec.limits);
  governor_.step(command(obs), state.steering_rad, dt_s, state.setting, orders_);
  for (std::size_t i = 0; i < steering_.size(); ++i) {
    cmd.set(steering_[i], msg::Float64{state.setting.steering_rad[i]});
    cmd.set(drive_[i], msg::Float64{orders_.rate_radps[i]});
  }
  fill_report();
  cmd.publish(report_, state_out_);
}

void FourWheelSteer::fill_report() {
  const Motion& set = state.setting.motion;
  Report& out = state_out_;
  out.mode = static_cast<std::uint8_t>(orders_.mode);
  out.phase = static_cast<std::uint8_t>(state.setting.phase);
  out.reachable = orders_.reachable;
  out.scale = orders_.scale;
  out.target = twist_of(set);
  out.steering_error = orders_.error_rad;
  const auto centre = centre_of_rotation(set);
  out.turns = centre.has_value();
  out.centre = centre ? Vec3{centre->x, centre->y, 0} : Vec3{};
  for (std::size_t i = 0; i < out.wheels.size(); ++i) {
    const Wheel& wheel = governor_.wheels()[i];
    msg::SteeredWheelState& shown = out.wheels[i];
    shown.steering_target = state.setting.steering_rad[i];
    shown.steering = state.steering_rad[i];
    shown.rate_target = orders_.rate_radps[i];
    shown.rate = state.rate_radps[i];
    shown.slip_angle = inverse(state.measured, wheel).slip_rad;
    shown.lateral_slip = slip_of(state.measured, wheel, state.steering_rad[i]);
    const Vec2 a = wheel_acceleration(set, orders_.change, wheel);
    shown.acceleration = {a.x, a.y, 0};
  }
  out.residual = state.residual_m;
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<FourWheelSteer>({
    .name = "four_wheel_steer",
    .help = "Drives a robot with four steered wheels by velocity commands, over its joint controllers, with "
            "odometry.",
});

}  // namespace sandlot::controllers::four_wheel_steer
