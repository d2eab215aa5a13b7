#pragma once
/// Grid geometry: size, resolution and place of a map of square cells.
///
/// Frame    M, the map's. Cell (0, 0) has its lower left corner at `origin`; columns run along the x axis of
///          the origin's frame, rows along its y axis (nav_msgs/OccupancyGrid, REP 105). The origin may be
///          turned.
/// Errors   check_geometry() refuses sizes below one cell, over max_side cells a side or max_cells in all,
///          and numbers that are not finite.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>

#include "base/fields.h"
#include "base/math.h"
#include "base/result.h"
#include "base/text.h"
#include "geometry/vec2.h"
#include "perception/scan_match.h"

namespace sandlot::navigation {

using Pose2 = perception::Pose2;

inline constexpr int max_side = 32'768;
inline constexpr std::size_t max_cells = std::size_t{1} << 26;  ///< 67 million: 8192 x 8192

/// Column and row of a cell.
struct Cell {
  int x = 0, y = 0;
  friend constexpr bool operator==(Cell, Cell) = default;
};

struct GridGeometry {
  int width = 0, height = 0;  ///< number of columns and rows
  double resolution_m = 0.05;
  Pose2 origin;  ///< X_MG: corner of cell (0, 0) in the map's frame

  std::size_t cells() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  bool contains(Cell c) const { return c.x >= 0 && c.y >= 0 && c.x < width && c.y < height; }
  std::size_t index(Cell c) const {
    return static_cast<std::size_t>(c.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(c.x);
  }
};

Status check_geometry(const GridGeometry& geometry);

/// Transform between the map's frame and coordinates counted in cells, with the origin's turn worked out
/// once.
class GridFrame {
 public:
  explicit GridFrame(const GridGeometry& geometry);
  /// Coordinates in cells: the cell (i, j) covers [i, i + 1) x [j, j + 1).
  Vec2 to_grid(Vec2 p_M) const;
  Vec2 to_map(Vec2 p_G) const;
  Vec2 centre(Cell c) const { return to_map({c.x + 0.5, c.y + 0.5}); }
  /// Turns a direction from the map's frame into the grid's.
  Vec2 direction_to_grid(Vec2 d_M) const {
    return {cos_ * d_M.x + sin_ * d_M.y, -sin_ * d_M.x + cos_ * d_M.y};
  }
  /// Cell at a point; nothing off the grid or for coordinates that are not finite.
  std::optional<Cell> cell(Vec2 p_M) const;
  double resolution_m() const { return resolution_; }

 private:
  double x_, y_, sin_, cos_, resolution_;
  int width_, height_;
};

bool is_finite(const Pose2& pose);
/// `(1.5, -2)`, for messages.
std::string point_text(Vec2 p);

/// Checks every number of a spec against the range in its field list; the error gives the field's key, value
/// and range.
template <class Spec>
Status check_ranges(const Spec& spec) {
  Status status;
  Spec::fields(spec, [&](const Field& f, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if constexpr (std::is_arithmetic_v<Member> && !std::is_same_v<Member, bool>) {
      const auto x = static_cast<double>(member);
      if (status && !(x >= f.min && x <= f.max))
        status = Error{std::string(f.key) + " is " + number_text(x),
                       "it must lie in [" + number_text(f.min) + ", " + number_text(f.max) + "] " + f.unit};
    }
  });
  return status;
}

}  // namespace sandlot::navigation
