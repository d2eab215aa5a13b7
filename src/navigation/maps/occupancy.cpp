#include "navigation/maps/occupancy.h"

#include <algorithm>
#include <cmath>

#include "navigation/maps/ray_walk.h"

namespace sandlot::navigation {
namespace {

float occupancy_log_odds(double probability) {
  return static_cast<float>(math::log(probability / (1 - probability)));
}

}  // namespace

msg::OccupancyGrid to_message(const GridMap& map) {
  msg::OccupancyGrid out;
  out.info.resolution = static_cast<float>(map.geometry.resolution_m);
  out.info.width = static_cast<std::uint32_t>(map.geometry.width);
  out.info.height = static_cast<std::uint32_t>(map.geometry.height);
  out.info.origin = pose_from_rpy({map.geometry.origin.x, map.geometry.origin.y, 0},
                                  {0, 0, map.geometry.origin.theta});
  out.data = map.occupancy;
  return out;
}

Result<GridMap> from_message(const msg::OccupancyGrid& message) {
  if (message.info.width > max_side || message.info.height > max_side)
    return Error{"a map of " + std::to_string(message.info.width) + " x " +
                     std::to_string(message.info.height) + " cells is too large",
                 "at most " + std::to_string(max_side) + " cells a side"};
  const Quat q = message.info.origin.q;
  GridMap map{{static_cast<int>(message.info.width),
               static_cast<int>(message.info.height),
               static_cast<double>(message.info.resolution),
               {message.info.origin.p.x, message.info.origin.p.y,
                math::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))}},
              {}};
  SL_TRY(check_geometry(map.geometry));
  if (message.data.size() != map.geometry.cells())
    return Error{"the map has " + std::to_string(message.data.size()) + " cells of data",
                 "its size says " + std::to_string(map.geometry.cells())};
  map.occupancy = message.data;
  return map;
}

Result<OccupancyMapper> OccupancyMapper::make(const OccupancySpec& spec, const GridGeometry& geometry) {
  SL_TRY(check_ranges(spec));
  SL_TRY(check_geometry(geometry));
  return OccupancyMapper(spec, geometry);
}

OccupancyMapper::OccupancyMapper(const OccupancySpec& spec, const GridGeometry& geometry)
    : spec_(spec), geometry_(geometry), frame_(geometry) {
  state_.log_odds.assign(geometry.cells(), 0.0f);
  state_.seen.assign(geometry.cells(), 0);
  hit_ = occupancy_log_odds(spec.hit_probability);
  miss_ = occupancy_log_odds(spec.miss_probability);
  lowest_ = occupancy_log_odds(spec.min_probability);
  highest_ = occupancy_log_odds(spec.max_probability);
}

void OccupancyMapper::add(const msg::LaserScan& scan, const Pose2& X_ML) {
  if (!is_finite(X_ML) || !std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment)) return;
  const Vec2 from = frame_.to_grid({X_ML.x, X_ML.y});
  const double resolution = geometry_.resolution_m, reach = spec_.max_range_m / resolution;
  // Cells that this scan can change: a box about the laser, cut to the map.
  const double left = std::max(0.0, std::floor(from.x - reach)),
               right = std::min<double>(geometry_.width, from.x + reach + 1),
               low = std::max(0.0, std::floor(from.y - reach)),
               high = std::min<double>(geometry_.height, from.y + reach + 1);
  if (!(left < right && low < high)) return;
  const int x0 = static_cast<int>(left), y0 = static_cast<int>(low), columns = static_cast<int>(right) - x0,
            rows = static_cast<int>(high) - y0;
  if (columns < 1 || rows < 1) return;
  enum : std::uint8_t { untouched, passed, ended };
  std::vector<std::uint8_t> touched(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
                                    untouched);
  const auto mark = [&](Cell c) -> std::uint8_t* {
    const int x = c.x - x0, y = c.y - y0;
    if (x < 0 || y < 0 || x >= columns || y >= rows) return nullptr;
    return &touched[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(x)];
  };
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto range = static_cast<double>(scan.ranges[i]);
    if (std::isnan(range) || range <= 0 || range < static_cast<double>(scan.range_min)) continue;
    const bool echo = std::isfinite(range) && range < static_cast<double>(scan.range_max);
    if (!echo && !spec_.clear_without_echo) continue;
    const double farthest = std::min(spec_.max_range_m, static_cast<double>(scan.range_max));
    const double length = echo ? std::min(range, spec_.max_range_m) : farthest;
    if (!(length > 0)) continue;
    const auto [s, c] = math::sincos(X_ML.theta + static_cast<double>(scan.angle_min) +
                                     static_cast<double>(i) * static_cast<double>(scan.angle_increment));
    const Vec2 to = from + (length / resolution) * frame_.direction_to_grid({c, s});
    walk_cells(from, to, geometry_.width, geometry_.height, [&](Cell cell) {
      if (std::uint8_t* t = mark(cell); t && *t == untouched) *t = passed;
    });
    if (!echo || range > spec_.max_range_m) continue;
    const Cell last{static_cast<int>(std::floor(std::clamp(to.x, -2.0, 1e6))),
                    static_cast<int>(std::floor(std::clamp(to.y, -2.0, 1e6)))};
    if (std::uint8_t* t = mark(last)) *t = ended;
  }
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const std::uint8_t t = *mark({x0 + x, y0 + y});
      if (t == untouched) continue;
      const std::size_t i = geometry_.index({x0 + x, y0 + y});
      state_.seen[i] = 1;
      state_.log_odds[i] = std::clamp(state_.log_odds[i] + (t == ended ? hit_ : miss_), lowest_, highest_);
    }
}

GridMap OccupancyMapper::map() const {
  GridMap out{geometry_, {}};
  out.occupancy.resize(geometry_.cells(), GridMap::unknown);
  for (std::size_t i = 0; i < out.occupancy.size(); ++i)
    if (state_.seen[i])
      out.occupancy[i] = static_cast<std::int8_t>(
          std::lround(100 / (1 + math::exp(-static_cast<double>(state_.log_odds[i])))));
  return out;
}

bool OccupancyMapper::restore(OccupancyState state) {
  if (state.log_odds.size() != geometry_.cells() || state.seen.size() != geometry_.cells()) return false;
  state_ = std::move(state);
  return true;
}

}  // namespace sandlot::navigation
