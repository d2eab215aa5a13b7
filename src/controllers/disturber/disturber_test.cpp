#include "controllers/disturber/disturber.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/math.h"

namespace sandlot::controllers::disturber {
namespace {

struct Trial {
  Disturber controller;
  Topic<msg::LaserScan> scan{"/robot/eye/proximity"};

  Trial() {
    Description robot;
    robot.robot = "robot";
    robot.readings = {{"eye", "proximity", msg::LaserScan::ros_type, 0, {}}};
    robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
    EXPECT_TRUE(static_cast<bool>(controller.init(robot)));
    scan.message.ranges = {std::numeric_limits<float>::infinity()};
  }
  msg::Twist step(double now_s) {
    scan.publish(Time::from_s(now_s));
    const TopicBase* const topics[] = {&scan};
    const std::vector<std::uint64_t> seen{0};
    Command cmd;
    const auto key = static_cast<std::uint64_t>(now_s * 1000);
    controller.step(Observation(Time::from_s(now_s), topics, seen, Stream(1, 2, Purpose::controller, key)),
                    cmd);
    msg::Twist twist;
    ByteReader r(cmd.bytes(cmd.orders()[0]));
    read(r, twist);
    return twist;
  }
};

TEST(Disturber, WandersSlowlyOnArcs) {
  Trial trial;
  for (int k = 0; k < 100; ++k) {
    const msg::Twist twist = trial.step(0.1 * k);
    EXPECT_EQ(twist.linear.x, trial.controller.spec.speed_mps);
    EXPECT_LE(std::abs(twist.angular.z), 0.4 * trial.controller.spec.turn_speed_radps);
  }
  EXPECT_EQ(trial.controller.state.bumps, 0u);
}

TEST(Disturber, BumpsIntoWhatIsInFrontThenBacksOffAndTurns) {
  Trial trial;
  trial.scan.message.ranges = {0.4f};
  EXPECT_EQ(trial.step(1.0).linear.x, 1.0);
  EXPECT_EQ(trial.controller.state.bumps, 1u);
  EXPECT_EQ(trial.step(1.7).linear.x, 1.0);  // for 0.8 s
  EXPECT_EQ(trial.step(1.9).linear.x, -0.15);
  EXPECT_EQ(trial.step(2.6).linear.x, -0.15);
  const msg::Twist turn = trial.step(2.8);
  EXPECT_EQ(turn.linear.x, 0);
  EXPECT_EQ(std::abs(turn.angular.z), 1.5);
  // At least 45 degrees, at most 180.
  const double lasts_s = trial.controller.state.until.s() - 2.8;
  EXPECT_GE(lasts_s, math::pi / 4 / 1.5);
  EXPECT_LE(lasts_s, math::pi / 1.5);
  EXPECT_EQ(trial.controller.state.bumps, 1u);
}

TEST(Disturber, WhatIsFartherThanItsDistanceIsNoObstacle) {
  Trial trial;
  trial.scan.message.ranges = {0.5f};
  EXPECT_EQ(trial.step(1).linear.x, 0.15);
}

}  // namespace
}  // namespace sandlot::controllers::disturber
