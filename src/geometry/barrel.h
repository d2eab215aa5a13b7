#pragma once
/// Points, directions and moments of a Barrel, in its own frame G.
///
/// Source   own derivation; in the half plane (rho, z) through the axis the barrel is the part |z| <= length
///          / 2 of a disc of radius `profile` round the point rho = radius - profile.
#include "geometry/shape.h"

namespace sandlot {

/// Its sizes are positive, the arc reaches both ends, and the ends are not thinner than nothing.
bool is_barrel(const Barrel& barrel);

double radius_at_m(const Barrel& barrel, double z_m);
inline double end_radius_m(const Barrel& barrel) { return radius_at_m(barrel, 0.5 * barrel.length_m); }

/// Extent from G's origin along a unit direction whose part along the axis is `axial`.
double reach_m(const Barrel& barrel, double axial);
/// The point that lies farthest along a unit direction; of a flat end a point of its rim.
Vec3 farthest(const Barrel& barrel, Vec3 direction);

/// The place of the surface that is nearest to a point.
struct BarrelSurface {
  double distance_m = 0;  ///< negative inside: how deep, exact but near the rims, where it may be less
  Vec3 normal;            ///< unit, out of the barrel, towards or through the point
};
BarrelSurface nearest(const Barrel& barrel, Vec3 point);

/// Integrals over the solid: its volume, of rho^2 and of z^2.
struct BarrelMoments {
  double volume = 0, r2 = 0, z2 = 0;
};
BarrelMoments moments(const Barrel& barrel);

}  // namespace sandlot
