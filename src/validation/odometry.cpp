#include <fmt/format.h>

#include <algorithm>

#include "kinematics/wheels.h"
#include "messages/messages.h"
#include "validation/robot.h"
#include "validation/world.h"

namespace sandlot::validation {
namespace {

using kinematics::PlanarMotion;
using kinematics::PlanarPose;

constexpr double arm_m = 0.21, radius_m = 0.075;
constexpr Vec3 wheels[] = {{arm_m, arm_m, 0}, {arm_m, -arm_m, 0}, {-arm_m, arm_m, 0}, {-arm_m, -arm_m, 0}};

/// Two seconds each; the four modes of the MARIO paper.
constexpr Twist path[] = {
    {0.4, 0, 0},    {0.25, 0.3, 0},      // crab: all wheels parallel
    {0, 0, 0.8},                         // on the spot
    {0.3, 0, 0.5},  {0.2, -0.15, -0.6},  // round a centre
    {-0.3, 0.2, 0}, {0, 0, 0},           // crab back, stop
};

PlanarPose read_odometry(const Robot& robot) {
  const auto* topic = topic_cast<msg::Odometry>(robot.sim->find_topic("/robot/drive/" + robot.level));
  SL_CHECK(topic);
  const Pose& pose = topic->message.pose.pose;
  return {pose.p.x, pose.p.y, yaw_of(pose.q)};
}

/// Where `pose` lies in the frame of `start`.
PlanarPose seen_from(const PlanarPose& start, const PlanarPose& pose) {
  const math::SinCos t = math::sincos(start.theta_rad);
  const double x = pose.x_m - start.x_m, y = pose.y_m - start.y_m;
  return {t.cos * x + t.sin * y, -t.sin * x + t.cos * y, math::wrap_angle(pose.theta_rad - start.theta_rad)};
}
PlanarPose planar(const Pose& pose) { return {pose.p.x, pose.p.y, yaw_of(pose.q)}; }

/// Motion of the wheels in a tick: angle turned and mean steering.
struct Turned {
  double angle_rad[4], steering_rad[4];
};
Turned read_joints(const Robot& robot) {
  Turned t{};
  for (std::size_t k = 0; k < 4; ++k)
    t.steering_rad[k] = robot.joint(2 * k).position, t.angle_rad[k] = robot.joint(2 * k + 1).position;
  return t;
}

struct Course {
  std::vector<double> time_s, error_m, bound_m;
  double end_error_m = 0, end_turn_rad = 0;            ///< of the odometry against the truth
  double foreseen_error_m = 0, foreseen_turn_rad = 0;  ///< by the slip of the wheels
  double slipped_m = 0;                                ///< mean way of the wheels' slip
  double largest_m = 0, largest_share = 0;             ///< error, and its largest ratio to its bound
  double steady_m = 0;                                 ///< error that a second at constant velocity adds
};

Course drive(const char* engine, const char* level, const char* odometry, bool slippery) {
  Robot::Trial trial{"{builder: swerve_robot}", engine, level};
  trial.drive = fmt::format("odometry: {}", odometry);
  if (slippery) {
    trial.drive += ", max_linear_acceleration: 4, max_angular_acceleration: 20";
    trial.world = "ground_zones:\n  - {name: wet, centre: [0, 0], radius: 20, friction: 0.12}\n";
  }
  auto started = Robot::start(trial);
  SL_CHECK_MSG(started, started ? "" : started.error().text().c_str());
  Robot& robot = *started;
  const PlanarPose truth0 = planar(robot.pose()), measured0 = read_odometry(robot);
  PlanarPose foreseen = truth0;  // where the wheels' slip takes an odometry by least squares
  Pose before = robot.pose();
  Turned wheel_before = read_joints(robot);
  Course c;
  double mean_slip_m = 0, turn_bound_rad = 0, bound_m = 0;
  for (const Twist& command : path) {
    robot.command(command);
    PlanarPose steady_truth, steady_measured;
    for (int i = 0; i < 200; ++i) {
      if (i == 150 && !slippery) robot.command({});
      robot.tick();
      const Pose now = robot.pose();
      const Turned wheel_now = read_joints(robot);
      const double turn = math::wrap_angle(yaw_of(now.q) - yaw_of(before.q));
      const Twist moved = between(before, now, turn, 1);
      // The slip of each wheel: what its middle moved by, less what it rolled.
      PlanarMotion wrong{};
      double slip_m = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double steering = 0.5 * (wheel_before.steering_rad[k] + wheel_now.steering_rad[k]);
        const double rolled = radius_m * (wheel_now.angle_rad[k] - wheel_before.angle_rad[k]);
        const math::SinCos h = math::sincos(steering);
        const double dx = moved.vx_mps - turn * wheels[k].y - rolled * h.cos,
                     dy = moved.vy_mps + turn * wheels[k].x - rolled * h.sin;
        // Least squares over a square of wheels: means, and moments by the sum of the arms' squares.
        wrong.x += dx / 4, wrong.y += dy / 4;
        wrong.turn += (wheels[k].x * dy - wheels[k].y * dx) / (8 * arm_m * arm_m);
        slip_m += std::sqrt(dx * dx + dy * dy) / 4;
      }
      foreseen = kinematics::integrate(foreseen,
                                       {moved.vx_mps - wrong.x, moved.vy_mps - wrong.y, turn - wrong.turn});
      // At worst all slips add up: the heading is off by slip / arm, and that turns whatever comes after.
      bound_m += slip_m +
                 turn_bound_rad * std::sqrt(moved.vx_mps * moved.vx_mps + moved.vy_mps * moved.vy_mps);
      turn_bound_rad += slip_m / (std::sqrt(2.0) * arm_m);
      mean_slip_m += slip_m;
      before = now, wheel_before = wheel_now;

      const PlanarPose truth = seen_from(truth0, planar(now)),
                       measured = seen_from(measured0, read_odometry(robot)),
                       thought = seen_from(truth0, foreseen);
      const auto off = [&](const PlanarPose& p) { return math::hypot(p.x_m - truth.x_m, p.y_m - truth.y_m); };
      if (i == 49) steady_truth = planar(now), steady_measured = read_odometry(robot);
      if (i == 149) {
        const PlanarPose a = seen_from(steady_truth, planar(now)),
                         b = seen_from(steady_measured, read_odometry(robot));
        c.steady_m = std::max(c.steady_m, math::hypot(a.x_m - b.x_m, a.y_m - b.y_m));
      }
      c.end_error_m = off(measured), c.foreseen_error_m = off(thought);
      c.end_turn_rad = math::wrap_angle(measured.theta_rad - truth.theta_rad);
      c.foreseen_turn_rad = math::wrap_angle(thought.theta_rad - truth.theta_rad);
      c.largest_m = std::max(c.largest_m, c.end_error_m);
      if (bound_m > 1e-3) c.largest_share = std::max(c.largest_share, c.end_error_m / bound_m);
      c.time_s.push_back(static_cast<double>(c.time_s.size() + 1) * robot.tick_s());
      c.error_m.push_back(c.end_error_m);
      c.bound_m.push_back(bound_m);
    }
  }
  c.slipped_m = mean_slip_m;
  return c;
}

}  // namespace

