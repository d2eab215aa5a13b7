#pragma once
/// Polygons in the plane cut into triangles.
///
/// Method   holes are joined to the outline by bridges, then ears are cut off. Every corner stays a corner of
///          the triangles, also one in the middle of a straight side, so that neighbouring walls fit.
/// Limits   at most `max_corners` in all loops together; the time grows with their square, at worst their
///          cube.
/// Source   D. Eberly, Triangulation by ear clipping (2002).
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sandlot {

using Loop2 = std::vector<std::array<double, 2>>;

constexpr std::size_t max_corners = 4096;

/// Twice the area, positive when the loop runs counter-clockwise.
double twice_area(const Loop2& loop);

/// No two sides touch but neighbours at their common corner, in one loop or between loops; every loop has an
/// area.
bool is_simple(const std::vector<Loop2>& loops);

/// Counter-clockwise triangles whose corners count through all loops in order. The first loop is the outline,
/// in either sense, the others are holes in it. Empty when that cannot be done: loops cross, a hole lies
/// outside, too many corners.
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Loop2>& loops);

}  // namespace sandlot
