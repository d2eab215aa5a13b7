#pragma once
/// Navigate: drives a robot to goals around what its laser sees, by the navigator of the navigation library.
///
/// Reads      `laser`, a LaserScan; `odometry`, an Odometry of wheels, of a program or of the ground truth, for the velocity and, without
///            `pose`, for the pose; `pose`, a PoseWithCovarianceStamped such as localise/amcl_pose. `map`: what is known beforehand.
///            The topics /ROBOT/goal_pose, geometry_msgs/PoseStamped, and /ROBOT/cancel_goal, std_msgs/Empty.
/// Orders     a Twist for a drive. With `publish` it orders nothing and publishes the Twist on a topic of that name, for
///            another program, such as four_wheel_steer.
/// Publishes  `plan` and `local_plan`, nav_msgs/Path; `costmap`, nav_msgs/OccupancyGrid of the window about the robot, at costmap_rate
///            while there is a goal; both once as soon as the pose is known, so that readers know the frame; `status`, diagnostic_msgs/DiagnosticStatus, at each change and at status_rate, with the feedback
///            of Nav2's NavigateToPose among its values.
/// Goals      those of `goals` in order; a goal_pose replaces the present goal and ends the list. Both are in the frame of the pose.
///            An orientation of zeros (or no yaw) means any heading.
/// Car        follows its plan with the middle of the axle that does not steer: `axle` is its place on the base link. `footprint`, goals,
///            plans and the velocities are of that point.
/// Errors     goals in a wall, off the map, without a way: `status` has the level ERROR and the reason; the list goes on, or ends with
///            stop_on_failure. A goal_pose of another frame, or with one before there is a pose, is refused: counted, the present goal stays. Pose or scan older than
///            `timeout`, or a pose less certain than max_pose_std: the robot stands. The log has a warning with the reason of each failure and refusal, and of a
///            robot that stands so for 5 s; at most one per second.
/// Method, limits, cost   navigation/navigator/navigator.h. No ground truth is read but where `odometry` names it, no random numbers.
/// Limits     of several scans in a control step the newest alone. Between the odometry's time and now the robot is taken to keep its
///            velocity.
#include <optional>

#include "control/controller.h"
#include "controllers/grid_map.h"
#include "messages/diagnostic_msgs.h"
#include "navigation/navigator/navigator.h"

namespace sandlot::controllers::navigate {

struct Goal {
  double x_m = 0, y_m = 0;
  std::optional<double> yaw_rad;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Place of the goal, x.", -1e6, 1e6, Field::required}, s.x_m);
    visit(Field{"y", "m", "Place of the goal, y.", -1e6, 1e6, Field::required}, s.y_m);
    visit(Field{"yaw", "rad", "Heading at the goal; none: any.", -7, 7}, s.yaw_rad);
  }
};

struct Spec : navigation::NavigatorSpec {
  MapKeys map;
  std::string laser, odometry, pose, drive, publish;
  std::vector<Goal> goals;
  bool loop = false, stop_on_failure = false;
  double axle_m = 0;
  double pause_s = 0, timeout_s = 0.5, costmap_rate_hz = 1, status_rate_hz = 2;

