#include "navigation/maps/grid.h"

#include <algorithm>
#include <cmath>

#include "navigation/maps/ray_walk.h"

namespace sandlot::navigation {

Status check_geometry(const GridGeometry& g) {
  if (g.width < 1 || g.height < 1)
    return Error{"a map of " + std::to_string(g.width) + " x " + std::to_string(g.height) + " cells",
                 "it needs at least one"};
  const auto cells = static_cast<double>(g.width) * static_cast<double>(g.height);
  if (g.width > max_side || g.height > max_side || cells > static_cast<double>(max_cells))
    return Error{
        "a map of " + std::to_string(g.width) + " x " + std::to_string(g.height) + " = " +
            number_text(cells) + " cells is too large",
        "at most " + std::to_string(max_side) + " cells a side and " + std::to_string(max_cells) + " in all"};
  if (!(g.resolution_m >= 1e-4 && g.resolution_m <= 1e4))
    return Error{"a resolution of " + number_text(g.resolution_m) + " m", "it must lie in [0.0001, 10000] m"};
  if (!is_finite(g.origin) || std::abs(g.origin.x) > 1e9 || std::abs(g.origin.y) > 1e9 ||
      std::abs(g.origin.theta) > 1e3)
    return Error{"the origin of the map is not a pose", "x, y and yaw must be finite and below 1e9 m"};
  return {};
}

GridFrame::GridFrame(const GridGeometry& g)
    : x_(g.origin.x), y_(g.origin.y), resolution_(g.resolution_m), width_(g.width), height_(g.height) {
  const auto [s, c] = math::sincos(g.origin.theta);
  sin_ = s;
  cos_ = c;
}

Vec2 GridFrame::to_grid(Vec2 p) const {
  const double dx = p.x - x_, dy = p.y - y_;
  return {(cos_ * dx + sin_ * dy) / resolution_, (-sin_ * dx + cos_ * dy) / resolution_};
}

Vec2 GridFrame::to_map(Vec2 p) const {
  const double gx = p.x * resolution_, gy = p.y * resolution_;
  return {x_ + cos_ * gx - sin_ * gy, y_ + sin_ * gx + cos_ * gy};
}

std::optional<Cell> GridFrame::cell(Vec2 p_M) const {
  const Vec2 g = to_grid(p_M);
  if (!(g.x >= 0 && g.y >= 0 && g.x < width_ && g.y < height_)) return std::nullopt;
  return Cell{static_cast<int>(g.x), static_cast<int>(g.y)};
}

bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.theta);
}

std::string point_text(Vec2 p) { return "(" + short_text(p.x) + ", " + short_text(p.y) + ")"; }

bool clip_segment(Vec2 a, Vec2 d, double w, double h, double& begin, double& end) {
  const double start[2] = {a.x, a.y}, step[2] = {d.x, d.y}, size[2] = {w, h};
  for (int k = 0; k < 2; ++k) {
    if (step[k] == 0) {
      if (start[k] < 0 || start[k] >= size[k]) return false;
      continue;
    }
    double enter = (0 - start[k]) / step[k], leave = (size[k] - start[k]) / step[k];
    if (enter > leave) std::swap(enter, leave);
    begin = std::max(begin, enter);
    end = std::min(end, leave);
  }
  return begin < end;
}

}  // namespace sandlot::navigation
