/// Joints against formulas: motors, effort, friction, damping, springs, limits.
#include "physics/rigid/joints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid::joints_test {
namespace {

using namespace test;

constexpr double h = 0.01;

/// A body of 2 kg on one joint along z; inertia 0.4 * 2 * 0.25^2 = 0.05 about it.
struct OneJoint : World {
  InstanceId id;
  explicit OneJoint(model::Joint joint, bool to_world = true, Vec3 gravity = {})
      : World(rigid::engine, {}, gravity) {
    model::Model m;
    if (!to_world) {
      m.links.push_back(link_of("base", Sphere{0.25}, 1e6));
      m.links[0].inertial.moments = {1e6, 1e6, 1e6};
      m.links[0].collisions.clear();
    }
    m.links.push_back(link_of("body", Sphere{0.25}, 2, {{1, 0, 0}, {}}));
    joint.parent = to_world ? model::world_link : 0;
    joint.child = to_world ? 0 : 1;
    m.joints.push_back(joint);
    id = add(instance_of("a", m, {{0, 0, 5}, quat_from_rpy(0, 0, 0.4)}));
  }
  double x() const { return joint(id).position; }
  double v() const { return joint(id).velocity; }
  double effort() const { return joint(id).effort; }
};

model::Joint joint_of(model::JointType type) {
  model::Joint joint;
  joint.name = "joint";
  joint.type = type;
  return joint;
}

struct MovingJoint : ::testing::TestWithParam<std::pair<model::JointType, bool>> {
  model::JointType type = GetParam().first;
  bool to_world = GetParam().second;
  double inertia = type == model::JointType::prismatic ? 2.0 : 0.05;
  model::Joint joint = joint_of(type);
};

TEST_P(MovingJoint, AMotorAcceleratesWithItsEffortThenHoldsItsVelocity) {
  OneJoint world(joint, to_world);
  const double effort = inertia * 4;  // 4 rad/s^2, or m/s^2
  world.target(world.id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 1, .max_effort = effort});
  for (int n = 1; n <= 25; ++n) {
    world.run(1, h);
    EXPECT_NEAR(world.v(), 4 * h * n, 1e-5);
    if (n < 25) { EXPECT_NEAR(world.effort(), effort, 1e-6 * effort) << n; }
  }
  world.run(100, h);
  EXPECT_NEAR(world.v(), 1, 1e-6);
  EXPECT_NEAR(world.effort(), 0, 1e-5);
  // x = sum of h v: 4 h^2 n (n + 1) / 2 for n = 25, then h per step.
  EXPECT_NEAR(world.x(), 4 * h * h * 25 * 26 / 2 + 1, 1e-4);
}

TEST_P(MovingJoint, AnEffortAccelerates) {
  OneJoint world(joint, to_world);
  world.target(world.id, 0, {.mode = JointTarget::Mode::effort, .effort = -inertia * 2});
  world.run(50, h);
  EXPECT_NEAR(world.v(), -2 * 0.5, 1e-5);
  EXPECT_DOUBLE_EQ(world.effort(), -inertia * 2);
  world.target(world.id, 0, {});
  world.run(50, h);
  EXPECT_NEAR(world.v(), -1, 1e-5);
  EXPECT_EQ(world.effort(), 0);
}

TEST_P(MovingJoint, TheDeclaredEffortAndVelocityBoundTheTarget) {
  joint.max_effort = inertia;
  joint.max_velocity = 0.3;
  OneJoint world(joint, to_world);
  world.target(world.id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 5, .max_effort = 1e3});
  world.run(10, h);
  EXPECT_NEAR(world.v(), 0.1, 1e-5);
  world.run(100, h);
  EXPECT_NEAR(world.v(), 0.3, 1e-5);
  world.target(world.id, 0, {.mode = JointTarget::Mode::effort, .effort = 50 * inertia});
  world.run(10, h);
  EXPECT_NEAR(world.v(), 0.4, 1e-5);
}

