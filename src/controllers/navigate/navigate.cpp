#include "controllers/navigate/navigate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/log.h"
#include "base/text.h"

namespace sandlot::controllers::navigate {
namespace {

using navigation::NavStatus;
using navigation::PlanarTwist;
using navigation::Pose2;

Pose2 in_plane(const Pose& X) { return {X.p.x, X.p.y, yaw_of(X.q)}; }
Pose in_space(const Pose2& X) { return {{X.x, X.y, 0}, quat_from_axis_angle({0, 0, 1}, X.theta)}; }
PlanarTwist in_plane(const msg::Twist& v) { return {v.linear.x, v.linear.y, v.angular.z}; }

/// Standard deviation of the position along its less certain axis; infinite for variances that are none.
double position_std(const std::array<double, 36>& covariance) {
  const double greatest = std::max(covariance[0], covariance[7]);
  return covariance[0] >= 0 && covariance[7] >= 0 ? std::sqrt(greatest)
                                                  : std::numeric_limits<double>::infinity();
}

/// Occupancy in percent as Nav2 publishes costs: 99 inscribed, 100 lethal.
std::int8_t percent_of(std::uint8_t cost) {
  if (cost >= navigation::lethal_cost) return 100;
  if (cost >= navigation::inscribed_cost) return 99;
  return static_cast<std::int8_t>(cost == 0 ? 0 : 1 + 97 * (cost - 1) / 251);
}

bool over(NavStatus status) {
  return status == NavStatus::idle || status == NavStatus::reached || status == NavStatus::failed;
}

}  // namespace

Status Navigate::init(const Description& robot, Outputs& out) {
  std::optional<navigation::GridMap> map;
  if (!spec.map.map.empty() || !spec.map.map_data.empty()) { SL_ASSIGN(map, map_of(spec.map)); }
  SL_ASSIGN(navigation::Navigator navigator,
            navigation::Navigator::make(spec, robot.control_period_s, std::move(map)));
  period_s_ = robot.control_period_s;
  state.navigator = navigator.take_state();
  navigator_ = std::move(navigator);
  SL_ASSIGN(laser_, robot.reading<msg::LaserScan>(spec.laser));
  X_BL_ = robot.pose(laser_);
  X_BL_.p.x -= spec.axle_m;
  if (!spec.pose.empty()) { SL_ASSIGN(pose_, robot.reading<msg::PoseWithCovarianceStamped>(spec.pose)); }
  if (!pose_ || !spec.odometry.empty()) { SL_ASSIGN(odometry_, robot.reading<msg::Odometry>(spec.odometry)); }
  if (spec.publish.empty()) {
    SL_ASSIGN(drive_, robot.actuator<msg::Twist>(spec.drive));
  } else if (spec.drive.empty()) {
    velocity_ = out.publish<msg::Twist>(spec.publish);
  } else {
    return Error{"both a drive and a topic are given", "leave one of them out", {}, "/publish"};
  }
  goal_pose_ = out.subscribe<msg::PoseStamped>("goal_pose");
  cancel_ = out.subscribe<msg::Empty>("cancel_goal");
  plan_ = out.publish<msg::Path>("plan");
  local_plan_ = out.publish<msg::Path>("local_plan");
  costmap_ = out.publish<msg::OccupancyGrid>("costmap");
  status_ = out.publish<msg::DiagnosticStatus>("status");
  status_out_.name = out.path();
  return {};
}

bool Navigate::fits() const {
  const navigation::ObstacleLayerState& layer = state.navigator.layer;
  return navigator_ && layer.trust.size() == navigator_->area().cells() &&
         layer.free.size() == layer.trust.size() && state.next <= spec.goals.size();
}

Pose2 Navigate::at_axle(const Pose& X_MB) const {
  Pose2 out = in_plane(X_MB);
  if (spec.axle_m == 0) return out;
  const auto [s, c] = math::sincos(out.theta);
  out.x += c * spec.axle_m, out.y += s * spec.axle_m;
  return out;
}
PlanarTwist Navigate::at_axle(const msg::Twist& v_B) const {
  PlanarTwist out = in_plane(v_B);
  if (spec.axle_m != 0) out.vy_mps += spec.axle_m * out.w_radps;
  return out;
}

navigation::NavigatorInput Navigate::input(const Observation& obs) {
  navigation::NavigatorInput in;
  in.dt_s = period_s_;
  frame_.clear();
  const auto fresh_enough = [&](Time stamp) { return (obs.now() - stamp).s() <= spec.timeout_s; };
  if (odometry_) {
    const auto odometry = obs.get(*odometry_);
    if (odometry.valid && !pose_) frame_ = odometry.message.header.frame_id;
    if (odometry.valid && fresh_enough(odometry.stamp)) {
      in.velocity = at_axle(odometry.message.twist.twist);
      if (!pose_) {
        in.X_MB = driven(at_axle(odometry.message.pose.pose), *in.velocity, (obs.now() - odometry.stamp).s());
        in.pose_std_m = position_std(odometry.message.pose.covariance);
      }
    }
  }
  if (pose_) {
    const auto pose = obs.get(*pose_);
    if (pose.valid) frame_ = pose.message.header.frame_id;
    if (pose.valid && fresh_enough(pose.stamp)) {
      const navigation::NavigatorState& s = state.navigator;
      const PlanarTwist v = in.velocity.value_or(PlanarTwist{s.last_vx_mps, s.last_vy_mps, s.last_w_radps});
      in.X_MB = driven(at_axle(pose.message.pose.pose), v, (obs.now() - pose.stamp).s());
      in.pose_std_m = position_std(pose.message.pose.covariance);
    }
  }
  const auto scan = obs.get(laser_);
  if (scan.fresh) in.scan = &scan.message;
  in.scan_age_s = scan.valid ? (obs.now() - scan.stamp).s() : 0;
  in.X_BL = X_BL_;
  // A robot that does not see stands.
  if (!scan.valid || !fresh_enough(scan.stamp)) in.X_MB.reset();
  return in;
}

void Navigate::take_goals(const Observation& obs) {
  state.rest_s = std::max(0.0, state.rest_s - period_s_);
  if (const auto cancelled = obs.get(cancel_); cancelled.fresh) {
    navigator_->cancel();
    state.driving = state.listed = false;
  }
  if (const auto goal = obs.get(goal_pose_); goal.fresh) {
    const std::string& frame = goal.message.header.frame_id;
    if (!frame.empty() && frame != frame_) {
      ++state.refused;
      warn(obs.now(), "a goal in the frame '" + frame + "' is refused; " +
                          (frame_.empty() ? "there is no pose yet" : "poses are in '" + frame_ + "'"));
    } else {
      (void)navigator_->set_goal({in_plane(goal.message.pose), norm(goal.message.pose.q) > 0.5});
      state.driving = true;
      state.listed = false;
    }
  }
  const bool waits = state.driving || state.rest_s > 0 || !state.listed;
  if (state.next >= spec.goals.size() && spec.loop) state.next = 0;
  if (waits || state.next >= spec.goals.size()) return;
  const Goal& goal = spec.goals[state.next++];
  (void)navigator_->set_goal({{goal.x_m, goal.y_m, goal.yaw_rad.value_or(0)}, goal.yaw_rad.has_value()});
  state.driving = true;
}

void Navigate::warn(Time now, const std::string& text) {
  if (warned_ && now >= *warned_ && (now - *warned_).s() < 1) return;
  warned_ = now;
  log::warning(status_out_.name + ": " + text);
}

std::string Navigate::why_blind(const Observation& obs, const navigation::NavigatorInput& in) const {
  const std::string recently = " in the last " + number_text(spec.timeout_s) + " s";
  const auto scan = obs.get(laser_);
  if (!scan.valid || (obs.now() - scan.stamp).s() > spec.timeout_s) return "there was no scan" + recently;
  if (!in.X_MB) return "there was no pose" + recently;
  if (in.pose_std_m <= spec.max_pose_std_m) return {};
  return "the pose is uncertain by " + number_text(std::round(in.pose_std_m * 100) / 100) +
         " m, max_pose_std is " + number_text(spec.max_pose_std_m) + " m";
}

void Navigate::step(const Observation& obs, Command& cmd) {
  navigation::NavigatorInput in = input(obs);
  const bool whole = navigator_->restore(std::move(state.navigator));
  SL_CHECK(whole);
  take_goals(obs);
  const navigation::NavigatorStep step = navigator_->step(in);
  if (state.driving && over(step.status)) {
    ++(step.status == NavStatus::reached ? state.reached : state.failed);
    state.driving = false;
    state.rest_s = spec.pause_s;
    state.since_status_s = 1e6;  // published at once, also after another failure
    if (step.status == NavStatus::failed) {
      warn(obs.now(), navigator_->state().reason);
      if (spec.stop_on_failure) state.listed = false;
    }
  }
  // Once for each goal.
  const double time_s = step.feedback.navigation_time_s;
  if (state.driving && time_s >= 5 && time_s - period_s_ < 5)
    if (const std::string why = why_blind(obs, in); !why.empty()) warn(obs.now(), "the robot stands: " + why);
  state.distance_remaining_m = step.feedback.distance_remaining_m;
  msg::Twist twist;
  twist.linear = {step.command.vx_mps, step.command.vy_mps, 0};
  twist.angular.z = step.command.w_radps;
  if (velocity_) cmd.publish(*velocity_, twist);
  else cmd.set(drive_, twist);
  publish(obs, cmd, step, in.X_MB.has_value());
  state.navigator = navigator_->take_state();
}

void Navigate::publish(const Observation& obs, Command& cmd, const navigation::NavigatorStep& step,
                       bool placed) {
  path_out_.header.stamp = obs.now();
  path_out_.header.frame_id = frame_;
  const auto show = [&](Publication<msg::Path> topic, std::size_t count, auto&& pose) {
    path_out_.poses.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      path_out_.poses[i].header = path_out_.header;
      path_out_.poses[i].pose = in_space(pose(i));
    }
    cmd.publish(topic, path_out_);
  };
  // An empty path takes back the one before.
  const auto plan = over(step.status) ? std::span<const navigation::PathPose>() : navigator_->plan();
  const bool first = placed && !state.begun;
  if (step.new_plan || plan.empty() == state.plan_shown || first) {
    show(plan_, plan.size(), [&](std::size_t i) { return plan[i].pose; });
    const auto local = navigator_->local_plan();
    if (plan.empty()) show(local_plan_, local.size(), [&](std::size_t i) { return local[i]; });
    state.plan_shown = !plan.empty();
  }
  if (const auto local = navigator_->local_plan(); !local.empty())
    show(local_plan_, local.size(), [&](std::size_t i) { return local[i]; });

