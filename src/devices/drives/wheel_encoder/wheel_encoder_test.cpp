#include "devices/drives/wheel_encoder/wheel_encoder.h"

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

TEST(WheelEncoder, ErrsInItsScaleAndHoldsTheCountWhenItLosesTheAngle) {
  const auto node = [](const char* stage, std::initializer_list<std::pair<const char*, const char*>> keys) {
    Node out = config({{"joint", "left"}, {"ticks_per_turn", "1000"}}), map = Node::map(),
         list = Node::sequence();
    map.set(stage, config(keys));
    list.push(std::move(map));
    out.set("noise", std::move(list));
    return out;
  };
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("scaled", node("scale", {{"error", "1 %"}}), 3));
  ASSERT_TRUE(rig.add("lost", node("dropouts", {{"rate", "0"}})));
  ASSERT_TRUE(rig.add("far", node("dropouts", {{"rate", "1"}, {"shows", "value"}, {"value", "1e12"}})));
  rig.engine->joint[0].position = 100.0005 * math::tau;
  rig.sense();
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("scaled/ticks").message.data, 101'000);
  EXPECT_EQ(rig.topic<msg::JointState>("scaled/joint").message.position[0], 100.0005 * math::tau);
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("lost/ticks").message.data, 100'000);
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("far/ticks").message.data, ticks_at(1e12, 1000));
  EXPECT_EQ(ticks_at(1e12, 100'000'000), 9'000'000'000'000'000'000);  // no count beyond 64 bits
  ASSERT_TRUE(rig.pool->set_parameter(0, "errors", Node::scalar("2")));
  ASSERT_TRUE(rig.pool->set_parameter(1, "noise/0/dropouts/rate", Node::scalar("1")));
  rig.engine->joint[0].position = 200.0005 * math::tau;
  rig.sense();
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("scaled/ticks").message.data, 204'000);
  EXPECT_EQ(rig.topic<msg::Int64Stamped>("lost/ticks").message.data, 100'000);
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
