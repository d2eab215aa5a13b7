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

#include <optional>

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

/// Unit vector across `normal` along `wanted`, or a fixed one when `wanted` has no part across it.
Vec3 friction_direction(Vec3 normal, Vec3 wanted);

}  // namespace sandlot::rigid
