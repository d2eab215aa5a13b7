/// Properties of the user's own as programs read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "sim/world/test_movers.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

/// robot1 with health, a sensor of it, and a wall 1 m ahead that does damage above 2 Ns, 10 points per Ns.
model::Setup before_a_wall() {
  model::Setup setup = movers({});
  setup.instances.push_back(placed("wall", one_shape("wall", Box{{0.2, 4, 1}}, 0), {{1, 0, 0.5}, {}}));
  model::Instance& robot = setup.instances[1];
  robot.properties = {{"age", "s", 7}, {"health", "points", 100, 20, 120}};
  robot.devices.push_back(device("sound", "property_sensor", map({{"property", "health"}, {"rate", "0"}})));
  model::ElementDecl rule;
  rule.name = rule.kind = "impact";
  rule.config = map({{"threshold", "2"}, {"property", "health"}, {"per_damage", "10"}});
  setup.rules.push_back(rule);
  return setup;
}

const msg::Property& sensed(const Simulation& simulation) {
  const auto* const topic = topic_cast<msg::PropertyStamped>(simulation.find_topic("/robot1/sound/property"));
  SL_CHECK(topic != nullptr);
  return topic->message.property;
}

TEST(PropertySensor, PublishesWhatRulesAndPeopleMakeOfAProperty) {
  const auto simulation = build(before_a_wall());
  const msg::Property& seen = sensed(*simulation);
  EXPECT_EQ(std::tuple(seen.name, seen.value, seen.unit, seen.min, seen.max),
            std::tuple("health", 100.0, "points", 20.0, 120.0));
  // It runs into the wall: what goes beyond 2 Ns is damage, 10 points per Ns.
  drive(*simulation, 3);
  advance(*simulation, 24);  // 0.72 m, and the wall is at 0.7 m
  drive(*simulation, 0);
  advance(*simulation, 3);
  EXPECT_EQ(value(*simulation, "rules/impact.robots[0].blows"), 1);
  const double damage_Ns = value(*simulation, "rules/impact.robots[0].sum");
  EXPECT_GT(damage_Ns, 1.9);
  EXPECT_NEAR(damage_Ns, value(*simulation, "rules/impact.robots[0].hardest") - 2, 1e-12);
  EXPECT_NEAR(seen.value, 100 - 10 * damage_Ns, 1e-9);
  EXPECT_EQ(seen.value, value(*simulation, "robot1.health"));
  simulation->submit(ParameterRequest{"robot1", "health", Node::scalar("90")});
  advance(*simulation, 1);
  EXPECT_EQ(seen.value, 90);
  const auto restored = again(*simulation);
  EXPECT_EQ(sensed(*restored).value, 90);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
  restored->submit(ParameterRequest{"robot1", "health", Node::scalar("80")});
  advance(*restored, 1);
  EXPECT_EQ(sensed(*restored).value, 80);
}

TEST(PropertySensor, NamesAPropertyThatIsNotThere) {
  model::Setup setup = before_a_wall();
  setup.rules.clear();
  setup.instances[1].devices.edit().back().config.set("property", Node::scalar("helth"));
  EXPECT_THAT(error_of(setup), HasSubstr("/property: 'robot1' has no property 'helth'"));
  EXPECT_THAT(error_of(setup), HasSubstr("did you mean 'health'?"));
  setup.instances[1].properties.clear();
  EXPECT_THAT(error_of(setup), HasSubstr("declare it: properties: {helth: 100}"));
}

}  // namespace
}  // namespace sandlot::test
