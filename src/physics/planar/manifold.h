#pragma once
/// Contact manifolds of two convex outlines that touch or nearly touch.
///
/// Circles have one point, polygons on a face up to two. The gap is negative where they overlap. Between
/// polygons the normal is that of the face with the largest gap (separating axes; clipping after E. Catto,
/// Contact Manifolds, 2007).
/// Limits   corner against corner the gap between polygons is at most the true distance.
#include <span>

#include "physics/planar/outline.h"

namespace sandlot::planar {

/// Circle or convex polygon: an outline with the array that holds its edges.
struct ConvexOutline {
  const Outline& outline;
  std::span<const Edge> edges;
};

struct Manifold {
  Vec2 normal;  ///< unit, from a towards b
  int count = 0;
  struct Point {
    Vec2 at;  ///< half way between both surfaces
    double gap_m;
    std::uint32_t feature;  ///< the same while the same corners and edges meet
  } points[2];
};

/// Fills the points whose gap is below `margin_m`; false: there are none.
bool find_manifold(ConvexOutline a, ConvexOutline b, double margin_m, Manifold& out);

/// A gap that is at most the distance of a and b, b shifted by `shift`, and the axis on which it was found
/// (unit, from a towards b).
struct Axis {
  double gap_m;
  Vec2 normal;
};
Axis separation(ConvexOutline a, ConvexOutline b, Vec2 shift = {});

/// The part of `path` (motion of b relative to a, without turning) after which only `target_m` is left
/// between them. 1: they stay farther apart, or begin closer (then the contact holds them).
double time_of_impact(ConvexOutline a, ConvexOutline b, Vec2 path, double target_m);

}  // namespace sandlot::planar
