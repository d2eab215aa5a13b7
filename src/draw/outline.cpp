#include "draw/outline.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/math.h"
#include "geometry/mesh.h"
#include "geometry/silhouette.h"

namespace sandlot::draw {
namespace {

constexpr int corners_per_turn = 32;
constexpr double upright = 1e-9;  ///< offset of a disc, in radii, that does not count

Vec3 flat(Vec3 p) { return {p.x, p.y, 0}; }

/// Points for the hull of a silhouette; those of discs lie on their circles.
std::vector<Vec2> points_of(const std::vector<SilhouetteDisc>& discs) {
  std::vector<Vec2> points;
  for (const SilhouetteDisc& disc : discs) {
    if (disc.radius_m == 0) {
      points.push_back(disc.centre);
      continue;
    }
    for (int i = 0; i < corners_per_turn; ++i) {
      const math::SinCos a = math::sincos(math::tau * i / corners_per_turn);
      points.push_back(disc.centre + disc.radius_m * Vec2{a.cos, a.sin});
    }
  }
  return points;
}

/// Radius of a circular silhouette, whose discs have one centre; else 0.
double circle_radius_m(const std::vector<SilhouetteDisc>& discs) {
  double radius_m = 0;
  for (const SilhouetteDisc& disc : discs) radius_m = std::max(radius_m, disc.radius_m);
  for (const SilhouetteDisc& disc : discs) {
    const Vec2 off = disc.centre - discs[0].centre;
    if (std::sqrt(dot(off, off)) > upright * radius_m) return 0;
  }
  return radius_m;
}

/// The pose without a lean that is too small to see, for shapes of revolution about z: a circle stays one.
Pose straightened(const Shape& shape, Pose X_WC) {
  const bool round = std::holds_alternative<Cylinder>(shape) || std::holds_alternative<Capsule>(shape) ||
                     std::holds_alternative<Cone>(shape) || std::holds_alternative<Barrel>(shape);
  const double cosine = rotate(X_WC.q, {0, 0, 1}).z;
  if (round && std::abs(cosine) > 1 - 1e-9) X_WC.q = cosine > 0 ? Quat{1, 0, 0, 0} : Quat{0, 1, 0, 0};
  return X_WC;
}

/// Squared distance of p from the segment a-b, in the plane.
double squared_distance(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 ab = flat(b - a), ap = flat(p - a);
  const double length2 = dot(ab, ab);
  const double t = length2 > 0 ? std::clamp(dot(ap, ab) / length2, 0.0, 1.0) : 0.0;
  const Vec3 off = ap - t * ab;
  return dot(off, off);
}

}  // namespace

std::optional<Outline> outline_from_above(const Shape& shape, const Pose& X_WC) {
  std::vector<SilhouetteDisc> discs;
  Heights heights;
  if (std::holds_alternative<Heightfield>(shape)) {
    for (const Vec3& v : tessellate(shape).vertices) {
      const Vec3 corner = X_WC * v;
      discs.push_back({{corner.x, corner.y}, 0});
      heights.add({corner.z, corner.z});
    }
  } else {
    const Pose X_drawn = straightened(shape, X_WC);
    add_silhouette(shape, X_drawn, discs);
    heights = heights_of(shape, X_drawn);
  }
  if (discs.empty()) return std::nullopt;
  Outline outline{{}, flat(X_WC.p), circle_radius_m(discs), heights.min_m, heights.max_m};
  if (outline.radius_m > 0) return outline;
  for (const Vec2 corner : convex_hull_2d(points_of(discs))) {
    outline.corners.push_back({corner.x, corner.y, 0});
    outline.radius_m = std::max(outline.radius_m, norm(outline.corners.back() - outline.centre_m));
  }
  return outline;
}

std::vector<Vec3> simplified(const std::vector<Vec3>& path, double tolerance_m) {
  if (path.size() < 3) return path;
  std::vector<bool> keep(path.size(), false);
  keep.front() = keep.back() = true;
  std::vector<std::array<std::size_t, 2>> open{{0, path.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double farthest = tolerance_m * tolerance_m;
    std::size_t split = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d2 = squared_distance(path[i], path[first], path[last]);
      if (d2 > farthest) farthest = d2, split = i;
    }
    if (split == first) continue;
    keep[split] = true;
    open.push_back({first, split});
    open.push_back({split, last});
  }
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < path.size(); ++i)
    if (keep[i]) kept.push_back(path[i]);
  return kept;
}

}  // namespace sandlot::draw
