#pragma once
/// Walk along a segment through the cells of a grid.
///
/// Source   J. Amanatides, A. Woo, A fast voxel traversal algorithm for ray tracing (1987).
#include <algorithm>
#include <cmath>
#include <limits>

#include "navigation/maps/grid.h"

namespace sandlot::navigation {

/// Part of the segment a + t d, t in [0, 1], within [0, w] x [0, h]; false when there is none.
bool clip_segment(Vec2 a, Vec2 d, double w, double h, double& begin, double& end);

/// Calls visit(cell) for the cells along a segment in coordinates of cells, in order, within the grid; for none if its ends are not finite.
template <class Visit>
void walk_cells(Vec2 a, Vec2 b, int width, int height, Visit&& visit) {
  const Vec2 d = b - a;
  double begin = 0, end = 1;
  if (!clip_segment(a, d, width, height, begin, end)) return;
  const Vec2 first = a + begin * d, last = a + end * d;
  // Ends that are far off overflow.
  if (!std::isfinite(first.x + first.y + last.x + last.y)) return;
  const auto cell = [&](Vec2 p) {
    return Cell{static_cast<int>(std::clamp(std::floor(p.x), 0.0, width - 1.0)),
                static_cast<int>(std::clamp(std::floor(p.y), 0.0, height - 1.0))};
  };
  Cell c = cell(first);
  const Cell stop = cell(last);
  const int sx = d.x > 0 ? 1 : -1, sy = d.y > 0 ? 1 : -1;
  constexpr double never = std::numeric_limits<double>::infinity();
  // Parameter at which the segment leaves the present column and row.
  const double dtx = d.x != 0 ? 1 / std::abs(d.x) : never, dty = d.y != 0 ? 1 / std::abs(d.y) : never;
  double tx = d.x != 0 ? (c.x + (sx > 0) - a.x) / d.x : never,
         ty = d.y != 0 ? (c.y + (sy > 0) - a.y) / d.y : never;
  for (int left = std::abs(stop.x - c.x) + std::abs(stop.y - c.y);; --left) {
    visit(c);
    if (left <= 0) return;
    if ((tx < ty && c.x != stop.x) || c.y == stop.y) {
      c.x += sx;
      tx += dtx;
    } else {
      c.y += sy;
      ty += dty;
    }
  }
}

}  // namespace sandlot::navigation
