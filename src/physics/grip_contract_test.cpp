/// Contract of grips (physics/engine.h), tested on every engine that claims them.
#include <gtest/gtest.h>

#include "physics/test_world.h"

namespace sandlot::grip_contract_test {
namespace {

using namespace test;

class GripContract : public ::testing::TestWithParam<const EngineKind*> {
 protected:
  const EngineKind& kind = *GetParam();
};

constexpr double h = 0.01;

/// 1 kg, 0.1 wide, standing on the ground.
model::Instance crate(const std::string& name, Vec3 p) {
  return body_of(name, Box{{0.1, 0.1, 0.1}}, 1, {{p.x, p.y, 0.05}, {}});
}

/// A cylinder on a path.
model::Instance guided_of(const std::string& name, Vec3 p) {
  model::Instance instance = static_of(name, Cylinder{0.2, 0.4}, {p, {}});
  instance.motion = model::Motion{.keys = {{0, {p, {}}}}};
  return instance;
}

/// Two crates of 1 kg side by side, 0.3 apart, in free space.
struct Grippers : World {
  InstanceId a, b;
  explicit Grippers(const EngineKind& k, Vec3 gravity = {0, 0, 0}) : World(k, {}, gravity) {
    a = add(crate("a", {0, 0, 0}));
    b = add(crate("b", {0.3, 0, 0}));
  }
  void grip(InstanceId x, InstanceId y, bool hold = true) {
    const GripTarget target{engine->bodies(x)[0], engine->bodies(y)[0], hold};
    engine->set_grips(std::span(&target, 1));
  }
};

TEST_P(GripContract, TwoThatHoldEachOtherAreOne) {
  Grippers world(kind);
  ASSERT_TRUE(world.engine->capabilities().grips);
  world.grip(world.b, world.a);  // whoever is named first
  ASSERT_EQ(world.engine->grips().size(), 1u);
  EXPECT_EQ(world.engine->grips()[0].a, world.engine->bodies(world.a)[0]);
  EXPECT_EQ(world.engine->grips()[0].b, world.engine->bodies(world.b)[0]);
  world.push(world.a, {0, 100, 0});
  world.run(1);
  // One body of 2 kg with I = 2 (0.1^2 / 6 + 0.15^2), hit 0.15 from its middle by 1 Ns: v = 1/2, w = -0.15 /
  // I. The grip brings what b has to it. ODE's compliance (1e-6) yields 1e-6 of that and more.
  const double inertia = 2 * (0.01 / 6 + 0.0225), w = -0.15 / inertia;
  EXPECT_NEAR(world.state(world.a).V_WB.angular.z, w, 1e-3);
  EXPECT_NEAR(world.state(world.b).V_WB.angular.z, w, 1e-3);
  EXPECT_NEAR(world.state(world.b).V_WB.linear.y, 0.5 + 0.15 * w, 1e-3);
  EXPECT_NEAR(world.engine->grips()[0].force_N.y, (0.5 + 0.15 * w) / h, 0.1);
  for (int i = 0; i < 200; ++i) {
    world.run(1);
    const Vec3 apart = world.state(world.b).X_WB.p - world.state(world.a).X_WB.p;
    // It turns by 0.03 in a step, of which a joint that looks ahead along the tangent is off by the square,
    // 0.3 mm / 2, and what ODE's error reduction of 0.2 leaves of that standing: five times.
    ASSERT_NEAR(norm(apart), 0.3, 1e-3) << i;
    ASSERT_NEAR(world.state(world.a).V_WB.linear.y + world.state(world.b).V_WB.linear.y, 1, 1e-6);
  }
  world.grip(world.a, world.b, false);
  EXPECT_TRUE(world.engine->grips().empty());
  const Vec3 v = world.state(world.b).V_WB.linear;
  world.run(20);
  EXPECT_NEAR(norm(world.state(world.b).V_WB.linear - v), 0, 1e-12);
}

TEST_P(GripContract, WhoIsHeldDoesNotCollideWithItsHolder) {
  Grippers world(kind);
  world.engine->set_pose(world.b, {{0.08, 0, 0.05}, {}});  // 2 cm deep
  world.grip(world.a, world.b);
  world.run(20);
  EXPECT_TRUE(world.engine->contacts().empty());
  EXPECT_NEAR(world.state(world.b).X_WB.p.x, 0.08, 1e-9);
  world.grip(world.a, world.b, false);
  world.run(20);
  EXPECT_GT(world.state(world.b).X_WB.p.x - world.state(world.a).X_WB.p.x, 0.09);
}

TEST_P(GripContract, TheWorldHoldsAndWhatMovesAlongAPathDoesNot) {
  Grippers world(kind);
  const InstanceId post = world.add(static_of("post", Cylinder{0.05, 0.2}, {{0, 1, 0.1}, {}}));
  const InstanceId other = world.add(static_of("other", Cylinder{0.05, 0.2}, {{0, 2, 0.1}, {}}));
  const InstanceId walker = world.add(guided_of("walker", {0.3, -3, 0.2}));
  world.grip(post, world.a);
  world.grip(post, other);
  world.grip(walker, world.b);
  ASSERT_EQ(world.engine->grips().size(), 1u);
  for (int i = 0; i < 100; ++i) {
    world.push(world.a, {5, 0, 0});
    world.push(world.b, {5, 0, 0});
    world.run(1);
  }
  EXPECT_NEAR(world.state(world.a).X_WB.p.x, 0, 1e-3);
  EXPECT_NEAR(world.engine->grips()[0].force_N.x, 5, 0.01);  // the post is younger: what it bears
  EXPECT_NEAR(world.state(world.b).V_WB.linear.x, 5, 1e-6);
}

TEST_P(GripContract, RemovingOrPlacingLetsGo) {
  Grippers world(kind);
  world.grip(world.a, world.b);
  world.engine->set_pose(world.b, {{2, 0, 0.05}, {}});
  EXPECT_TRUE(world.engine->grips().empty());
  world.run(10);
  EXPECT_NEAR(world.state(world.a).X_WB.p.x, 0, 1e-12);
  world.grip(world.a, world.b);
  world.engine->remove(world.a);
  EXPECT_TRUE(world.engine->grips().empty());
  world.push(world.b, {0, 100, 0});
  world.run(10);
  EXPECT_NEAR(world.state(world.b).V_WB.linear.y, 1, 1e-9);
}

TEST_P(GripContract, ARestoredGripContinuesWithTheSameBits) {
  // Three in a row on the ground, the middle one held by both, pushed so that they swing and rub.
  const auto make = [&](bool gripped) {
    Grippers world(kind, {0, 0, -9.81});
    world.add(crate("c", {0.6, 0, 0}));
    world.add(ground());
    if (gripped) {
      world.grip(world.ids[2], world.b);
      world.grip(world.a, world.b);
    }
    return world;
  };
  const auto step = [](Grippers& world) {
    world.push(world.a, {0, 30, 0}, {0, 0, 1});
    world.run(1);
  };
  Grippers world = make(true);
  for (int i = 0; i < 40; ++i) step(world);
  Grippers copy = make(false);
  for (const InstanceId id : world.ids) {
    const auto bytes = world.bytes(id);
    for (std::size_t size = 0; size < bytes.size(); ++size)
      ASSERT_FALSE(copy.load(id, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
    ASSERT_TRUE(copy.load(id, bytes));
  }
  ASSERT_EQ(copy.engine->grips().size(), 2u);
  copy.steps = world.steps;
  for (int i = 0; i < 60; ++i) {
    step(world);
    step(copy);
    for (const InstanceId id : world.ids) ASSERT_EQ(world.bytes(id), copy.bytes(id)) << i;
  }
  EXPECT_GT(norm(world.state(world.a).V_WB.linear), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Engines, GripContract,
                         ::testing::ValuesIn(engine_kinds().begin(), engine_kinds().end()),
                         [](const auto& param) { return std::string(param.param->name); });

}  // namespace
}  // namespace sandlot::grip_contract_test
