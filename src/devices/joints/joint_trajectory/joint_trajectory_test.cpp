#include "devices/joints/joint_trajectory/joint_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::joint_trajectory {
namespace {

using test::config;
using test::Rig;

Node arm(std::initializer_list<const char*> joints = {"left", "lift"}) {
  Node node = config({});
  Node& list = node.set("joints", Node::sequence());
  for (const char* joint : joints) list.push(Node::scalar(joint));
  return node;
}

struct Point {
  double t_s;
  std::vector<double> positions, velocities;
};
msg::JointTrajectory path(std::vector<std::string> names, const std::vector<Point>& points) {
  msg::JointTrajectory out;
  out.joint_names = std::move(names);
  for (const Point& p : points)
    out.points.push_back({p.positions, p.velocities, {}, {}, Time::from_s(p.t_s)});
  return out;
}

void act(Rig& rig, int ticks) {
  for (int i = 0; i < ticks; ++i) rig.act(2);
}
double position(const Rig& rig, std::size_t joint) { return rig.engine->joint[joint].position; }

TEST(JointTrajectory, FollowsStraightLinesExactlyAndStaysAtTheEnd) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("arm", arm()));
  rig.command("arm/trajectory", path({"lift", "left"}, {{1, {0.4, 2}, {}}, {2, {0.2, 2}, {}}}));
  act(rig, 50);
  EXPECT_NEAR(position(rig, 0), 1, 1e-12);
  EXPECT_NEAR(position(rig, 2), 0.2, 1e-12);
  act(rig, 100);
  EXPECT_NEAR(position(rig, 0), 2, 1e-12);
  EXPECT_NEAR(position(rig, 2), 0.3, 1e-12);
  act(rig, 100);
  EXPECT_NEAR(position(rig, 2), 0.2, 1e-12);
  EXPECT_EQ(rig.engine->target[1].mode, JointTarget::Mode::free);  // not its joint
}

TEST(JointTrajectory, RefusesAStateThatWouldLeadOutOfItsLists) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("arm", arm()));
  const std::size_t joints = arm().find("joints")->items().size();
  const auto taken = [&](const auto& change) {
    State state;
    state.held = 1;
    state.time_s = {0, 1};
    state.position.assign(2 * joints, 0.0);
    state.pids.resize(joints);
    change(state);
    ByteWriter w;
    write_tunables(w, Spec{});
    write(w, state);
    ByteReader r(w.bytes());
    rig.pool->load(0, r);
    return r.ok();
  };
  EXPECT_TRUE(taken([](State&) {}));
  EXPECT_FALSE(taken([](State& s) { s.time_s.clear(); }));
  EXPECT_FALSE(taken([](State& s) { s.time_s.push_back(2); }));
  EXPECT_FALSE(taken([](State& s) { s.velocity.resize(1); }));
  EXPECT_FALSE(taken([](State& s) { s.pids.clear(); }));
  EXPECT_FALSE(taken([](State& s) { s.elapsed_s = NAN; }));
  EXPECT_FALSE(taken([](State& s) { s.time_s[1] = NAN; }));
  EXPECT_FALSE(taken([](State& s) { s.time_s[0] = 3; }));
}

TEST(JointTrajectory, WithVelocitiesThePathIsACubic) {
  // From rest at 0 to rest at 1 in 2 s: u^2 (3 - 2 u).
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("arm", arm({"left"})));
  rig.command("arm/trajectory", path({"left"}, {{2, {1}, {0}}}));
  for (int k = 1; k <= 200; ++k) {
    act(rig, 1);
    const double u = 0.005 * k;
    EXPECT_NEAR(position(rig, 0), u * u * (3 - 2 * u), 1e-12);
  }
}

TEST(JointTrajectory, ANewOneStartsWhereTheOldOneIsAndOtherJointsStay) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("arm", arm()));
  rig.command("arm/trajectory", path({"left", "lift"}, {{1, {2, 0.4}, {}}}));
  act(rig, 50);
  rig.command("arm/trajectory", path({"left"}, {{1, {0}, {}}}));
  act(rig, 50);
  EXPECT_NEAR(position(rig, 0), 0.5, 1e-12);
  EXPECT_NEAR(position(rig, 2), 0.2, 1e-12);
}

TEST(JointTrajectory, AStampSaysWhenItBegins) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("arm", arm({"left"})));
  act(rig, 10);
  msg::JointTrajectory later = path({"left"}, {{1, {1}, {}}});
  later.header.stamp = Time::from_s(0.5);
  rig.command("arm/trajectory", later);
  act(rig, 40);
  EXPECT_NEAR(position(rig, 0), 0, 1e-9);
  act(rig, 50);
  EXPECT_NEAR(position(rig, 0), 0.5, 1e-9);
}

