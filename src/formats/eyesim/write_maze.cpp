/// Mazes drawn with characters, from walls on a grid.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/math.h"
#include "base/text.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/plan.h"

namespace sandlot::formats::eyesim {
namespace {

using Micrometres = std::int64_t;
constexpr Micrometres finest_cell = 20'000, finest_step = 1000;
constexpr std::int64_t most_cells = 1000;

/// Walls that were typed in mm come back as they were.
Micrometres to_mm(double m) { return static_cast<Micrometres>(std::llround(m * 1e3)) * 1000; }

struct Grid {
  Micrometres cell = 0;
  std::int64_t columns = 0, rows = 0;

  std::int64_t line_of(double m) const { return to_mm(m) / cell; }
  /// Index of the cell in whose middle a spot lies, or -1.
  std::int64_t cell_of(double m, std::int64_t count) const {
    const Micrometres doubled = static_cast<Micrometres>(std::llround(2e3 * m)) * 1000;
    if (doubled % cell != 0 || doubled / cell % 2 == 0) return -1;
    const std::int64_t index = (doubled / cell - 1) / 2;
    return index >= 0 && index < count ? index : -1;
  }
};

Result<Grid> grid_of(const Plan& plan) {
  Grid grid;
  const auto error = [](const char* what, const Place& place) {
    return Error{what, "a maze has walls along x and y from one corner of a cell to another", place};
  };
  for (const Wall& wall : plan.walls) {
    const bool along_x = std::abs(wall.y1_m - wall.y2_m) < 1e-4,
               along_y = std::abs(wall.x1_m - wall.x2_m) < 1e-4;
    if (along_x == along_y) return error("a wall is neither along x nor along y", wall.place);
    for (const double each : {wall.x1_m, wall.y1_m, wall.x2_m, wall.y2_m}) {
      if (each < -1e-4 || each > 1e5) return error("a wall is outside of the maze", wall.place);
      grid.cell = std::gcd(grid.cell, to_mm(each));
    }
  }
  // Spots lie in the middle of cells.
  for (const std::vector<Spot>* const spots : {&plan.starts, &plan.balls, &plan.boxes})
    for (const Spot& spot : *spots)
      for (const double each : {spot.x_m, spot.y_m})
        if (const Micrometres doubled = static_cast<Micrometres>(std::llround(2e3 * each)) * 1000;
            doubled > 0)
          if (const Micrometres finer = std::gcd(grid.cell, doubled); finer >= finest_cell) grid.cell = finer;
  if (grid.cell < finest_cell || grid.cell % finest_step != 0)
    return Error{"the walls do not lie on a grid of cells of 20 mm or more", "convert it to .wld"};
  for (const Wall& wall : plan.walls) {
    grid.columns = std::max({grid.columns, grid.line_of(wall.x1_m), grid.line_of(wall.x2_m)});
    grid.rows = std::max({grid.rows, grid.line_of(wall.y1_m), grid.line_of(wall.y2_m)});
  }
  grid.columns = std::max<std::int64_t>(grid.columns, 1);
  grid.rows = std::max<std::int64_t>(grid.rows, 1);
  if (grid.columns > most_cells || grid.rows >= most_cells)
    return Error{"the maze has more than 1000 cells in a row", "convert it to .wld"};
  return grid;
}

/// The letter of a start, or 0: none looks there.
char letter_of(double yaw_rad) {
  const double quarters = yaw_rad / (math::pi / 2);
  const double nearest = std::floor(quarters + 0.5);
  if (std::abs(quarters - nearest) > 1e-3) return 0;
  return "rsld"[((static_cast<std::int64_t>(nearest) % 4) + 4) % 4];
}

class Drawing {
 public:
  explicit Drawing(const Grid& grid)
      : grid_(grid),
        rows_(static_cast<std::size_t>(grid.rows) + 1,
              std::string(static_cast<std::size_t>(2 * grid.columns + 1), ' ')) {}

  /// The row whose base line is y = `line` cells.
  char& at(std::int64_t line, std::int64_t column) {
    return rows_[static_cast<std::size_t>(grid_.rows - line)][static_cast<std::size_t>(column)];
  }
  void wall(const Wall& wall) {
    const std::int64_t x1 = std::min(grid_.line_of(wall.x1_m), grid_.line_of(wall.x2_m)),
                       x2 = std::max(grid_.line_of(wall.x1_m), grid_.line_of(wall.x2_m)),
                       y1 = std::min(grid_.line_of(wall.y1_m), grid_.line_of(wall.y2_m)),
                       y2 = std::max(grid_.line_of(wall.y1_m), grid_.line_of(wall.y2_m));
    for (std::int64_t x = x1; x < x2; ++x) at(y1, 2 * x + 1) = '_';
    for (std::int64_t y = y1; y < y2; ++y) at(y, 2 * x1) = '|';
  }
  bool letter(const Spot& spot, char c) {
    const std::int64_t x = grid_.cell_of(spot.x_m, grid_.columns), y = grid_.cell_of(spot.y_m, grid_.rows);
    if (c == 0 || x < 0 || y < 0) return false;
    char& place = at(y, 2 * x + 1);
    if (place != ' ' && place != '_') return false;
    place = place == '_' ? static_cast<char>(c - 'a' + 'A') : c;
    return true;
  }
  std::string text() const {
    std::string out;
    for (std::string row : rows_) {
      // Walls of neighbouring cells are drawn as one line.
      for (std::size_t i = 2; i + 1 < row.size(); i += 2)
        if (row[i] == ' ' && row[i - 1] == '_' && row[i + 1] == '_') row[i] = '_';
      while (row.size() > 1 && row.back() == ' ') row.pop_back();
      out += row + "\n";
    }
    return out + number_text(static_cast<double>(grid_.cell) / 1000) + "\n";
  }

 private:
  const Grid& grid_;
  std::vector<std::string> rows_;
};

}  // namespace

Result<std::string> maze_text(const Plan& plan, Diagnostics& diagnostics) {
  if (plan.walls.empty()) return Error{"there is no wall that a maze could have"};
  SL_ASSIGN(const Grid grid, grid_of(plan));
  Drawing drawing(grid);
  for (const Wall& wall : plan.walls) drawing.wall(wall);
  const auto letter = [&](const Spot& spot, char c) {
    if (!drawing.letter(spot, c))
      diagnostics.warn({"a start or thing is left out: a maze has one in the middle of a cell, along x or y",
                        "", spot.place});
  };
  for (const Spot& spot : plan.starts) letter(spot, letter_of(spot.yaw_rad));
  for (const Spot& spot : plan.balls) letter(spot, 'o');
  for (const Spot& spot : plan.boxes) letter(spot, 'x');
  return drawing.text();
}

Result<std::string> maze_of(const model::Setup& setup, Diagnostics& diagnostics) {
  Plan plan;
  for (const model::Instance& instance : setup.instances) {
    if (!instance.model->is_static) {
      // Balls and boxes of mazes by their shape, robots as starts.
      const Spot spot{instance.X_WM.p.x, instance.X_WM.p.y, yaw_of(instance.X_WM.q), instance.place};
      const auto& shapes = instance.model->links.front().collisions;
      if (instance.is_robot) plan.starts.push_back(spot);
      else if (shapes.size() == 1 && std::holds_alternative<Sphere>(shapes[0].shape))
        plan.balls.push_back(spot);
      else plan.boxes.push_back(spot);
      continue;
    }
    walls_of_instance(instance, plan.walls, diagnostics);
  }
  return maze_text(plan, diagnostics);
}

}  // namespace sandlot::formats::eyesim
