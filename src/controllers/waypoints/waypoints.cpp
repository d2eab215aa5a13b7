#include "controllers/waypoints/waypoints.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::waypoints {
namespace {

constexpr double turn_first_rad = math::pi / 3;
constexpr double turned_rad = math::pi / 18;

}  // namespace

Status Waypoints::init(const Description& robot, Outputs& out) {
  if (spec.points_m.empty()) return Error{"there are no points", "give at least one [x, y]", {}, "/points"};
  SL_ASSIGN(odometry, robot.reading<msg::Odometry>(spec.odometry));
  if (spec.publish.empty()) {
    SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  } else if (spec.drive.empty()) {
    shown = out.publish<msg::Twist>(spec.publish);
  } else {
    return Error{"both a drive and a topic are given", "leave one of them out", {}, "/publish"};
  }
  if (!spec.plan.empty()) way = out.publish<msg::Path>(spec.plan);
  return {};
}

void Waypoints::step(const Observation& obs, Command& cmd) {
  const msg::Twist twist = velocity(obs);
  if (shown) cmd.publish(*shown, twist);
  else cmd.set(drive, twist);
  if (way) show_way(obs, cmd);
}

/// What was published is compared with what would be: so a restored run, and one whose `loop` was set, need no note of it.
void Waypoints::show_way(const Observation& obs, Command& cmd) const {
  const auto seen = obs.get(odometry);
  if (!seen.valid) return;
  const std::string& frame = seen.message.header.frame_id;
  const std::size_t count = spec.points_m.size(), length = count + (spec.loop && count > 1 ? 1 : 0);
  const auto point = [&](std::size_t i) -> const std::array<double, 2>& { return spec.points_m[i % count]; };
  const msg::Path* const last = cmd.published(*way);
  bool same = last && last->poses.size() == length && last->header.frame_id == frame;
  for (std::size_t i = 0; same && i < length; ++i) {
    const Vec3& p = last->poses[i].pose.p;
    same = p.x == point(i)[0] && p.y == point(i)[1];
  }
  if (same) return;
  msg::Path path;
  path.header = {obs.now(), frame};
  for (std::size_t i = 0; i < length; ++i) {
    msg::PoseStamped& made = path.poses.emplace_back();
    made.header = path.header;
    made.pose.p = {point(i)[0], point(i)[1], 0};
    // The last one looks where the one before does.
    const std::size_t from = i + 1 < length || i == 0 ? i : i - 1, to = std::min(from + 1, length - 1);
    if (to != from)
      made.pose.q = quat_from_axis_angle(
          {0, 0, 1}, math::atan2(point(to)[1] - point(from)[1], point(to)[0] - point(from)[0]));
  }
  cmd.publish(*way, path);
}

msg::Twist Waypoints::velocity(const Observation& obs) {
  const auto seen = obs.get(odometry);
  msg::Twist twist;
  if (!seen.valid) return twist;
  const Pose& X_OB = seen.message.pose.pose;
  const auto count = static_cast<std::uint32_t>(spec.points_m.size());
  const auto aim = [&] {
    const auto& point = spec.points_m[state.next];
    return rotate_inverse(X_OB.q, Vec3{point[0] - X_OB.p.x, point[1] - X_OB.p.y, 0});
  };

  // Points that are near already are passed by, but no more than one round of them: a loop may lie within tolerance.
  for (std::uint32_t passed = 0; passed < count && state.next < count; ++passed) {
    const Vec3 to = aim();
    if (std::sqrt(to.x * to.x + to.y * to.y) > spec.tolerance_m) break;
    state.turning = 0;
    if (++state.next == count) {
      ++state.rounds;
      if (spec.loop) state.next = 0;
    }
  }
  if (state.next >= count) {
    if (!spec.loop) return twist;
    state.next = 0;  // `loop` was switched on after the last point
  }

  const Vec3 to = aim();
  const double distance = std::sqrt(to.x * to.x + to.y * to.y);
  if (distance <= spec.tolerance_m) return twist;
  const double bearing = math::atan2(to.y, to.x);
  state.turning = std::abs(bearing) > (state.turning ? turned_rad : turn_first_rad) ? 1 : 0;
  if (state.turning) {
    twist.angular.z = std::clamp(2.0 * bearing, -spec.turn_speed_radps, spec.turn_speed_radps);
    return twist;
  }
  const double curvature = 2 * (to.y / distance) / distance;
  double speed = spec.speed_mps;
  if (std::abs(curvature) * speed > spec.turn_speed_radps)
    speed = spec.turn_speed_radps / std::abs(curvature);
  if (!spec.loop && state.next + 1 == count)
    speed = std::min(speed, std::sqrt(2 * spec.deceleration_mps2 * distance));
  twist.linear.x = speed;
  twist.angular.z = curvature * speed;
  return twist;
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Waypoints>({
    .name = "waypoints",
    .help = "Drives through a list of points.",
});

}  // namespace sandlot::controllers::waypoints