TEST_P(MovingJoint, FrictionSlowsAndHolds) {
  joint.friction = inertia * 0.5;
  OneJoint world(joint, to_world);
  // Below the friction nothing moves (but for CFM * effort), above it the difference accelerates.
  world.target(world.id, 0, {.mode = JointTarget::Mode::effort, .effort = inertia * 0.4});
  world.run(100, h);
  EXPECT_NEAR(world.v(), 0, 2e-6);
  world.target(world.id, 0, {.mode = JointTarget::Mode::effort, .effort = inertia * 2.5});
  world.run(50, h);
  EXPECT_NEAR(world.v(), 1, 1e-4);
  // A velocity motor has to overcome it: at constant speed its effort is the friction.
  world.target(world.id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 1, .max_effort = 100});
  world.run(10, h);
  EXPECT_NEAR(world.effort(), inertia * 0.5, 1e-4);
  // Let go it comes to rest in 2 s.
  world.target(world.id, 0, {});
  world.run(100, h);
  EXPECT_NEAR(world.v(), 0.5, 1e-3);
  world.run(110, h);
  EXPECT_NEAR(world.v(), 0, 1e-6);
}

TEST_P(MovingJoint, ASpringWithDampingIsImplicitEuler) {
  const double k = inertia * 30, d = inertia * 0.8, x0 = 0.5;
  joint.spring_stiffness = k;
  joint.damping = d;
  joint.spring_reference = x0;
  OneJoint world(joint, to_world);
  double x = 0, v = 0;
  for (int n = 0; n < 300; ++n) {
    world.run(1, h);
    // I (v' - v) / h = -k (x + h v' - x0) - d v'
    v = (v - h * k / inertia * (x - x0)) / (1 + h * d / inertia + h * h * k / inertia);
    x += h * v;
    // A base of 1e6 kg gives way by some 1e-5 of the motion.
    ASSERT_NEAR(world.v(), v, to_world ? 1e-7 : 5e-5) << n;
    ASSERT_NEAR(world.x(), x, to_world ? 1e-7 : 5e-5) << n;
  }
}

TEST_P(MovingJoint, DampingAloneDecaysAndSurvivesAnyValue) {
  for (const double rate : {2.0, 1e6}) {
    joint.damping = inertia * rate;
    OneJoint world(joint, to_world);
    world.target(world.id, 0, {.mode = JointTarget::Mode::effort, .effort = inertia * 10});
    world.run(20, h);
    const double v0 = world.v();
    // v <- (v + h 10) / (1 + h rate)
    double v = 0;
    for (int n = 0; n < 20; ++n) v = (v + h * 10) / (1 + h * rate);
    EXPECT_NEAR(v0, v, 1e-5 * std::max(1.0, v));
    world.target(world.id, 0, {});
    world.run(30, h);
    EXPECT_NEAR(world.v(), v0 * math::pow(1 + h * rate, -30), 1e-5);
  }
}

TEST_P(MovingJoint, LimitsHoldAgainstTheMotor) {
  if (type == model::JointType::continuous) {
    joint.lower = -0.1, joint.upper = 0.1;  // means nothing on a continuous joint
    OneJoint world(joint, to_world);
    world.target(world.id, 0,
                 {.mode = JointTarget::Mode::velocity, .velocity = 2, .max_effort = 10 * inertia});
    world.run(100, h);
    EXPECT_GT(world.x(), 1);
    return;
  }
  joint.lower = -0.2;
  joint.upper = 0.3;
  OneJoint world(joint, to_world);
  for (const double sign : {1.0, -1.0}) {
    const double limit = sign > 0 ? 0.3 : -0.2;
    world.target(world.id, 0,
                 {.mode = JointTarget::Mode::velocity, .velocity = sign, .max_effort = 10 * inertia});
    double farthest = 0;
    for (int i = 0; i < 200; ++i) {
      world.run(1, h);
      farthest = std::max(farthest, sign * world.x());
    }
    EXPECT_NEAR(world.x(), limit, 1e-4);               // CFM * effort * h / ERP
    EXPECT_LE(farthest, sign * limit + 1 * h + 1e-6);  // one sub-step at 1 per second
    EXPECT_NEAR(world.effort(), sign * 10 * inertia, 1e-3 * inertia);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, MovingJoint,
                         ::testing::Values(std::pair{model::JointType::continuous, true},
                                           std::pair{model::JointType::continuous, false},
                                           std::pair{model::JointType::revolute, true},
                                           std::pair{model::JointType::revolute, false},
                                           std::pair{model::JointType::prismatic, true},
                                           std::pair{model::JointType::prismatic, false}));

TEST(RigidJoints, ARevoluteLimitMayLieBeyondATurn) {
  model::Joint joint = joint_of(model::JointType::revolute);
  joint.lower = -10;
  joint.upper = 9;
  OneJoint world(joint);
  world.target(world.id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 5, .max_effort = 5});
  world.run(150, h);
  EXPECT_GT(world.x(), 6.5);
  world.run(200, h);
  EXPECT_NEAR(world.x(), 9, 1e-3);
}

