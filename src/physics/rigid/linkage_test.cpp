/// Universal joints, screws and followers against formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/math.h"
#include "physics/rigid/joints.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid::linkage_test {
namespace {

using namespace test;

constexpr double h = 0.002;

model::Joint joint_of(const std::string& name, model::JointType type, std::uint32_t parent,
                      std::uint32_t child, Vec3 axis, Pose X_CJ = {}) {
  model::Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.axis_J = axis;
  joint.X_CJ = X_CJ;
  return joint;
}

model::Link bare(const std::string& name, double mass_kg, Pose X_ML = {}, Vec3 moments = {0.05, 0.05, 0.05}) {
  model::Link link = link_of(name, Sphere{0.1}, mass_kg, X_ML);
  link.inertial.moments = moments;
  link.collisions.clear();
  return link;
}

/// A body of 2 kg, 0.05 kg m^2, 1 m along x from its joint to the world: once as the joint's child, once as
/// its parent.
struct OnWorld : ::testing::TestWithParam<bool> {
  bool reversed = GetParam();
  double sign = reversed ? -1 : 1;  ///< of the body's motion for a positive position
  struct Bench : World {
    InstanceId id;
    std::size_t body, joint_index;
    double x() const { return joint(id, joint_index).position; }
    double v() const { return joint(id, joint_index).velocity; }
    double effort() const { return joint(id, joint_index).effort; }
    Pose at() const { return inverse(Pose{{0, 0, 5}, {}}) * state(id, body).X_WB; }
    using World::World;
  };
  Bench bench(model::Joint joint, Vec3 gravity, Pose place = {{1, 0, 0}, {}}) const {
    Bench b(rigid::engine, Node{}, gravity);
    model::Model m;
    if (reversed) {
      // The joint's child is a post that stands on the world.
      m.links.push_back(bare("post", 1));
      m.joints.push_back(joint_of("root", model::JointType::fixed, model::world_link, 0, {0, 0, 1}));
      joint.parent = 1;
      joint.child = 0;
    } else {
      joint.parent = model::world_link;
      joint.child = 0;
      joint.X_CJ = inverse(place);
    }
    m.links.push_back(bare("body", 2, place));
    b.body = m.links.size() - 1;
    b.joint_index = m.joints.size();
    m.joints.push_back(joint);
    b.id = b.add(instance_of("a", m, {{0, 0, 5}, {}}));
    return b;
  }
};

TEST_P(OnWorld, AUniversalJointTurnsAboutItsFirstAxisAndStopsAtTheLimitOfItsSecond) {
  model::Joint joint = joint_of("u", model::JointType::universal, 0, 0, {0, 0, 1});
  // Forwards the child sinks by turning about +y; with the body as parent the same fall is a negative angle.
  joint.second = model::SecondAxis{{0, 1, 0}, -0.5, 0.5, 0.2, 0};
  Bench b = bench(joint, {0, 0, -9.81});
  b.target(b.id, b.joint_index, {.mode = JointTarget::Mode::velocity, .velocity = 1, .max_effort = 100});
  b.run(1500, h);
  EXPECT_NEAR(b.v(), 1, 1e-3);
  EXPECT_NEAR(b.x(), 3, 0.01);
  if (!reversed) {
    EXPECT_NEAR(b.at().p.z, -math::sin(0.5), 5e-3);
    EXPECT_NEAR(b.at().p.x, math::cos(0.5) * math::cos(b.x()), 5e-3);
    EXPECT_NEAR(b.at().p.y, math::cos(0.5) * math::sin(b.x()), 5e-3);
  }
  // Beyond a whole turn it keeps counting.
  b.run(2500, h);
  EXPECT_NEAR(b.x(), 8, 0.02);
  b.target(b.id, b.joint_index, {.mode = JointTarget::Mode::effort, .effort = 0.3});
  b.run(1, h);
  EXPECT_DOUBLE_EQ(b.effort(), 0.3);
}

TEST_P(OnWorld, AUniversalMotorGivesItsEffort) {
  model::Joint joint = joint_of("u", model::JointType::universal, 0, 0, {0, 0, 1});
  joint.second = model::SecondAxis{{0, 1, 0}};
  Bench b = bench(joint, {}, {});  // centre of mass in the joint: inertia 0.05
  b.target(b.id, b.joint_index,
           {.mode = JointTarget::Mode::velocity, .velocity = 10, .max_effort = 0.05 * 4});
  b.run(250, h);
  EXPECT_NEAR(b.v(), 4 * 0.5, 1e-3);
  EXPECT_NEAR(b.effort(), 0.2, 1e-6);
}

TEST_P(OnWorld, AScrewSlidesByItsPitchPerTurn) {
  for (const double pitch : {0.1, -0.1, 0.002, 0.0}) {
    model::Joint joint = joint_of("s", model::JointType::screw, 0, 0, {0, 0, 1});
    joint.thread_pitch_m = pitch;
    Bench b = bench(joint, {0, 0, -9.81}, {});
    b.target(b.id, b.joint_index, {.mode = JointTarget::Mode::velocity, .velocity = 10, .max_effort = 1e4});
    b.run(500, h);
    EXPECT_NEAR(b.x(), 10, 0.05) << pitch;
    // The thread gives way by CFM times the force of the flanks, and ERP takes that back.
    EXPECT_NEAR(b.at().p.z, sign * pitch / math::tau * b.x(), 2e-5) << pitch;
    EXPECT_NEAR(b.at().p.x, 0, 1e-5) << pitch;
    // It carries the weight: torque = m g pitch / (2 pi).
    EXPECT_NEAR(b.effort(), sign * 2 * 9.81 * pitch / math::tau, 1e-3) << pitch;
  }
}

TEST_P(OnWorld, AScrewWithoutFrictionRunsDown) {
  // Energy: (I + m c^2) turn'' = -m g c.
  const double c = 0.5;
  model::Joint joint = joint_of("s", model::JointType::screw, 0, 0, {0, 0, 1});
  joint.thread_pitch_m = math::tau * c;
  Bench b = bench(joint, {0, 0, -9.81}, {});
  b.run(250, h);
  const double acceleration = -2 * 9.81 * c / (0.05 + 2 * c * c);
  EXPECT_NEAR(b.v(), sign * acceleration * 0.5, 1e-3 * -acceleration);
  EXPECT_NEAR(b.at().p.z, sign * c * b.x(), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Sides, OnWorld, ::testing::Values(false, true),
                         [](const auto& suite) { return suite.param ? "reversed" : "forwards"; });

TEST(Universal, DrivesAShaftUnevenly) {
  // Two shafts at an angle b: tan(c) = tan(a) cos(b), so c' / a' = cos(b) / (1 - sin(b)^2 sin(a)^2) where the
  // driving pin stands across the plane of the shafts at a = 0.
  const double b = 0.6;
  model::Model m;
  m.links = {bare("in", 1), bare("out", 1)};
  const Vec3 shaft{math::cos(b), 0, math::sin(b)};
  m.joints.push_back(joint_of("drive", model::JointType::continuous, model::world_link, 0, {1, 0, 0}));
  m.joints.push_back(joint_of("driven", model::JointType::continuous, model::world_link, 1, shaft));
  m.joints.push_back(joint_of("cross", model::JointType::universal, 0, 1, {0, 1, 0}));
  m.joints[2].second = model::SecondAxis{{-math::sin(b), 0, math::cos(b)}};
  World world(rigid::engine, {}, {});
  const InstanceId id = world.add(instance_of("shafts", m, {{0, 0, 1}, quat_from_rpy(0.2, 0.1, 0.7)}));
  world.target(id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 2, .max_effort = 100});
  world.run(50, h);
  double least = 10, most = 0;
  for (int i = 0; i < 2000; ++i) {
    world.run(1, h);
    const double a = world.joint(id, 0).position, s = math::sin(a) * math::sin(b);
    const double ratio = world.joint(id, 1).velocity / world.joint(id, 0).velocity;
    ASSERT_NEAR(ratio, math::cos(b) / (1 - s * s), 0.005) << a;
    ASSERT_NEAR(math::tan(world.joint(id, 1).position) * math::cos(a), math::sin(a) * math::cos(b), 0.01)
        << a;
    least = std::min(least, ratio), most = std::max(most, ratio);
  }
  EXPECT_NEAR(least, math::cos(b), 0.005);
  EXPECT_NEAR(most, 1 / math::cos(b), 0.005);
}

/// Two fingers on rails and two wheels, each second one following the first.
model::Model followers() {
  model::Model m;
  m.links = {bare("base", 50, {}, {5, 5, 5}), bare("left", 0.2, {{0, 0.1, 0}, {}}),
             bare("right", 0.2, {{0, -0.1, 0}, {}}), bare("wheel", 0.5, {{1, 0, 0}, {}}),
             bare("gear", 0.5, {{-1, 0, 0}, {}})};
  m.joints = {joint_of("left", model::JointType::prismatic, 0, 1, {0, 1, 0}),
              joint_of("right", model::JointType::prismatic, 0, 2, {0, 1, 0}),
              joint_of("wheel", model::JointType::continuous, 0, 3, {0, 0, 1}),
              joint_of("gear", model::JointType::continuous, 0, 4, {0, 0, 1})};
  m.joints[1].mimic = model::Mimic{0, -1, 0.01, 0.002};
  m.joints[3].mimic = model::Mimic{2, -2.5, 0, 0};
  return m;
}

TEST(Mimic, FollowersEndWhereTheirLeadersSay) {
  World world(rigid::engine, {}, {});
  const InstanceId id = world.add(instance_of("gripper", followers(), {{0, 0, 1}, {}}));
  world.target(id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 0.1, .max_effort = 50});
  world.target(id, 2, {.mode = JointTarget::Mode::velocity, .velocity = 3, .max_effort = 50});
  world.run(500, h);
  // While it moves it may lag by a sub-step.
  EXPECT_NEAR(world.joint(id, 3).velocity, -2.5 * 3, 0.01);
  EXPECT_NEAR(world.joint(id, 3).position, -2.5 * world.joint(id, 2).position, 2.5 * 3 * h + 1e-3);
  world.target(id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 0, .max_effort = 50});
  world.target(id, 2, {.mode = JointTarget::Mode::velocity, .velocity = 0, .max_effort = 50});
  world.run(250, h);
  EXPECT_NEAR(world.joint(id, 0).position, 0.1, 0.002);
  EXPECT_NEAR(world.joint(id, 1).position, -(world.joint(id, 0).position - 0.002) + 0.01, 1e-4);
  EXPECT_NEAR(world.joint(id, 3).position, -2.5 * world.joint(id, 2).position, 1e-4);
  // Orders to a follower are not heard.
  world.target(id, 3, {.mode = JointTarget::Mode::velocity, .velocity = 5, .max_effort = 50});
  world.run(100, h);
  EXPECT_NEAR(world.joint(id, 3).position, -2.5 * world.joint(id, 2).position, 1e-4);
}

