#pragma once
/// Primitive solids as rays see them: in the world, ready for eight rays at a time.
///
/// Precision   the ray's origin is taken into the solid's frame in double precision, so a solid 10 km from
///             the world's origin is as sharp as one near it; from there on single precision. Roots are taken
///             of r^2 minus the squared distance of the ray from the centre (never of b^2 - c, which
///             cancels), so the error of a distance stays at a few float epsilon times distance and size,
///             divided by the cosine of incidence. Cones and ellipsoids, too, are met where they are, not
///             where triangles would be; the discriminant of a cone is built from the minors of origin and
///             direction (Lagrange's identity). A barrel is the spheroid through its middle and its ends, cut
///             off there: for rollers of wheels within 1 % of their radius.
///             Triangles of meshes and terrain are held in single precision about the middle of their bounds,
///             so their error grows with the size of the mesh, not with its place in the world.
/// Source      E. Haines et al., Precision improvements for ray/sphere intersection, Ray Tracing Gems (2019),
///             ch. 7.
#include <cstdint>

#include "geometry/pose.h"
#include "geometry/shape.h"
#include "optics/lanes.h"

namespace sandlot::optics {

/// A bounded shape placed in the world. Of triangles it is the box around them; what is inside, a tree knows.
struct Solid {
  enum class Type : std::uint32_t { box, sphere, cylinder, capsule, cone, ellipsoid, barrel, triangles };
  double position[3];  ///< of the shape frame C in W
  float axes[9];       ///< rows: the axes of C in W
  float size
      [3];  ///< box, triangles: half edges; ellipsoid: radii; otherwise radius and half length; barrel: also
            ///< the half axis of its spheroid
  std::uint32_t body;
  Type type;

  void place(const Pose& X_WC);
};

/// @pre shape is neither a Plane nor made of triangles
Solid make_solid(const Shape& shape, std::uint32_t body);
/// Triangles within a box about the origin of their frame.
Solid make_triangles(Vec3 half_size_m, std::uint32_t body);

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

/// The same rays seen from the solid's frame: one origin (float) or one for each (lanes::F), eight
/// directions.
template <class Origin>
struct LocalRaysOf {
  Origin ox, oy, oz;
  lanes::F dx, dy, dz;
};
using LocalRays8 = LocalRaysOf<float>;
using LocalSpread8 = LocalRaysOf<lanes::F>;

/// A point of W in the solid's frame.
void origin_in(const Solid& solid, const double origin[3], float out[3]);
LocalRays8 to_local(const Solid& solid, const double origin[3], const Rays8& rays);
/// Rays that begin at `from`, near `origin`: their places relative to it, in W.
struct Spread8 {
  lanes::F x, y, z;
};
LocalSpread8 to_local(const Solid& solid, const double origin[3], const Spread8& from, const Rays8& rays);

/// Distance to the first surface of the solid at or behind `near`; NaN or infinite where there is none.
/// @pre not triangles
/// @param origin  in W
lanes::F distance_to(const Solid& solid, const double origin[3], const Rays8& rays);
lanes::F distance_to(const Solid& solid, const LocalSpread8& rays, lanes::F near);

}  // namespace sandlot::optics