TEST(RigidJoints, AFastWheelCountsItsTurns) {
  OneJoint world(joint_of(model::JointType::continuous));
  world.target(world.id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 200, .max_effort = 1e6});
  world.run(1, h);
  const double start = world.x();
  world.run(500, h);  // 2 rad per sub-step, 159 turns
  EXPECT_NEAR(world.x() - start, 200 * 5, 1e-3);
}

TEST(RigidJoints, AWheelsAxisTurnsWithItsRobot) {
  // Yawing at 2 rad/s with wheels at 40 rad/s, in opposite senses so that nothing turns the base. In 10 ms
  // the axis turns by 0.02 rad and the wheel by 0.4: adding both up as one rotation would tilt the axis by
  // half their product, 4e-3 rad per sub-step, which ERP could only bound to 5 times that.
  World world(rigid::engine, {}, Vec3{});
  model::Model m;
  m.links.push_back(link_of("base", Box{{0.4, 0.3, 0.1}}, 5));
  for (const double y : {0.2, -0.2}) {
    m.links.push_back(
        link_of("wheel", Cylinder{0.1, 0.04}, 0.5, {{0, y, 0}, quat_from_rpy(-math::pi / 2, 0, 0)}));
    model::Joint axle = joint_of(model::JointType::continuous);
    axle.parent = 0;
    axle.child = static_cast<std::uint32_t>(m.links.size() - 1);
    m.joints.push_back(axle);
  }
  const InstanceId id = world.add(instance_of("a", m, {}, true));
  for (const std::size_t j : {0u, 1u})
    world.target(id, j, {.mode = JointTarget::Mode::velocity, .velocity = j ? -40.0 : 40.0, .max_effort = 1});
  world.drive(id, {.wz_radps = 2});
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    world.run(1, h);
    const Vec3 axis = rotate(world.state(id, 1).X_WB.q, {0, 0, 1}),
               y = rotate(world.state(id, 0).X_WB.q, {0, 1, 0});
    worst = std::max(worst, norm(cross(axis, y)));
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_NEAR(world.state(id).V_WB.angular.z, 2, 1e-5);
  // Measured about the axis as it stands after the sub-step, 0.02 rad from the one that the motor turned
  // about.
  EXPECT_NEAR(world.joint(id).velocity, 40 * math::cos(0.02), 1e-5);
  EXPECT_NEAR(world.joint(id, 1).velocity, -40 * math::cos(0.02), 1e-5);
}

