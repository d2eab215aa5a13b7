#pragma once
/// Navigator: drives a robot to goals on a map, around what its laser sees.
///
///   scan -> obstacle layer, tracker of moving discs -> local cost map (a window about the robot)
///   goal -> global plan (Theta*/A*, or hybrid A* for car and four_wheel_steer), again at plan_rate or when blocked
///   plan -> velocity: dynamic window (differential, omni), regulated pursuit with a check of contacts (car,
///           four_wheel_steer) -> recovery: clear, wait, back up, turn; then failed with the reason
///
/// A new plan replaces a free old one only if it is a tenth shorter, and a gap that was found blocked twice stays closed for this
/// goal while there is another way: the robot does not waver. Objects that move are taken out of the global map and avoided as discs
/// with a velocity, too. Backwards and sideways the robot drives only over what its laser saw, or what it drove over.
///
/// Frame    M, that of the pose and of the map. Velocities in the robot's frame. Without a static map, a square of
///          `area` about the first pose.
/// Errors   goals that are not finite, off the map, or in an obstacle of the static map are refused with the
///          reason at once; others fail with it after the rounds of recovery, after twice as many recoveries that bring
///          the robot no nearer, and after `time_limit` at the latest.
///          Without a pose, or with one less certain than max_pose_std, the robot stands.
/// Limits   obstacles in the plane of the laser. A goal outside the area is never reached: no rolling map.
///          The first pose is taken as free. Gaps that were found blocked stay closed for differential and omni alone. A car's local plan
///          is its global one: it stops before obstacles and plans again. Latency of the drive is not modelled.
/// Cost     a step: local map about 40 ns a cell of the window (0.4 ms at 5 m and 0.05 m), dynamic window 0.5 ms; a scan 0.1 ms; a
///          plan some milliseconds, with the global map 40 ns a cell. Memory: three bytes a cell of the area, 20 during a plan;
///          a plan has at most max_poses.
/// Source   the structure and the names of feedback are those of Nav2 1.1 (NavigateToPose).
#include <array>
#include <optional>
#include <string>

#include "navigation/planning/disc_tracker.h"
#include "navigation/planning/grid_planner.h"
#include "navigation/planning/hybrid_astar.h"
#include "navigation/planning/pursuit.h"
#include "navigation/planning/recovery.h"

namespace sandlot::navigation {

enum class Chassis : std::uint8_t { differential, omni, car, four_wheel_steer };
std::span<const EnumName<Chassis>> enum_names(Chassis);

struct NavigatorLimits {
  double speed_mps = 0.6, backward_mps = 0.15, sideways_mps = 0.4, turn_radps = 1.5;
  double acceleration_mps2 = 0.8, turn_acceleration_radps2 = 3;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"speed", "m/s", "Greatest speed forward.", 0.01, 100}, s.speed_mps);
    visit(Field{"backward", "m/s", "Greatest speed backward.", 0, 100}, s.backward_mps);
    visit(Field{"sideways", "m/s", "Greatest speed sideways of omni and four_wheel_steer.", 0.01, 100},
          s.sideways_mps);
    visit(Field{"turn_rate", "rad/s", "Greatest turn rate.", 0.01, 100}, s.turn_radps);
    visit(Field{"acceleration", "m/s^2", "Greatest change of speed.", 0.01, 1000}, s.acceleration_mps2);
    visit(Field{"turn_acceleration", "rad/s^2", "Greatest change of the turn rate.", 0.01, 1000},
          s.turn_acceleration_radps2);
  }
};