TEST(Mimic, HasNoMoreThanItsEffort) {
  model::Model m = followers();
  m.joints[3].max_effort = 0.05 * 2;  // 2 rad/s^2 on 0.05 kg m^2
  m.links[0].inertial.moments = {1e6, 1e6, 1e6};
  World world(rigid::engine, {}, {});
  const InstanceId id = world.add(instance_of("gripper", m, {{0, 0, 1}, {}}));
  world.target(id, 2, {.mode = JointTarget::Mode::velocity, .velocity = 3, .max_effort = 50});
  world.run(100, h);
  EXPECT_NEAR(world.joint(id, 3).velocity, -2 * 0.2, 0.01);
  EXPECT_NEAR(world.joint(id, 3).effort, -0.1, 1e-6);
}

TEST(Linkage, WhatCannotBeIsRefusedByName) {
  const auto error = [](model::Model m) {
    World world(rigid::engine);
    const auto made = world.engine->add(instance_of("m", std::move(m)));
    return made ? std::string() : made.error().text();
  };
  model::Model m = followers();
  m.joints[1].mimic->joint = 1;
  EXPECT_NE(error(m).find("'right' cannot follow"), std::string::npos);
  m.joints[1].mimic->joint = 9;
  EXPECT_NE(error(m).find("'right' cannot follow"), std::string::npos);
  m = followers();
  m.joints[0].type = model::JointType::universal;
  EXPECT_NE(error(m).find("universal joint 'left'"), std::string::npos);
  m.joints[0].second = model::SecondAxis{{0, 1, 0}};
  EXPECT_NE(error(m).find("universal joint 'left'"), std::string::npos);
  m.joints[0].second = model::SecondAxis{{1, 0, 0}, 1, -1};
  EXPECT_NE(error(m).find("limit"), std::string::npos);
  m.joints[0].second = model::SecondAxis{{1, 0, 0}};
  EXPECT_EQ(error(m), "");
  for (const double bad : {0.0, 2.0, 1e300}) {
    m = followers();
    m.links[1].X_ML.q = {bad, 0, 0, 0};
    EXPECT_NE(error(m).find("a pose of link"), std::string::npos) << bad;
    m = followers();
    m.joints[0].X_CJ.q = {bad, 0, 0, 0};
    EXPECT_NE(error(m).find("the pose of joint 'left'"), std::string::npos) << bad;
  }
}

