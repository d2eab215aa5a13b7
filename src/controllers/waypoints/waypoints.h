#pragma once
/// Waypoints: drives through a list of points, one after the other, on arcs.
///
/// Reads    an Odometry of the robot's base: the drive's own, or a ground_truth. The points are in its frame.
/// Orders   a Twist for a drive that can turn on the spot. With `publish` it orders nothing and publishes the Twist on a topic
///          of that name for another program, such as four_wheel_steer.
/// Shows    with `plan`, the points as a Path on a topic of that name, in the odometry's frame: once the odometry is there, and again
///          when `loop`, which leads it back to its first point, or the points are changed. Headings point to the next point; heights
///          are 0, since points have none.
/// Method   pure pursuit of the next point: the arc that touches the present heading and ends in the point has
///          curvature 2 sin(a) / d (d: distance, a: bearing of the point). A point more than 60 degrees to the side is
///          first turned to on the spot. Speed falls so that the turn stays within turn_speed and, before the last
///          point, with the square root of the distance, so that braking takes a constant deceleration.
/// Limits   no obstacles, no heading at the points; corners are cut by at most `tolerance`.
/// Cost     one arc tangent per step, no allocation; with `plan` a comparison per point.
/// Errors   no points; both `drive` and `publish`.
/// Source   R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01 (1992).
#include <array>
#include <optional>

#include "control/controller.h"

namespace sandlot::controllers::waypoints {

struct Spec {
  std::vector<std::array<double, 2>> points_m;
  std::string odometry, drive, publish, plan;
  bool loop = true;
  double tolerance_m = 0.15;
  double speed_mps = 0.5;
  double turn_speed_radps = 1.2;
  double deceleration_mps2 = 0.5;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"points", "m", "Points [x, y] in the frame of the odometry.", -1e6, 1e6, Field::required,
                10'000},
          s.points_m);
    visit(Field{"odometry", "", "Odometry or ground truth to use; empty: the only one.", 0, 0, Field::none,
                1000},
          s.odometry);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(
        Field{
            "publish", "",
            "Topic, such as cmd_vel, that shows the velocities to other programs; no drive is ordered then.",
            0, 0, Field::none, 1000},
        s.publish);
    visit(Field{"plan", "", "Topic, such as plan, that shows the points as a path; empty: none.", 0, 0,
                Field::none, 1000},
          s.plan);
    visit(Field{"loop", "", "Whether to begin again after the last point.", 0, 1, tunable}, s.loop);
    visit(Field{"tolerance", "m", "Distance at which a point counts as reached.", 1e-3, 100, tunable},
          s.tolerance_m);
    visit(Field{"speed", "m/s", "Speed on straight parts.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"deceleration", "m/s^2", "Braking before the last point.", 0.01, 100, tunable},
          s.deceleration_mps2);
  }
};

struct State {
  std::uint32_t next = 0;  ///< index of the point aimed at; the number of points when all are done
  std::uint32_t rounds = 0;
  std::uint8_t turning = 0;  ///< turning on the spot

  static void fields(auto& s, auto&& visit) {
    visit(Field{"next", "1", "Index of the current target point."}, s.next);
    visit(Field{"rounds", "1", "Number of completed rounds."}, s.rounds);
    visit(Field{"turning", "1", "Whether the robot turns on the spot (1)."}, s.turning);
  }
};

struct Waypoints {
  using Spec = waypoints::Spec;
  using State = waypoints::State;
  Spec spec;
  State state;

  Reading<msg::Odometry> odometry;
  Actuator<msg::Twist> drive;
  std::optional<Publication<msg::Twist>> shown;  ///< instead of the drive
  std::optional<Publication<msg::Path>> way;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);

 private:
  msg::Twist velocity(const Observation& obs);
  void show_way(const Observation& obs, Command& cmd) const;
};

}  // namespace sandlot::controllers::waypoints
