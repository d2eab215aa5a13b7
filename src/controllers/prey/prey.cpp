#include "controllers/prey/prey.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::prey {
namespace {

using steering::flat, steering::heading_of;

constexpr double wall_m = 0.3;  // of a wall: nearer than this it is followed
constexpr int directions = 24, points = 4;
constexpr double wall_weight = 0.3;
constexpr double nearest_m2 = 1e-4;

}  // namespace

Status Prey::init(const Description& robot) {
  name = robot.robot;
  SL_ASSIGN(camera, robot.reading<msg::ObjectPoseArray>(spec.camera));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  return {};
}

double Prey::along_walls(Vec3 at, double heading_rad) const {
  Vec3 way = steering::towards(heading_rad);
  bool at_wall = false;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (spec.yard_m[axis] <= 0) continue;
    const double limit = 0.5 * spec.yard_m[axis] - wall_m;
    if (std::abs(at[axis]) < limit || at[axis] * way[axis] <= 0) continue;
    way[axis] = 0;
    at_wall = true;
  }
  if (!at_wall) return heading_rad;
  // Straight against a wall, or in a corner: along the side with more room.
  if (norm(way) < 0.05) {
    const bool along_y = std::abs(at.x) * spec.yard_m[1] > std::abs(at.y) * spec.yard_m[0];
    way = along_y ? Vec3{0, at.y > 0 ? -1.0 : 1.0, 0} : Vec3{at.x > 0 ? -1.0 : 1.0, 0, 0};
  }
  return heading_of(way);
}

double Prey::danger(const msg::ObjectPoseArray& world, Vec3 at, double heading_rad) const {
  const Vec3 step = (spec.speed_mps * spec.horizon_s / points) * steering::towards(heading_rad);
  double sum = 0;
  for (int k = 1; k <= points; ++k) {
    const Vec3 there = at + k * step;
    for (const msg::ObjectPose& other : world.objects) {
      if (other.label != spec.predators) continue;
      const Vec3 off = flat(other.pose.p) - there;
      sum += 1 / std::max(dot(off, off), nearest_m2);
    }
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (spec.yard_m[axis] <= 0) continue;
      for (const double side : {1.0, -1.0}) {
        const double room = std::max(0.5 * spec.yard_m[axis] - side * there[axis], 0.0);
        sum += wall_weight / std::max(room * room, nearest_m2);
      }
    }
  }
  return sum;
}

void Prey::step(const Observation& obs, Command& cmd) {
  const auto seen = obs.get(camera);
  const msg::ObjectPose* const self = seen.valid ? steering::find(seen.message, name) : nullptr;
  if (!self) return cmd.set(drive, msg::Twist());
  const Vec3 here = flat(self->pose.p);
  const msg::ObjectPose* nearest = nullptr;
  for (const msg::ObjectPose& each : seen.message.objects)
    if (each.label == spec.predators &&
        (!nearest || norm(flat(each.pose.p) - here) < norm(flat(nearest->pose.p) - here)))
      nearest = &each;
  if (!nearest || norm(flat(nearest->pose.p) - here) > spec.alarm_m) return cmd.set(drive, msg::Twist());
  double heading = heading_of(here - flat(nearest->pose.p));
  switch (spec.strategy) {
    case Strategy::flee: heading = along_walls(here, heading); break;
    case Strategy::zigzag: {
      const double phase = obs.now().s() / spec.period_s;
      heading = along_walls(here,
                            heading + (phase - std::floor(phase) < 0.5 ? spec.swerve_rad : -spec.swerve_rad));
      break;
    }
    case Strategy::hide: {
      double least = 0;
      for (int i = 0; i < directions; ++i) {
        const double tried = math::tau * i / directions;
        const double danger = this->danger(seen.message, here, tried);
        if (i == 0 || danger < least) least = danger, heading = tried;
      }
      break;
    }
  }
  cmd.set(drive, steering::drive_along(self->pose, heading, {spec.speed_mps, spec.turn_speed_radps}));
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Prey>({
    .name = "prey",
    .help = "Keeps away from predators: straight away, swerving, or to where there is least danger.",
});

}  // namespace sandlot::controllers::prey
