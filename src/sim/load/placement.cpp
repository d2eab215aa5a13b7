#include "sim/load/placement.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/hash.h"
#include "base/math.h"
#include "base/random.h"
#include "base/text.h"

namespace sandlot {

Placer::Placer(const std::vector<model::Instance>& world, std::uint64_t seed) : seed_(seed) {
  for (const model::Instance& instance : world) add(instance);
}

void Placer::add(const model::Instance& instance) {
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

/// Origins by square cells as wide as the clearance: whoever is too near lies in the cell or one beside it.
struct Placer::Cells {
  double size_m;
  std::unordered_map<std::uint64_t, std::vector<Vec3>> cells;

  std::int64_t cell(double x) const { return static_cast<std::int64_t>(std::floor(x / size_m)); }
  static std::uint64_t key(std::int64_t i, std::int64_t j) {
    return hash_combine(static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j));
  }
  void add(Vec3 p) { cells[key(cell(p.x), cell(p.y))].push_back(p); }
  bool any_nearer(Vec3 p, double clearance_m) const {
    for (std::int64_t j = cell(p.y) - 1; j <= cell(p.y) + 1; ++j)
      for (std::int64_t i = cell(p.x) - 1; i <= cell(p.x) + 1; ++i) {
        const auto found = cells.find(key(i, j));
        if (found == cells.end()) continue;
        for (const Vec3& other : found->second)
          if (math::hypot(other.x - p.x, other.y - p.y) < clearance_m) return true;
      }
    return false;
  }
};

bool Placer::free(const Cells& near, Vec3 point, double clearance_m) const {
  if (near.any_nearer(point, clearance_m)) return false;
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
  if (group.count == 0) return poses;
  switch (placement.kind) {
    case formats::Placement::Kind::pose:
      if (group.count > 1)
        return Error{
            "a pose is for one robot, and '" + group.name + "' has count " + std::to_string(group.count),
            "use distribution: {grid: ...} or {uniform: ...}",
            placement.place.file ? placement.place : group.instance.place};
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
    case formats::Placement::Kind::uniform: {
      Cells near{std::max(placement.clearance_m, 1e-3), {}};
      for (const Vec3& other : placed_) near.add(other);
      for (int i = 0; i < group.count; ++i) {
        Stream random(seed_, entity_key(group.name), Purpose::placement, static_cast<std::uint64_t>(i));
        constexpr int tries = 2000;
        int left = tries;
        Vec3 point;
        do {
          const double x = random.uniform(-0.5, 0.5) * placement.width_m;
          const double y = random.uniform(-0.5, 0.5) * placement.height_m;
          point = placement.centre_m + Vec3{x, y, 0};
        } while (--left > 0 && !free(near, point, placement.clearance_m));
        if (left == 0)
          return Error{"no room for robot " + std::to_string(i + 1) + " of '" + group.name + "' after " +
                           std::to_string(tries) + " tries",
                       "make the area larger, or count or clearance smaller",
                       placement.place.file ? placement.place : group.instance.place};
        poses.push_back(at(point.x, point.y, point.z, random.uniform(-math::pi, math::pi)));
        placed_.push_back(point);
        near.add(point);
      }
      return poses;
    }
  }
  for (const Pose& pose : poses) placed_.push_back(pose.p);
  return poses;
}

std::optional<model::Instance> walls_of(const formats::RobotGroup& group) {
  const formats::Placement& placement = group.placement;
  if (placement.kind != formats::Placement::Kind::uniform || placement.wall_height_m <= 0) return {};
  constexpr double thickness_m = 0.1;
  auto walls = std::make_shared<model::Model>();
  walls->name = group.name + "_walls";
  walls->is_static = true;
  walls->place = placement.place;
  model::Link link;
  link.name = "link";
  const double z = 0.5 * placement.wall_height_m;
  const double x = 0.5 * (placement.width_m + thickness_m), y = 0.5 * (placement.height_m + thickness_m);
  const auto wall = [&](const char* name, Vec3 at, double dx, double dy) {
    const Box box{{dx, dy, placement.wall_height_m}};
    link.collisions.push_back({name, {at, {}}, box, {}, placement.place});
    model::Visual visual{name, {at, {}}, box, {}, true, placement.place};
    visual.material.diffuse = {0.55f, 0.55f, 0.58f, 1};
    link.visuals.push_back(std::move(visual));
  };
  wall("east", {x, 0, z}, thickness_m, placement.height_m + 2 * thickness_m);
  wall("west", {-x, 0, z}, thickness_m, placement.height_m + 2 * thickness_m);
  wall("north", {0, y, z}, placement.width_m, thickness_m);
  wall("south", {0, -y, z}, placement.width_m, thickness_m);
  walls->links.push_back(std::move(link));
  model::Instance instance;
  instance.original_name = walls->name;
  instance.name = sanitised(walls->name);
  instance.model = std::move(walls);
  instance.X_WM.p = placement.centre_m;
  instance.place = placement.place;
  return instance;
}

}  // namespace sandlot
