#pragma once
/// Hybrid A*: path of poses for robots with a turning radius, and for those that also drive sideways or turn on
/// the spot.
///
/// Moves of one step from each pose: straight, and arcs at the turning radius and at twice it, forward; the same
/// backward; to six sides (Mecanum, omni, four-wheel steering in crab mode); turns on the spot. Cells of (x, y,
/// heading) keep the cheapest pose that reached them, so poses are not rounded to cells. From time to time the
/// goal is tried directly: Reeds-Shepp, Dubins without backward, or turn - straight - turn.
///
///   price = integral of factor (1 + cost_weight cost / 252) over the metres + changes + turns on the spot
///
/// Frame    poses in the map's frame, of the footprint's origin (the middle of the rear axle of a car).
/// Errors   start or goal not finite, off the map or with the footprint in an obstacle; no way; no way within
///          max_expansions.
/// Unknown  with `known`, moves backward and sideways lead over what is known to be free alone.
/// Limits   the footprint is checked at poses at most half a cell (and of a turn, half a cell of the outermost
///          corner) apart: corners may cut an obstacle by a small part of that. Near the optimum, not optimal.
///          Steering and driving direction change at once, at the given price.
/// Cost     10 to 50 us an expansion; two times 12 bytes a cell for the heuristic.
/// Source   D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel, Path planning for autonomous vehicles in unknown
///          semi-structured environments (2010). Sideways moves, turns and the open list's goal are ours.
#include <functional>
#include <vector>

#include "navigation/maps/footprint.h"
#include "navigation/planning/motion.h"

namespace sandlot::navigation {

struct HybridSpec {
  double turning_radius_m = 1;
  bool backward = true, sideways = false, turn_on_spot = false;
  double step_m = 0.3;
  int headings = 72;
  double backward_factor = 2, sideways_factor = 1.5, arc_factor = 1.05;
  double change_price_m = 0.5, turn_price_mprad = 0.3;
  double cost_weight = 1;
  double goal_tolerance_m = 0.1, goal_tolerance_rad = 0.1;
  int max_expansions = 200'000;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"turning_radius", "m", "Least radius of an arc.", 0.01, 1000}, s.turning_radius_m);
    visit(Field{"backward", "", "Whether the robot drives backward."}, s.backward);
    visit(Field{"sideways", "", "Whether the robot drives sideways: Mecanum, omni, four steered wheels."},
          s.sideways);
    visit(Field{"turn_on_spot", "", "Whether the robot turns on the spot."}, s.turn_on_spot);
    visit(Field{"step", "m", "Length of a move of the search; at least two cells.", 0.01, 100}, s.step_m);
    visit(Field{"headings", "1", "Number of headings that count as different.", 8, 720}, s.headings);
    visit(Field{"backward_factor", "1", "Price of a metre backward; forward: 1.", 1, 100}, s.backward_factor);
    visit(Field{"sideways_factor", "1", "Price of a metre sideways; forward: 1.", 1, 100}, s.sideways_factor);
    visit(Field{"arc_factor", "1", "Price of a metre on an arc; straight: 1.", 1, 100}, s.arc_factor);
    visit(Field{"change_price", "m", "Price of a change of the driving direction.", 0, 1000},
          s.change_price_m);
    visit(Field{"turn_price", "m/rad", "Price of a turn on the spot.", 0.001, 1000}, s.turn_price_mprad);
    visit(Field{"cost_weight", "1", "Price of nearness to obstacles. 0: the shortest path.", 0, 100},
          s.cost_weight);
    visit(Field{"goal_tolerance", "m", "Distance from the goal at which it is reached.", 0, 10},
          s.goal_tolerance_m);
    visit(Field{"goal_tolerance_angle", "rad", "Difference of heading at which the goal is reached.", 0,
                math::pi},
          s.goal_tolerance_rad);
    visit(Field{"max_expansions", "1", "Number of poses after which the search gives up.", 1, 10'000'000},
          s.max_expansions);
  }
};

struct HybridPlan {
  std::vector<PathPose> poses;  ///< the start, then poses at most half a cell apart
  std::vector<Move> moves;      ///< from the start to the goal
  double length_m = 0;          ///< without turns on the spot
  double price = 0;
  std::size_t expanded = 0;
};

/// Whether a move leads where a robot whose sensors look ahead may not see: backward or sideways.
inline bool is_blind(Vec2 direction_B) { return direction_B.x < 0 || direction_B.y != 0; }

/// @param known  whether all that the robot covers at a pose is known to be free: blind moves lead to such poses alone; none: the
///               map knows all
Result<HybridPlan> plan_hybrid(const CostMap& map, const Footprint& footprint, const HybridSpec& spec,
                               const Pose2& start, const Pose2& goal,
                               const std::function<bool(const Pose2&)>& known = {});

}  // namespace sandlot::navigation