struct NavigatorSpec {
  Chassis chassis = Chassis::differential;
  double radius_m = 0.25;
  std::vector<std::array<double, 2>> footprint_m;
  double margin_m = 0.03;
  double turning_radius_m = 1;
  NavigatorLimits limits;
  double area_m = 20, resolution_m = 0.05, window_m = 5;
  double plan_rate_hz = 1;
  double lookahead_m = 0.8, horizon_s = 1.6, disc_clearance_m = 0.15;
  double goal_tolerance_m = 0.15, goal_tolerance_rad = 0.15;
  double patience_s = 1, time_limit_s = 600, max_pose_std_m = 0.5;
  ObstacleLayerSpec obstacles;
  TrackerSpec tracker;
  InflationSpec inflation;
  GridPlannerSpec planner{.cost_weight = 1, .start_tolerance_m = 0.4};
  RecoverySpec recovery;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"chassis", "",
                "Motions of the robot. differential: turns on the spot, omni: drives to any side, car: has a "
                "turning radius, four_wheel_steer: all of these."},
          s.chassis);
    visit(Field{"radius", "m", "Radius of a round robot; unused with a footprint.", 0.01, 100}, s.radius_m);
    visit(Field{"footprint", "m", "Corners [x, y] of the robot's outline; empty: round.", -100, 100,
                Field::none, 100},
          s.footprint_m);
    visit(Field{"margin", "m", "Distance kept from obstacles, in addition to half a cell.", 0, 10},
          s.margin_m);
    visit(
        Field{"turning_radius", "m", "Least radius of arcs of a car or of four steered wheels.", 0.01, 1000},
        s.turning_radius_m);
    visit(Field{"limits", "", "Greatest velocities and accelerations."}, s.limits);
    visit(Field{"area", "m", "Side of the square about the first pose that is mapped without a static map.",
                1, 1e4},
          s.area_m);
    visit(Field{"resolution", "m", "Side of a cell without a static map.", 0.005, 10}, s.resolution_m);
    visit(Field{"window", "m", "Side of the local cost map about the robot.", 1, 100}, s.window_m);
    visit(Field{"plan_rate", "Hz", "Number of global plans per second.", 0.01, 100}, s.plan_rate_hz);
    visit(Field{"lookahead", "m", "Distance along the plan of the point that is driven to.", 0.05, 100},
          s.lookahead_m);
    visit(Field{"horizon", "s", "Time over which velocities are tried.", 0.1, 20}, s.horizon_s);
    visit(Field{"disc_clearance", "m", "Distance kept from moving obstacles.", 0, 10}, s.disc_clearance_m);
    visit(Field{"goal_tolerance", "m", "Distance from the goal at which it is reached.", 0.005, 10},
          s.goal_tolerance_m);
    visit(Field{"goal_tolerance_angle", "rad", "Difference of heading at which the goal is reached.", 0.005,
                math::pi},
          s.goal_tolerance_rad);
    visit(Field{"patience", "s", "Time without a way or a free velocity before a recovery.", 0, 600},
          s.patience_s);
    visit(Field{"time_limit", "s", "Time after which a goal is given up.", 1, 1e6}, s.time_limit_s);
    visit(Field{"max_pose_std", "m", "Standard deviation of the position above which the robot stands.", 1e-3,
                1e3},
          s.max_pose_std_m);
    visit(Field{"obstacles", "", "Layer of obstacles that the laser sees."}, s.obstacles);
    visit(Field{"tracker", "", "Tracker of moving obstacles."}, s.tracker);
    visit(Field{"inflation", "", "Inflation of obstacles in both cost maps."}, s.inflation);
    visit(Field{"planner", "", "Global planner of differential and omni chassis."}, s.planner);
    visit(Field{"recovery", "", "Recovery of a robot that gets no further."}, s.recovery);
  }
};

enum class NavStatus : std::uint8_t { idle, planning, following, recovering, reached, failed };
std::span<const EnumName<NavStatus>> enum_names(NavStatus);

struct NavGoal {
  Pose2 pose;
  bool heading = true;  ///< whether the pose's heading counts
};

struct PlanPose {
  double x_m = 0, y_m = 0, theta_rad = 0, dx = 1, dy = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Place, x."}, s.x_m);
    visit(Field{"y", "m", "Place, y."}, s.y_m);
    visit(Field{"theta", "rad", "Heading of the pose."}, s.theta_rad);
    visit(Field{"dx", "1", "Direction of travel in the robot's frame, x."}, s.dx);
    visit(Field{"dy", "1", "Direction of travel in the robot's frame, y."}, s.dy);
  }
};

/// Place at which a plan was found blocked on the way.
struct BlockedPlace {
  double x_m = 0, y_m = 0;
  std::uint32_t times = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Place, x."}, s.x_m);
    visit(Field{"y", "m", "Place, y."}, s.y_m);
    visit(Field{"times", "1", "Number of plans that were found blocked there."}, s.times);
  }
};

