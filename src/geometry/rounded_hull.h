#pragma once
/// Rounded hull: all points of the plane within a radius of a convex polygon, such as the outline of a solid from above.
///
/// Frame   the world's xy plane.
/// Exact   what geometry/silhouette.h makes of boxes, discs and capsules.
#include <span>
#include <vector>

#include "geometry/silhouette.h"
#include "geometry/vec2.h"

namespace sandlot {

struct RoundedHull {
  std::vector<Vec2> corners;  ///< counter-clockwise; one: a disc, two: a capsule. Never empty
  double radius_m = 0;
};

/// @pre discs is not empty; their radii are equal, or their centres are
RoundedHull rounded_hull(std::span<const SilhouetteDisc> discs);

/// Distance from the segment a b to the polygon of the hull, its radius left out; 0 where they meet.
double distance_m(std::span<const Vec2> corners, Vec2 a, Vec2 b);

/// Distance from a point to the segment a b.
double distance_m(Vec2 point, Vec2 a, Vec2 b);

/// Whether the hull shares a point with a simple polygon. @param outline  counter-clockwise
bool meets(const RoundedHull& hull, std::span<const Vec2> outline);

}  // namespace sandlot
