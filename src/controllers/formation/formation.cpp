#include "controllers/formation/formation.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::formation {
namespace {

constexpr double turn_first_rad = math::pi / 3;
constexpr double turned_rad = 0.02;

}  // namespace

Status Formation::init(const Description& team, Outputs& out) {
  if (team.members.empty() && !(team.readings.empty() && team.actuators.empty()))
    return Error{"'" + team.robot + "' is a robot, and a formation drives a team",
                 "write it as the controller of a team: teams: [{name: red, controller: formation}]"};
  members.clear();
  for (const Description& robot : team.members) {
    Member& member = members.emplace_back();
    SL_ASSIGN(member.odometry, robot.reading<msg::Odometry>(spec.odometry));
    SL_ASSIGN(member.drive, robot.actuator<msg::Twist>(spec.drive));
  }
  arrived = out.publish<msg::UInt32>("arrived");
  return {};
}

std::array<double, 2> Formation::place(std::size_t i, std::size_t n) const {
  const double k = 0.5 * static_cast<double>(n - 1) - static_cast<double>(i);
  const auto [s, c] = math::sincos(spec.heading_rad);
  const auto [x, y] = spec.centre_m;
  const double along = k * spec.spacing_m;
  switch (spec.shape) {
    case Shape::line: return {x - s * along, y + c * along};
    case Shape::column: return {x + c * along, y + s * along};
    case Shape::circle: break;
  }
  if (n < 2) return {x, y};
  const double step = 2 * math::pi / static_cast<double>(n);
  const double radius = spec.spacing_m / (2 * math::sin(0.5 * step));
  const auto at = math::sincos(spec.heading_rad + step * static_cast<double>(i));
  return {x + radius * at.cos, y + radius * at.sin};
}

msg::Twist Formation::order(const Pose& X_WB, std::array<double, 2> place_m, bool& there) const {
  msg::Twist twist;
  const Vec3 to = rotate_inverse(X_WB.q, Vec3{place_m[0] - X_WB.p.x, place_m[1] - X_WB.p.y, 0});
  const double distance = std::sqrt(to.x * to.x + to.y * to.y);
  const auto turn_by = [&](double angle) {
    twist.angular.z = std::clamp(2 * angle, -spec.turn_speed_radps, spec.turn_speed_radps);
  };
  there = false;
  if (distance <= spec.tolerance_m) {
    const double off = math::wrap_angle(spec.heading_rad - yaw_of(X_WB.q));
    there = std::abs(off) <= turned_rad;
    if (!there) turn_by(off);
    return twist;
  }
  const double bearing = math::atan2(to.y, to.x);
  if (std::abs(bearing) > turn_first_rad) return turn_by(bearing), twist;
  const double curvature = 2 * (to.y / distance) / distance;
  double speed = std::min(spec.speed_mps, std::sqrt(2 * spec.deceleration_mps2 * distance));
  if (std::abs(curvature) * speed > spec.turn_speed_radps)
    speed = spec.turn_speed_radps / std::abs(curvature);
  twist.linear.x = speed;
  twist.angular.z = curvature * speed;
  return twist;
}

void Formation::step(const Observation& obs, Command& cmd) {
  msg::UInt32 count;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const auto seen = obs.get(members[i].odometry);
    bool there = false;
    cmd.set(members[i].drive,
            seen.valid ? order(seen.message.pose.pose, place(i, members.size()), there) : msg::Twist());
    count.data += there;
  }
  cmd.publish(arrived, count);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Formation>({
    .name = "formation",
    .help = "Drives the robots of a team to places in a formation.",
});

}  // namespace sandlot::controllers::formation
