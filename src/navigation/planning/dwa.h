#pragma once
/// Dynamic window approach: velocity for the next moment, chosen among those that the robot can reach and stop
/// from.
///
/// Samples (vx, vy, w) from the window of the present velocity +- acceleration * period, cut to the limits. Each
/// is driven over the horizon as an arc; the footprint is checked against the map, and against discs that move on
/// with their velocities. One after which the robot could not stop along its arc without touching something is
/// dropped: when a disc turns towards it, it stands. First the arc of pure pursuit to the path's point `lookahead` ahead, or to
/// nearer ones, is tried: if it is clear as far as that point, and of discs over the horizon, it is driven. So the robot keeps to
/// the straight way of its plan. Else, of the samples, the least sum wins:
///
///   goal * |end - target| + path * |end - path| + heading * |angle at the end to the target|
///     + obstacle * greatest cost / 252 + contact * (1 - time to contact / horizon)
///
/// The target is the path's point `lookahead` ahead. At the goal the robot turns to the last pose's heading.
///
/// Frame    map, path, pose and discs in M, velocities in the robot's frame.
/// Errors   none: no path or no pose stops the robot (lost); without an admissible velocity it brakes (blocked).
/// Limits   checked at poses half a cell apart: give a footprint that is larger by as much (Footprint::grown).
///          Velocities are constant over the horizon, for the discs too. No latency. A car's steering is not
///          sampled: differential and omnidirectional robots (lateral limits of 0: differential).
/// Cost     samples * horizon / step footprints: 105 * 40, about 0.5 ms; no random numbers.
/// Source   D. Fox, W. Burgard, S. Thrun, The dynamic window approach to collision avoidance (1997); critics as
///          in Nav2's dwb_critics. Discs, and the exact footprint, are ours.
#include <span>

#include "navigation/maps/footprint.h"
#include "navigation/planning/motion.h"

namespace sandlot::navigation {

struct DwaSpec {
  double max_vx_mps = 0.6, min_vx_mps = -0.1, max_vy_mps = 0, max_w_radps = 1.5;
  double acceleration_mps2 = 0.8, turn_acceleration_radps2 = 3;
  double period_s = 0.1, horizon_s = 1.6;
  int vx_samples = 7, vy_samples = 5, w_samples = 15;
  double lookahead_m = 0.8, disc_clearance_m = 0.1, turn_first_rad = 0.8;
  double goal_weight = 1, path_weight = 0.6, heading_weight = 0.1, obstacle_weight = 0.2,
         contact_weight = 1.5;
  double goal_tolerance_m = 0.15, goal_tolerance_rad = 0.15, max_deviation_m = 3;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"max_vx", "m/s", "Greatest speed forward.", 0, 100}, s.max_vx_mps);
    visit(Field{"min_vx", "m/s", "Least velocity forward. Negative: the robot may back up.", -100, 0},
          s.min_vx_mps);
    visit(Field{"max_vy", "m/s", "Greatest speed sideways. 0: a differential robot.", 0, 100}, s.max_vy_mps);
    visit(Field{"max_w", "rad/s", "Greatest turn rate.", 0.01, 100}, s.max_w_radps);
    visit(Field{"acceleration", "m/s^2", "Greatest change of speed, in each direction.", 0.01, 1000},
          s.acceleration_mps2);
    visit(Field{"turn_acceleration", "rad/s^2", "Greatest change of the turn rate.", 0.01, 1000},
          s.turn_acceleration_radps2);
    visit(Field{"period", "s", "Time between two choices.", 0.001, 10}, s.period_s);
    visit(Field{"horizon", "s", "Time over which a velocity is tried.", 0.01, 60}, s.horizon_s);
    visit(Field{"vx_samples", "1", "Number of velocities forward.", 2, 1000}, s.vx_samples);
    visit(Field{"vy_samples", "1", "Number of velocities sideways.", 1, 1000}, s.vy_samples);
    visit(Field{"w_samples", "1", "Number of turn rates.", 2, 1000}, s.w_samples);
    visit(Field{"lookahead", "m", "Distance along the path of the point that is driven to.", 0.01, 100},
          s.lookahead_m);
    visit(Field{"disc_clearance", "m", "Distance kept from moving obstacles.", 0, 10}, s.disc_clearance_m);
    visit(
        Field{
            "turn_first", "rad",
            "Angle to the point that is driven to, from which a differential robot turns on the spot first.",
            0.01, math::pi},
        s.turn_first_rad);
    visit(Field{"goal_weight", "1/m", "Weight of the distance to the point that is driven to.", 0, 1000},
          s.goal_weight);
    visit(Field{"path_weight", "1/m", "Weight of the distance from the path.", 0, 1000}, s.path_weight);
    visit(Field{"heading_weight", "1/rad", "Weight of the angle to the point that is driven to.", 0, 1000},
          s.heading_weight);
    visit(Field{"obstacle_weight", "1", "Weight of the greatest cost on the way.", 0, 1000},
          s.obstacle_weight);
    visit(Field{"contact_weight", "1", "Weight of a contact within the horizon.", 0, 1000}, s.contact_weight);
    visit(Field{"goal_tolerance", "m", "Distance from the goal at which it is reached.", 0.001, 10},
          s.goal_tolerance_m);
    visit(Field{"goal_tolerance_angle", "rad", "Difference of heading at which the goal is reached.", 0.001,
                math::pi},
          s.goal_tolerance_rad);
    visit(
        Field{"max_deviation", "m", "Distance from the path at which the robot counts as lost.", 0.01, 1000},
        s.max_deviation_m);
  }
};

/// Obstacle that is not in the map.
struct MovingDisc {
  Vec2 centre_M, velocity_M_mps;
  double radius_m = 0;
};

struct DwaState {
  std::uint32_t at = 0;  ///< pose of the path that the robot has come to
  bool turning = false;  ///< has come to the goal and turns to its heading
  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "1", "Index of the path's pose that the robot has come to.", 0, 4294967295.0}, s.at);
    visit(Field{"turning", "", "Whether the robot is at the goal and turns to its heading."}, s.turning);
  }
};

enum class Driving : std::uint8_t { driving, arrived, blocked, lost };

struct DwaStep {
  Driving status = Driving::lost;
  PlanarTwist command;
  Vec2 target_M;
  double clear_s = 0;  ///< time until the command would touch something; the horizon if it does not
};

/// @param state     of a path: begins anew ({}) with each
/// @param velocity  of the robot at present, in its frame
/// @pre   the spec's numbers lie in their ranges (check_ranges)
DwaStep choose_velocity(const DwaSpec& spec, DwaState& state, const CostMap& map, const Footprint& footprint,
                        std::span<const PathPose> path, const Pose2& X_MB, const PlanarTwist& velocity,
                        std::span<const MovingDisc> discs);

/// Distance from the footprint's outline at a pose to a point; negative inside a circle, 0 inside a polygon.
double footprint_distance(const Footprint& footprint, const Pose2& X_MB, Vec2 point_M);

}  // namespace sandlot::navigation
