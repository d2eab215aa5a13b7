/// The controller in a room, with rays and odometry that a test makes: goals, cancelling, topics, state.
#include "controllers/navigate/navigate.h"

#include <gmock/gmock.h>

#include "base/bytes.h"
#include "base/log.h"
#include "navigation/navigator/test_clutter.h"

namespace sandlot::controllers::navigate {
namespace {

using navigation::Pose2;
using navigation::test::Clutter;
using testing::HasSubstr;

/// A robot that drives through a room exactly as it is told.
struct Trial {
  Clutter room;
  Pose2 X{-2, 0, 0};
  Navigate controller;
  Outputs outputs{"rover/navigator"};
  Topic<msg::LaserScan> scan{"/rover/laser/ranges"};
  Topic<msg::Odometry> odometry{"/rover/odometry"};
  std::vector<std::uint64_t> seen{0, 0};
  Status ready;
  Time now;
  msg::Twist twist;  ///< ordered last

  explicit Trial(Spec spec) {
    controller.spec = std::move(spec);
    Description robot;
    robot.robot = "rover";
    robot.control_period_s = 0.1;
    robot.readings = {{"laser", "ranges", msg::LaserScan::ros_type, 0, {}},
                      {"odometry", "", msg::Odometry::ros_type, 1, {}}};
    robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
    ready = controller.init(robot, outputs);
    odometry.message.header.frame_id = "rover/odom";
  }
  static Spec to(std::vector<Goal> goals) {
    Spec spec;
    spec.radius_m = 0.2;
    spec.goals = std::move(goals);
    return spec;
  }
  /// A client publishes on /rover/goal_pose; without an orientation any heading will do.
  void put_goal(double x, double y, const std::string& frame = "rover/odom") {
    auto* const topic = topic_cast<msg::PoseStamped>(outputs.inputs()[0].topic.get());
    topic->message = {};
    topic->message.header.frame_id = frame;
    topic->message.pose = {{x, y, 0}, {0, 0, 0, 0}};
    topic->stamp = now;
    ++topic->count;
  }
  void put_cancel() {
    TopicBase& topic = *outputs.inputs()[1].topic;
    topic.stamp = now;
    ++topic.count;
  }
  template <class M>
  const Topic<M>& published(std::size_t index) const {
    return *topic_cast<M>(outputs.all()[index].topic.get());
  }
  const Topic<msg::Path>& plan() const { return published<msg::Path>(0); }
  const Topic<msg::OccupancyGrid>& costmap() const { return published<msg::OccupancyGrid>(2); }
  const msg::DiagnosticStatus& status() const { return published<msg::DiagnosticStatus>(3).message; }

