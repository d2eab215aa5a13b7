/// Wheels that turn as their ideally driven base moves.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/planar/test_world.h"

namespace sandlot::planar {
namespace {

using namespace test;

constexpr double wheel_m = 0.05;
/// At 1e9 m/s^2 a base is v^2 / 2a behind one that moved at once: 1.25e-10 m at 0.5 m/s, and so is what it
/// turned.
constexpr double ramped = 5e-9;

/// A disc of radius 0.2 whose centre of mass lies 0.1 before its origin, with a wheel of its own to the left.
std::shared_ptr<model::Model> robot() {
  auto m = model_of(Cylinder{0.2, 0.2}, false, 3, {{0, 0, 0.2}, {}});
  m->links[0].inertial.X_LCo.p = {0.1, 0, 0};
  model::Link wheel;
  wheel.name = "wheel";
  wheel.X_ML.p = {0, 0.15, wheel_m};
  wheel.inertial = {.mass_kg = 0.1, .X_LCo = {{0, -0.15, 0}, {}}, .moments = {1e-4, 1e-4, 1e-4}};
  wheel.collisions.push_back({"tyre", {}, Sphere{wheel_m}, {}, {}});
  m->links.push_back(wheel);
  m->joints.push_back(
      {.name = "axle", .type = model::JointType::continuous, .parent = 0, .child = 1, .axis_J = {0, 1, 0}});
  return m;
}

struct Rolling : World {
  InstanceId id;
  explicit Rolling(double y = 0) : id(add(robot(), at(0, y))) {}
  JointId wheel() { return engine.joints(id)[0]; }
  JointState joint() { return engine.joint_states()[wheel().index]; }
  /// A wheel at (0, 0.15) on an axle along y rolls as v_x - 0.15 w says.
  void roll(double per_vy = 0) {
    const RollTarget t{wheel(), engine.bodies(id)[0], 1 / wheel_m, per_vy, -0.15 / wheel_m};
    engine.set_rolls({&t, 1});
  }
};

TEST(PlanarRoll, AWheelTurnsByTheWayOfItsBase) {
  Rolling w;
  w.drive(w.id, 0.5, 0, 0.8, 1.0, 4.0);
  w.roll();
  w.run(200);
  // 0.5 s to 0.5 m/s and 0.2 s to 0.8 rad/s, then as asked: way = v (T - v / 2a). Rounding alone is left.
  const double way = 0.5 * (2 - 0.25), turned = 0.8 * (2 - 0.1);
  EXPECT_NEAR(w.joint().position, (way - 0.15 * turned) / wheel_m, 1e-12);
  EXPECT_NEAR(w.joint().velocity, (0.5 - 0.15 * 0.8) / wheel_m, 1e-12);
}

TEST(PlanarRoll, TheStatesOfSomeBodiesAreThoseOfAll) {
  Rolling w(1), other(-1);
  w.drive(w.id, 0.5, 0.1, 0.8);
  w.roll();
  w.run(20);
  const BodyId base = w.engine.bodies(w.id)[0], wheel = w.engine.bodies(w.id)[1];
  const std::uint32_t asked[] = {wheel.index, base.index};
  // Asked for alone first, so that nothing is ready; then after all have been.
  for (int round = 0; round < 2; ++round) {
    BodyState got[2];
    w.engine.states_of({asked + 1, 1}, {got + 1, 1});
    EXPECT_EQ(got[1].X_WB.p.y, w.p(w.id).y);
    w.engine.states_of(asked, got);
    for (int i = 0; i < 2; ++i) {
      const BodyState& is = w.engine.states()[asked[i]];
      EXPECT_EQ(got[i].X_WB, is.X_WB) << i;
      EXPECT_EQ(got[i].V_WB.linear, is.V_WB.linear) << i;
      EXPECT_EQ(got[i].V_WB.angular, is.V_WB.angular) << i;
    }
    EXPECT_GT(got[1].V_WB.linear.x, 0.4);
  }
}

TEST(PlanarRoll, ItCountsTheVelocityOfTheOriginItWasGivenNotOfTheCentreOfMass) {
  Rolling w;
  w.drive(w.id, 0, 0,
          1);  // on the spot about the base's origin: the centre of mass moves to the left at 0.1 m/s
  w.roll(7);
  w.run(100);
  EXPECT_NEAR(w.joint().position, -0.15 / wheel_m, ramped);
  w.drive(w.id, 0, 0.2, 0);
  w.run(100);
  EXPECT_NEAR(w.joint().position, -0.15 / wheel_m + 7 * 0.2, ramped);
}

TEST(PlanarRoll, LookingOrRepeatingTheTargetChangesNoBit) {
  Rolling a, b;
  for (Rolling* w : {&a, &b}) w->drive(w->id, 0.3, 0.1, 0.7, 0.9, 1.3), w->roll();
  for (int i = 0; i < 100; ++i) {
    a.run(1);
    a.joint();
    a.roll();
  }
  b.run(100);
  EXPECT_EQ(a.joint().position, b.joint().position);
  EXPECT_EQ(a.joint().velocity, b.joint().velocity);
}

TEST(PlanarRoll, ARobotHeldByAWallTurnsItsWheelsToTheWallAndNoFurther) {
  Rolling w;
  w.add(model_of(Box{{1, 4, 2}}, true), at(1, 0));  // its face at x = 0.5
  w.drive(w.id, 0.5, 0, 0, 1.0);
  w.roll();
  w.run(300);
  // The disc about (0, 0) comes to x = 0.3; overlap beyond 0.1 mm is taken back.
  EXPECT_NEAR(w.joint().position, 0.3 / wheel_m, 2e-4 / wheel_m);
  EXPECT_NEAR(w.joint().position, w.p(w.id).x / wheel_m, 1e-9);
  EXPECT_NEAR(w.joint().velocity, 0, 1e-9);
}

TEST(PlanarRoll, AlongAWallItsAngleIsThatOfTheArcItWent) {
  // Pushed obliquely along a wall the base turns and slides at once. A free wheel with per_wz alone tells its
  // heading.
  Rolling w;
  w.add(model_of(Box{{1, 40, 2}}, true), at(0.75, 0));  // its face at x = 0.25
  w.drive(w.id, 0.3, 0.4, 0.5, 2.0, 2.0);
  const RollTarget t{w.wheel(), w.engine.bodies(w.id)[0], 0, 0, 1};
  w.engine.set_rolls({&t, 1});
  w.run(80);
  const Quat q = w.engine.pose(w.id).q;
  EXPECT_GT(w.engine.contacts().size(), 0u);
  EXPECT_NEAR(w.joint().position, 2 * math::atan2(q.z, q.w), 1e-9);
}

TEST(PlanarRoll, ATargetOfTheOtherSortOrTheEndOfTheDriveEndsIt) {
  Rolling w;
  w.drive(w.id, 0.5, 0, 0);
  w.roll();
  w.run(100);
  const double angle = w.joint().position;
  EXPECT_NEAR(angle, 10, ramped);
  const JointTarget t{w.wheel(), JointTarget::Mode::velocity, 3, 1e6};
  w.engine.set_targets({&t, 1});
  w.run(100);
  EXPECT_NEAR(w.joint().position, angle + 3, 1e-12);
  w.roll();
  w.run(100);
  EXPECT_NEAR(w.joint().position, angle + 13, ramped);
  // Released, it is a wheel on the ground that keeps its speed of 10 rad/s and rolls on.
  const DriveTarget off{w.engine.bodies(w.id)[0], false};
  w.engine.set_drive_targets({&off, 1});
  EXPECT_NEAR(w.joint().velocity, 10, 1e-12);
  w.run(1);
  EXPECT_NEAR(w.joint().position, angle + 13 + 0.1, 1e-3);
  // Without a drive there is nothing to follow.
  w.engine.set_targets({&t, 1});
  w.roll();
  w.run(200);
  EXPECT_NEAR(w.joint().velocity, 3, 1e-9);
}

TEST(PlanarRoll, ItGoesOnWithTheSameBitsAfterARestore) {
  Rolling a, b;
  a.drive(a.id, 0.4, 0.1, 0.9, 1.0, 2.0);
  a.roll(0.3);
  a.run(37);
  ByteWriter bytes;
  a.engine.save(a.id, bytes);
  ByteReader reader(bytes.bytes());
  ASSERT_TRUE(b.engine.load(b.id, reader));
  EXPECT_EQ(a.joint().position, b.joint().position);
  a.run(60);
  b.run(60);
  EXPECT_EQ(a.joint().position, b.joint().position);
  EXPECT_EQ(a.joint().velocity, b.joint().velocity);
  // Nor does a new height change the angle.
  a.engine.set_pose(a.id, at(1, 1, 0.5, 0.3));
  EXPECT_NEAR(a.joint().position, b.joint().position, 1e-12);
  EXPECT_EQ(a.joint().velocity, 0);
}

TEST(PlanarRoll, RemovingOneRobotLeavesTheOthersTurning) {
  Rolling w;
  const InstanceId other = w.add(robot(), at(0, 2)), third = w.add(robot(), at(0, 4));
  for (const InstanceId each : {w.id, other, third}) {
    w.drive(each, 0.5, 0, 0);
    const RollTarget t{w.engine.joints(each)[0], w.engine.bodies(each)[0], 1 / wheel_m};
    w.engine.set_rolls({&t, 1});
  }
  w.run(100);
  const JointId last = w.engine.joints(third)[0];
  w.engine.remove(w.id);
  w.run(100);
  EXPECT_NEAR(w.engine.joint_states()[last.index].position, 20, ramped);
  EXPECT_NEAR(w.engine.joint_states()[w.engine.joints(other)[0].index].position, 20, ramped);
}

}  // namespace
}  // namespace sandlot::planar
