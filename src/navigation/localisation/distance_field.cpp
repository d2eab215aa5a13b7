#include "navigation/localisation/distance_field.h"

#include <algorithm>
#include <cmath>

#include "navigation/maps/distance.h"

namespace sandlot::navigation {

Result<DistanceField> DistanceField::make(const GridMap& map, int occupied_percent, double max_distance_m) {
  SL_TRY(check_geometry(map.geometry));
  if (map.occupancy.size() != map.geometry.cells())
    return Error{"the map has " + std::to_string(map.occupancy.size()) + " cells of data",
                 "its size says " + std::to_string(map.geometry.cells())};
  std::vector<std::uint8_t> occupied(map.occupancy.size()), open(map.occupancy.size());
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    occupied[i] = map.occupancy[i] >= occupied_percent;
    open[i] = !occupied[i];
  }
  if (std::find(occupied.begin(), occupied.end(), 1) == occupied.end())
    return Error{"the map has no occupied cell",
                 "a scan can only be compared with walls: at least one cell of " +
                     std::to_string(occupied_percent) + " % or more"};
  const auto outside = squared_distances(occupied, map.geometry.width, map.geometry.height),
             inside = squared_distances(open, map.geometry.width, map.geometry.height);
  DistanceField out(map.geometry);
  out.distance_m_.resize(outside.size());
  const auto length = [&](std::uint32_t square) {
    return std::sqrt(static_cast<double>(square)) * map.geometry.resolution_m;
  };
  for (std::size_t i = 0; i < outside.size(); ++i) {
    const double d = open[i] ? length(outside[i]) : map.geometry.resolution_m - length(inside[i]);
    out.distance_m_[i] = static_cast<float>(std::clamp(d, -max_distance_m, max_distance_m));
  }
  return out;
}

bool DistanceField::sample(Vec2 p_M, Sample& out) const {
  const Vec2 g = frame_.to_grid(p_M);
  const int w = geometry_.width, h = geometry_.height;
  if (!(g.x >= 0 && g.y >= 0 && g.x < w && g.y < h)) return false;
  // Centres lie at half-integers; beyond the outermost ones the field is constant.
  const double u = std::clamp(g.x - 0.5, 0.0, w - 1.0), v = std::clamp(g.y - 0.5, 0.0, h - 1.0);
  const int x0 = static_cast<int>(u), y0 = static_cast<int>(v), x1 = std::min(x0 + 1, w - 1),
            y1 = std::min(y0 + 1, h - 1);
  const double a = u - x0, b = v - y0;
  const auto d00 = static_cast<double>(at({x0, y0})), d10 = static_cast<double>(at({x1, y0})),
             d01 = static_cast<double>(at({x0, y1})), d11 = static_cast<double>(at({x1, y1}));
  out.distance_m = (1 - b) * ((1 - a) * d00 + a * d10) + b * ((1 - a) * d01 + a * d11);
  const double gx = ((1 - b) * (d10 - d00) + b * (d11 - d01)) / geometry_.resolution_m,
               gy = ((1 - a) * (d01 - d00) + a * (d11 - d10)) / geometry_.resolution_m;
  // direction_to_grid() turns by the origin's angle; its transpose turns back.
  const Vec2 ex = frame_.direction_to_grid({1, 0}), ey = frame_.direction_to_grid({0, 1});
  out.gradient_M = {ex.x * gx + ex.y * gy, ey.x * gx + ey.y * gy};
  return true;
}

}  // namespace sandlot::navigation
