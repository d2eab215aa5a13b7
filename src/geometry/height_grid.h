#pragma once
/// Terrain: heights on a regular grid over the xy plane of its frame, centred on the frame's z axis.
#include <cstddef>
#include <string>
#include <vector>

#include "base/fields.h"
#include "geometry/vec3.h"

namespace sandlot {

/// Samples run along x first (column 0 at -size_x/2), then along y (row 0 at -size_y/2). Each cell is two
/// triangles, split from its corner of least x and y to that of greatest x and y: rays, contacts and
/// height_at() agree on that.
struct HeightGrid {
  int columns = 0, rows = 0;          ///< samples, at least 2 each
  double size_x_m = 0, size_y_m = 0;  ///< between the first and the last sample
  std::vector<float> height_m;        ///< columns * rows
  std::string source;                 ///< file it came from, for messages
  double source_height_m = 1;         ///< height that the file's brightest pixel stands for

  static void fields(auto& s, auto&& visit) {
    visit(Field{"columns", "1", "Samples along x."}, s.columns);
    visit(Field{"rows", "1", "Samples along y."}, s.rows);
    visit(Field{"size_x", "m", "Extent along x."}, s.size_x_m);
    visit(Field{"size_y", "m", "Extent along y."}, s.size_y_m);
    visit(Field{"height", "m", "Heights, row by row."}, s.height_m);
    visit(Field{"source", "", "File that the heights are from."}, s.source);
    visit(Field{"source_height", "m", "Height of the brightest pixel of the file."}, s.source_height_m);
  }

  float at(int column, int row) const {
    return height_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(column)];
  }
  double cell_x_m() const { return size_x_m / (columns - 1); }
  double cell_y_m() const { return size_y_m / (rows - 1); }
};

/// Height of the surface above a point; outside the grid that of its nearest edge.
double height_at(const HeightGrid& grid, double x_m, double y_m);
/// Unit normal there, pointing up.
Vec3 normal_at(const HeightGrid& grid, double x_m, double y_m);

}  // namespace sandlot
