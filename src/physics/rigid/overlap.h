#pragma once
/// Distance between a point and a primitive solid, in closed form.
#include "geometry/shape.h"

namespace sandlot::rigid {

/// Distance [m] from a point in the shape's own frame to the solid; 0 inside.
double distance_m(const Shape& shape, Vec3 point_G);

}  // namespace sandlot::rigid
