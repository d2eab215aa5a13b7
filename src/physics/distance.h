#pragma once
/// Distance between a point and a solid: primitives in closed form (an ellipsoid by bisection, to rounding),
/// meshes and terrain by their triangles.
///
/// Meshes   inside is where the surface winds around the point at least half a turn of the sphere, so small
///          holes do no harm. Cost: 10 ns per triangle of the mesh, 100 ns where the bounds contain the
///          point.
/// Terrain  the ground below the grid is solid without end. Cost: the cells within the distance or the limit.
#include <limits>

#include "geometry/shape.h"

namespace sandlot {

/// Distance [m] from a point in the shape's own frame to the solid; 0 inside.
/// @param limit_m  a distance above it may come out as any number above it
double distance_m(const Shape& shape, Vec3 point_G, double limit_m = std::numeric_limits<double>::infinity());

}  // namespace sandlot
