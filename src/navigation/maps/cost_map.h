#pragma once
/// Cost map: how near each cell of a grid map lies to an obstacle, as planners price it.
///
///   254  lethal       an obstacle
///   253  inscribed    an obstacle nearer than the robot's inscribed radius r: its middle can't be here
///   252  ... 1        252 exp(-cost_scaling (d - r)), rounded down, for d <= inflation_radius
///   0    free
///
/// d is the exact Euclidean distance between cell centres (maps/distance.h).
///
/// Frame    the map's.
/// Errors   those of check_geometry(), of the spec's ranges, and a map whose data does not fit its size.
/// Limits   one layer: obstacles, inflation. The inscribed test counts from centre to centre, so a path over
///          free cells may pass an obstacle's edge by up to half a cell's diagonal nearer than r; a footprint
///          is checked exactly by footprint_contact().
/// Cost     linear in the number of cells, about 30 ns each.
/// Source   Nav2 1.1 (Humble), nav2_costmap_2d/plugins/inflation_layer.cpp; the distance is exact here.
#include <vector>

#include "navigation/maps/occupancy.h"

namespace sandlot::navigation {

inline constexpr std::uint8_t lethal_cost = 254, inscribed_cost = 253;

struct InflationSpec {
  double inflation_radius_m = 0.55;
  double cost_scaling_per_m = 10;
  int occupied_percent = 65;
  int unknown_cost = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"inflation_radius", "m", "Distance from an obstacle at which cells become free of cost.", 0,
                1e3},
          s.inflation_radius_m);
    visit(Field{"cost_scaling", "1/m", "Decay of the cost with the distance from an obstacle.", 0, 1e4},
          s.cost_scaling_per_m);
    visit(Field{"occupied", "%", "Occupancy from which a cell is an obstacle.", 1, 100}, s.occupied_percent);
    visit(Field{"unknown_cost", "1", "Cost of an unknown cell. 0: free, 254: an obstacle.", 0, 254},
          s.unknown_cost);
  }
};

struct CostMap {
  GridGeometry geometry;
  std::vector<std::uint8_t> cost;
  /// From the centre of each cell to that of the nearest obstacle; infinite in a map without obstacles.
  std::vector<float> distance_m;
};

/// @param inscribed_m  radius of the largest circle about the robot's origin within its footprint
Result<CostMap> make_cost_map(const GridMap& map, const InflationSpec& spec, double inscribed_m);

}  // namespace sandlot::navigation
