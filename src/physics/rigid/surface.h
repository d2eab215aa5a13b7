#pragma once
/// What two touching surfaces make together.
///
/// Friction  Coulomb, pairs combine by min(). ODE bounds friction by a box along two directions; aligning the first with
///           the slip makes it the isotropic cone, because along the slip the box and the cone agree. A surface with
///           fdir1 keeps its directions and its box: that is what anisotropic wheels ask for.
/// Bounce    the larger restitution counts, above the threshold of the surface it came from.
/// Softness  slip and soft_cfm are compliances in series: they add. soft_erp: the smaller.
/// Limits    no rolling or spinning friction, no adhesion, no conveyors.
#include <ode/ode.h>

#include "model/model.h"

namespace sandlot::rigid {

/// A pair of surfaces as ODE wants it, and which of them sets the friction direction.
struct SurfacePair {
  dSurfaceParameters parameters{};
  const model::Surface* directed = nullptr;  ///< the surface whose fdir1 holds; null: aligned with slip
};

/// @param world_cfm  compliance of constraints without one of their own
/// @param slippery   friction is switched off (an ideal drive moves one of the two)
SurfacePair combine(const model::Surface& a, const model::Surface& b, double world_cfm, bool slippery);

/// Unit vector across `normal` along `wanted`, or a fixed one when `wanted` has no part across it. Inline: it is asked for
/// every contact point.
inline Vec3 friction_direction(Vec3 normal, Vec3 wanted) {
  const Vec3 across = wanted - dot(wanted, normal) * normal;
  const double length2 = dot(across, across);
  // Below 1e-12 m/s it is rounding that moves the bodies, and rounding has no direction worth following.
  if (length2 > 1e-24) return across / std::sqrt(length2);
  const Vec3 axis = std::abs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalised(axis - dot(axis, normal) * normal);
}

}  // namespace sandlot::rigid
