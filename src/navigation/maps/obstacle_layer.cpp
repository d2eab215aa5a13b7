#include "navigation/maps/obstacle_layer.h"

#include <algorithm>
#include <cmath>

#include "navigation/maps/ray_walk.h"

namespace sandlot::navigation {
namespace {

constexpr std::uint8_t obstacle_full = 255, obstacle_pass = 64;

bool obstacle_scan_usable(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& X_MB) {
  return std::isfinite(scan.angle_min) && std::isfinite(scan.angle_increment) &&
         !std::isnan(scan.range_min) && !std::isnan(scan.range_max) && is_finite(X_BL) && is_finite(X_MB);
}

/// Point at a distance along a beam, in the map's frame.
Vec2 obstacle_point(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& X_MB, std::size_t beam,
                    double range) {
  const auto [s, c] = math::sincos(static_cast<double>(scan.angle_min) +
                                   static_cast<double>(beam) * static_cast<double>(scan.angle_increment));
  const Vec3 p_B = X_BL * Vec3{range * c, range * s, 0};
  const auto [st, ct] = math::sincos(X_MB.theta);
  return {X_MB.x + ct * p_B.x - st * p_B.y, X_MB.y + st * p_B.x + ct * p_B.y};
}

}  // namespace

void take_echoes(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& X_MB, double max_range_m,
                 std::vector<Echo>& out) {
  out.clear();
  if (!obstacle_scan_usable(scan, X_BL, X_MB)) return;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto r = static_cast<double>(scan.ranges[i]);
    if (!(r > 0 && r >= static_cast<double>(scan.range_min) && r < static_cast<double>(scan.range_max) &&
          r <= max_range_m))
      continue;
    out.push_back({obstacle_point(scan, X_BL, X_MB, i, r), i, r});
  }
}

void mark_scan(const ObstacleLayerSpec& spec, const GridGeometry& geometry, ObstacleLayerState& state,
               const msg::LaserScan& scan, const Pose& X_BL, const Pose2& X_MB, double robot_radius_m) {
  if (!obstacle_scan_usable(scan, X_BL, X_MB)) return;
  const GridFrame frame(geometry);
  const Vec2 from = frame.to_grid(obstacle_point(scan, X_BL, X_MB, 0, 0));
  // Cells that this scan touches: 1 passed, 2 ended.
  std::vector<std::uint8_t> touched(geometry.cells());
  std::vector<std::uint32_t> list;
  const auto touch = [&](Cell c, std::uint8_t how) {
    const std::size_t i = geometry.index(c);
    if (touched[i] == 0) list.push_back(static_cast<std::uint32_t>(i));
    touched[i] = std::max(touched[i], how);
  };
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto r = static_cast<double>(scan.ranges[i]);
    if (std::isnan(r) || r <= 0 || r < static_cast<double>(scan.range_min)) continue;
    const bool echo = r < static_cast<double>(scan.range_max) && r <= spec.max_range_m;
    const double length = std::min({r, spec.max_range_m, static_cast<double>(scan.range_max)});
    const Vec2 end_M = obstacle_point(scan, X_BL, X_MB, i, length);
    const bool own = math::hypot(end_M.x - X_MB.x, end_M.y - X_MB.y) < robot_radius_m;
    if (echo && own) continue;
    walk_cells(from, frame.to_grid(end_M), geometry.width, geometry.height, [&](Cell c) { touch(c, 1); });
    if (!echo) continue;
    if (const auto c = frame.cell(end_M)) touch(*c, 2);
  }
  for (const std::uint32_t i : list) {
    std::uint8_t& trust = state.trust[i];
    trust = touched[i] == 2         ? obstacle_full
            : trust > obstacle_pass ? static_cast<std::uint8_t>(trust - obstacle_pass)
                                    : std::uint8_t{0};
    state.free[i] = trust == 0 ? obstacle_full : std::uint8_t{0};
  }
}

void decay(const ObstacleLayerSpec& spec, ObstacleLayerState& state, double dt_s) {
  state.rest_s += dt_s;
  const double step_s = spec.persistence_s / obstacle_full;
  if (state.rest_s < step_s) return;
  const double steps = std::floor(state.rest_s / step_s);
  state.rest_s = std::max(0.0, state.rest_s - steps * step_s);
  const int lost = static_cast<int>(std::min(steps, 255.0));
  for (auto* cells : {&state.trust, &state.free})
    for (std::uint8_t& cell : *cells) cell = static_cast<std::uint8_t>(std::max(0, cell - lost));
}

void clear_near(const GridGeometry& geometry, ObstacleLayerState& state, Vec2 centre_M, double radius_m,
                double keep_m) {
  const GridFrame frame(geometry);
  const auto middle = frame.cell(centre_M);
  if (!middle) return;
  const int reach = static_cast<int>(std::min(radius_m / geometry.resolution_m, double{max_side}));
  const double keep = keep_m / geometry.resolution_m;
  for (int y = std::max(0, middle->y - reach); y <= std::min(geometry.height - 1, middle->y + reach); ++y)
    for (int x = std::max(0, middle->x - reach); x <= std::min(geometry.width - 1, middle->x + reach); ++x) {
      const int square = (x - middle->x) * (x - middle->x) + (y - middle->y) * (y - middle->y);
      if (square <= reach * reach && square >= keep * keep) state.trust[geometry.index({x, y})] = 0;
    }
}

}  // namespace sandlot::navigation