TEST(RigidJoints, ASpinningWheelDoesNotTiltADrivenRobot) {
  World world(rigid::engine, {}, Vec3{});
  model::Model m;
  m.links.push_back(link_of("base", Box{{1, 1, 1}}, 50));
  m.links.push_back(
      link_of("wheel", Cylinder{0.1, 0.04}, 0.5, {{0, 0.6, 0}, quat_from_rpy(-math::pi / 2, 0, 0)}));
  model::Joint axle = joint_of(model::JointType::continuous);
  axle.parent = 0;
  axle.child = 1;
  m.joints.push_back(axle);
  const InstanceId id = world.add(instance_of("a", m, {}, true));
  // Spun up from outside, so that the base does not turn the other way: 40 rad/s, angular momentum L = 0.1.
  const double inertia = 0.5 * 0.5 * 0.01;
  const Wrench spin{world.engine->bodies(id)[1], {}, {0, 40 * inertia / h, 0}};
  world.engine->apply(std::span(&spin, 1));
  world.run(1, h);
  EXPECT_NEAR(world.joint(id).velocity, 40, 1e-6);
  world.drive(id, {.wz_radps = 2});
  // A free body would answer the turning of the axis with L w = 0.2 Nm, and roll back and forth with L / I =
  // 0.012 rad/s.
  double roll = 0;
  for (int i = 0; i < 300; ++i) {
    world.run(1, h);
    const Vec3 w = world.state(id).V_WB.angular;
    roll = std::max(roll, std::sqrt(w.x * w.x + w.y * w.y));
  }
  EXPECT_LT(roll, 2e-4);
  EXPECT_NEAR(world.joint(id).velocity, 40, 0.1);
}

TEST(RigidJoints, AMotorThatHoldsAWeightShowsItsTorque) {
  World world(rigid::engine);
  for (const bool slides : {false, true}) {
    model::Model m;
    m.links.push_back(link_of("arm", Sphere{0.1}, 2, {{0, 0, slides ? 5.0 : 0.0}, {}}));
    m.links[0].inertial.X_LCo.p = {0.5, 0.1,
                                   0.2};  // away from the anchor, whose force must not be mistaken for torque
    m.links[0].collisions.clear();
    model::Joint joint = joint_of(slides ? model::JointType::prismatic : model::JointType::revolute);
    joint.axis_J = slides ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    joint.parent = model::world_link;
    m.joints.push_back(joint);
    const InstanceId id = world.add(instance_of("arm", m));
    world.target(id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 0, .max_effort = 100});
    world.run(50, h);
    // About +y gravity turns a mass at +x by +m g x; the motor holds against it.
    EXPECT_NEAR(world.joint(id).effort, slides ? 2 * 9.81 : -2 * 9.81 * 0.5, 1e-3);
  }
}

TEST(RigidJoints, WhatAJointPushesPushesBack) {
  for (const bool slides : {false, true})
    for (const auto mode : {JointTarget::Mode::effort, JointTarget::Mode::velocity}) {
      World world(rigid::engine, {}, Vec3{});
      model::Model m;
      m.links = {link_of("a", Sphere{0.1}, 1), link_of("b", Sphere{0.2}, 3, {{0.5, 0.2, 0}, {}})};
      for (model::Link& link : m.links) link.collisions.clear();
      model::Joint joint = joint_of(slides ? model::JointType::prismatic : model::JointType::continuous);
      joint.axis_J = {0, 1, 0};
      joint.parent = 0;
      joint.child = 1;
      m.joints.push_back(joint);
      const InstanceId id = world.add(instance_of("two", m));
      world.target(id, 0, {.mode = mode, .velocity = 1, .max_effort = 2, .effort = 2});
      world.run(20, h);
      Vec3 momentum, spin;
      for (std::size_t l = 0; l < 2; ++l) {
        const double mass = l ? 3 : 1, inertia = inertia_kg_m2(Sphere{l ? 0.2 : 0.1}, mass).x;
        const BodyState& s = world.state(id, l);
        momentum += mass * s.V_WB.linear;
        spin += mass * cross(s.X_WB.p, s.V_WB.linear) + inertia * s.V_WB.angular;
      }
      EXPECT_GT(world.joint(id).velocity, 0.1);
      EXPECT_LT(norm(momentum), 1e-12);
      // The sub-step moves along straight lines, so angular momentum is kept to first order in h only.
      EXPECT_LT(norm(spin), slides ? 1e-3 : 5e-3);
    }
}

