#include "devices/joints/joint_state/joint_state.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::joint_state {
namespace {

using test::config;
using test::Rig;
using Names = std::vector<std::string>;

TEST(JointStateDevice, ShowsAllJointsInTheModelsOrder) {
  model::Model model = test::two_wheels();
  model.joints.push_back({.name = "weld", .type = model::JointType::fixed, .child = 3});
  Rig rig(kind, model);
  ASSERT_TRUE(rig.add("joints", Node()));
  rig.engine->joint[0] = {1, 2, 3};
  rig.engine->joint[2] = {0.25, -1, 7};
  rig.now = Time::from_s(4);
  rig.sense();
  const msg::JointState& m = rig.topic<msg::JointState>("joints/joints").message;
  EXPECT_EQ(m.name, (Names{"left", "right", "lift"}));
  EXPECT_EQ(m.position, (std::vector<double>{1, 0, 0.25}));
  EXPECT_EQ(m.velocity, (std::vector<double>{2, 0, -1}));
  EXPECT_EQ(m.effort, (std::vector<double>{3, 0, 7}));
  EXPECT_EQ(m.header.stamp, Time::from_s(4));
}

TEST(JointStateDevice, OrThoseNamedInTheirOrder) {
  Rig rig(kind, test::two_wheels());
  Node node = config({});
  Node& list = node.set("joints", Node::sequence());
  list.push(Node::scalar("lift"));
  list.push(Node::scalar("left"));
  ASSERT_TRUE(rig.add("joints", std::move(node)));
  rig.engine->joint[2].position = 0.5;
  rig.sense();
  const msg::JointState& m = rig.topic<msg::JointState>("joints/joints").message;
  EXPECT_EQ(m.name, (Names{"lift", "left"}));
  EXPECT_EQ(m.position, (std::vector<double>{0.5, 0}));
}

TEST(JointStateDevice, WhatIsWrongIsSaidAtItsPlace) {
  model::Model model = test::two_wheels();
  model.joints.push_back({.name = "weld", .type = model::JointType::fixed, .child = 3});
  Rig rig(kind, model);
  EXPECT_EQ(rig.add("joints", config({{"joints", "lft"}})).error().text(),
            "robot.yaml:1:9: /joints: model 'rover' has no joint 'lft'; did you mean 'left'?");
  EXPECT_EQ(rig.add("joints", config({{"joints", "weld"}})).error().text(),
            "robot.yaml:1:9: /joints: joint 'weld' has no single angle or length; name revolute, continuous, "
            "prismatic or screw joints");
}

TEST(JointStateFromSdf, TakesBothSpellings) {
  Diagnostics diagnostics;
  const auto names = [&](const Node& plugin) {
    const auto node = kind.from_sdf(plugin, diagnostics);
    return read_spec<Spec>(*node)->joints;
  };
  Node repeated = config({{"update_rate", "20"}});
  Node& list = repeated.set("joint_name", Node::sequence());
  list.push(Node::scalar("a"));
  list.push(Node::scalar("b"));
  EXPECT_EQ(names(repeated), (Names{"a", "b"}));
  EXPECT_EQ(names(config({{"jointName", "a, b,c"}})), (Names{"a", "b", "c"}));
  EXPECT_EQ(names(config({})), Names{});
  EXPECT_TRUE(diagnostics.warnings.empty());
}

TEST(JointStateDevice, RefusesARestoredMessageWithOtherLists) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("joints", Node()));
  ByteWriter w;
  rig.pool->save(0, w);
  ByteReader whole(w.bytes());
  rig.pool->load(0, whole);
  EXPECT_TRUE(whole.ok());
  rig.topic<msg::JointState>("joints/joints").message.effort.pop_back();
  ByteReader forged(w.bytes());
  rig.pool->load(0, forged);
  EXPECT_FALSE(forged.ok());
}

}  // namespace
}  // namespace sandlot::joint_state
