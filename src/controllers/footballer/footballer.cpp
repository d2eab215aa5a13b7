#include "controllers/footballer/footballer.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::footballer {
namespace {

using steering::flat, steering::heading_of;

constexpr double beside_m = 0.08;  // off the line through ball and goal: from here it drives through the ball
constexpr double offset_gain = 1.5;  // towards the side to which the ball rolls
constexpr double ball_clearance_m = 0.24, robot_clearance_m = 0.3;
constexpr double wall_m = 0.15;  // of a wall: no place for a robot
constexpr double there_m = 0.1;

Vec3 point(const std::array<double, 2>& xy) { return {xy[0], xy[1], 0}; }

}  // namespace

Status Footballer::init(const Description& robot) {
  name = robot.robot;
  SL_ASSIGN(camera, robot.reading<msg::ObjectPoseArray>(spec.camera));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  if (!spec.kicker.empty()) { SL_ASSIGN(kicker, robot.actuator<msg::Float64>(spec.kicker)); }
  return {};
}

bool Footballer::nearest(const msg::ObjectPoseArray& world, const msg::ObjectPose& self, Vec3 place) const {
  const double own = norm(flat(self.pose.p) - place);
  return std::none_of(world.objects.begin(), world.objects.end(), [&](const msg::ObjectPose& other) {
    if (other.label != self.label || other.name == name) return false;
    const double distance = norm(flat(other.pose.p) - place);
    return distance < own || (distance == own && other.name < name);
  });
}

Vec3 Footballer::way(const msg::ObjectPoseArray& world, const Pose& X_WB, Vec3 to) {
  discs.clear();
  for (const msg::ObjectPose& other : world.objects)
    if (other.name != name)
      discs.push_back({other.pose.p, other.label == spec.ball ? ball_clearance_m : robot_clearance_m});
  return steering::way_around(X_WB.p, to, discs);
}

msg::Twist Footballer::attack(const msg::ObjectPoseArray& world, const Pose& X_WB, Vec3 ball, Vec3 behind,
                              Command& cmd) {
  const Vec3 here = flat(X_WB.p), goal = point(spec.goal_m);
  const Vec3 along = normalised(goal - ball), off = ball - here;
  const Vec3 at = rotate_inverse(X_WB.q, off);
  const double goal_rad = math::wrap_angle(heading_of(goal - here) - yaw_of(X_WB.q));
  const bool in_front = at.x > 0 && at.x < spec.kick_reach_m && std::abs(at.y) < beside_m;
  if (in_front && std::abs(goal_rad) < spec.kick_angle_rad && !spec.kicker.empty()) {
    cmd.set(kicker, msg::Float64{spec.impulse_Ns});
    ++state.kicks;
  }
  const bool blocked = std::abs(behind.x) > 0.5 * spec.field_m[0] - wall_m ||
                       std::abs(behind.y) > 0.5 * spec.field_m[1] - wall_m;
  if (blocked) return steering::drive_along(X_WB, heading_of(off), limits());
  const bool lined_up = dot(off, along) > 0 && std::abs(cross(along, off).z) < beside_m;
  if (!lined_up) return steering::drive_to(X_WB, way(world, X_WB, behind), limits());
  const double bearing = math::atan2(at.y, at.x);
  return steering::drive_along(X_WB, heading_of(goal - here) + offset_gain * bearing, limits());
}

msg::Twist Footballer::cover(const msg::ObjectPoseArray& world, const Pose& X_WB, Vec3 ball) {
  const Vec3 own = point(spec.own_goal_m);
  const Vec3 place = own + spec.cover * (ball - own);
  if (norm(place - flat(X_WB.p)) < there_m)
    return steering::turn_to(X_WB, heading_of(ball - flat(X_WB.p)), limits());
  return steering::drive_to(X_WB, way(world, X_WB, place), limits());
}

void Footballer::step(const Observation& obs, Command& cmd) {
  const auto seen = obs.get(camera);
  const msg::ObjectPose* const self = seen.valid ? steering::find(seen.message, name) : nullptr;
  const auto& objects = seen.message.objects;
  const auto ball = std::find_if(objects.begin(), objects.end(),
                                 [&](const msg::ObjectPose& each) { return each.label == spec.ball; });
  if (!self || ball == objects.end()) return cmd.set(drive, msg::Twist());
  const Vec3 at = flat(ball->pose.p);
  const Vec3 behind = at - spec.behind_m * normalised(point(spec.goal_m) - at);
  state.attacks = nearest(seen.message, *self, behind);
  cmd.set(drive, state.attacks ? attack(seen.message, self->pose, at, behind, cmd)
                               : cover(seen.message, self->pose, at));
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Footballer>({
    .name = "footballer",
    .help = "Plays football in a team: the nearest to the ball attacks, the others cover their goal.",
});

}  // namespace sandlot::controllers::footballer