  static void fields(auto& s, auto&& visit) {
    MapKeys::fields(s.map, visit);
    visit(Field{"laser", "", "Laser scanner, not needed when there is only one.", 0, 0, Field::none, 1000},
          s.laser);
    visit(Field{"odometry", "",
                "Odometry for velocity and pose, not needed when there is only one. With `pose`: for the "
                "velocity "
                "alone; empty: the last command is taken.",
                0, 0, Field::none, 1000},
          s.odometry);
    visit(Field{"pose", "", "Pose in the map, such as localise/amcl_pose; empty: that of the odometry.", 0, 0,
                Field::none, 1000},
          s.pose);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(
        Field{
            "publish", "",
            "Topic, such as cmd_vel, that sends the velocities to other programs; no drive is ordered then.",
            0, 0, Field::none, 1000},
        s.publish);
    visit(
        Field{
            "axle", "m",
            "Place on the robot, x, of the axle of a car that does not steer: plans, goals, the outline and "
            "the velocities are those of its middle.",
            -100, 100},
        s.axle_m);
    visit(Field{"goals", "", "Goals to drive to, in order.", 0, 0, Field::none, 10'000}, s.goals);
    visit(Field{"loop", "", "Whether to begin again after the last goal."}, s.loop);
    visit(Field{"stop_on_failure", "", "Whether a goal that fails ends the list."}, s.stop_on_failure);
    visit(Field{"pause", "s", "Time to stand at each goal.", 0, 1e6}, s.pause_s);
    visit(Field{"timeout", "s", "Age of the pose or the scan above which the robot stands.", 0.01, 1e3},
          s.timeout_s);
    visit(Field{"costmap_rate", "Hz", "Number of cost maps published per second. 0: none.", 0, 10},
          s.costmap_rate_hz);
    visit(Field{"status_rate", "Hz", "Number of statuses published per second without a change.", 0.01, 100},
          s.status_rate_hz);
    navigation::NavigatorSpec::fields(s, visit);
  }
};

struct State {
  navigation::NavigatorState navigator;
  std::uint32_t next = 0;  ///< goal of the list
  bool listed = true;      ///< whether the list goes on
  bool driving = false;    ///< whether the present goal has no result yet
  double rest_s = 0;       ///< of the pause
  double since_costmap_s = 1e6, since_status_s = 1e6;
  navigation::NavStatus shown = navigation::NavStatus::idle;
  bool begun = false;       ///< whether a plan and a cost map were published, be they empty
  bool plan_shown = false;  ///< whether the newest plan published has poses
  std::uint32_t reached = 0, failed = 0, refused = 0;
  double distance_remaining_m = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"navigator", "", "State of the navigator."}, s.navigator);
    visit(Field{"next", "1", "Index of the list's next goal."}, s.next);
    visit(Field{"listed", "", "Whether the list of goals goes on."}, s.listed);
    visit(Field{"driving", "", "Whether the present goal has no result yet."}, s.driving);
    visit(Field{"rest", "s", "Rest of the pause at a goal."}, s.rest_s);
    visit(Field{"since_costmap", "s", "Time since the last cost map."}, s.since_costmap_s);
    visit(Field{"since_status", "s", "Time since the last status."}, s.since_status_s);
    visit(Field{"shown", "", "Status published last."}, s.shown);
    visit(Field{"begun", "", "Whether a plan and a cost map were published."}, s.begun);
    visit(Field{"plan_shown", "", "Whether the plan published last has poses."}, s.plan_shown);
    visit(Field{"reached", "1", "Number of goals that were reached."}, s.reached);
    visit(Field{"failed", "1", "Number of goals that failed."}, s.failed);
    visit(Field{"refused", "1", "Number of poses of clients that were in another frame."}, s.refused);
    visit(Field{"distance_remaining", "m", "Rest of the way to the goal."}, s.distance_remaining_m);
  }
};

struct Navigate {
  using Spec = navigate::Spec;
  using State = navigate::State;
  Spec spec;
  State state;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const;

 private:
  void take_goals(const Observation& obs);
  void warn(Time now, const std::string& text);
  /// Why the robot stands although it has a goal; empty: pose and scan are there.
  std::string why_blind(const Observation& obs, const navigation::NavigatorInput& in) const;
  /// Pose and velocity as they are now; no pose if it is too old.
  navigation::NavigatorInput input(const Observation& obs);
  /// From the base link to the middle of the axle.
  navigation::Pose2 at_axle(const Pose& X_MB) const;
  navigation::PlanarTwist at_axle(const msg::Twist& v_B) const;
  void publish(const Observation& obs, Command& cmd, const navigation::NavigatorStep& step, bool placed);
  void publish_status(Command& cmd, const navigation::NavigatorStep& step);

  std::optional<navigation::Navigator> navigator_;  ///< its state is in `state` between steps
  double period_s_ = 0;
  Pose X_BL_;  ///< from the middle of the axle
  Reading<msg::LaserScan> laser_;
  std::optional<Reading<msg::Odometry>> odometry_;
  std::optional<Reading<msg::PoseWithCovarianceStamped>> pose_;
  Actuator<msg::Twist> drive_;
  std::optional<Publication<msg::Twist>> velocity_;  ///< instead of the drive
  Subscription<msg::PoseStamped> goal_pose_;
  Subscription<msg::Empty> cancel_;
  Publication<msg::Path> plan_, local_plan_;
  Publication<msg::OccupancyGrid> costmap_;
  Publication<msg::DiagnosticStatus> status_;
  // Of one step: members for the memory of their texts and lists.
  std::string frame_;           ///< of the newest pose; empty: there is none yet
  std::optional<Time> warned_;  ///< time of the last warning; concerns the log alone
  msg::Path path_out_;
  msg::OccupancyGrid costmap_out_;
  msg::DiagnosticStatus status_out_;
};

}  // namespace sandlot::controllers::navigate
