#pragma once
/// Simple polygons seen from above: corners in order, z unused.
#include <optional>
#include <span>
#include <utility>

#include "geometry/vec3.h"

namespace sandlot {

/// Whether a point lies in the polygon. Points on an edge belong to one of the two sides, always the same.
bool polygon_contains(std::span<const Vec3> corners, Vec3 point);
/// Positive where the corners go counter-clockwise.
double polygon_area(std::span<const Vec3> corners);
/// Two sides that meet though they are not neighbours, or overlap; nothing for a simple polygon. Cost: the square of the
/// number of corners.
std::optional<std::pair<std::size_t, std::size_t>> polygon_crossing(std::span<const Vec3> corners);

}  // namespace sandlot
