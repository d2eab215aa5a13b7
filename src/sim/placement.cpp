#include "sim/placement.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/random.h"

namespace sandlot {

Placer::Placer(const std::vector<model::Instance>& world, std::uint64_t seed) : seed_(seed) {
  for (const model::Instance& instance : world)
    for (const model::Link& link : instance.model->links)
      for (const model::Collision& collision : link.collisions) {
        Obstacle obstacle{instance.X_WM * link.X_ML * collision.X_LC, {}, true};
        // On planes and terrain one stands.
        if (std::holds_alternative<Plane>(collision.shape) ||
            std::holds_alternative<Heightfield>(collision.shape))
          continue;
        if (const auto* box = std::get_if<Box>(&collision.shape)) {
          obstacle.half_m = 0.5 * box->size_m;
          obstacle.round = false;
        } else if (const auto* cylinder = std::get_if<Cylinder>(&collision.shape)) {
          obstacle.half_m = {cylinder->radius_m, cylinder->radius_m, 0};
        } else {
          const double r = bounding_radius_m(collision.shape);
          obstacle.half_m = {r, r, r};
        }
        obstacles_.push_back(obstacle);
      }
}

bool Placer::free(Vec3 point, double clearance_m) const {
  for (const Vec3& other : placed_)
    if (math::hypot(other.x - point.x, other.y - point.y) < clearance_m) return false;
  for (const Obstacle& obstacle : obstacles_) {
    // Seen from above: the point at the obstacle's own height, in its frame.
    const Vec3 local = inverse(obstacle.X_WC) * Vec3{point.x, point.y, obstacle.X_WC.p.z};
    double distance = 0;
    if (obstacle.round) {
      distance = std::sqrt(local.x * local.x + local.y * local.y) - obstacle.half_m.x;
    } else {
      const double dx = std::max(0.0, std::abs(local.x) - obstacle.half_m.x);
      const double dy = std::max(0.0, std::abs(local.y) - obstacle.half_m.y);
      distance = std::sqrt(dx * dx + dy * dy);
    }
    if (distance < clearance_m) return false;
  }
  return true;
}

Result<std::vector<Pose>> Placer::place(const formats::RobotGroup& group) {
  std::vector<Pose> poses;
  const formats::Placement& placement = group.placement;
  const auto at = [](double x, double y, double z, double yaw) {
    return Pose{{x, y, z}, quat_from_rpy(0, 0, yaw)};
  };
  switch (placement.kind) {
    case formats::Placement::Kind::pose:
      if (group.count > 1)
        return Error{
            "a pose is for one robot, and '" + group.name + "' has count " + std::to_string(group.count),
            "use distribution: {grid: ...} or {uniform: ...}",
            placement.place.file ? placement.place : group.place};
      poses.push_back(placement.X_WM);
      break;
    case formats::Placement::Kind::grid: {
      const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(group.count))));
      const int rows = (group.count + columns - 1) / columns;
      for (int i = 0; i < group.count; ++i) {
        const double x = (i % columns - 0.5 * (columns - 1)) * placement.spacing_m;
        const double y = (i / columns - 0.5 * (rows - 1)) * placement.spacing_m;
        poses.push_back(at(placement.centre_m.x + x, placement.centre_m.y + y, placement.centre_m.z, 0));
      }
      break;
    }
    case formats::Placement::Kind::uniform:
      for (int i = 0; i < group.count; ++i) {
        Stream random(seed_, entity_key(group.name), Purpose::placement, static_cast<std::uint64_t>(i));
        constexpr int tries = 2000;
        int left = tries;
        Vec3 point;
        do {
          const double x = random.uniform(-0.5, 0.5) * placement.width_m;
          const double y = random.uniform(-0.5, 0.5) * placement.height_m;
          point = placement.centre_m + Vec3{x, y, 0};
        } while (--left > 0 && !free(point, placement.clearance_m));
        if (left == 0)
          return Error{"no room for robot " + std::to_string(i + 1) + " of '" + group.name + "' after " +
                           std::to_string(tries) + " tries",
                       "make the area larger, or count or clearance smaller",
                       placement.place.file ? placement.place : group.place};
        poses.push_back(at(point.x, point.y, point.z, random.uniform(-math::pi, math::pi)));
        placed_.push_back(point);
      }
      return poses;
  }
  for (const Pose& pose : poses) placed_.push_back(pose.p);
  return poses;
}

}  // namespace sandlot
