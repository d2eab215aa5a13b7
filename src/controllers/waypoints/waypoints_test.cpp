#include "controllers/waypoints/waypoints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::waypoints {
namespace {

Description description() {
  Description robot;
  robot.robot = "rover";
  robot.control_period_s = 0.1;
  robot.readings = {{"drive", "ideal", msg::Odometry::ros_type, 0, {}}};
  robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
  return robot;
}

/// The controller and a unicycle that is integrated exactly.
struct Trial {
  Waypoints controller;
  Outputs outputs{"rover/way"};
  Topic<msg::Odometry> topic{"/rover/drive/ideal"};
  std::vector<std::uint64_t> seen{0};
  double x = 0, y = 0, theta = 0, v = 0, omega = 0;

  explicit Trial(Spec spec) {
    controller.spec = std::move(spec);
    const Status ready = controller.init(description(), outputs);
    EXPECT_TRUE(static_cast<bool>(ready));
  }
  void decide(bool with_message = true) {
    if (with_message) {
      topic.message.pose.pose = {{x, y, 0}, quat_from_axis_angle({0, 0, 1}, theta)};
      topic.publish({});
    }
    const TopicBase* const topics[] = {&topic};
    const Observation obs({}, topics, seen, Stream(1, 2, Purpose::controller, 3));
    Command cmd;
    controller.step(obs, cmd);
    ASSERT_EQ(cmd.orders().size(), 1u);
    ByteReader r(cmd.bytes(cmd.orders()[0]));
    msg::Twist twist;
    read(r, twist);
    v = twist.linear.x;
    omega = twist.angular.z;
  }
  void move(double dt) {
    const double half = 0.5 * omega * dt,
                 chord = v * dt * (std::abs(half) < 1e-9 ? 1.0 : math::sin(half) / half);
    x += chord * math::cos(theta + half);
    y += chord * math::sin(theta + half);
    theta += 2 * half;
  }
};

TEST(Waypoints, ThePursuitArcHasTheCurvatureThatMeetsThePoint) {
  // A point at distance d and bearing a: curvature 2 sin(a) / d. (2, 1): d^2 = 5, sin(a) = 1/sqrt(5): 2/5.
  Trial t({.points_m = {{2, 1}}, .loop = false, .speed_mps = 0.3, .deceleration_mps2 = 100});
  t.decide();
  EXPECT_NEAR(t.v, 0.3, 1e-15);
  EXPECT_NEAR(t.omega / t.v, 0.4, 1e-15);
  // Kept up, that arc leads through the point: its length is 2 a / curvature.
  const double length = 2 * math::atan2(1, 2) / 0.4;
  t.move(length / t.v);
  EXPECT_NEAR(t.x, 2, 1e-12);
  EXPECT_NEAR(t.y, 1, 1e-12);
}

TEST(Waypoints, TurnsOnTheSpotTowardsWhatLiesBehind) {
  Trial t({.points_m = {{-2, 0.1}}, .turn_speed_radps = 1.0});
  t.decide();
  EXPECT_EQ(t.v, 0);
  EXPECT_EQ(t.omega, 1.0);
  t.theta = math::pi - 0.15;  // still more than 10 degrees off? atan2(0.1, -2) = pi - 0.05: 5.7 degrees
  t.decide();
  EXPECT_GT(t.v, 0);
  t.theta = math::pi - 0.05 - 0.3;  // 17 degrees: driving, it does not stop to turn again
  t.decide();
  EXPECT_GT(t.v, 0);
}

TEST(Waypoints, VisitsAllPointsInOrderAndStopsAtTheLast) {
  const std::vector<std::array<double, 2>> points{{2, 0}, {2, 2}, {0, 2}, {1, 1}};
  Trial t({.points_m = points, .loop = false, .tolerance_m = 0.1});
  std::size_t reached = 0;
  double time = 0;
  for (; time < 120 && (time < 1 || t.v != 0 || t.omega != 0); time += 0.05) {
    t.decide();
    t.move(0.05);
    if (reached < points.size() && math::hypot(t.x - points[reached][0], t.y - points[reached][1]) <= 0.1)
      ++reached;
    EXPECT_LE(std::abs(t.omega), 1.2 + 1e-12);
    EXPECT_LE(t.v, 0.5);
  }
  EXPECT_EQ(reached, points.size());
  EXPECT_LT(time, 60);
  EXPECT_EQ(t.controller.state.next, points.size());
  EXPECT_EQ(t.controller.state.rounds, 1u);
  EXPECT_LE(math::hypot(t.x - 1, t.y - 1), 0.1);
}

TEST(Waypoints, LoopsAndCountsItsRounds) {
  Trial t({.points_m = {{1, 0}, {1, 1}, {0, 0}}});
  for (int k = 0; k < 2000; ++k) {
    t.decide();
    t.move(0.05);
  }
  EXPECT_GE(t.controller.state.rounds, 5u);  // 100 s at 0.5 m/s on 3.4 m and three turns of up to 2.4 rad
  EXPECT_LT(t.controller.state.next, 3u);
}

TEST(Waypoints, BrakesBeforeTheLastPoint) {
  Trial t({.points_m = {{5, 0}}, .loop = false, .speed_mps = 2, .deceleration_mps2 = 0.5});
  t.x = 4;
  t.decide();
  EXPECT_NEAR(t.v, 1.0, 1e-12);  // sqrt(2 * 0.5 * 1)
  t.x = 0;
  t.decide();
  EXPECT_NEAR(t.v, 2.0, 1e-12);
}

TEST(Waypoints, ALoopWithinTheToleranceStandsStill) {
  Trial t({.points_m = {{0, 0}, {0.01, 0}}});
  t.decide();
  EXPECT_EQ(t.v, 0);
  EXPECT_EQ(t.omega, 0);
}

TEST(Waypoints, StandsStillWithoutOdometry) {
  Trial t({.points_m = {{5, 0}}});
  t.decide(false);
  EXPECT_EQ(t.v, 0);
}

TEST(Waypoints, GoesOnWhenLoopIsSwitchedOnAfterTheEnd) {
  Trial t({.points_m = {{5, 0}, {0, 0}}, .loop = false});
  t.controller.state.next = 2;
  t.decide();
  EXPECT_EQ(t.v, 0);
  t.controller.spec.loop = true;
  t.decide();
  EXPECT_EQ(t.controller.state.next, 0u);
  EXPECT_GT(t.v, 0);
}

TEST(Waypoints, PublishesForAnotherProgramInsteadOfOrdering) {
  Trial t({.points_m = {{2, 1}},
           .publish = "cmd_vel",
           .loop = false,
           .speed_mps = 0.3,
           .deceleration_mps2 = 100});
  t.topic.message.pose.pose = {};
  t.topic.publish({});
  const TopicBase* const topics[] = {&t.topic};
  Command cmd;
  cmd.bind(&t.outputs);
  t.controller.step(Observation({}, topics, t.seen, Stream(1, 2, Purpose::controller, 3)), cmd);
  t.outputs.commit({});
  EXPECT_TRUE(cmd.orders().empty());
  const auto* const shown = topic_cast<msg::Twist>(t.outputs.all()[0].topic.get());
  EXPECT_NEAR(shown->message.linear.x, 0.3, 1e-12);
  EXPECT_NEAR(shown->message.angular.z, 0.3 * 2 / 5, 1e-12);
  Outputs other("rover/both");
  Waypoints both;
  both.spec = {.points_m = {{2, 1}}, .drive = "drive", .publish = "cmd_vel"};
  EXPECT_FALSE(both.init(description(), other));
}

/// The controller with its plan, standing at the origin of its odometry.
struct Plans {
  Waypoints controller;
  Outputs outputs{"rover/way"};
  Topic<msg::Odometry> topic{"/rover/drive/ideal"};
  std::vector<std::uint64_t> seen{0};