TEST(Linkage, AForgedOrientationOfWhatStandsStillIsRefused) {
  World world(rigid::engine);
  model::Model m = followers();
  m.joints.push_back(joint_of("foot", model::JointType::fixed, model::world_link, 0, {0, 0, 1}));
  const InstanceId id = world.add(instance_of("m", m, {}, true));
  const auto good = world.bytes(id);
  ASSERT_TRUE(world.load(id, good));
  for (const double w : {1e300, std::nan("")}) {
    auto bytes = good;
    std::memcpy(&bytes[2 * 4 + 3 * 8], &w, 8);  // behind two counts and a position
    EXPECT_FALSE(world.load(id, bytes)) << w;
  }
}

TEST(Linkage, RestoredJointsContinueWithTheSameBits) {
  model::Model m = followers();
  m.links.push_back(bare("nut", 0.3, {{0, 0, 1}, {}}));
  m.links.push_back(bare("arm", 0.3, {{0.2, 0, 1.3}, {}}));
  m.joints.push_back(joint_of("thread", model::JointType::screw, 0, 5, {0, 0, 1}));
  m.joints.back().thread_pitch_m = 0.2;
  m.joints.push_back(joint_of("cross", model::JointType::universal, 5, 6, {1, 0, 0}, {{-0.2, 0, 0}, {}}));
  m.joints.back().second = model::SecondAxis{{0, 1, 0}, -0.7, 0.3, 0.01, 0.02};
  World first(rigid::engine), second(rigid::engine);
  const auto fill = [&](World& world) {
    world.add(ground());
    world.add(instance_of("m", m, {{0, 0, 3}, quat_from_rpy(0.3, 0.1, 0)}, true));
    world.target(world.ids[1], 0, {.mode = JointTarget::Mode::velocity, .velocity = 0.1, .max_effort = 5});
    world.target(world.ids[1], 5, {.mode = JointTarget::Mode::velocity, .velocity = 2, .max_effort = 0.1});
  };
  fill(first);
  first.run(200, h);
  fill(second);
  second.steps = first.steps;
  for (std::size_t i = 0; i < 2; ++i) ASSERT_TRUE(second.load(second.ids[i], first.bytes(first.ids[i])));
  for (int k = 0; k < 100; ++k) {
    first.run(1, h);
    second.run(1, h);
    ASSERT_EQ(first.bytes(first.ids[1]), second.bytes(second.ids[1])) << k;
  }
  EXPECT_TRUE(first.engine->check_finite());
}

