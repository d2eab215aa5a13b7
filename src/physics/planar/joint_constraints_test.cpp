/// Joints between groups, and grips.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/planar/test_world.h"

namespace sandlot::planar {
namespace {

using namespace test;

/// Two rods of 1 m and 1 kg, end to end along x, jointed at the origin.
std::shared_ptr<model::Model> flail(model::Joint joint) {
  auto m = model_of(Box{{1, 0.05, 0.1}}, false, 1, {{0, 0, 0.5}, {}});
  m->links[0].X_ML = at(-0.5, 0);
  m->links[0].inertial.moments = inertia_kg_m2(Box{{1, 0.05, 0.1}}, 1);
  m->links.push_back(m->links[0]);
  m->links[1].name = "tail";
  m->links[1].X_ML = at(0.5, 0);
  joint.name = "joint";
  joint.parent = 0;
  joint.child = 1;
  joint.X_CJ = {{-0.5, 0, 0}, {}};
  m->joints.push_back(joint);
  return m;
}

struct Free : World {
  Free() : World{.engine = PlanarEngine(Spec{}, {0, 0, 0})} {}
  void push(InstanceId id, std::size_t link, Vec3 force, double torque = 0) {
    const Wrench wrench{engine.bodies(id)[link], force, {0, 0, torque}};
    engine.apply({&wrench, 1});
  }
  JointState joint(InstanceId id) { return engine.joint_states()[engine.joints(id)[0].index]; }
  Velocity V(InstanceId id, std::size_t link) { return engine.states()[engine.bodies(id)[link].index].V_WB; }
};

TEST(PlanarPivot, ABlowMovesBothAsNewtonSays) {
  // Two free rods with a pin between them, hit at the middle of the first, across: the pin's impulse makes
  // the velocities at the pin equal: (J - j) / m - j b^2 / I' = j / m + j b^2 / I'  with b = 1/2, I = m (1 +
  // 0.05^2) / 12.
  Free w;
  const InstanceId id = w.add(flail({.type = model::JointType::continuous}), at(0, 0));
  w.push(id, 0, {0, 1 / h_s, 0});
  w.run(1);
  const double inertia = (1 + 0.0025) / 12, j = 1 / (2 + 0.5 / inertia);
  EXPECT_NEAR(w.V(id, 0).linear.y, 1 - j, 1e-6);
  // The tail is reported as the joint holds it after the step, in which the rods have turned by w h: (w h)^2
  // (w b) / 2 for each.
  EXPECT_NEAR(w.V(id, 1).linear.y, j, 2.2e-5);
  EXPECT_NEAR(w.V(id, 0).angular.z, -0.5 * j / inertia, 1e-5);
  for (int i = 0; i < 300; ++i) {
    w.run(1);
    const Vec3 end = w.engine.states()[w.engine.bodies(id)[0].index].X_WB * Vec3{0.5, 0, 0};
    const Vec3 begin = w.engine.states()[w.engine.bodies(id)[1].index].X_WB * Vec3{-0.5, 0, 0};
    ASSERT_NEAR(norm(end - begin), 0, 1e-4) << i;
    // Momentum stays; and the reported velocity at the joint is off by h b (w0^2 + w1^2), w = 0.75 for each
    // at first.
    ASSERT_NEAR(w.V(id, 0).linear.y + w.V(id, 1).linear.y, 1, h_s * 0.5 * 2 * 0.75 * 0.75) << i;
  }
}

TEST(PlanarPivot, AMotorTurnsBothWaysAndALimitStops) {
  Free w;
  const InstanceId id = w.add(flail({.type = model::JointType::revolute, .lower = -0.5, .upper = 0.5}),
                              at(0, 0));
  const JointTarget t{w.engine.joints(id)[0], JointTarget::Mode::velocity, 1, 100};
  w.engine.set_targets({&t, 1});
  w.run(30);
  EXPECT_NEAR(w.joint(id).velocity, 1, 1e-4);
  EXPECT_NEAR(w.joint(id).position, 0.3, 1e-3);
  EXPECT_NEAR(w.V(id, 0).angular.z + w.V(id, 1).angular.z, 0, 1e-6);  // equal rods turn against each other
  w.run(100);
  EXPECT_NEAR(w.joint(id).position, 0.5, 1e-3);
}

TEST(PlanarSlider, ASpringSwingsWithItsPeriod) {
  Free w;
  model::Joint joint{.type = model::JointType::prismatic, .axis_J = {1, 0, 0}};
  joint.spring_stiffness = 50;
  joint.spring_reference = 0.1;
  const InstanceId id = w.add(flail(joint), at(0, 0, 0.4));
  // Reduced mass 1/2: omega = sqrt(50 / 0.5) = 10, from 0 about 0.1; implicit, so it loses a little each
  // period.
  double most = 0;
  for (int i = 0; i < 63; ++i) {
    w.engine.step(0.005, 0);
    most = std::max(most, w.joint(id).position);
  }
  EXPECT_NEAR(w.joint(id).velocity, 0, 0.15);  // half a period is 0.314 s
  EXPECT_NEAR(most, 0.2, 0.02);
  EXPECT_NEAR(w.V(id, 0).angular.z, 0, 1e-9);
}

TEST(PlanarGrip, TwoAreOneUntilReleased) {
  Free w;
  const InstanceId a = w.add(model_of(Cylinder{0.1, 0.2}), at(0, 0)),
                   b = w.add(model_of(Cylinder{0.1, 0.2}), at(0.3, 0));
  GripTarget grip{w.engine.bodies(a)[0], w.engine.bodies(b)[0]};
  w.engine.set_grips({&grip, 1});
  w.push(a, 0, {0, 1 / h_s, 0});
  w.run(1);
  // One body of 2 kg with I = 2 + 2 * 0.15^2 (the test's links have 1 kg m^2 each), hit 0.15 from its middle.
  EXPECT_NEAR(w.V(a, 0).angular.z, -0.15 / (2 + 2 * 0.0225), 1e-6);
  EXPECT_NEAR(w.V(b, 0).angular.z, w.V(a, 0).angular.z, 1e-9);
  for (int i = 0; i < 200; ++i) w.run(1);
  EXPECT_NEAR(norm(w.p(a) - w.p(b)), 0.3, 1e-4);
  ByteWriter saved;
  w.engine.save(b, saved);
  grip.hold = false;
  w.engine.set_grips({&grip, 1});
  const Vec3 v = w.V(b, 0).linear;
  w.run(20);
  EXPECT_NEAR(norm(w.V(b, 0).linear - v), 0, 1e-12);
  // A grip is State of the younger.
  ByteReader r(saved.bytes());
  ASSERT_TRUE(w.engine.load(b, r));
  ByteWriter again;
  w.engine.save(b, again);
  EXPECT_TRUE(
      std::equal(saved.bytes().begin(), saved.bytes().end(), again.bytes().begin(), again.bytes().end()));
}

}  // namespace
}  // namespace sandlot::planar
