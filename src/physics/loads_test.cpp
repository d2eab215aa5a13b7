/// Forces of contacts, loads of joints, and motors that bring inertia and friction: predicted by Newton and
/// Euler.
#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "physics/test_world.h"

namespace sandlot::loads_test {
namespace {

using namespace test;

class EngineLoads : public ::testing::TestWithParam<const EngineKind*> {
 protected:
  const EngineKind& kind = *GetParam();
  // In the plane contacts with the ground are not reported.
  bool has_forces = World(kind).engine->capabilities().contact_forces &&
                    !World(kind).engine->capabilities().planar;
  bool has_loads = World(kind).engine->capabilities().joint_loads;
};

constexpr double g = 9.81, h = 0.001;

model::Joint joint_of(const std::string& name, model::JointType type, std::uint32_t parent,
                      std::uint32_t child, Pose X_CJ = {}, Vec3 axis = {0, 0, 1}) {
  model::Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.X_CJ = X_CJ;
  joint.axis_J = axis;
  return joint;
}

struct Watched : World {
  using World::load;
  using World::World;
  /// One sub-step whose contacts with `body` are watched. @return their sum on it
  Vec3 force_on(InstanceId id, std::size_t link = 0) {
    const BodyId body = engine->bodies(id)[link];
    Watch watch;
    watch.contacts.push_back(body);
    engine->watch(watch);
    run(1, h);
    Vec3 sum;
    for (const Contact& c : engine->contacts()) {
      if (c.b == body) sum += c.force_W;
      if (c.a == body) sum -= c.force_W;
    }
    return sum;
  }
  JointLoad load(InstanceId id, std::size_t joint) {
    Watch watch;
    watch.loads.push_back(engine->joints(id)[joint]);
    engine->watch(watch);
    run(1, h);
    return engine->joint_loads()[watch.loads[0].index];
  }
};

void expect_near(Vec3 is, Vec3 should, double tolerance) {
  EXPECT_NEAR(is.x, should.x, tolerance);
  EXPECT_NEAR(is.y, should.y, tolerance);
  EXPECT_NEAR(is.z, should.z, tolerance);
}

TEST_P(EngineLoads, ABoxThatRestsWeighsWhatItWeighs) {
  Watched world(kind);
  const InstanceId floor = world.add(static_of("floor", Box{{2, 2, 0.1}}, {{0, 0, -0.05}, {}}));
  const InstanceId box = world.add(body_of("box", Box{{0.2, 0.2, 0.2}}, 2, {{0, 0, 0.1}, {}}, {}, true));
  world.run(1000, h);
  // Settled to 1e-6 m/s; what is left of the acceleration is below 1e-4 m/s^2.
  const Vec3 weight = has_forces ? Vec3{0, 0, 2 * g} : Vec3{};
  expect_near(world.force_on(box), weight, 2e-4);
  expect_near(world.force_on(floor), -weight, 2e-4);
  // Watching lasts one step.
  world.run(1, h);
  for (const Contact& c : world.engine->contacts()) EXPECT_EQ(c.force_W, Vec3{});
}

TEST_P(EngineLoads, TheImpulseOfACollisionIsTheChangeOfMomentum) {
  if (!has_forces) return;
  Watched world(kind);
  world.add(ground({.mu = 0.5, .restitution = 0.6}));
  const InstanceId ball = world.add(
      body_of("ball", Sphere{0.1}, 3, {{0, 0, 0.3}, {}}, {.restitution = 0.6}, true));
  world.push(ball, {1000, 0, 0});  // 1/3 m/s along, so that there is friction
  const Vec3 before = world.state(ball).V_WB.linear;
  Vec3 impulse;
  int n = 0, touched = 0;
  for (; n < 400; ++n) {
    const Vec3 force = world.force_on(ball);
    impulse += h * force;
    touched += force.z > 0;
  }
  const Vec3 change = 3 * (world.state(ball).V_WB.linear - before) - Vec3{0, 0, -3 * g * h * n} -
                      Vec3{1000 * h, 0, 0};
  EXPECT_GT(touched, 0);
  EXPECT_GT(impulse.z, 3 * 1.9);  // it fell 0.2 m: 1.98 m/s
  EXPECT_LT(impulse.x, -1e-3);    // friction slowed it
  expect_near(impulse, change, 1e-9);
}

/// A base fixed to the world with an arm of 2 kg whose centre lies 0.3 m along x of the joint.
model::Model arm(model::JointType type, std::uint32_t base_mass = 1) {
  model::Model m;
  m.links = {link_of("base", Box{{0.1, 0.1, 0.1}}, base_mass, {{0, 0, 1}, {}}),
             link_of("arm", Box{{0.2, 0.05, 0.05}}, 2, {{0.3, 0, 1}, {}})};
  m.links[0].collisions.clear();
  m.links[1].collisions.clear();
  m.joints = {joint_of("stand", model::JointType::fixed, model::world_link, 0),
              joint_of("shoulder", type, 0, 1, {{-0.3, 0, 0}, {}}, {0, 1, 0})};
  return m;
}

TEST_P(EngineLoads, AJointBearsTheWeightBeyondItWithItsLeverArm) {
  if (!has_loads) return;
  for (const auto type : {model::JointType::fixed, model::JointType::revolute, model::JointType::prismatic}) {
    Watched world(kind);
    const InstanceId id = world.add(instance_of("a", arm(type), {{1, 2, 0}, quat_from_rpy(0, 0, 0.7)}, true));
    if (type != model::JointType::fixed)
      world.target(id, 1, {.mode = JointTarget::Mode::velocity, .max_effort = 1e4});
    world.run(200, h);
    // In J, whose x points along the arm: m g upwards; r x F = (0.3,0,0) x (0,0,mg) = (0, -0.3 mg, 0). The
    // rows of ODE yield by CFM * force = 2e-5 m/s, and the load is that of a body that has come to rest so.
    const JointLoad shoulder = world.load(id, 1);
    expect_near(shoulder.force_N, {0, 0, 2 * g}, 1e-3);
    expect_near(shoulder.torque_Nm, {0, -0.3 * 2 * g, 0}, 1e-3);
    // The joint below bears the base too; its origin is the base's.
    const JointLoad stand = world.load(id, 0);
    expect_near(stand.force_N, {0, 0, 3 * g}, 1e-3);
    expect_near(stand.torque_Nm, {0, -0.3 * 2 * g, 0}, 1e-3);
  }
}

TEST_P(EngineLoads, APushedJointBearsTheEffortToo) {
  if (!has_loads) return;
  Watched world(kind, {}, {0, 0, 0});
  const InstanceId id = world.add(instance_of("a", arm(model::JointType::revolute), {}, true));
  world.target(id, 1, {.mode = JointTarget::Mode::effort, .effort = 0.5});
  // From rest: torque about the axis is the effort, and the centre's acceleration alpha r needs a force
  // across the arm.
  const Vec3 moments = inertia_kg_m2(Box{{0.2, 0.05, 0.05}}, 2);
  const double alpha = 0.5 / (moments.y + 2 * 0.09);
  const JointLoad load = world.load(id, 1);
  expect_near(load.torque_Nm, {0, 0.5, 0}, 1e-9);
  expect_near(load.force_N, {0, 0, -2 * 0.3 * alpha},
              3e-4);  // CFM / h = 1e-3 per N in addition to 1/m + r^2/I
}

TEST_P(EngineLoads, FreeFallLoadsNothingAndAPushLoadsByInertia) {
  if (!has_loads) return;
  model::Model m = arm(model::JointType::fixed);
  m.joints.erase(m.joints.begin());  // no stand: both fall
  Watched world(kind);
  const InstanceId id = world.add(instance_of("a", m, {{0, 0, 50}, {}}, true));
  expect_near(world.load(id, 0).force_N, {}, 1e-9);
  // A push at the base's centre. Its line lies off the common centre of mass by 0.2 m (of 0.3, masses 1 and
  // 2).
  Watch watch;
  watch.loads.push_back(world.engine->joints(id)[0]);
  world.engine->watch(watch);
  world.push(id, {0, 6, 0}, {0, 0, 0.1});
  world.run(1, h);
  const JointLoad load = world.engine->joint_loads()[watch.loads[0].index];
  const double base_I = inertia_kg_m2(Box{{0.1, 0.1, 0.1}}, 1).z,
               arm_I = inertia_kg_m2(Box{{0.2, 0.05, 0.05}}, 2).z;
  const double I = base_I + arm_I + 1 * 0.04 + 2 * 0.01;
  const double alpha = (0.1 - 0.2 * 6) / I, a_arm = 6.0 / 3 + alpha * 0.1;
  // Half the new turning rate, 9 mrad/s, already bends the path: m w^2 r = 1e-5 N.
  expect_near(load.force_N, {0, 2 * a_arm, 0}, 1e-4);
  expect_near(load.torque_Nm, {0, 0, arm_I * alpha + 0.3 * 2 * a_arm}, 1e-9);
  // The push on the arm itself is not the joint's.
  world.engine->watch(watch);
  const Wrench on_arm{world.engine->bodies(id)[1], {0, 6, 0}, {}};
  world.engine->apply(std::span(&on_arm, 1));
  world.run(1, h);
  // What the joint passes on to the base accelerates the base alone: the arm's a is 2 + 0.1 alpha, the base's
  // 2 - 0.2 alpha.
  const double alpha2 = 0.1 * 6 / I;
  EXPECT_NEAR(world.engine->joint_loads()[watch.loads[0].index].force_N.y, -(2 - 0.2 * alpha2), 1e-2);
}

/// A hub that turns about z with, fixed to it, a tip of 0.5 kg whose centre is 0.4 m from the axis; J is at
/// 0.25 m.
model::Model rotor() {
  model::Model m;
  m.links = {link_of("base", Box{{0.1, 0.1, 0.1}}, 1), link_of("hub", Box{{0.2, 0.05, 0.05}}, 1),
             link_of("tip", Box{{0.05, 0.05, 0.05}}, 0.5, {{0.4, 0, 0}, quat_from_rpy(0, 0, math::pi / 2)})};
  for (model::Link& link : m.links) link.collisions.clear();
  m.joints = {joint_of("stand", model::JointType::fixed, model::world_link, 0),
              joint_of("axle", model::JointType::continuous, 0, 1),
              joint_of("glue", model::JointType::fixed, 1, 2, {{0, 0.15, 0}, {}})};
  return m;
}

TEST_P(EngineLoads, ASpinningTipIsHeldTowardsTheAxis) {
  if (!has_loads) return;
  Watched world(kind, {}, {0, 0, 0});
  const InstanceId id = world.add(instance_of("a", rotor(), {}, true));
  world.target(id, 1, {.mode = JointTarget::Mode::velocity, .velocity = 8, .max_effort = 100});
  world.run(500, h);
  // m w^2 r towards the axis, which is +y of the tip's own frame (its x points along the hub's y, its y
  // inwards), and so it is in every position. w h = 0.008: a step's chord differs by (w h)^2 / 24.
  const double force = 0.5 * 64 * 0.4;
  for (int i = 0; i < 5; ++i) {
    const JointLoad tip = world.load(id, 2);
    expect_near(tip.force_N, {0, force, 0}, 1e-4 * force);
    expect_near(tip.torque_Nm, {}, 1e-4);
    // The axle holds both: hub centre on the axis, so the same force, along the hub's -x.
    const JointLoad axle = world.load(id, 1);
    expect_near(axle.force_N, {-force, 0, 0}, 1e-3 * force);
    world.run(37, h);
  }
  // Braking with 2 Nm: alpha = -2 / I; the tip needs m r alpha across, and that has the lever arm of 0.15 m
  // about J.
  world.target(id, 1, {.mode = JointTarget::Mode::effort, .effort = -2});
  const double tip_I = inertia_kg_m2(Box{{0.05, 0.05, 0.05}}, 0.5).z;
  const double I = inertia_kg_m2(Box{{0.2, 0.05, 0.05}}, 1).z + tip_I + 0.5 * 0.16, alpha = -2 / I;
  const JointLoad tip = world.load(id, 2);
  // The tip is turned by 90 deg: the hub's y is its x. In this step the turning rate has already sunk by
  // 1.5e-3 of it.
  expect_near(tip.force_N, {0.5 * 0.4 * alpha, force, 0}, 5e-3 * force);
  EXPECT_NEAR(tip.torque_Nm.z, tip_I * alpha + 0.15 * 0.5 * 0.4 * alpha, 1e-3);
}

TEST_P(EngineLoads, WhatStandsOnAFixedPlateIsBorneByItsJoint) {
  if (!has_loads) return;
  model::Model m;
  m.links = {link_of("foot", Box{{0.1, 0.1, 0.1}}, 1, {{0, 0, 0.05}, {}}),
             link_of("plate", Box{{1, 1, 0.1}}, 4, {{0, 0, 0.15}, {}})};
  m.joints = {joint_of("cell", model::JointType::fixed, 0, 1)};
  for (const bool stands : {true, false}) {
    model::Model scale = m;
    scale.is_static = stands;
    Watched world(kind);
    world.add(ground());
    const InstanceId id = world.add(instance_of("scale", scale, {}, true));
    world.add(body_of("box", Box{{0.1, 0.1, 0.1}}, 3, {{0.02, 0, 0.25}, {}}, {}, true));
    world.run(2000, h);
    const JointLoad load = world.load(id, 0);
    expect_near(load.force_N, {0, 0, 7 * g}, 1e-2);
    expect_near(load.torque_Nm, {0, -0.02 * 3 * g, 0}, 1e-2);
  }
}

TEST_P(EngineLoads, WhatHangsOnAFixedLinkIsBorneByItsJoint) {
  if (!has_loads) return;
  model::Model m = rotor();
  // Now the tip carries a pendulum of 0.3 kg on a free hinge, hanging straight down.
  m.links.push_back(link_of("bob", Box{{0.02, 0.02, 0.02}}, 0.3, {{0.4, 0, -0.2}, {}}));
  m.links.back().collisions.clear();
  m.joints.push_back(joint_of("pivot", model::JointType::continuous, 2, 3, {{0, 0, 0.2}, {}}, {1, 0, 0}));
  m.joints[1].type = model::JointType::fixed;
  Watched world(kind);
  const InstanceId id = world.add(instance_of("a", m, {}, true));
  world.run(200, h);
  const JointLoad glue = world.load(id, 2);
  expect_near(glue.force_N, {0, 0, 0.8 * g}, 1e-3);
  // J lies 0.15 m inwards of the tip's centre: along +y of the tip. r = (0, -0.15, 0): r x (0,0,F) = (-0.15
  // F, 0, 0).
  expect_near(glue.torque_Nm, {-0.15 * 0.8 * g, 0, 0}, 1e-3);
}

/// A flywheel of inertia 1 kg m^2 on an axle.
model::Model flywheel(model::JointType type = model::JointType::continuous) {
  model::Model m = arm(type);
  m.links[1].X_ML.p = {0, 0, 1};
  m.joints[1].X_CJ = {};
  m.links[1].inertial.moments = {1, 1, 1};
  m.links[1].inertial.mass_kg = 1;
  return m;
}

TEST_P(EngineLoads, AMotorsInertiaDampingAndFrictionActOnTheEndOfTheStep) {
  if (!has_loads) return;
  for (const auto type :
       {model::JointType::continuous, model::JointType::revolute, model::JointType::prismatic}) {
    World world(kind, {}, {0, 0, 0});
    const InstanceId id = world.add(instance_of("a", flywheel(type), {}, true));
    const JointTarget motor{
        .mode = JointTarget::Mode::effort, .effort = 5, .damping = 2000, .inertia = 3, .friction = 1};
    double v = 0;
    for (int i = 0; i < 5; ++i) {
      world.target(id, 1, motor);
      world.run(1, h);
      // (1 + 3) (v' - v) / h = 5 - 1 - 2000 v', a damping that no explicit step of 1 ms would survive
      v = (4 / h * v + 4) / (4 / h + 2000);
      EXPECT_NEAR(world.joint(id, 1).velocity, v, 1e-5 * v) << i;
    }
    EXPECT_NEAR(world.joint(id, 1).effort, 5 - 2000 * v - 3 * (4 - 2000 * v) / 4, 1e-2);
    world.run(2000, h);
    EXPECT_NEAR(world.joint(id, 1).velocity, 4.0 / 2000, 1e-7);
    // Without its own slope the motor is a plain effort again.
    world.target(id, 1, {.mode = JointTarget::Mode::effort, .effort = 5});
    const double before = world.joint(id, 1).velocity;
    world.run(1, h);
    EXPECT_NEAR(world.joint(id, 1).velocity - before, 5 * h, 1e-7);
  }
}

TEST_P(EngineLoads, FrictionHoldsAMotorUntilItBreaksAway) {
  if (!has_loads) return;
  World world(kind, {}, {0, 0, 0});
  const InstanceId id = world.add(instance_of("a", flywheel(), {}, true));
  JointTarget motor{
      .mode = JointTarget::Mode::effort, .effort = 0.9, .damping = 0.1, .inertia = 2, .friction = 1};
  world.target(id, 1, motor);
  world.run(100, h);
  EXPECT_NEAR(world.joint(id, 1).velocity, 0, 1e-5);  // CFM lets it creep by 1e-6 per Nm
  motor.effort = 1.3;
  world.target(id, 1, motor);
  world.run(100, h);
  EXPECT_NEAR(world.joint(id, 1).velocity, 0.3 / 3 * 0.1, 1e-4);  // 0.3 Nm on 3 kg m^2 for 0.1 s
}

TEST_P(EngineLoads, AWatchedRunIsRestoredWithTheSameBits) {
  if (!has_loads) return;
  const auto make = [&] {
    auto world = std::make_unique<Watched>(kind);
    world->add(ground());
    model::Model m = flywheel();
    m.joints.erase(m.joints.begin());
    m.links[0] = link_of("base", Box{{0.4, 0.4, 0.1}}, 3, {{0, 0, 0.05}, {}});
    world->add(instance_of("a", m, {}, true));
    return world;
  };
  auto one = make(), two = make();
  const InstanceId a = one->ids[1], b = two->ids[1];
  one->target(
      a, 0,
      {.mode = JointTarget::Mode::effort, .effort = 3, .damping = 0.5, .inertia = 0.2, .friction = 0.4});
  for (int i = 0; i < 50; ++i) one->load(a, 0);
  ASSERT_TRUE(two->load(b, one->bytes(a)));
  two->steps = one->steps;
  for (int i = 0; i < 50; ++i) {
    one->force_on(a);
    two->force_on(b);
    ASSERT_EQ(one->bytes(a), two->bytes(b)) << i;
    one->load(a, 0);
    two->load(b, 0);
    ASSERT_EQ(one->bytes(a), two->bytes(b)) << i;
  }
}

std::string engine_name(const ::testing::TestParamInfo<const EngineKind*>& info) { return info.param->name; }
INSTANTIATE_TEST_SUITE_P(Engines, EngineLoads, ::testing::ValuesIn(engine_kinds()), engine_name);

}  // namespace
}  // namespace sandlot::loads_test
