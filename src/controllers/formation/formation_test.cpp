#include "controllers/formation/formation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::formation {
namespace {

Formation with(const Spec& spec) {
  Formation formation;
  formation.spec = spec;
  return formation;
}

void expect_place(const Formation& formation, std::size_t i, std::size_t n, double x, double y) {
  const auto place = formation.place(i, n);
  EXPECT_NEAR(place[0], x, 1e-12) << i << " of " << n;
  EXPECT_NEAR(place[1], y, 1e-12) << i << " of " << n;
}

TEST(Formation, PlacesFollowTheShapeAndTheHeading) {
  // Heading along y: left of it is -x, in front of it +y.
  const Spec spec{.centre_m = {1, 2}, .heading_rad = math::pi / 2, .spacing_m = 0.5};
  const Formation line = with(spec);
  expect_place(line, 0, 3, 0.5, 2);
  expect_place(line, 1, 3, 1, 2);
  expect_place(line, 2, 3, 1.5, 2);
  Spec other = spec;
  other.shape = Shape::column;
  expect_place(with(other), 0, 2, 1, 2.25);
  expect_place(with(other), 1, 2, 1, 1.75);
  other.shape = Shape::circle;
  // Four on a circle, neighbours 0.5 m apart: a square with half diagonals of 0.5 / sqrt(2).
  const double r = 0.5 / std::sqrt(2.0);
  expect_place(with(other), 0, 4, 1, 2 + r);
  expect_place(with(other), 1, 4, 1 - r, 2);
  expect_place(with(other), 0, 1, 1, 2);
}

TEST(Formation, ARobotTurnsThenDrivesThenTakesTheHeading) {
  const Formation formation = with(
      {.heading_rad = 1, .tolerance_m = 0.1, .speed_mps = 0.4, .turn_speed_radps = 0.8});
  bool there = true;
  const msg::Twist turn = formation.order({{0, 0, 0}, {}}, {-1, 0.1}, there);
  EXPECT_FALSE(there);
  EXPECT_EQ(turn.linear.x, 0);
  EXPECT_EQ(turn.angular.z, 0.8);
  // The arc that meets (2, 1) has curvature 2 sin(a) / d = 0.4.
  const msg::Twist drive = formation.order({{0, 0, 0}, {}}, {2, 1}, there);
  EXPECT_NEAR(drive.linear.x, 0.4, 1e-12);
  EXPECT_NEAR(drive.angular.z, 0.4 * 0.4, 1e-12);
  // v^2 = 2 a d before the place.
  EXPECT_NEAR(formation.order({{0, 0, 0}, {}}, {0.15, 0}, there).linear.x, std::sqrt(2 * 0.3 * 0.15), 1e-12);
  const msg::Twist face = formation.order({{0, 0, 0}, {}}, {0.05, 0}, there);
  EXPECT_FALSE(there);
  EXPECT_EQ(face.linear.x, 0);
  EXPECT_EQ(face.angular.z, 0.8);
  const msg::Twist stand = formation.order({{0, 0, 0}, quat_from_axis_angle({0, 0, 1}, 1.01)}, {0.05, 0},
                                           there);
  EXPECT_TRUE(there);
  EXPECT_EQ(stand.linear.x, 0);
  EXPECT_EQ(stand.angular.z, 0);
}

TEST(Formation, DrivesEachMemberByItsOwnHandles) {
  Description team;
  team.robot = "red";
  for (std::uint32_t i = 0; i < 2; ++i) {
    const std::string name = "red" + std::to_string(i + 1);
    Description& robot = team.members.emplace_back();
    robot.robot = name;
    robot.readings = {{"truth", "", msg::Odometry::ros_type, i, {}}};
    robot.actuators = {{"drive", "", msg::Twist::ros_type, i, {}}};
    team.readings.push_back({name + "/truth", "", msg::Odometry::ros_type, i, {}});
    team.actuators.push_back({name + "/drive", "", msg::Twist::ros_type, i, {}});
  }
  Formation formation = with({.spacing_m = 2});
  Outputs outputs("red/coach");
  ASSERT_TRUE(formation.init(team, outputs));
  Topic<msg::Odometry> at[2] = {Topic<msg::Odometry>("/red1/truth"), Topic<msg::Odometry>("/red2/truth")};
  at[0].message.pose.pose.p = {0, 1, 0};  // in its place
  at[0].publish({});
  const TopicBase* const topics[] = {&at[0], &at[1]};
  const std::vector<std::uint64_t> seen{0, 0};
  Command cmd;
  cmd.bind(&outputs);
  formation.step(Observation({}, topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
  outputs.commit({});
  ASSERT_EQ(cmd.orders().size(), 2u);
  EXPECT_EQ(cmd.orders()[0].slot, 0u);
  EXPECT_EQ(cmd.orders()[1].slot, 1u);
  EXPECT_EQ(topic_cast<msg::UInt32>(outputs.all()[0].topic.get())->message.data, 1u);
  // The second has sent nothing yet: it stands. Then it drives.
  at[1].message.pose.pose.p = {-3, -1, 0};
  at[1].publish({});
  cmd.clear();
  formation.step(Observation({}, topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
  msg::Twist order;
  ByteReader r(cmd.bytes(cmd.orders()[1]));
  read(r, order);
  EXPECT_NEAR(order.linear.x, 0.3, 1e-12);
}

TEST(Formation, RefusesASingleRobot) {
  Description robot;
  robot.robot = "rover";
  robot.readings = {{"truth", "", msg::Odometry::ros_type, 0, {}}};
  Formation formation;
  Outputs outputs("rover/controller");
  const Status status = formation.init(robot, outputs);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "'rover' is a robot, and a formation drives a team");
  EXPECT_TRUE(formation.init({}, outputs));  // of a team without robots
}

}  // namespace
}  // namespace sandlot::controllers::formation
