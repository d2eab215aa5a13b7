#pragma once
/// Where two outlines touch, or come close to it.
///
/// Circles have one point, polygons on a face up to two. The gap is negative where they overlap. Between polygons the
/// normal is that of the face with the largest gap (separating axes; clipping after E. Catto, Contact Manifolds, 2007).
/// Limits   corner against corner the gap between polygons is at most the true distance.
#include <span>

#include "physics/planar/outline.h"

namespace sandlot::planar {

struct Figure {
  const Outline& outline;
  std::span<const Edge> edges;
};

struct Touching {
  Vec2 normal;  ///< unit, from a towards b
  int count = 0;
  struct Point {
    Vec2 at;  ///< half way between both surfaces
    double gap_m;
    std::uint32_t feature;  ///< the same while the same corners and edges meet
  } points[2];
};

/// Points with a gap below `margin_m`; false: none.
bool touching(Figure a, Figure b, double margin_m, Touching& out);

/// A gap that is at most the distance of a and b, b shifted by `shift`, and the axis on which it was found (unit, from a
/// towards b).
struct Axis {
  double gap_m;
  Vec2 normal;
};
Axis separation(Figure a, Figure b, Vec2 shift = {});

/// The part of `path` (how b moves, seen from a) after which only `target_m` is left between them; 1: they do not come so
/// near. Neither turns. 1 also when
/// they begin so near: then it is for the contact to hold them.
double time_of_impact(Figure a, Figure b, Vec2 path, double target_m);

}  // namespace sandlot::planar
