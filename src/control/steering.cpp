#include "control/steering.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::steering {
namespace {

constexpr double turn_first_rad = math::pi / 3;
constexpr double turn_gain = 3;
/// Discs that a way is led around, one after the other.
constexpr int most_discs = 4;

}  // namespace

double heading_of(Vec3 v) { return math::atan2(v.y, v.x); }

Vec3 towards(double heading_rad) {
  const auto [s, c] = math::sincos(heading_rad);
  return {c, s, 0};
}

const msg::ObjectPose* find(const msg::ObjectPoseArray& world, std::string_view name) {
  for (const msg::ObjectPose& object : world.objects)
    if (object.name == name) return &object;
  return nullptr;
}

msg::Twist turn_to(const Pose& X_WB, double heading_rad, const Limits& limits) {
  const double error = math::wrap_angle(heading_rad - yaw_of(X_WB.q));
  msg::Twist twist;
  twist.angular.z = std::clamp(turn_gain * error, -limits.turn_speed_radps, limits.turn_speed_radps);
  return twist;
}

msg::Twist drive_along(const Pose& X_WB, double heading_rad, const Limits& limits) {
  msg::Twist twist = turn_to(X_WB, heading_rad, limits);
  twist.linear.x = limits.speed_mps * std::max(0.0, math::cos(heading_rad - yaw_of(X_WB.q)));
  return twist;
}

msg::Twist drive_to(const Pose& X_WB, Vec3 point, const Limits& limits, double slow_m) {
  const Vec3 way = flat(point - X_WB.p);
  const double distance = norm(way);
  if (distance < 1e-6) return {};
  const double heading = heading_of(way);
  if (std::abs(math::wrap_angle(heading - yaw_of(X_WB.q))) > turn_first_rad)
    return turn_to(X_WB, heading, limits);
  Limits slower = limits;
  slower.speed_mps *= std::clamp(distance / slow_m, 0.2, 1.0);
  return drive_along(X_WB, heading, slower);
}

Vec3 way_around(Vec3 from, Vec3 to, std::span<const Disc> discs) {
  from = flat(from), to = flat(to);
  Vec3 aim = to;
  const Disc* passed = nullptr;
  for (int k = 0; k < most_discs; ++k) {
    const Vec3 way = aim - from;
    const double length = norm(way);
    if (length < 1e-6) return aim;
    const Vec3 along = way / length;
    const Disc* nearest = nullptr;
    double nearest_m = 0, nearest_radius_m = 0;
    for (const Disc& disc : discs) {
      const Vec3 centre = flat(disc.centre);
      if (&disc == passed || norm(centre - to) < disc.radius_m) continue;
      const Vec3 off = centre - from;
      const double apart = norm(off);
      const double radius = std::min(disc.radius_m, 0.95 * apart);
      const double ahead = dot(off, along);
      if (ahead <= 0 || ahead - radius > length || std::abs(cross(along, off).z) >= radius) continue;
      if (nearest && ahead >= nearest_m) continue;
      nearest = &disc, nearest_m = ahead, nearest_radius_m = radius;
    }
    if (!nearest) return aim;
    // The tangent on the side where `to` lies: to the left of the centre when it lies to the left of the line there.
    const Vec3 off = flat(nearest->centre) - from;
    const double apart = norm(off);
    const double side = cross(off, to - from).z >= 0 ? 1.0 : -1.0;
    const double turn = side * math::asin(nearest_radius_m / apart);
    const double tangent = std::max(
        std::sqrt(std::max(0.0, apart * apart - nearest_radius_m * nearest_radius_m)), 0.1);
    aim = from + tangent * towards(heading_of(off) + turn);
    passed = nearest;
  }
  return aim;
}

}  // namespace sandlot::steering