struct NavigatorState {
  static constexpr std::size_t max_poses = 20'000, max_blocked = 100;
  NavStatus status = NavStatus::idle;
  std::string reason;  ///< of a failure or a recovery
  double goal_x_m = 0, goal_y_m = 0, goal_theta_rad = 0;
  bool goal_heading = true;
  bool placed = false;  ///< whether the area has its place
  double area_x_m = 0, area_y_m = 0;
  ObstacleLayerState layer;
  TrackerState tracker;
  std::vector<PlanPose> plan;
  std::vector<BlockedPlace> blocked;
  DwaState dwa;
  PursuitState pursuit;
  RecoveryState recovery;
  double since_plan_s = 0, failing_s = 0, time_s = 0, speed_mps = 0;
  bool plan_wanted = false;
  std::uint32_t recoveries = 0, plans = 0;
  double nearest_m = 1e9;  ///< least way to the goal that was left, in steps of `navigator_nearer_m`
  std::uint32_t vain = 0;  ///< recoveries since then
  double last_vx_mps = 0, last_vy_mps = 0, last_w_radps = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"status", "", "Status of the goal."}, s.status);
    visit(Field{"reason", "", "Reason of a failure or a recovery."}, s.reason);
    visit(Field{"goal_x", "m", "Place of the goal, x."}, s.goal_x_m);
    visit(Field{"goal_y", "m", "Place of the goal, y."}, s.goal_y_m);
    visit(Field{"goal_theta", "rad", "Heading of the goal."}, s.goal_theta_rad);
    visit(Field{"goal_heading", "", "Whether the goal's heading counts."}, s.goal_heading);
    visit(Field{"placed", "", "Whether the mapped area has its place."}, s.placed);
    visit(Field{"area_x", "m", "Corner of the mapped area, x."}, s.area_x_m);
    visit(Field{"area_y", "m", "Corner of the mapped area, y."}, s.area_y_m);
    visit(Field{"layer", "", "Obstacles that the laser saw."}, s.layer);
    visit(Field{"tracker", "", "Objects that are tracked."}, s.tracker);
    visit(Field{"plan", "", "Global plan.", 0, 0, Field::none, max_poses}, s.plan);
    visit(Field{"blocked", "", "Places where plans for this goal were found blocked.", 0, 0, Field::none,
                max_blocked},
          s.blocked);
    visit(Field{"dwa", "", "Progress of the dynamic window."}, s.dwa);
    visit(Field{"pursuit", "", "Progress of the pursuit."}, s.pursuit);
    visit(Field{"recovery", "", "Stage of the recovery."}, s.recovery);
    visit(Field{"since_plan", "s", "Time since the last plan."}, s.since_plan_s);
    visit(Field{"failing", "s", "Time without a way or a free velocity."}, s.failing_s);
    visit(Field{"navigation_time", "s", "Time since the goal was set."}, s.time_s);
    visit(Field{"mean_speed", "m/s", "Recent mean of the speed."}, s.speed_mps);
    visit(Field{"plan_wanted", "", "Whether a plan is wanted at once."}, s.plan_wanted);
    visit(Field{"number_of_recoveries", "1", "Number of recoveries since the goal was set."}, s.recoveries);
    visit(Field{"plans", "1", "Number of plans since the goal was set."}, s.plans);
    visit(Field{"nearest", "m", "Least way to the goal that was left, in coarse steps."}, s.nearest_m);
    visit(Field{"vain_recoveries", "1", "Number of recoveries since the robot came nearer to the goal."},
          s.vain);
    visit(Field{"last_vx", "m/s", "Velocity forward of the last command."}, s.last_vx_mps);
    visit(Field{"last_vy", "m/s", "Velocity to the left of the last command."}, s.last_vy_mps);
    visit(Field{"last_w", "rad/s", "Turn rate of the last command."}, s.last_w_radps);
  }
};

struct NavigatorInput {
  std::optional<Pose2> X_MB;
  double pose_std_m = 0;                 ///< standard deviation of the position
  std::optional<PlanarTwist> velocity;   ///< measured; none: the last command
  const msg::LaserScan* scan = nullptr;  ///< a new one, or none
  Pose X_BL;                             ///< of the laser on the robot
  double scan_age_s = 0;                 ///< time since the scan was taken
  double dt_s = 0.1;                     ///< since the last step, > 0
};