  state.since_costmap_s += period_s_;
  const navigation::CostMap& map = navigator_->local_map();
  const bool due = !over(step.status) && state.since_costmap_s * spec.costmap_rate_hz >= 1;
  if (!map.cost.empty() && (due || (first && spec.costmap_rate_hz > 0))) {
    state.since_costmap_s = 0;
    costmap_out_.header = path_out_.header;
    costmap_out_.info.resolution = static_cast<float>(map.geometry.resolution_m);
    costmap_out_.info.width = static_cast<std::uint32_t>(map.geometry.width);
    costmap_out_.info.height = static_cast<std::uint32_t>(map.geometry.height);
    costmap_out_.info.origin = in_space(map.geometry.origin);
    costmap_out_.data.resize(map.cost.size());
    std::transform(map.cost.begin(), map.cost.end(), costmap_out_.data.begin(), percent_of);
    cmd.publish(costmap_, costmap_out_);
  }
  state.begun |= first;
  state.since_status_s += period_s_;
  if (step.status == state.shown && state.since_status_s * spec.status_rate_hz < 1) return;
  state.since_status_s = 0;
  state.shown = step.status;
  publish_status(cmd, step);
}

void Navigate::publish_status(Command& cmd, const navigation::NavigatorStep& step) {
  const navigation::NavigatorState& s = navigator_->state();
  status_out_.level = step.status == NavStatus::failed ? msg::DiagnosticStatus::error
                      : step.status == NavStatus::recovering || !s.reason.empty()
                          ? msg::DiagnosticStatus::warn
                          : msg::DiagnosticStatus::ok;
  status_out_.message = name_of(step.status);
  if (!s.reason.empty()) status_out_.message.append(": ").append(s.reason);
  const navigation::NavigatorFeedback& f = step.feedback;
  const std::pair<const char*, std::string> values[] = {
      {"status", name_of(step.status)},
      {"distance_remaining", number_text(f.distance_remaining_m)},
      {"estimated_time_remaining", number_text(f.estimated_time_remaining_s)},
      {"navigation_time", number_text(f.navigation_time_s)},
      {"number_of_recoveries", std::to_string(f.number_of_recoveries)},
      {"goal_x", number_text(s.goal_x_m)},
      {"goal_y", number_text(s.goal_y_m)},
      {"goals_reached", std::to_string(state.reached)},
      {"goals_failed", std::to_string(state.failed)},
      {"goals_refused", std::to_string(state.refused)}};
  status_out_.values.resize(std::size(values));
  for (std::size_t i = 0; i < std::size(values); ++i)
    status_out_.values[i] = {values[i].first, values[i].second};
  cmd.publish(status_, status_out_);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Navigate>({
    .name = "navigate",
    .help = "Drives to goals around obstacles, by laser and a map.",
});

}  // namespace sandlot::controllers::navigate
