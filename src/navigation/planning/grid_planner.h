#pragma once
/// Global planners on a cost map: A* (eight neighbours) and Theta* (any angle).
///
///   cost of a path = integral of (1 + cost_weight * cost / 252) along it [m]
///
/// Cells of inscribed and lethal cost are never entered, and no corner of one is cut. A* finds the least cost
/// among paths from cell to neighbouring cell. Theta* joins a cell to the parent of its predecessor where the
/// straight line is cheaper; it opens a cell again whenever its cost falls, so its path is never more expensive
/// than A*'s.
///
/// Frame    points in the map's frame.
/// Errors   start or goal not finite, off the map, or nearer to an obstacle than allowed; no way between them.
/// Limits   the robot is a disc of the cost map's inscribed radius; headings and turning radius: hybrid_astar.h.
///          Theta* is within a few percent of the shortest path, not optimal.
/// Cost     A*: about 0.35 us a visited cell, of which it visits few where the way is open; memory 14 bytes a cell.
///          Theta*: a line of sight where it may pay, about five times as long. Ties are broken by heuristic, then by
///          cell: the same path everywhere.
/// Source   P. E. Hart, N. J. Nilsson, B. Raphael (1968); K. Daniel, A. Nash, S. Koenig, A. Felner, Theta*:
///          any-angle path planning on grids (2010). Opening again and the integral of costs are ours.
#include <vector>

#include "navigation/maps/cost_map.h"

namespace sandlot::navigation {

enum class GridMethod : std::uint8_t { astar, theta };
std::span<const EnumName<GridMethod>> enum_names(GridMethod);

struct GridPlannerSpec {
  GridMethod method = GridMethod::theta;
  double cost_weight = 2;
  double start_tolerance_m = 0.25;
  double goal_tolerance_m = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"method", "", "Search of the global planner. astar: from cell to cell, theta: at any angle."},
          s.method);
    visit(Field{"cost_weight", "1", "Price of nearness to obstacles. 0: the shortest path.", 0, 100},
          s.cost_weight);
    visit(Field{"start_tolerance", "m",
                "Distance to the free cell that a robot in the inflated zone starts from.", 0, 10},
          s.start_tolerance_m);
    visit(Field{"goal_tolerance", "m", "Distance to the free cell that replaces a goal which is not free.", 0,
                100},
          s.goal_tolerance_m);
  }
};

struct GridPlan {
  std::vector<Vec2>
      points;  ///< corners of the path, from the start to the goal, or to the cell that replaced it
  double length_m = 0;
  double cost_m = 0;  ///< between the centres of the first and the last cell
  std::size_t expanded = 0;
};

Result<GridPlan> plan_grid(const CostMap& map, const GridPlannerSpec& spec, Vec2 start_M, Vec2 goal_M);

/// Nearest cell (by centres) to a point within a radius that is neither inscribed nor lethal; nothing if there
/// is none.
std::optional<Cell> nearest_free_cell(const CostMap& map, Vec2 point_M, double radius_m);

}  // namespace sandlot::navigation