TEST(RigidJoints, ABallJointHoldsItsPointAndItsDampingDecays) {
  model::Joint joint = joint_of(model::JointType::ball);
  joint.damping = 0.05 * 3;
  OneJoint world(joint);
  const Vec3 anchor = world.state(world.id).X_WB.p;
  world.push(world.id, {}, {0.05 * 2 / h, 0.05 * 1 / h, 0});
  world.run(1, h);
  // (w + dw) / (1 + h d / I)
  EXPECT_NEAR(world.state(world.id).V_WB.angular.x, 2 / (1 + h * 3), 1e-6);
  world.run(100, h);
  EXPECT_NEAR(world.state(world.id).V_WB.angular.y, math::pow(1 + h * 3, -101), 1e-5);
  EXPECT_LT(norm(world.state(world.id).X_WB.p - anchor), 1e-6);
}

TEST(RigidJoints, ABallJointsFrictionHolds) {
  model::Joint joint = joint_of(model::JointType::ball);
  joint.friction = 0.2;
  OneJoint world(joint);
  world.engine->set_pose(world.id, {{0, 0, 5}, {}});  // its axes are those of J: let them be the world's
  for (int i = 0; i < 100; ++i) {
    world.push(world.id, {}, {0.15, 0, 0});
    world.run(1, h);
  }
  EXPECT_NEAR(world.state(world.id).V_WB.angular.x, 0, 1e-6);
  for (int i = 0; i < 100; ++i) {
    world.push(world.id, {}, {0.25, 0, 0});
    world.run(1, h);
  }
  EXPECT_NEAR(world.state(world.id).V_WB.angular.x, 0.05 / 0.05, 1e-4);
}

TEST(RigidJoints, ALoopOfJointsWorks) {
  // A four-bar parallelogram in the vertical plane: crank and rocker are equal, so the coupler keeps its
  // attitude.
  World world(rigid::engine, {}, Vec3{0, 0, -9.81});
  model::Model m;
  const auto bar = [&](const char* name, Vec3 at, Vec3 size) {
    model::Link link = link_of(name, Box{size}, 0.5, {at, {}});
    link.collisions.clear();
    m.links.push_back(link);
  };
  bar("crank", {0, 0, 0.25}, {0.02, 0.02, 0.5});
  bar("coupler", {0.5, 0, 0.5}, {1, 0.02, 0.02});
  bar("rocker", {1, 0, 0.25}, {0.02, 0.02, 0.5});
  const auto hinge = [&](std::uint32_t parent, std::uint32_t child, Vec3 at_child) {
    model::Joint j = joint_of(model::JointType::continuous);
    j.parent = parent;
    j.child = child;
    j.X_CJ.p = at_child;
    j.axis_J = {0, 1, 0};
    m.joints.push_back(j);
  };
  hinge(model::world_link, 0, {0, 0, -0.25});
  hinge(0, 1, {-0.5, 0, 0});
  hinge(1, 2, {0, 0, 0.25});
  hinge(model::world_link, 2, {0, 0, -0.25});
  const InstanceId id = world.add(instance_of("bars", m));
  world.target(id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 1, .max_effort = 100});
  world.run(100, 0.01);
  EXPECT_NEAR(world.joint(id, 0).position, 1, 0.02);
  EXPECT_NEAR(world.joint(id, 3).position, world.joint(id, 0).position, 2e-3);
  EXPECT_NEAR(rpy_from_quat(world.state(id, 1).X_WB.q).y, 0, 2e-3);
}

TEST(RigidJoints, WhatIsFixedToTheWorldStays) {
  World world(rigid::engine);
  model::Model m;
  m.links.push_back(link_of("post", Box{{0.1, 0.1, 1}}, 1, {{0, 0, 0.5}, {}}));
  m.links.push_back(link_of("arm", Box{{0.5, 0.1, 0.1}}, 1, {{0.3, 0, 0.9}, {}}));
  model::Joint root = joint_of(model::JointType::fixed);
  root.parent = model::world_link;
  root.child = 0;
  model::Joint shoulder = joint_of(model::JointType::revolute);
  shoulder.parent = 0;
  shoulder.child = 1;
  shoulder.X_CJ.p = {-0.3, 0, 0};
  m.joints = {root, shoulder};
  const InstanceId id = world.add(instance_of("arm", m, {{1, 0, 0}, {}}));
  world.target(id, 1, {.mode = JointTarget::Mode::velocity, .velocity = 1, .max_effort = 5});
  world.run(50, 0.01);
  EXPECT_NEAR(world.joint(id, 1).position, 0.5, 0.02);
  EXPECT_EQ(world.state(id, 0).X_WB.p, (Vec3{1, 0, 0.5}));
  // The whole thing moves with set_pose: the shoulder is then held at its new place.
  world.engine->set_pose(id, {{5, 5, 0}, {}});
  world.run(50, 0.01);
  EXPECT_NEAR(world.joint(id, 1).position, 1.0, 0.03);
  EXPECT_EQ(world.state(id, 0).X_WB.p, (Vec3{5, 5, 0.5}));
  EXPECT_NEAR(norm(world.state(id, 1).X_WB.p - Vec3{5, 5, 0.9}), 0.3, 1e-4);
}

