#include "devices/drives/body_velocity/body_velocity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::body_velocity {
namespace {

using test::config;
using test::Rig;

msg::Twist twist(double x, double y, double turn) { return {{x, y, 9}, {9, 9, turn}}; }

TEST(BodyVelocity, MovesOnTheArcOfItsCommand) {
  // 1 m/s ahead at 0.5 rad/s for pi seconds: a quarter turn on a circle of 2 m.
  Rig rig(kind, test::two_wheels(), math::pi / 1000);
  ASSERT_TRUE(rig.add("mover", config({{"max_acceleration", "1e9"}, {"max_angular_acceleration", "1e9"}})));
  rig.command("mover/ideal", twist(1, 0, 0.5));
  for (int i = 0; i < 1000; ++i) rig.act();
  // A tick is a whole number of nanoseconds: 1000 roundings of half a nanosecond.
  EXPECT_NEAR(rig.engine->body[0].X_WB.p.x, 2, 1e-6);
  EXPECT_NEAR(rig.engine->body[0].X_WB.p.y, 2, 1e-6);
  rig.command("mover/ideal", twist(0, 0.25, 0));
  rig.act();
  EXPECT_EQ(rig.engine->drive.vy_mps, 0.25);
  EXPECT_EQ(rig.engine->drive.vx_mps, 0);
}

TEST(BodyVelocity, BeginsAtItsInitialVelocityAndStopsWhenCommandsFail) {
  Rig rig(kind, test::two_wheels());
  Node node = config({{"command_timeout", "50 ms"}});
  Node& list = node.set("initial_linear", Node::sequence());
  for (const char* x : {"0.5", "0.1", "3"}) list.push(Node::scalar(x));
  ASSERT_TRUE(rig.add("mover", std::move(node)));
  rig.act();
  EXPECT_EQ(rig.engine->drive.vx_mps, 0.5);
  EXPECT_EQ(rig.engine->drive.vy_mps, 0.1);
  rig.command("mover/ideal", twist(NAN, 2, INFINITY));
  rig.act();
  EXPECT_EQ(rig.engine->drive.vx_mps, 0);
  EXPECT_EQ(rig.engine->drive.vy_mps, 2);
  EXPECT_EQ(rig.engine->drive.wz_radps, 0);
  for (int i = 0; i < 6; ++i) rig.act();
  EXPECT_EQ(rig.engine->drive.vy_mps, 0);
  EXPECT_TRUE(rig.engine->drive.active);
  rig.pool->release(0, rig.context(rig.now));
  ASSERT_FALSE(rig.actuation.drives.empty());
  EXPECT_FALSE(rig.actuation.drives.back().active);
}

TEST(BodyVelocity, StateSurvivesSaving) {
  Rig a(kind, test::two_wheels()), b(kind, test::two_wheels());
  for (Rig* rig : {&a, &b}) ASSERT_TRUE(rig->add("mover", Node()));
  a.command("mover/ideal", twist(1, 2, 3));
  a.act();
  b.load(a.saved());
  b.topic<msg::Twist>("mover/ideal/command").count = 1;
  b.act();
  EXPECT_EQ(b.engine->drive.vy_mps, 2);
  EXPECT_EQ(a.saved(), b.saved());
}

TEST(BodyVelocity, NeedsAnEngineWithIdealDrives) {
  Rig rig(kind, test::two_wheels());
  rig.engine->what.ideal_drives = false;
  EXPECT_EQ(rig.add("mover", Node()).error().text(),
            "robot.yaml:12:5: the engine 'hand' has no ideal drives");
}

TEST(BodyVelocityFromSdf, TakesTheInitialVelocities) {
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(
      config({{"initial_linear", "0.3 0  0.1"}, {"initial_angular", "0 0 -0.1"}, {"topic", "x"}}),
      diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<Spec>(*node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->initial_linear_mps, (Vec3{0.3, 0, 0.1}));
  EXPECT_EQ(spec->initial_angular_radps.z, -0.1);
  EXPECT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_FALSE(read_spec<Spec>(*kind.from_sdf(config({{"initial_linear", "1 2"}}), diagnostics)));
}

}  // namespace
}  // namespace sandlot::body_velocity
