#pragma once
/// Outline of a solid in the plane: a convex prism, upright over an interval of heights.
///
/// Exact      upright boxes, cylinders, cones' bases and capsules lying flat or standing up; for rays also their lids.
/// Meshes     each triangle by itself, over its own heights: so a building of one mesh has rooms. Upright triangles are
///            walls a millionth of their length thick. A slope is as high as its upper end everywhere.
/// Limits     anything else becomes the upright prism over its shadow: a sphere the cylinder around it, a tilted box
///            the prism over the convex hull of its corners, an oblique cylinder or cone one over a 32-gon about each
///            rim, an ellipsoid one over a 32-gon about its shadow.
/// Errors     terrain has no outline; the engine refuses it.
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/pose.h"
#include "geometry/shape.h"
#include "geometry/silhouette.h"
#include "physics/planar/turn.h"

namespace sandlot::planar {

/// True when the two share more than `clearance_m`.
constexpr bool meet(Heights a, Heights b, double clearance_m) {
  return a.max_m - b.min_m > clearance_m && b.max_m - a.min_m > clearance_m;
}

/// An edge of a convex polygon, its inside on the left.
struct Edge {
  Vec2 from;
  Vec2 along;  ///< unit
  double length_m;
  Vec2 outward() const { return {along.y, -along.x}; }
};

/// A circle, or a polygon of `edge_count` edges in an array that many outlines share.
struct Outline {
  Vec2 centre;  ///< of the circle, or of a circle around the polygon
  double radius_m = 0;
  Heights heights;
  std::uint32_t first_edge = 0, edge_count = 0;
};

/// The shadow of a shape at X_WC as outlines with their edges, appended. A plane has none.
void add_outlines(const Shape& shape, const Pose& X_WC, std::vector<Outline>& outlines,
                  std::vector<Edge>& edges);

/// The convex hull of points over some heights; nothing when it has no area.
void add_polygon(std::vector<Vec2> points, Heights h, std::vector<Outline>& outlines,
                 std::vector<Edge>& edges);

struct Nearest {
  double distance_m;  ///< negative inside
  Vec2 normal;        ///< unit, outwards
};
Nearest nearest(const Outline& outline, std::span<const Edge> edges, Vec2 point);

/// Where the line origin + t * direction (any length) runs inside the outline; empty when first > last.
struct Chord {
  double first, last;
};
Chord chord(const Outline& outline, std::span<const Edge> edges, Vec2 origin, Vec2 direction);

inline Chord chord_of_circle(Vec2 to_centre, double radius_m, Vec2 direction, double length2,
                             double inverse_length2) {
  const double side = to_centre.x * direction.y - to_centre.y * direction.x;
  const double square = length2 * (radius_m * radius_m) - side * side;
  if (!(square >= 0)) return {1, 0};
  const double half = std::sqrt(square), middle = dot(to_centre, direction);
  return {(middle - half) * inverse_length2, (middle + half) * inverse_length2};
}

}  // namespace sandlot::planar
