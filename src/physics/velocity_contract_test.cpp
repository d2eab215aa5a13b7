/// Contract of Engine::set_velocity, tested on each engine.
#include <gtest/gtest.h>

#include "base/math.h"
#include "physics/test_world.h"

namespace sandlot {
namespace {

using namespace test;

class VelocityContract : public ::testing::TestWithParam<const EngineKind*> {
 protected:
  const EngineKind& kind = *GetParam();
};

constexpr double h = 0.01;

/// Two discs joined by a hinge that turns: the whole gets a motion, and the hinge keeps its own.
TEST_P(VelocityContract, SetVelocityMovesTheWholeAndLeavesTheJointsAlone) {
  World world(kind, {}, {0, 0, 0});
  model::Model m;
  m.links.push_back(link_of("base", Cylinder{0.1, 0.1}, 2, {{0, 0, 0.05}, {}}));
  m.links.push_back(link_of("arm", Cylinder{0.1, 0.1}, 1, {{0.5, 0, 0.05}, {}}));
  model::Joint joint;
  joint.name = "hinge";
  joint.type = model::JointType::continuous;
  joint.parent = 0;
  joint.child = 1;
  joint.axis_J = {0, 0, 1};
  m.joints.push_back(joint);
  const InstanceId id = world.add(instance_of("a", m, {{1, 2, 0}, quat_from_rpy(0, 0, math::pi / 2)}, true));
  const auto arm = [&] { return world.engine->states()[world.engine->bodies(id)[1].index]; };
  const auto hinge = [&] { return world.engine->joint_states()[world.engine->joints(id)[0].index].velocity; };
  const double before = hinge();
  world.engine->set_velocity(id, {{0.3, -0.2, 0}, {0, 0, 2}});
  const BodyState base = world.state(id);
  EXPECT_NEAR(base.V_WB.linear.x, 0.3, 1e-12);
  EXPECT_NEAR(base.V_WB.linear.y, -0.2, 1e-12);
  EXPECT_NEAR(base.V_WB.angular.z, 2, 1e-12);
  EXPECT_NEAR(base.X_WB.p.x, 1, 1e-12) << "where it was";
  // The arm stands at (1, 2.5): v + w x (0, 0.5, 0) = (0.3 - 1, -0.2).
  EXPECT_NEAR(arm().V_WB.linear.x, -0.7, 1e-9);
  EXPECT_NEAR(arm().V_WB.linear.y, -0.2, 1e-9);
  EXPECT_NEAR(hinge(), before, 1e-12);
  world.engine->set_velocity(id, {{0.3, -0.2, 0}, {}});
  world.run(1);
  EXPECT_NEAR(world.state(id).X_WB.p.x, 1 + 0.3 * h, 1e-9);
  EXPECT_NEAR(world.state(id).X_WB.p.y, 2 - 0.2 * h, 1e-9);
  // What stands still stays where it is.
  const InstanceId wall = world.add(static_of("wall", Box{{0.2, 4, 0.5}}, {{5, 0, 0.25}, {}}));
  world.engine->set_velocity(wall, {{1, 0, 0}, {}});
  world.run(1);
  EXPECT_EQ(world.state(wall).X_WB.p.x, 5);
}

INSTANTIATE_TEST_SUITE_P(Engines, VelocityContract,
                         ::testing::ValuesIn(engine_kinds().begin(), engine_kinds().end()),
                         [](const auto& info) { return std::string(info.param->name); });

}  // namespace
}  // namespace sandlot