Section odometry() {
  Section s{
      "odometry",
      "Odometry of wheels that slip",
      "A robot driven and steered at four wheels (MARIO's size) goes through its four modes: crab, on the "
      "spot, round a centre, stop; 14 s, 3 m. Its odometry knows the encoders of wheels and steering alone, "
      "by "
      "least squares or by Kabsch, and is held against the true pose. On rails (`ideal`) nothing slips, if "
      "it stops before wheels are steered anew; but the wheels follow the base one sub-step h late, which is "
      "h v of "
      "place and h w of heading while it moves, and the rigid engine moves bodies along chords, v w h / 2 "
      "per second off "
      "the arc. At "
      "`contact` on wet ground (friction 0.12), commanded to accelerate with 4 m/s^2, wheels spin and slide: "
      "the "
      "slip of each wheel in each tick is its middle's true way less what it rolled. To least squares over a "
      "square of wheels the mean of these slips is an error of place and their moment one of heading, from "
      "which the error along the whole path follows; Kabsch gives the same to first order in the turn per "
      "tick. "
      "However the slips point, the error stays below what they make when all add up.",
      {},
      {}};
  for (const char* engine : engine_names)
    for (const char* method : {"least_squares", "kabsch"}) {
      const Course c = drive(engine, "ideal", method, false);
      s.rows.push_back(
          {fmt::format("{}, no slip (ideal): error gathered in 1 s at constant velocity", method),
           fmt::format("{}, 2 ms", engine), "m", c.steady_m, 0,
           std::string_view(engine) == "rigid" ? 0.3 * 0.5 * 0.001 : 1e-9, false});
      // Speeds of 0.4 m/s and 0.8 rad/s, at most 3 m of way.
      s.rows.push_back({fmt::format("{}, no slip (ideal): largest error of place", method),
                        fmt::format("{}, 2 ms", engine), "m", c.largest_m, 0, 0.002 * (0.4 + 0.8 * 3),
                        false});
    }
  for (const char* engine : engine_names) {
    Figure figure{fmt::format("odometry_{}", engine),
                  fmt::format("Error of odometry on wet ground, {} engine", engine),
                  {"time", "least squares", "Kabsch", "all slips together"},
                  {"s", "m", "m", "m"},
                  {}};
    const std::string where = fmt::format("{}, 2 ms", engine);
    std::vector<double> most_m;
    for (const char* method : {"least_squares", "kabsch"}) {
      const Course c = drive(engine, "contact", method, true);
      s.rows.push_back({fmt::format("{}, wet ground: error of place at the end", method), where, "m",
                        c.end_error_m, c.foreseen_error_m, 0.02});
      s.rows.push_back({fmt::format("{}, wet ground: error of heading at the end", method), where, "rad",
                        c.end_turn_rad, c.foreseen_turn_rad, 0.01, false});
      s.rows.push_back(
          {fmt::format("{}, wet ground: error of place, largest share of all slips together", method), where,
           "", c.largest_share, 0, 1, false});
      if (figure.columns.empty()) figure.columns.push_back(c.time_s);
      figure.columns.push_back(c.error_m);
      most_m = c.bound_m;
    }
    figure.columns.push_back(most_m);
    s.figures.push_back(std::move(figure));
  }
  return s;
}

}  // namespace sandlot::validation