TEST(RigidJoints, WhatCannotBeBuiltIsNamed) {
  World world(rigid::engine);
  const auto complaint = [&](model::Model m) {
    auto id = world.engine->add(instance_of("a", std::move(m)));
    return id ? std::string() : id.error().text();
  };
  model::Model two;
  two.links = {link_of("one", Sphere{0.1}, 1), link_of("two", Sphere{0.1}, 1)};
  two.joints.push_back(joint_of(model::JointType::ball));
  two.joints[0].child = 1;
  EXPECT_EQ(complaint(two), "");
  auto bad = two;
  bad.joints[0].spring_stiffness = 1;
  EXPECT_NE(complaint(bad).find("springs on ball joints"), std::string::npos);
  bad = two;
  bad.joints[0].axis_J = {};
  EXPECT_NE(complaint(bad).find("axis"), std::string::npos);
  bad = two;
  bad.joints[0].parent = 1;
  EXPECT_NE(complaint(bad).find("itself"), std::string::npos);
  bad = two;
  bad.joints[0].damping = -1;
  EXPECT_NE(complaint(bad).find("negative"), std::string::npos);
  bad.joints[0].damping = 1e-310;  // the library would divide by it
  EXPECT_NE(complaint(bad).find("beyond 1e30"), std::string::npos);
  bad = two;
  bad.joints[0].max_effort = std::nan("");
  EXPECT_NE(complaint(bad).find("effort"), std::string::npos);
  bad = two;
  bad.joints[0].type = model::JointType::revolute;
  bad.joints[0].lower = 1, bad.joints[0].upper = 0;
  EXPECT_NE(complaint(bad).find("limit"), std::string::npos);
  bad = two;
  bad.links[1].inertial.mass_kg = 0;
  EXPECT_NE(complaint(bad).find("mass of link 'two'"), std::string::npos);
  bad = two;
  bad.links[1].inertial.moments = {1, 1, -1};
  EXPECT_NE(complaint(bad).find("inertia of link 'two'"), std::string::npos);
  bad = two;
  bad.links[0].collisions[0].shape = Plane{{0, 0, 1}};
  EXPECT_NE(complaint(bad).find("plane"), std::string::npos);
  bad = two;
  bad.links[0].collisions[0].shape = Box{{1, 0, 1}};
  EXPECT_NE(complaint(bad).find("size"), std::string::npos);
}

TEST(JointTarget, OneThatIsNotFiniteEndsTheRunBeforeTheLibraryMeetsIt) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  for (const JointTarget& bad :
       {JointTarget{.mode = JointTarget::Mode::velocity, .velocity = nan, .max_effort = 1},
        JointTarget{.mode = JointTarget::Mode::effort, .effort = inf},
        JointTarget{.mode = JointTarget::Mode::effort, .damping = nan}}) {
    OneJoint world(joint_of(model::JointType::revolute), true);
    world.run(2, h);
    const auto before = world.bytes(world.id);
    world.target(world.id, 0, bad);
    world.run(2, h);
    const Status status = world.engine->check_finite();
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().what.find("/joint' is not finite"), std::string::npos) << status.error().what;
    EXPECT_EQ(world.bytes(world.id), before) << "the state of before is kept";
  }
}

}  // namespace
}  // namespace sandlot::rigid::joints_test