TEST(JointTrajectory, GainsMakeItAServo) {
  // A constant load f on a unit inertia leaves an error of f / p once the transient exp(-d t / 2) is gone.
  Rig rig(kind, test::two_wheels(), 0.001);
  Node node = arm({"left"});
  node.set("gains", Node::sequence()).push(config({{"p", "100"}, {"d", "20"}}));
  ASSERT_TRUE(rig.add("arm", std::move(node)));
  rig.engine->outside[0] = 5;
  rig.command("arm/trajectory", path({"left"}, {{0.5, {1}, {}}}));
  act(rig, 5000);
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::effort);
  EXPECT_NEAR(position(rig, 0), 1.05, 1e-6);
}

TEST(JointTrajectory, APathWithAFaultIsDroppedWhole) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("arm", arm()));
  for (const msg::JointTrajectory& bad :
       {path({"left"}, {}), path({}, {{1, {}, {}}}), path({"right"}, {{1, {1}, {}}}),
        path({"left", "left"}, {{1, {1, 1}, {}}}), path({"left"}, {{1, {1, 2}, {}}}),
        path({"left"}, {{1, {1}, {}}, {1, {2}, {}}}), path({"left"}, {{-1, {1}, {}}}),
        path({"left"}, {{1, {NAN}, {}}}), path({"left"}, {{1, {1}, {INFINITY}}}),
        path({"left"}, {{1, {1}, {}}, {2, {2}, {0}}})}) {
    rig.command("arm/trajectory", bad);
    act(rig, 10);
    EXPECT_EQ(position(rig, 0), 0);
  }
  rig.command("arm/trajectory", path({"lift"}, {{0.1, {9}, {}}}));
  act(rig, 20);
  EXPECT_NEAR(position(rig, 2), 0.5, 1e-12);  // the joint's upper end
}

TEST(JointTrajectory, HoldsWhatItFindsAndStoppedLeavesItFree) {
  Rig rig(kind, test::two_wheels());
  rig.engine->joint[0].position = 0.7;
  ASSERT_TRUE(rig.add("arm", arm({"left"})));
  act(rig, 10);
  EXPECT_EQ(position(rig, 0), 0.7);
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::velocity);
  ASSERT_TRUE(rig.pool->set_parameter(0, "active", Node::scalar("false")));
  act(rig, 1);
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::free);
  rig.engine->joint[0].position = -3;
  ASSERT_TRUE(rig.pool->set_parameter(0, "active", Node::scalar("true")));
  act(rig, 10);
  EXPECT_EQ(position(rig, 0), -3);
}

TEST(JointTrajectory, StateSurvivesSavingOnTheWay) {
  Rig a(kind, test::two_wheels()), b(kind, test::two_wheels());
  for (Rig* rig : {&a, &b}) ASSERT_TRUE(rig->add("arm", arm()));
  a.command("arm/trajectory", path({"left", "lift"}, {{1, {2, 0.4}, {0, 0}}, {2, {1, 0.1}, {0, 0}}}));
  act(a, 33);
  b.load(a.saved());
  b.engine->joint = a.engine->joint;
  b.now = a.now;
  b.topic<msg::JointTrajectory>("arm/trajectory/command").count = 1;
  act(a, 100);
  act(b, 100);
  EXPECT_EQ(a.saved(), b.saved());
  EXPECT_EQ(position(a, 0), position(b, 0));
}

TEST(JointTrajectory, WhatIsWrongIsSaidAtItsPlace) {
  Rig rig(kind, test::two_wheels());
  EXPECT_EQ(rig.add("arm", config({{"joints", "lft"}})).error().text(),
            "robot.yaml:1:9: /joints: model 'rover' has no joint 'lft'; did you mean 'left'?");
  EXPECT_EQ(rig.add("arm", arm({"left", "left"})).error().what, "joint 'left' is named twice");
  Node node = arm();
  node.set("gains", Node::sequence()).push(config({{"p", "1"}}));
  EXPECT_EQ(rig.add("arm", std::move(node)).error().what, "there are 1 gains for 2 joints");
}

TEST(JointTrajectory, NoNamesMeanAllJointsInTheOrderOfTheModel) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(static_cast<bool>(rig.add("arm", config({}))));
  Node three = config({});
  Node& gains = three.set("gains", Node::sequence());
  for (int i = 0; i < 5; ++i) gains.push(config({{"p", "1"}}));
  EXPECT_EQ(rig.add("more", std::move(three)).error().what, "there are 5 gains for 3 joints");
}

TEST(JointTrajectoryFromSdf, TakesJointsAndGainsInOrder) {
  Node plugin = config({{"position_p_gain", "5"}});
  Node& names = plugin.set("joint_name", Node::sequence());
  for (const char* name : {"a", "b"}) names.push(Node::scalar(name));
  Node& gains = plugin.set("position_p_gain", Node::sequence());
  for (const char* p : {"5", "6"}) gains.push(Node::scalar(p));
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(plugin, diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<Spec>(*node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->joints, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(spec->gains.size(), 2u);
  EXPECT_EQ(spec->gains[1].p, 6);
  const auto all = kind.from_sdf(config({{"position_p_gain", "5"}}), diagnostics);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->find("joints"), nullptr) << "none named: all of them";
  EXPECT_EQ(all->find("gains")->items().size(), 1u);
}

}  // namespace
}  // namespace sandlot::joint_trajectory