TEST(Linkage, AScrewAndLooseWheelsComeDownOnTheGround) {
  // Contacts that come and go next to a thread once broke ODE's solver off.
  const Vec3 small{0.01, 0.01, 0.01};
  model::Model m;
  m.links.push_back(link_of("base", Box{{1, 1, 0.4}}, 20));
  m.links[0].inertial.moments = {1, 1, 1};
  m.links.push_back(bare("nut", 1, {{0, 0, 0.8}, {}}, small));
  m.links.push_back(bare("wheel", 1, {{0.5, -0.5, 0.3}, {}}, small));
  m.links.push_back(bare("tool", 0.5, {{-0.5, 0.5, 0.3}, {}}, small));
  m.joints.push_back(joint_of("thread", model::JointType::screw, 0, 1, {0, 0, 1}));
  m.joints.back().thread_pitch_m = 0.1;
  m.joints.push_back(joint_of("spin", model::JointType::continuous, 0, 2, {0, 0, 1}, {{0, 0, 0.05}, {}}));
  m.joints.back().damping = 0.1;
  m.joints.push_back(joint_of("fix", model::JointType::fixed, 0, 3, {0, 0, 1}));
  World world(rigid::engine);
  world.add(static_of("floor", Box{{20, 20, 0.2}}, {{0, 0, 4}, {}}));
  const InstanceId id = world.add(instance_of("machine", m, {{-3, -3, 4.6}, {}}, true));
  world.run(2000, 0.001);
  ASSERT_TRUE(world.engine->check_finite());
  EXPECT_NEAR(world.state(id, 0).X_WB.p.z, 4.3, 1e-3);
}

}  // namespace
}  // namespace sandlot::rigid::linkage_test
