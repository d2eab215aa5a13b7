#pragma once
/// Primitive solids as rays see them: in the world, ready for eight rays at a time.
///
/// Precision   the ray's origin is taken into the solid's frame in double precision, so a solid 10 km from the
///             world's origin is as sharp as one beside it; from there on single precision. Roots are taken of
///             r^2 minus the squared distance of the ray from the centre (never of b^2 - c, which cancels), so
///             the error of a distance stays at a few float epsilon times distance and size, divided by the
///             cosine of incidence.
/// Source      E. Haines et al., Precision improvements for ray/sphere intersection, Ray Tracing Gems (2019), ch. 7.
#include <cstdint>

#include "geometry/pose.h"
#include "geometry/shape.h"
#include "optics/lanes.h"

namespace sandlot::optics {

/// A box, sphere, cylinder or capsule placed in the world.
struct Solid {
  enum class Type : std::uint32_t { box, sphere, cylinder, capsule };
  double position[3];  ///< of the shape frame C in W
  float axes[9];       ///< rows: the axes of C in W
  float size[3];       ///< box: half edges; otherwise radius and half length
  std::uint32_t body;
  Type type;

  void place(const Pose& X_WC);
};

/// @pre shape is not a Plane
Solid make_solid(const Shape& shape, std::uint32_t body);

/// The part of space that the solid occupies, without margin.
struct Bounds {
  double lower[3], upper[3];
};
Bounds bounds(const Solid& solid);

/// Rays that leave one point. Directions are unit vectors in W.
struct Rays8 {
  lanes::F dx, dy, dz;
  lanes::F near;  ///< surfaces before it are not seen
};

/// Distance to the first surface of the solid at or behind `near`; NaN or infinite where there is none.
/// @param origin  in W
lanes::F distance_to(const Solid& solid, const double origin[3], const Rays8& rays);

}  // namespace sandlot::optics
