#pragma once
/// Whether a shape meets the convex hull of some points.
///
/// Exact    to 1e-9 of the sizes involved; what touches meets. A mesh stands for its convex hull, a height field for its box.
/// Cost     some iterations of one pass over the points each, and over the vertices of a mesh.
/// Source   E. G. Gilbert, D. W. Johnson, S. S. Keerthi, A Fast Procedure for Computing the Distance Between Complex Objects
///          in Three-Dimensional Space (1988).
#include <span>

#include "geometry/pose.h"
#include "geometry/shape.h"

namespace sandlot {

/// @param hull_A  corners in the frame A of `X_AG`; one point, a line and a polygon are hulls too
/// @pre hull_A is not empty
bool meets(const Shape& shape, const Pose& X_AG, std::span<const Vec3> hull_A);

}  // namespace sandlot
