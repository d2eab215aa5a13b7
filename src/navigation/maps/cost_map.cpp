#include "navigation/maps/cost_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "navigation/maps/distance.h"

namespace sandlot::navigation {

Result<CostMap> make_cost_map(const GridMap& map, const InflationSpec& spec, double inscribed_m) {
  SL_TRY(check_ranges(spec));
  SL_TRY(check_geometry(map.geometry));
  if (!(inscribed_m >= 0 && inscribed_m <= 1e3))
    return Error{"an inscribed radius of " + number_text(inscribed_m) + " m", "it must lie in [0, 1000] m"};
  const std::size_t cells = map.geometry.cells();
  if (map.occupancy.size() != cells)
    return Error{"the map has " + std::to_string(map.occupancy.size()) + " cells of data",
                 "its size says " + std::to_string(cells)};

  CostMap out{map.geometry, std::vector<std::uint8_t>(cells), std::vector<float>(cells)};
  std::vector<std::uint8_t> marked(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    const int percent = map.occupancy[i];
    out.cost[i] = percent < 0                        ? static_cast<std::uint8_t>(spec.unknown_cost)
                  : percent >= spec.occupied_percent ? lethal_cost
                                                     : std::uint8_t{0};
    marked[i] = out.cost[i] == lethal_cost;
  }
  const std::vector<std::uint32_t> squares = squared_distances(marked, map.geometry.width,
                                                               map.geometry.height);

  // Cost by squared distance, worked out once for each value that occurs within the radius.
  const double resolution = map.geometry.resolution_m,
               radius_cells = std::max(spec.inflation_radius_m, inscribed_m) / resolution;
  constexpr double table_limit = 1 << 22;
  std::vector<std::uint8_t> table(
      static_cast<std::size_t>(std::min(radius_cells * radius_cells, table_limit)) + 1);
  const auto price = [&](double distance_m) {
    if (distance_m == 0) return lethal_cost;
    if (distance_m <= inscribed_m) return inscribed_cost;
    if (distance_m > spec.inflation_radius_m) return std::uint8_t{0};
    return static_cast<std::uint8_t>((inscribed_cost - 1) *
                                     math::exp(-spec.cost_scaling_per_m * (distance_m - inscribed_m)));
  };
  for (std::size_t square = 0; square < table.size(); ++square)
    table[square] = price(std::sqrt(static_cast<double>(square)) * resolution);
  for (std::size_t i = 0; i < cells; ++i) {
    if (squares[i] == no_distance) {
      out.distance_m[i] = std::numeric_limits<float>::infinity();
      continue;
    }
    const double distance = std::sqrt(static_cast<double>(squares[i])) * resolution;
    out.distance_m[i] = static_cast<float>(distance);
    const std::uint8_t inflated = squares[i] < table.size() ? table[squares[i]] : price(distance);
    out.cost[i] = std::max(out.cost[i], inflated);
  }
  return out;
}

}  // namespace sandlot::navigation