/// Feedback in the names of Nav2's NavigateToPose.
struct NavigatorFeedback {
  double distance_remaining_m = 0, estimated_time_remaining_s = 0, navigation_time_s = 0;
  std::uint32_t number_of_recoveries = 0;
};

struct NavigatorStep {
  NavStatus status = NavStatus::idle;
  PlanarTwist command;
  NavigatorFeedback feedback;
  bool new_plan = false;
};

class Navigator {
 public:
  /// Errors: numbers out of range, a footprint that is none, a map that does not fit its size.
  static Result<Navigator> make(const NavigatorSpec& spec, double period_s, std::optional<GridMap> map);

  /// Begins to drive to a goal. Errors: not finite, off the map, in an obstacle of the static map; the status
  /// is `failed` then.
  Status set_goal(const NavGoal& goal);
  void cancel();
  NavigatorStep step(const NavigatorInput& in);

  const NavigatorState& state() const { return state_; }
  /// Moves the state out, for an owner that keeps it; restore() must give one back before anything else is called.
  NavigatorState take_state() { return std::move(state_); }
  /// Takes back a saved state; false, and no change, if its sizes do not fit.
  bool restore(NavigatorState state);
  const CostMap& local_map() const { return local_; }
  std::span<const PathPose> plan() const { return plan_; }
  /// Poses that the last command leads to within the horizon.
  std::span<const Pose2> local_plan() const { return local_plan_; }
  std::span<const MovingDisc> discs() const { return discs_; }
  const GridGeometry& area() const { return area_; }

 private:
  Navigator(const NavigatorSpec& spec, const Footprint& footprint, const Footprint& grown);
  bool by_dwa() const { return spec_.chassis <= Chassis::omni; }  ///< else the pursuit drives
  void place_area(const Pose2& X);
  void observe(const NavigatorInput& in, const Pose2& X);
  /// Obstacles of a part of the area.
  GridMap obstacles(Cell corner, int width, int height, bool with_moving) const;
  Status rebuild_local(const Pose2& X);
  Status make_plan(const Pose2& X);
  Result<std::vector<PathPose>> grid_path(CostMap map, const Pose2& X);
  /// First pose ahead on the plan that is blocked; nothing if it is free.
  std::optional<Pose2> blocked_pose() const;
  /// Remembers that a plan was blocked at a pose.
  void note_blocked(const Pose2& at);
  /// The same where the outline of a robot that is stuck touches something.
  void note_stuck();
  /// Outline for checks of contacts: without the margin, or smaller, for a robot that is nearer already, so that it can leave.
  Footprint fitting_footprint(const Pose2& X) const;
  void mark_driven(const Pose2& X);
  /// Whether nothing that the robot covers at a pose is unknown. @param slack_m  width of its rim that does not count
  bool pose_known(const Pose2& X, double slack_m = 0) const;
  bool motion_known(const Pose2& X, const PlanarTwist& v, double slack_m = 0) const;
  double remaining(const Pose2& X) const;
  /// The same arc at velocities within the limits: a robot is measured to be faster by mistake, too.
  PlanarTwist within_limits(const PlanarTwist& v) const;
  bool command_safe(const Footprint& outline, const Pose2& X, const PlanarTwist& v) const;
  /// Whether a velocity soon brings the robot nearer to a moving disc than standing would, and too near.
  bool nears_disc(const Pose2& X, const PlanarTwist& v) const;
  void set_plan(std::vector<PathPose> path);
  Status fail(Error why);
  /// Whether the goal lies in the area, once that has its place.
  Status check_goal_on_map() const;

  NavigatorSpec spec_;
  DwaSpec dwa_;
  PursuitSpec pursuit_;
  HybridSpec hybrid_;
  Footprint footprint_, grown_;
  std::optional<GridMap> static_;
  GridGeometry area_;
  NavigatorState state_;
  // Derived from the state: rebuilt in each step.
  CostMap local_;
  std::vector<PathPose> plan_;
  std::vector<Pose2> local_plan_;
  std::vector<MovingDisc> discs_;
  std::vector<Echo> echoes_;
};

}  // namespace sandlot::navigation
