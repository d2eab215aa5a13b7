#include "devices/wheel_encoder/wheel_encoder.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::wheel_encoder {
namespace {

using test::config;
using test::Rig;

TEST(WheelEncoder, CountsTheEdgesPassed) {
  // 4 ticks per turn: an edge each quarter turn; an angle just short of it still shows the tick before.
  const double quarter = math::pi / 2;
  EXPECT_EQ(ticks_at(0, 4), 0);
  EXPECT_EQ(ticks_at(0.99 * quarter, 4), 0);
  EXPECT_EQ(ticks_at(1.01 * quarter, 4), 1);
  EXPECT_EQ(ticks_at(-0.01 * quarter, 4), -1);
  EXPECT_EQ(ticks_at(-1.01 * quarter, 4), -2);
  EXPECT_EQ(ticks_at(4000.5 * quarter, 4), 4000);
  EXPECT_EQ(ticks_at(1e9 * math::tau, 1000), 1'000'000'000'000);
}

TEST(WheelEncoder, EachLevelShowsItsOwnAndAnIdleOneIsSilent) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("left_encoder", config({{"joint", "left"}, {"ticks_per_turn", "1000"}}), 1));
  ASSERT_TRUE(rig.add("right_encoder", config({{"joint", "right"}}), 2));
  ASSERT_TRUE(rig.add("both", config({{"joint", "right"}, {"ticks_per_turn", "100"}}), 3));
  rig.engine->joint[0] = {2.5 * math::tau + 0.001, 3, 0.5};
  rig.engine->joint[1] = {-0.25 * math::tau - 0.001, -3, -0.5};
  rig.now = Time::from_s(2);
  rig.sense();
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("left_encoder/ticks").message.data, 2500);
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("left_encoder/ticks").message.header.stamp, Time::from_s(2));
  EXPECT_EQ(rig.topic<msg::JointState>("left_encoder/joint").count, 0u);
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("right_encoder/ticks").count, 0u);
  const msg::JointState& exact = rig.topic<msg::JointState>("right_encoder/joint").message;
  EXPECT_EQ(exact.name, std::vector<std::string>{"right"});
  EXPECT_EQ(exact.position, std::vector<double>{-0.25 * math::tau - 0.001});
  EXPECT_EQ(exact.velocity, std::vector<double>{-3});
  EXPECT_EQ(exact.effort, std::vector<double>{-0.5});
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("both/ticks").message.data, -26);
  EXPECT_EQ(rig.topic<msg::JointState>("both/joint").count, 1u);
}

TEST(WheelEncoder, RefusesWhatItCannotMeasure) {
  Rig rig(kind, test::two_wheels());
  EXPECT_EQ(rig.add("e", config({{"joint", "lft"}})).error().text(),
            "robot.yaml:1:9: /joint: model 'rover' has no joint 'lft'; did you mean 'left'?");
  EXPECT_EQ(
      rig.add("e", config({{"joint", "lift"}})).error().text(),
      "robot.yaml:1:9: /joint: joint 'lift' does not turn; an encoder needs a revolute or continuous joint");
  EXPECT_EQ(rig.add("e", Node()).error().text(),
            "robot.yaml:12:5: key 'joint' is missing; Name of the revolute or continuous joint.");
  EXPECT_FALSE(rig.add("e", config({{"joint", "left"}, {"ticks_per_turn", "0"}})));
}

}  // namespace
}  // namespace sandlot::wheel_encoder
