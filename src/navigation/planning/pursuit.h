#pragma once
/// Regulated pure pursuit: follows a path of poses.
///
///   target    the point of the path at the lookahead distance L = clamp(lookahead_time |v|, min, max)
///   curvature 2 y / (x^2 + y^2) of the arc to the target (x, y) in the robot's frame;  w = v curvature
///   speed     reduced in curves tighter than curve_radius, near obstacles, and on the way to an end
///
/// Near a straight line an offset follows y'' + 2 (v/L) y' + 2 (v/L)^2 y = 0: damping ratio 1/sqrt(2). A robot
/// that turns on the spot first turns towards a target that lies aside. An omnidirectional one drives straight to
/// the target and turns to the path's heading meanwhile. A path's sections (forward, backward, turn) are driven
/// one after the other.
///
/// Frame    path and pose in the map's frame, the command in the robot's.
/// Errors   none: an empty path or a pose that is not finite stops the robot and is reported as `lost`.
/// Limits   no check of collisions but by slowing down: that is the local planner's (dwa.h). Kinematic: slip and
///          latency act as a disturbance. Paths of at most 2^31 poses.
/// Cost     about 1 us; no allocation.
/// Source   R. C. Coulter, Implementation of the pure pursuit path tracking algorithm (1992); S. Macenski et al.,
///          Regulated pure pursuit for robot path tracking (2023), as in Nav2 1.1. Sections, and the distance map
///          in place of costs, are ours.
#include <span>

#include "navigation/maps/cost_map.h"
#include "navigation/planning/motion.h"

namespace sandlot::navigation {

enum class Drive : std::uint8_t { differential, car, omni };
std::span<const EnumName<Drive>> enum_names(Drive);

struct PursuitSpec {
  Drive drive = Drive::differential;
  double speed_mps = 0.5, backward_speed_mps = 0.5, sideways_speed_mps = 0.5, min_speed_mps = 0.05,
         acceleration_mps2 = 0.5;
  double lookahead_time_s = 1.5, min_lookahead_m = 0.3, max_lookahead_m = 1;
  double max_turn_rate_radps = 1.5, turn_acceleration_radps2 = 3;
  double turning_radius_m = 1;
  double curve_radius_m = 0.9;
  double obstacle_distance_m = 0.6;
  double approach_distance_m = 0.6;
  double turn_first_rad = 0.8;
  double goal_tolerance_m = 0.1, goal_tolerance_rad = 0.1;
  double max_deviation_m = 2;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"drive", "",
                "Motions of the robot. differential: turns on the spot, car: has a turning radius, "
                "omni: drives to any side."},
          s.drive);
    visit(Field{"speed", "m/s", "Speed on a free straight.", 0.001, 100}, s.speed_mps);
    visit(Field{"backward_speed", "m/s", "Speed backward, at most.", 0.001, 100}, s.backward_speed_mps);
    visit(Field{"sideways_speed", "m/s", "Speed sideways of an omnidirectional robot, at most.", 0.001, 100},
          s.sideways_speed_mps);
    visit(Field{"min_speed", "m/s", "Speed that slowing down does not go below.", 0.001, 100},
          s.min_speed_mps);
    visit(Field{"acceleration", "m/s^2", "Greatest change of speed.", 0.001, 1000}, s.acceleration_mps2);
    visit(Field{"lookahead_time", "s", "Lookahead distance per speed.", 0.01, 100}, s.lookahead_time_s);
    visit(Field{"min_lookahead", "m", "Shortest lookahead distance.", 0.01, 100}, s.min_lookahead_m);
    visit(Field{"max_lookahead", "m", "Longest lookahead distance.", 0.01, 100}, s.max_lookahead_m);
    visit(Field{"max_turn_rate", "rad/s", "Greatest turn rate.", 0.01, 100}, s.max_turn_rate_radps);
    visit(Field{"turn_acceleration", "rad/s^2", "Deceleration that ends a turn on the spot.", 0.01, 1000},
          s.turn_acceleration_radps2);
    visit(Field{"turning_radius", "m", "Least radius of a car's arcs.", 0.01, 1000}, s.turning_radius_m);
    visit(Field{"curve_radius", "m", "Radius below which curves are driven slower.", 0, 1000},
          s.curve_radius_m);
    visit(Field{"obstacle_distance", "m",
                "Distance from obstacles below which the robot slows down. 0: never.", 0, 1000},
          s.obstacle_distance_m);
    visit(Field{"approach_distance", "m", "Distance before an end from which the robot slows down.", 0, 1000},
          s.approach_distance_m);
    visit(Field{"turn_first", "rad", "Angle to the target from which a robot turns on the spot first.", 0.01,
                math::pi},
          s.turn_first_rad);
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

struct PursuitState {
  std::uint32_t at = 0;  ///< pose of the path that the robot has come to
  bool turning = false;  ///< turns on the spot
  double speed_mps = 0;  ///< of the last command, negative backward
  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "1", "Index of the path's pose that the robot has come to.", 0, 4294967295.0}, s.at);
    visit(Field{"turning", "", "Whether the robot turns on the spot."}, s.turning);
    visit(Field{"speed", "m/s", "Speed of the last command, negative backward."}, s.speed_mps);
  }
};

enum class Following : std::uint8_t {
  driving,
  arrived,
  missed,  ///< passed the path's end further aside than the tolerance: plan again
  lost     ///< no path, no pose, or too far from the path
};

struct PursuitStep {
  Following status = Following::lost;
  PlanarTwist command;
  Vec2 target_M;           ///< the point pursued
  double deviation_m = 0;  ///< distance from the path
};

/// @param state  of a path: begins anew ({}) with each
/// @param map    slows the robot near obstacles; null: no map
/// @param dt_s   since the last step, > 0
/// @pre   the spec's numbers lie in their ranges (check_ranges)
PursuitStep pursue(const PursuitSpec& spec, PursuitState& state, std::span<const PathPose> path,
                   const Pose2& X_MB, const CostMap* map, double dt_s);

}  // namespace sandlot::navigation
