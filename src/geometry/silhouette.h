#pragma once
/// Silhouette of a solid from straight above: points and discs whose convex hull is its shadow, and the
/// heights it spans.
///
/// Frame      the world's xy plane.
/// Exact      upright boxes, cylinders, cones' bases, spheres, capsules; ellipsoids that are round from
///            above.
/// Limits     the rim of a leaning disc and the shadow of an ellipsoid are 32-gons that enclose them; a
///            barrel is five rings, which lie inside the true outline by less than 1 % of the sagitta. Planes
///            and terrain have no silhouette.
#include <limits>
#include <vector>

#include "geometry/pose.h"
#include "geometry/shape.h"
#include "geometry/vec2.h"

namespace sandlot {

/// Interval of heights; empty as it is made.
struct Heights {
  double min_m = std::numeric_limits<double>::infinity();
  double max_m = -std::numeric_limits<double>::infinity();
  bool empty() const { return !(min_m <= max_m); }
  void add(Heights h) {
    if (h.min_m < min_m) min_m = h.min_m;
    if (h.max_m > max_m) max_m = h.max_m;
  }
};

/// Disc in the plane; a point when its radius is 0.
struct SilhouetteDisc {
  Vec2 centre;
  double radius_m;
};

/// Silhouette of a shape at X_WC, appended: points alone (discs of radius 0), or discs. Discs have one centre
/// (a shape of revolution that stands upright) or are two equal ones at the ends of an axis (a capsule).
void add_silhouette(const Shape& shape, const Pose& X_WC, std::vector<SilhouetteDisc>& discs);

/// Heights of a shape at X_WC; empty for planes and terrain.
Heights heights_of(const Shape& shape, const Pose& X_WC);

/// Convex hull, counter-clockwise, without collinear points; fewer than three corners when the points span no
/// area.
/// Source   A. M. Andrew, Another efficient algorithm for convex hulls in two dimensions, Inf. Process. Lett.
///          9 (1979).
std::vector<Vec2> convex_hull_2d(std::vector<Vec2> points);

}  // namespace sandlot
