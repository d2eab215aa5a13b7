#include "controllers/predator/predator.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::predator {
namespace {

using steering::flat, steering::heading_of;

/// Share of the latest picture in the estimated velocity.
constexpr double freshness = 0.3;
/// Slack of the circle: beyond it a predator is not on it yet.
constexpr double on_circle = 1.3;
constexpr double on_place_rad = 0.6;

}  // namespace

Status Predator::init(const Description& robot) {
  name = robot.robot;
  SL_ASSIGN(camera, robot.reading<msg::ObjectPoseArray>(spec.camera));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  return {};
}

void Predator::follow(const msg::ObjectPose& prey, Time stamp) {
  const Vec3 at = flat(prey.pose.p);
  const double dt = (stamp - state.seen_at).s();
  if (prey.name != state.prey) {
    state.prey = prey.name;
    state.velocity = {};
  } else if (dt > 0) {
    state.velocity = (1 - freshness) * state.velocity + (freshness / dt) * (at - state.seen);
  }
  state.seen = at;
  state.seen_at = stamp;
}

Vec3 Predator::meeting_point(Vec3 from, Vec3 at, Vec3 velocity) const {
  // |off + v t| = s t: (s^2 - v^2) t^2 - 2 off.v t - off^2 = 0.
  const Vec3 off = at - from;
  const double a = spec.speed_mps * spec.speed_mps - dot(velocity, velocity), b = dot(off, velocity),
               c = dot(off, off);
  const double under = b * b + a * c;
  double t = spec.horizon_s;
  if (under >= 0 && std::abs(a) > 1e-9) {
    const double root = std::sqrt(under);
    // For a < 0 both roots may be positive: the earlier one counts.
    const double first = (b - root) / a, second = (b + root) / a;
    const double early = std::min(first, second), late = std::max(first, second);
    if (early > 0) t = early;
    else if (late > 0) t = late;
  } else if (std::abs(a) <= 1e-9 && b < 0) {
    t = -c / (2 * b);
  }
  return at + std::min(t, spec.horizon_s) * velocity;
}

Vec3 Predator::place_around(const msg::ObjectPoseArray& world, const msg::ObjectPose& self, Vec3 prey) {
  hunters.clear();
  for (const msg::ObjectPose& other : world.objects) {
    if (other.label != self.label) continue;
    const Vec3 off = flat(other.pose.p) - prey;
    hunters.push_back({heading_of(off), norm(off), other.name == name});
  }
  std::stable_sort(hunters.begin(), hunters.end(),
                   [](const Hunter& a, const Hunter& b) { return a.angle_rad < b.angle_rad; });
  const auto n = static_cast<double>(hunters.size());
  // Even directions, turned so that all together have the shortest way: the mean of what each is ahead of its own.
  double sin_sum = 0, cos_sum = 0;
  for (std::size_t i = 0; i < hunters.size(); ++i) {
    const auto [s, c] = math::sincos(hunters[i].angle_rad - math::tau * static_cast<double>(i) / n);
    sin_sum += s, cos_sum += c;
  }
  const double turn = math::atan2(sin_sum, cos_sum);
  double place = 0;
  bool closed = true;
  for (std::size_t i = 0; i < hunters.size(); ++i) {
    const double wanted = turn + math::tau * static_cast<double>(i) / n;
    closed = closed && hunters[i].distance_m < on_circle * spec.circle_m &&
             std::abs(math::wrap_angle(hunters[i].angle_rad - wanted)) < on_place_rad;
    if (hunters[i].self) place = wanted;
  }
  if (closed) return prey;
  return prey + spec.circle_m * steering::towards(place);
}

void Predator::step(const Observation& obs, Command& cmd) {
  const auto seen = obs.get(camera);
  const msg::ObjectPose* const self = seen.valid ? steering::find(seen.message, name) : nullptr;
  const msg::ObjectPose* prey = nullptr;
  if (self)
    for (const msg::ObjectPose& each : seen.message.objects)
      if (each.label == spec.prey &&
          (!prey || norm(flat(each.pose.p - self->pose.p)) < norm(flat(prey->pose.p - self->pose.p))))
        prey = &each;
  if (!prey) return cmd.set(drive, msg::Twist());
  if (seen.fresh) follow(*prey, seen.stamp);
  const Vec3 here = flat(self->pose.p), there = flat(prey->pose.p);
  Vec3 aim = there;
  switch (spec.strategy) {
    case Strategy::pursuit: break;
    case Strategy::lead: aim = meeting_point(here, there, state.velocity); break;
    case Strategy::encircle: aim = place_around(seen.message, *self, there); break;
  }
  cmd.set(drive,
          steering::drive_along(self->pose, heading_of(aim - here), {spec.speed_mps, spec.turn_speed_radps}));
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Predator>({
    .name = "predator",
    .help = "Hunts the nearest prey: straight at it, at where it will be, or from all sides.",
});

}  // namespace sandlot::controllers::predator
