#pragma once
/// Ground paint: the visible markers as flat meshes for cameras and ground sensors. They collide with nothing.
///
/// Height   the first visible marker lies 0.5 mm above z = 0, each further one 0.5 mm above the one before, in the order of the
///          file: so a later one covers an earlier one, and all cover the ground. A ground whose surface is not at z = 0 hides
///          them, or has them hover.
/// Limits   opaque and matt, of one colour; they cast no shadows and have no instance or label.
#include <span>
#include <vector>

#include "geometry/color.h"
#include "geometry/shape.h"
#include "sim/world/world_elements.h"

namespace sandlot {

struct GroundPaint {
  Mesh shape;  ///< in W
  Color color;
};

std::vector<GroundPaint> ground_paint_of(std::span<const WorldElements::NamedMarker> markers);

}  // namespace sandlot
