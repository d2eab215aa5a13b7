/// Sleeping: who may, when, and what wakes.
#include <gtest/gtest.h>

#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

struct Tower : World {
  explicit Tower(const Settings& config = {}) : World(rigid::engine, settings(config)) {
    add(ground());
    for (int i = 0; i < 3; ++i) add(body_of("box", Box{{0.2, 0.2, 0.2}}, 1, {{0, 0, 0.1 + 0.2 * i}, {}}));
  }
  std::uint64_t awake() const { return engine->counters().awake_bodies; }
  double height(std::size_t i) const { return state(ids[i]).X_WB.p.z; }
};

TEST(RigidSleep, AnIslandSleepsAfterItsTimeAndCostsNoContacts) {
  Tower world(Settings{{"sleep_time", "0.3"}});
  // Rests from the first sub-steps on: 30 of them make 0.3 s, one more begins without it. Settling takes a
  // few.
  world.run(30);
  EXPECT_EQ(world.awake(), 3u);
  EXPECT_GE(world.engine->contacts().size(), 12u);
  world.run(10);
  EXPECT_EQ(world.awake(), 0u);
  EXPECT_EQ(world.engine->contacts().size(), 0u);
  EXPECT_EQ(world.state(world.ids[2]).V_WB.linear, Vec3{});
  const Vec3 place = world.state(world.ids[3]).X_WB.p;
  world.run(100);
  EXPECT_EQ(world.state(world.ids[3]).X_WB.p, place);
}

TEST(RigidSleep, WithoutSleepingNobodySleeps) {
  Tower world(Settings{{"sleeping", "false"}});
  world.run(200);
  EXPECT_EQ(world.awake(), 3u);
}

TEST(RigidSleep, ARobotNeverSleepsNorDoesWhatItTouches) {
  Tower world;
  world.add(disc_robot("r", {5, 0, 0}));
  world.add(body_of("load", Box{{0.1, 0.1, 0.1}}, 0.1, {{5, 0, 0.15}, {}}));
  world.run(200);
  EXPECT_EQ(world.awake(), 2u);
}

TEST(RigidSleep, WhatMovesSlowlyStaysAwakeAboveTheThresholds) {
  for (const bool spin : {false, true}) {
    World world(rigid::engine, {}, Vec3{});
    const InstanceId id = world.add(body_of("ball", Sphere{0.1}, 1));
    // 0.011 m/s or 0.055 rad/s, a tenth above the thresholds; then half of it.
    if (spin) world.push(id, {}, {0, 0, 0.004 * 0.055 / 0.01});
    else world.push(id, {0.011 / 0.01, 0, 0});
    world.run(200);
    EXPECT_EQ(world.engine->counters().awake_bodies, 1u) << spin;
    if (spin) world.push(id, {}, {0, 0, -0.004 * 0.0275 / 0.01});
    else world.push(id, {-0.0055 / 0.01, 0, 0});
    world.run(200);
    EXPECT_EQ(world.engine->counters().awake_bodies, 0u) << spin;
  }
}

TEST(RigidSleep, ATouchWakesTheWholeTowerAndItHolds) {
  Tower world;
  world.run(100);
  ASSERT_EQ(world.awake(), 0u);
  const InstanceId ball = world.add(body_of("ball", Sphere{0.05}, 0.2, {{0, 0, 0.8}, {}}));
  world.run(10);
  EXPECT_EQ(world.awake(), 1u);
  // It falls 0.15 m in 0.17 s.
  world.run(10);
  EXPECT_EQ(world.awake(), 4u);
  world.run(5);
  // In the sub-step of the touch the tower has all its contacts: nothing has sunk in.
  for (std::size_t i = 1; i <= 3; ++i)
    EXPECT_NEAR(world.height(i), 0.1 + 0.2 * (static_cast<double>(i) - 1), 1e-3);
  EXPECT_NEAR(world.state(ball).X_WB.p.z, 0.65, 2e-2);
}

TEST(RigidSleep, RemovingTheSupportWakes) {
  Tower world;
  world.run(100);
  ASSERT_EQ(world.awake(), 0u);
  world.engine->remove(world.ids[1]);
  world.run(50);
  EXPECT_NEAR(world.height(2), 0.1, 1e-3);
  EXPECT_NEAR(world.height(3), 0.3, 1e-3);
}

TEST(RigidSleep, RemovingOrMovingAStaticSupportWakes) {
  for (const bool remove : {false, true}) {
    World world(rigid::engine);
    world.add(ground());
    const InstanceId table = world.add(static_of("table", Box{{1, 1, 0.1}}, {{0, 0, 0.95}, {}}));
    const InstanceId cup = world.add(body_of("cup", Cylinder{0.04, 0.1}, 0.2, {{0, 0, 1.05}, {}}));
    world.run(150);
    ASSERT_EQ(world.engine->counters().awake_bodies, 0u);
    if (remove) world.engine->remove(table);
    else world.engine->set_pose(table, {{3, 0, 0.95}, {}});
    world.run(100);
    EXPECT_NEAR(world.state(cup).X_WB.p.z, 0.05, 2e-3);
  }
}

TEST(RigidSleep, PosesPushesTargetsAndNewStaticsWake) {
  Tower world;
  world.run(100);
  ASSERT_EQ(world.awake(), 0u);
  world.push(world.ids[1], {});  // a zero force is not a push
  world.run(1);
  EXPECT_EQ(world.awake(), 0u);
  world.push(world.ids[3], {0.1, 0, 0});
  world.run(1);
  EXPECT_EQ(world.awake(), 3u);
  world.run(100);
  ASSERT_EQ(world.awake(), 0u);
  world.engine->set_pose(world.ids[3], {{1, 0, 0.5}, {}});
  world.run(1);
  EXPECT_EQ(world.awake(), 3u);  // itself, and those it stood upon
  world.run(150);
  ASSERT_EQ(world.awake(), 0u);
  EXPECT_NEAR(world.height(3), 0.1, 1e-3);
  world.add(static_of("wedge", Box{{0.1, 0.1, 0.1}}, {{1.1, 0, 0.05}, {}}));
  world.run(1);
  EXPECT_EQ(world.awake(), 1u);
}

}  // namespace
}  // namespace sandlot::rigid
