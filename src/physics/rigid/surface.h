#pragma once
/// Parameters of ODE for a pair of surfaces (physics/pair_surface.h).
///
/// Friction  ODE bounds friction by a box along two directions; aligning the first with the slip makes it the
///           isotropic cone, because along the slip the box and the cone agree. A pair with fdir1_W keeps its
///           directions and its box: that is what anisotropic wheels and skins ask for.
/// Rolling   a torque of at most resistance * normal force against rolling, none against spinning on the
///           spot. ODE bounds it along the same two directions: see rolls_along().
/// Softness  a spring with a damper is ODE's ERP and CFM of the sub-step.
/// Limits    no spinning friction, no adhesion.
#include <ode/ode.h>

#include "physics/pair_surface.h"

namespace sandlot::rigid {

/// @param world_cfm  compliance of constraints without one of their own
/// @param slippery   friction is switched off (an ideal drive moves one of the two)
dSurfaceParameters parameters_of(const PairSurface& pair, double h_s, double world_cfm, bool slippery);

/// Unit vector across `normal` along `wanted`, or a fixed one when `wanted` has no part across it. Inline: it
/// is called every contact point.
inline Vec3 friction_direction(Vec3 normal, Vec3 wanted) {
  const Vec3 across = wanted - dot(wanted, normal) * normal;
  const double length2 = dot(across, across);
  // Below 1e-12 m/s it is rounding that moves the bodies, and rounding has no direction worth following.
  if (length2 > 1e-24) return across / std::sqrt(length2);
  const Vec3 axis = std::abs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalised(axis - dot(axis, normal) * normal);
}

}  // namespace sandlot::rigid
