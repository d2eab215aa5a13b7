#pragma once
/// Conversion of ODE's vectors.
#include <ode/ode.h>

#include "geometry/vec3.h"

namespace sandlot::rigid {

/// The first three numbers of one of ODE's vectors.
inline Vec3 vec(const dReal* v) { return {v[0], v[1], v[2]}; }

}  // namespace sandlot::rigid
