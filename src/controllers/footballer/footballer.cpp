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
constexpr double own_goal_side = 0.5;  // cosine of the angle to the own goal within which it never kicks
/// Places of the aims across the mouth of the goal, as parts of its half width, in the order in which equals are chosen.
constexpr double aims[] = {0, 0.35, -0.35, 0.7, -0.7};

Vec3 point(const std::array<double, 2>& xy) { return {xy[0], xy[1], 0}; }

}  // namespace

Status Footballer::init(const Description& robot) {
  name = robot.robot;
  SL_ASSIGN(camera, robot.reading<msg::ObjectPoseArray>(spec.camera));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  if (spec.kicker.empty()) return {};
  SL_ASSIGN(kicker, robot.actuator<msg::Float64>(spec.kicker));
  SL_ASSIGN(kicker_state, robot.reading<msg::KickerState>(spec.kicker));
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

Vec3 Footballer::mouth() const {
  const Vec3 to = normalised(point(spec.goal_m) - point(spec.own_goal_m), {1, 0, 0});
  return {-to.y, to.x, 0};
}

Vec3 Footballer::aim(const msg::ObjectPoseArray& world, const msg::ObjectPose& self, Vec3 ball) const {
  const Vec3 middle = point(spec.goal_m), along_mouth = mouth();
  Vec3 best = middle;
  double most_room = -1;
  for (const double part : aims) {
    const Vec3 place = middle + along_mouth * (0.5 * spec.goal_width_m * part);
    const Vec3 way = place - ball, ahead = normalised(way);
    double room = robot_clearance_m;
    for (const msg::ObjectPose& other : world.objects) {
      if (other.label == self.label || other.label == spec.ball) continue;
      const Vec3 off = flat(other.pose.p) - ball;
      const double along = dot(off, ahead);
      if (along > 0 && along < norm(way)) room = std::min(room, std::abs(cross(ahead, off).z));
    }
    if (room > most_room) most_room = room, best = place;
  }
  return best;
}

bool Footballer::scores(Vec3 ball, double heading_rad) const {
  const Vec3 along_mouth = mouth(), to_goal = {along_mouth.y, -along_mouth.x, 0};
  const Vec3 off = point(spec.goal_m) - ball, heading = steering::towards(heading_rad);
  const double speed = dot(heading, to_goal), depth = dot(off, to_goal);
  if (speed <= 0 || depth <= 0) return false;
  const double beside = depth / speed * dot(heading, along_mouth) - dot(off, along_mouth);
  return std::abs(beside) <= 0.5 * spec.goal_width_m;
}

bool Footballer::blocked(Vec3 place) const {
  return std::abs(place.x) > 0.5 * spec.field_m[0] - wall_m ||
         std::abs(place.y) > 0.5 * spec.field_m[1] - wall_m;
}

bool Footballer::kicks(const Observation& obs, const Pose& X_WB, Vec3 ball, Vec3 behind) const {
  if (spec.kicker.empty()) return false;
  const auto store = obs.get(kicker_state);
  if (!store.valid || !store.message.ready) return false;
  const Vec3 at = rotate_inverse(X_WB.q, ball - flat(X_WB.p));
  const bool in_front = at.x > 0 && at.x < spec.kick_reach_m && std::abs(at.y) < beside_m;
  if (!in_front) return false;
  const double heading = yaw_of(X_WB.q);
  if (!blocked(behind)) return scores(ball, heading);
  const Vec3 home = normalised(point(spec.own_goal_m) - ball);
  return dot(steering::towards(heading), home) < own_goal_side;
}

msg::Twist Footballer::attack(const msg::ObjectPoseArray& world, const Pose& X_WB, Vec3 ball, Vec3 target,
                              Vec3 behind) {
  const Vec3 here = flat(X_WB.p);
  const Vec3 along = normalised(target - ball), off = ball - here;
  if (blocked(behind)) return steering::drive_along(X_WB, heading_of(off), limits());
  const bool lined_up = dot(off, along) > 0 && std::abs(cross(along, off).z) < beside_m;
  if (!lined_up) return steering::drive_to(X_WB, way(world, X_WB, behind), limits());
  const Vec3 at = rotate_inverse(X_WB.q, off);
  const double bearing = math::atan2(at.y, at.x);
  return steering::drive_along(X_WB, heading_of(target - here) + offset_gain * bearing, limits());
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
  const Vec3 target = aim(seen.message, *self, at);
  const Vec3 behind = at - spec.behind_m * normalised(target - at);
  state.attacks = nearest(seen.message, *self, behind);
  cmd.set(drive, state.attacks ? attack(seen.message, self->pose, at, target, behind)
                               : cover(seen.message, self->pose, at));
  if (!state.attacks || !kicks(obs, self->pose, at, behind)) return;
  cmd.set(kicker, msg::Float64{spec.impulse_Ns});
  ++state.kicks;
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Footballer>({
    .name = "footballer",
    .help = "Plays football in a team: the nearest to the ball attacks, the others cover their goal.",
});

}  // namespace sandlot::controllers::footballer
