/// Pairs of shapes that collide, and pairs that do not.
#include <gtest/gtest.h>

#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

/// Three balls that overlap; the first two share a joint, the third is loose.
model::Instance trio(bool self_collide) {
  model::Model m;
  for (int i = 0; i < 3; ++i) m.links.push_back(link_of("ball", Sphere{0.1}, 1, {{0.15 * i, 0, 0}, {}}));
  model::Joint joint;
  joint.type = model::JointType::continuous;
  joint.parent = 1;
  joint.child = 0;
  m.joints.push_back(joint);
  m.self_collide = self_collide;
  return instance_of("trio", m);
}

TEST(RigidPairs, LinksOfAModelMeetOnlyWhenItSaysSoAndNeverAcrossAJoint) {
  for (const bool self_collide : {false, true}) {
    World world(rigid::engine, {}, Vec3{});
    const InstanceId id = world.add(trio(self_collide));
    world.run(1);
    ASSERT_EQ(world.engine->contacts().size(), self_collide ? 1u : 0u);
    if (!self_collide) continue;
    EXPECT_EQ(world.engine->contacts()[0].a, world.engine->bodies(id)[1]);
    EXPECT_EQ(world.engine->contacts()[0].b, world.engine->bodies(id)[2]);
    EXPECT_NEAR(world.engine->contacts()[0].normal_W.x, 1, 1e-12);
    EXPECT_NEAR(world.engine->contacts()[0].depth_m, 0.05, 1e-12);
  }
}

TEST(RigidPairs, WhatStandsNeverMeetsWhatStands) {
  World world(rigid::engine);
  world.add(ground());
  world.add(static_of("wall", Box{{1, 1, 1}}));
  world.add(static_of("pillar", Cylinder{0.5, 1}));
  model::Model fixed = *body_of("", Sphere{0.3}, 1).model;
  model::Joint joint;
  joint.parent = model::world_link;
  joint.child = 0;
  fixed.joints.push_back(joint);
  world.add(instance_of("bolted", fixed));
  world.run(1);
  EXPECT_TRUE(world.engine->contacts().empty());
}

TEST(RigidPairs, EveryPairOfShapesIsSeen) {
  const Shape shapes[] = {Box{{0.2, 0.2, 0.2}}, Sphere{0.1}, Cylinder{0.1, 0.2}, Capsule{0.1, 0.2}};
  for (const Shape& a : shapes) {
    for (const Shape& b : shapes)
      for (const double apart : {0.19, 0.25}) {
        World world(rigid::engine, {}, Vec3{});
        world.add(body_of("a", a, 1));
        world.add(body_of("b", b, 1, {{apart, 0.01, 0.02}, {}}));
        world.run(1);
        EXPECT_EQ(world.engine->contacts().empty(), apart > 0.2) << a.index() << " " << b.index();
        if (apart < 0.2) { EXPECT_GT(world.engine->contacts().front().normal_W.x, 0.9); }
      }
    World world(rigid::engine, {}, Vec3{});
    world.add(ground());
    world.add(body_of("a", a, 1, {{0, 0, 0.09}, {}}));
    world.run(1);
    EXPECT_FALSE(world.engine->contacts().empty()) << a.index();
  }
}

}  // namespace
}  // namespace sandlot::rigid
