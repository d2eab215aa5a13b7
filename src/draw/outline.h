#pragma once
/// Outline of a solid for drawing it from above: a circle or a convex polygon, and the heights it spans; and
/// paths with fewer points.
#include <optional>
#include <vector>

#include "geometry/pose.h"
#include "geometry/shape.h"

namespace sandlot::draw {

/// Outline in the world's xy plane.
///
/// Limits   those of geometry/silhouette.h; the ends of leaning capsules have 32 corners per turn.
struct Outline {
  std::vector<Vec3> corners;  ///< counter-clockwise, z = 0; empty: a circle
  Vec3 centre_m;              ///< of the circle or of the shape's frame, z = 0
  double radius_m = 0;        ///< of the circle, or about centre_m around all corners
  double bottom_m = 0, top_m = 0;
};

/// Nothing for planes, which have no edge.
std::optional<Outline> outline_from_above(const Shape& shape, const Pose& X_WC);

/// Path without the points that lie within `tolerance_m` of the line through the ones that stay; first and
/// last stay. Heights are ignored.
/// Source   D. Douglas, T. Peucker, Algorithms for the reduction of the number of points required to
///          represent a digitized line or its caricature, Cartographica 10 (1973).
std::vector<Vec3> simplified(const std::vector<Vec3>& path, double tolerance_m);

}  // namespace sandlot::draw
