#include "geometry/height_grid.h"

#include <algorithm>
#include <cmath>

namespace sandlot {
namespace {

/// Position of a point: the cell and the place in it, 0..1 both ways.
struct InCell {
  int column, row;
  double u, v;
};
InCell cell_of(const HeightGrid& g, double x_m, double y_m) {
  const double x = std::clamp((x_m + 0.5 * g.size_x_m) / g.cell_x_m(), 0.0,
                              static_cast<double>(g.columns - 1));
  const double y = std::clamp((y_m + 0.5 * g.size_y_m) / g.cell_y_m(), 0.0, static_cast<double>(g.rows - 1));
  const int column = std::min(static_cast<int>(x), g.columns - 2),
            row = std::min(static_cast<int>(y), g.rows - 2);
  return {column, row, x - column, y - row};
}

/// Slopes of the triangle the point is in, per cell.
struct Slopes {
  double along_u, along_v, base;
};
Slopes slopes_of(const HeightGrid& g, const InCell& c) {
  const double a = g.at(c.column, c.row), b = g.at(c.column + 1, c.row), d = g.at(c.column + 1, c.row + 1),
               e = g.at(c.column, c.row + 1);
  if (c.u >= c.v) return {b - a, d - b, a};
  return {d - e, e - a, a};
}

}  // namespace

double height_at(const HeightGrid& grid, double x_m, double y_m) {
  const InCell c = cell_of(grid, x_m, y_m);
  const Slopes s = slopes_of(grid, c);
  return s.base + s.along_u * c.u + s.along_v * c.v;
}

Vec3 normal_at(const HeightGrid& grid, double x_m, double y_m) {
  const Slopes s = slopes_of(grid, cell_of(grid, x_m, y_m));
  return normalised(Vec3{-s.along_u / grid.cell_x_m(), -s.along_v / grid.cell_y_m(), 1});
}

}  // namespace sandlot