  explicit Plans(Spec spec) {
    controller.spec = std::move(spec);
    const Status ready = controller.init(description(), outputs);
    EXPECT_TRUE(static_cast<bool>(ready));
    topic.message.header.frame_id = "rover/odom";
  }
  void step(double now_s) {
    const TopicBase* const topics[] = {&topic};
    Command cmd;
    cmd.bind(&outputs);
    controller.step(Observation(Time::from_s(now_s), topics, seen, Stream(1, 2, Purpose::controller, 3)),
                    cmd);
    outputs.commit(Time::from_s(now_s));
  }
  const Topic<msg::Path>& plan() const { return *topic_cast<msg::Path>(outputs.all()[0].topic.get()); }
  double off(std::size_t i, double heading_rad) const {
    const Quat difference = conjugate(plan().message.poses[i].pose.q) *
                            quat_from_axis_angle({0, 0, 1}, heading_rad);
    return std::abs(difference.z);
  }
};

TEST(Waypoints, ShowsItsPlanOnceAndWhenItChanges) {
  Plans t({.points_m = {{2, 0}, {2, 3}, {0, 3}}, .plan = "plan", .loop = false});
  EXPECT_EQ(t.plan().name(), "/rover/way/plan");
  t.step(0.1);
  EXPECT_EQ(t.plan().count, 0u);  // without odometry there is no frame
  t.topic.publish({});
  for (int k = 2; k < 20; ++k) t.step(0.1 * k);
  ASSERT_EQ(t.plan().count, 1u);
  const msg::Path& path = t.plan().message;
  EXPECT_EQ(path.header.frame_id, "rover/odom");
  EXPECT_EQ(path.header.stamp, Time::from_s(0.2));
  ASSERT_EQ(path.poses.size(), 3u);
  EXPECT_EQ(path.poses[1].header.frame_id, "rover/odom");
  EXPECT_EQ(path.poses[1].pose.p.x, 2);
  EXPECT_EQ(path.poses[1].pose.p.y, 3);
  // Up, to the left, and as before at the end.
  EXPECT_LE(t.off(0, math::pi / 2), 1e-12);
  EXPECT_LE(t.off(1, math::pi), 1e-12);
  EXPECT_LE(t.off(2, math::pi), 1e-12);

  t.controller.spec.loop = true;
  for (int k = 20; k < 30; ++k) t.step(0.1 * k);
  EXPECT_EQ(t.plan().count, 2u);
  ASSERT_EQ(t.plan().message.poses.size(), 4u);
  EXPECT_EQ(t.plan().message.poses[3].pose.p.x, 2);
  EXPECT_EQ(t.plan().message.poses[3].pose.p.y, 0);
  EXPECT_LE(t.off(2, math::atan2(-3, 2)), 1e-12);

  // A run that went back to before the first message shows it again.
  t.outputs.all()[0].topic->count = 0;
  t.step(3);
  EXPECT_EQ(t.plan().count, 1u);
}

TEST(Waypoints, ShowsASinglePointAndNoPlanUnasked) {
  Plans one({.points_m = {{2, 1}}, .plan = "plan"});
  one.topic.publish({});
  one.step(0);
  ASSERT_EQ(one.plan().message.poses.size(), 1u);
  EXPECT_EQ(one.plan().message.poses[0].pose.q.w, 1);
  Trial without({.points_m = {{2, 1}}});
  EXPECT_TRUE(without.outputs.empty());
}

TEST(Waypoints, ReadsPointsAndNamesWhatIsMissing) {
  ControllerAdapter<Waypoints> adapter;
  const auto complaint = [&](const Node& config) {
    const Status status = adapter.init(description(), config);
    return status ? "" : status.error().text();
  };
  Node config = Node::map();
  EXPECT_EQ(complaint(config), "key 'points' is missing; Points [x, y] in the frame of the odometry.");
  Node& points = config.set("points", Node::sequence());
  EXPECT_EQ(complaint(config), "/points: there are no points; give at least one [x, y]");
  Node& point = points.push(Node::sequence());
  point.push(Node::scalar("1 m"));
  EXPECT_EQ(complaint(config), "/points/0: expected a list of 2 values, found one of 1");
  point.push(Node::scalar("50 cm"));
  EXPECT_EQ(complaint(config), "");
  config.set("odometry", Node::scalar("gps"));
  EXPECT_EQ(complaint(config),
            "robot 'rover' has no reading 'gps' of type nav_msgs/msg/Odometry; known are: drive");
  // A device has an entry for each level, and a name that has another type is known.
  Description levels = description();
  levels.readings.push_back(levels.readings[0]);
  levels.readings.push_back({"fix", "", msg::NavSatFix::ros_type, 0, {}});
  EXPECT_EQ(levels.reading<msg::Odometry>("gps").error().text(),
            "robot 'rover' has no reading 'gps' of type nav_msgs/msg/Odometry; known are: drive");
  EXPECT_EQ(levels.reading<msg::Odometry>("fix").error().text(),
            "robot 'rover' has no reading 'fix' of type nav_msgs/msg/Odometry; 'fix' has "
            "sensor_msgs/msg/NavSatFix");
}

TEST(Waypoints, StateSurvivesSaving) {
  Trial a({.points_m = {{1, 0}, {1, 1}}});
  for (int k = 0; k < 60; ++k) {
    a.decide();
    a.move(0.05);
  }
  ByteWriter w;
  write(w, a.controller.state);
  Trial b({.points_m = {{1, 0}, {1, 1}}});
  ByteReader r(w.bytes());
  read(r, b.controller.state);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(b.controller.state.next, a.controller.state.next);
}

}  // namespace
}  // namespace sandlot::controllers::waypoints