  void step(bool sees = true) {
    now = now + Time::from_s(0.1);
    if (sees) {
      scan.message = navigation::test::scan(room, {}, X);
      scan.publish(now);
      odometry.message.pose.pose = {{X.x, X.y, 0}, quat_from_axis_angle({0, 0, 1}, X.theta)};
      odometry.message.twist.twist = twist;
      odometry.publish(now);
    }
    const std::vector<const TopicBase*> topics{&scan, &odometry};
    Command cmd;
    cmd.bind(&outputs);
    controller.step(
        Observation(now, topics, seen, Stream(1, 2, Purpose::controller, 0), std::as_const(outputs).inputs()),
        cmd);
    outputs.commit(now);
    seen = {scan.count, odometry.count};
    for (Outputs::Input& input : outputs.inputs()) input.seen = input.topic->count;
    ASSERT_EQ(cmd.orders().size(), 1u);
    ByteReader r(cmd.bytes(cmd.orders()[0]));
    read(r, twist);
    X = navigation::driven(X, {twist.linear.x, twist.linear.y, twist.angular.z}, 0.1);
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) step();
  }
  double distance(double x, double y) const { return math::hypot(X.x - x, X.y - y); }
};

TEST(Navigate, DrivesToTheGoalsOfItsListInOrder) {
  Spec spec = Trial::to({{-1, 0, {}}, {-1, 1, 0.5}});
  spec.pause_s = 1;
  Trial t(spec);
  ASSERT_TRUE(t.ready) << t.ready.error().text();
  while (t.controller.state.reached == 0 && t.now.s() < 10) t.step();
  // 1 m less the tolerance at 0.6 m/s, with 0.8 m/s^2 to begin and half of it to end: 1.4 s, 0.4 s and 0.8 s more at most.
  EXPECT_GT(t.now.s(), 1.4);
  EXPECT_LT(t.now.s(), 3.5);
  EXPECT_LE(t.distance(-1, 0), 0.15);
  EXPECT_EQ(t.controller.state.next, 1u);
  const Time reached = t.now;
  while (t.controller.state.next == 1 && t.now.s() < 10) t.step();
  EXPECT_NEAR((t.now - reached).s(), 1, 0.11) << "the pause";
  while (t.controller.state.reached == 1 && t.now.s() < 20) t.step();
  EXPECT_LE(t.distance(-1, 1), 0.15);
  EXPECT_LE(std::abs(t.X.theta - 0.5), 0.15);
  t.steps(20);
  EXPECT_EQ(t.controller.state.reached, 2u);
  EXPECT_EQ(t.twist.linear.x, 0) << "the list is over";
}

TEST(Navigate, PublishesPlanAndCostMapOnceBeforeThereIsAGoal) {
  Trial t(Trial::to({}));
  t.step(false);
  EXPECT_EQ(t.plan().count, 0u) << "there is no pose yet";
  t.steps(30);
  EXPECT_EQ(t.plan().count, 1u);
  EXPECT_TRUE(t.plan().message.poses.empty());
  EXPECT_EQ(t.plan().message.header.frame_id, "rover/odom");
  ASSERT_EQ(t.costmap().count, 1u);
  EXPECT_EQ(t.costmap().message.header.frame_id, "rover/odom");
  EXPECT_EQ(t.costmap().message.data.size(),
            std::size_t{t.costmap().message.info.width} * t.costmap().message.info.height);
  t.put_goal(1, 0);
  t.steps(20);
  EXPECT_FALSE(t.plan().message.poses.empty());
  EXPECT_NEAR(double(t.costmap().count), 3, 1) << "one a second";
}

TEST(Navigate, AGoalOfAClientReplacesThePresentOneAndEndsTheList) {
  Trial t(Trial::to({{2, 0, {}}, {2, 2, {}}}));
  t.steps(10);
  const double x = t.X.x;
  EXPECT_GT(x, -1.9);
  t.put_goal(-2, 1);
  while (t.controller.state.reached == 0 && t.now.s() < 20) t.step();
  EXPECT_LE(t.distance(-2, 1), 0.15);
  EXPECT_EQ(t.status().message, "reached");
  t.steps(20);
  EXPECT_LE(t.distance(-2, 1), 0.15) << "the list does not go on";
  EXPECT_EQ(t.controller.state.failed, 0u) << "what was replaced has not failed";
}

TEST(Navigate, ACancelledGoalEndsTheDriveAndThePlan) {
  Trial t(Trial::to({{2, 0, {}}, {2, 2, {}}}));
  t.steps(10);
  EXPECT_GT(t.twist.linear.x, 0.1);
  EXPECT_FALSE(t.plan().message.poses.empty());
  t.put_cancel();
  t.step();
  EXPECT_EQ(t.twist.linear.x, 0);
  EXPECT_TRUE(t.plan().message.poses.empty());
  EXPECT_EQ(t.status().message, "idle");
  const Pose2 stood = t.X;
  t.steps(20);
  EXPECT_EQ(t.X.x, stood.x);
  EXPECT_EQ(t.controller.state.reached + t.controller.state.failed, 0u);
  t.put_goal(-2, 0);
  while (t.controller.state.reached == 0 && t.now.s() < 20) t.step();
  EXPECT_LE(t.distance(-2, 0), 0.15);
}

TEST(Navigate, RefusesGoalsOfOtherFramesAndAnswersBadOnes) {
  Trial t(Trial::to({{2, 0, {}}}));
  t.put_goal(0, 1);
  t.step(false);
  EXPECT_EQ(t.controller.state.refused, 1u) << "there is no pose whose frame could be compared";
  t.put_goal(0, 1, "map");
  t.step();
  EXPECT_EQ(t.controller.state.refused, 2u);
  EXPECT_EQ(t.controller.state.navigator.goal_x_m, 2) << "the present goal stays";
  t.put_goal(0, 1, "");
  t.step();
  EXPECT_EQ(t.controller.state.refused, 2u) << "no frame is that of the pose";
  EXPECT_EQ(t.controller.state.navigator.goal_y_m, 1);
  const auto answer = [&](double x, double y) {
    const std::uint32_t before = t.controller.state.failed;
    t.put_goal(x, y);
    t.step();
    EXPECT_EQ(t.controller.state.failed, before + 1);
    EXPECT_EQ(t.status().level, msg::DiagnosticStatus::error);
    EXPECT_EQ(t.twist.linear.x, 0);
    return t.status().message;
  };
  EXPECT_THAT(answer(NAN, 0), HasSubstr("not a finite pose"));
  EXPECT_THAT(answer(0, -INFINITY), HasSubstr("not a finite pose"));
  // 20 m about the first pose, which was at x = -2.
  EXPECT_THAT(answer(8.1, 0), HasSubstr("is off the map"));
  t.put_goal(7.9, 0);
  t.step();
  EXPECT_EQ(t.controller.state.failed, 3u) << "on the map: it fails later, when there is no way";
}

/// Entries of the log while it exists.
struct LogEntries {
  std::vector<std::string> all;
  LogEntries() {
    log::set_listener([this](log::Level, std::string_view text) { all.emplace_back(text); });
  }
  ~LogEntries() { log::set_listener({}); }
};

TEST(Navigate, WarnsInTheLogWhyAGoalFailsOrIsRefused) {
  LogEntries entries;
  Trial t(Trial::to({}));
  t.steps(2);
  t.put_goal(0, 1, "map");
  t.step();
  ASSERT_EQ(entries.all.size(), 1u);
  EXPECT_EQ(entries.all[0],
            "rover/navigator: a goal in the frame 'map' is refused; poses are in 'rover/odom'");
  t.put_goal(50, 0);
  t.step();
  EXPECT_EQ(entries.all.size(), 1u) << "one per second";
  t.steps(9);
  t.put_goal(50, 0);
  t.step();
  ASSERT_EQ(entries.all.size(), 2u);
  EXPECT_THAT(entries.all[1],
              HasSubstr("rover/navigator: the goal (50, 0) is off the map; it covers 20 x 20 m"));
}

TEST(Navigate, WarnsOnceForEachGoalThatItStandsAndWhy) {
  LogEntries entries;
  Trial t(Trial::to({{2, 0, {}}}));
  t.odometry.message.pose.covariance[0] = 1.44;
  t.steps(48);
  EXPECT_TRUE(entries.all.empty());
  t.steps(20);
  ASSERT_EQ(entries.all.size(), 1u);
  EXPECT_EQ(entries.all[0],
            "rover/navigator: the robot stands: the pose is uncertain by 1.2 m, max_pose_std is 0.5 m");
  t.put_goal(0, 1);
  for (int i = 0; i < 60; ++i) t.step(false);
  ASSERT_EQ(entries.all.size(), 2u);
  EXPECT_EQ(entries.all[1], "rover/navigator: the robot stands: there was no scan in the last 0.5 s");
}

TEST(Navigate, StandsWithoutScans) {
  Trial t(Trial::to({{2, 0, {}}}));
  t.steps(10);
  EXPECT_GT(t.twist.linear.x, 0.3);
  for (int i = 0; i < 5; ++i) t.step(false);
  EXPECT_GT(t.twist.linear.x, 0.3) << "0.5 s old";
  t.step(false);
  EXPECT_EQ(t.twist.linear.x, 0);
  t.steps(10);
  EXPECT_GT(t.twist.linear.x, 0.3);
}

TEST(Navigate, GoesOnFromItsStateToTheBit) {
  Trial t(Trial::to({{4.2, 4.2, {}}})), other(Trial::to({{4.2, 4.2, {}}}));
  t.room = other.room = Clutter::random(3, 12);
  t.X = {-4.2, -4.2, 0};
  t.steps(47);
  ByteWriter bytes;
  write(bytes, t.controller.state);
  ByteReader reader(bytes.bytes());
  read(reader, other.controller.state);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(other.controller.fits());
  other.X = t.X, other.now = t.now, other.twist = t.twist;
  for (int i = 0; i < 80; ++i) {
    t.step(), other.step();
    ASSERT_EQ(t.twist.linear.x, other.twist.linear.x) << i;
    ASSERT_EQ(t.twist.angular.z, other.twist.angular.z) << i;
  }
  ByteWriter one, two;
  write(one, t.controller.state), write(two, other.controller.state);
  EXPECT_TRUE(std::ranges::equal(one.bytes(), two.bytes()));
  other.controller.state.navigator.layer.free.pop_back();
  EXPECT_FALSE(other.controller.fits());
}

}  // namespace
}  // namespace sandlot::controllers::navigate
