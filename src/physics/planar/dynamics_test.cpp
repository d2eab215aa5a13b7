/// Collisions, friction and what the ground does, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/planar/test_world.h"

namespace sandlot::planar {
namespace {

using namespace test;

constexpr double g = 9.81;

/// A shape of homogeneous mass on a ground of its own mu.
std::shared_ptr<model::Model> solid(Shape shape, double mass_kg, double restitution = 0, double mu = 0,
                                    double z = 0) {
  auto m = model_of(shape, false, mass_kg, {{0, 0, z}, {}});
  m->links[0].inertial.moments = inertia_kg_m2(shape, mass_kg);
  m->links[0].collisions[0].surface.restitution = restitution;
  m->links[0].collisions[0].surface.restitution_threshold_mps = 1e-6;
  m->links[0].collisions[0].surface.mu = mu;
  return m;
}

/// Sets a body going by one push of a whole step.
void kick(World& w, InstanceId id, Vec3 v, double wz, double mass_kg, double inertia = 0) {
  const Wrench wrench{w.engine.bodies(id)[0], mass_kg / h_s * v, {0, 0, inertia * wz / h_s}};
  w.engine.apply({&wrench, 1});
}

TEST(PlanarCollision, TwoDiscsExchangeMomentumByTheLawOfElasticImpact) {
  for (const double e : {1.0, 0.5, 0.0}) {
    World w;
    const InstanceId a = w.add(solid(Cylinder{0.1, 0.2}, 2, e), at(0, 0)),
                     b = w.add(solid(Cylinder{0.1, 0.2}, 3, e), at(0.5, 0));
    kick(w, a, {1, 0, 0}, 0, 2);
    w.run(100);
    // v_a = (m_a - e m_b) v / (m_a + m_b), v_b = (1 + e) m_a v / (m_a + m_b)
    EXPECT_NEAR(w.state(a).V_WB.linear.x, (2 - 3 * e) / 5, 1e-12) << e;
    EXPECT_NEAR(w.state(b).V_WB.linear.x, (1 + e) * 2 / 5, 1e-12) << e;
    EXPECT_EQ(w.state(a).V_WB.linear.y, 0);
  }
}

TEST(PlanarCollision, ADiscHitsARodOffItsCentre) {
  World w;
  const Shape rod = Box{{0.1, 1, 0.2}}, disc = Cylinder{0.1, 0.2};
  const InstanceId r = w.add(solid(rod, 3, 1), at(0, 0)), d = w.add(solid(disc, 1, 1), at(-0.5, 0.3));
  kick(w, d, {1, 0, 0}, 0, 1);
  w.run(80);
  // j (1/m + 1/M + b^2/I) = 2 v, b = 0.3
  const double inertia = 3 * (0.01 + 1) / 12, j = 2 / (1 + 1.0 / 3 + 0.09 / inertia);
  EXPECT_NEAR(w.state(d).V_WB.linear.x, 1 - j, 1e-12);
  EXPECT_NEAR(w.state(r).V_WB.linear.x, j / 3, 1e-12);
  EXPECT_NEAR(w.state(r).V_WB.angular.z, -0.3 * j / inertia, 1e-12);
}

/// Two links in one body, 1 m apart, the tensor of the second turned about x: upright it has its y moment, and a product with it.
TEST(PlanarCollision, LinksThatAreFixedTogetherTurnAsTheirMassesAndTurnedTensorsSay) {
  World w;
  auto m = solid(Cylinder{0.1, 0.2}, 2);
  m->links.push_back(m->links[0]);
  m->links[0].inertial = {.mass_kg = 2, .X_LCo = {{0, -0.1, 0}, {}}, .moments = {0.3, 0.4, 0.5}};
  m->links[1].name = "other";
  m->links[1].X_ML.p = {1, 0, 0};
  m->links[1].inertial = {.mass_kg = 3,
                          .X_LCo = {{0, 0.1, 0.05}, quat_from_rpy(math::pi / 2, 0, 0)},
                          .moments = {0.1, 0.2, 0.25}};
  model::Joint joint;
  joint.type = model::JointType::fixed;
  joint.child = 1;
  m->joints.push_back(joint);
  const InstanceId id = w.add(m, at(0, 0));
  // About the common centre: reduced mass 2 * 3 / 5, distance^2 = 1 + 0.2^2.
  const double inertia = 0.5 + 0.2 + 1.2 * 1.04;
  kick(w, id, {}, 1, 5, inertia);
  w.run(1);
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 1, 1e-12);
}

TEST(PlanarCollision, NewtonsCradlePassesItOnWhicheverEndIsHit) {
  for (const bool from_left : {true, false}) {
    World w;
    std::vector<InstanceId> balls;
    for (int i = 0; i < 5; ++i) balls.push_back(w.add(solid(Sphere{0.05}, 1, 1), at(0.1 * i, 0)));
    const InstanceId hit = w.add(solid(Sphere{0.05}, 1, 1), at(from_left ? -0.3 : 0.7, 0));
    kick(w, hit, {from_left ? 2.0 : -2.0, 0, 0}, 0, 1);
    w.run(30);
    const InstanceId last = from_left ? balls[4] : balls[0];
    EXPECT_NEAR(w.state(last).V_WB.linear.x, from_left ? 2 : -2, 1e-12);
    for (const InstanceId id : balls) EXPECT_NEAR(id == last ? 0 : w.state(id).V_WB.linear.x, 0, 1e-12);
    EXPECT_NEAR(w.state(hit).V_WB.linear.x, 0, 1e-12);
  }
}

TEST(PlanarGround, WhatSlidesStopsAfterVSquaredOver2MuG) {
  for (const Shape& shape : {Shape(Cylinder{0.1, 0.2}), Shape(Box{{0.3, 0.2, 0.2}})}) {
    World w;
    const InstanceId id = w.add(solid(shape, 2, 0, 0.4, 0.1), at(0, 0, 0.7));
    kick(w, id, {2, 0, 0}, 0, 2);
    w.run(100);
    // Semi-implicit Euler: each step goes on at the velocity it ends with, v h / 2 less in all.
    EXPECT_NEAR(w.p(id).x, 4 / (2 * 0.4 * g) - 2 * h_s / 2, 2e-3);
    EXPECT_EQ(w.state(id).V_WB.linear, Vec3{});
    EXPECT_EQ(w.state(id).V_WB.angular, Vec3{});
  }
}

TEST(PlanarGround, ASpinningDiscStopsAfterItsMeanRadiusSays) {
  World w;
  const Shape disc = Cylinder{0.15, 0.2};
  const InstanceId id = w.add(solid(disc, 2, 0, 0.4, 0.1), at(0, 0));
  const double inertia = 2 * 0.15 * 0.15 / 2;
  kick(w, id, {}, 20, 2, inertia);
  // T = 2/3 mu m g R, so dw/dt = 4 mu g / (3 R) and it stops after 0.57 s.
  const double slowing = 4 * 0.4 * g / (3 * 0.15);
  w.run(30);
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 20 - slowing * 0.3, 1e-9);
  w.run(static_cast<int>(20 / slowing / h_s) - 30 + 1);
  EXPECT_EQ(w.state(id).V_WB.angular.z, 0);
  EXPECT_NEAR(norm(w.p(id)), 0, 1e-12);
}

TEST(PlanarGround, ABallRollsOnAndRollingResistanceSlowsIt) {
  World w;
  auto ball = solid(Sphere{0.1}, 1, 0, 0.8, 0.1);
  const InstanceId free = w.add(ball, at(0, 0));
  ball = std::make_shared<model::Model>(*ball);
  ball->links[0].collisions[0].surface.rolling_resistance_m = 0.002;
  const InstanceId held = w.add(ball, at(0, 1));
  kick(w, free, {1, 0, 0}, 0, 1.4);  // m + I / r^2, since it rolls
  kick(w, held, {1, 0, 0}, 0, 1.4);
  w.run(100);
  EXPECT_NEAR(w.state(free).V_WB.linear.x, 1, 1e-12);
  // a = rho g / (1.4 r): torque rho m g against (m + I / r^2) with I = 2/5 m r^2
  EXPECT_NEAR(w.state(held).V_WB.linear.x, 1 - 0.002 * g / (1.4 * 0.1), 1e-9);
}

TEST(PlanarGround, AHollowBallIsSlowedLess) {
  World w;
  auto ball = std::make_shared<model::Model>(*solid(Sphere{0.11}, 0.43, 0, 0.8, 0.11));
  ball->links[0].collisions[0].surface.rolling_resistance_m = 0.0056;
  const double inertia = 2.0 / 3 * 0.43 * 0.11 * 0.11;
  ball->links[0].inertial.moments = {inertia, inertia, inertia};
  const InstanceId id = w.add(ball, at(0, 0));
  kick(w, id, {1, 0, 0}, 0, 0.43 * 5 / 3);
  w.run(100);
  // a = rho g / r / (1 + 2/3)
  EXPECT_NEAR(w.state(id).V_WB.linear.x, 1 - 0.6 * 0.0056 * g / 0.11, 1e-9);
}

/// A hollow ball: I = 2/3 m r^2. One that is hit slides, keeps its spin meanwhile, and rolls in the end with 0.6 of its velocity and 0.4
/// of its spin times r, since m v + I w / r is kept by friction, which acts at the ground.
std::shared_ptr<model::Model> hollow_ball(double restitution, double mu = 0.6) {
  auto ball = std::make_shared<model::Model>(*solid(Sphere{0.11}, 0.43, restitution, mu, 0.11));
  const double inertia = 2.0 / 3 * 0.43 * 0.11 * 0.11;
  ball->links[0].inertial.moments = {inertia, inertia, inertia};
  return ball;
}

TEST(PlanarBall, AKickLeavesWhatRollsOnInTheEnd) {
  World w;
  const InstanceId rolls = w.add(hollow_ball(0), at(0, 0)), slides = w.add(hollow_ball(0, 0), at(0, 1));
  for (const InstanceId id : {rolls, slides}) kick(w, id, {5, 0, 0}, 0, 0.43);
  w.run(1);
  EXPECT_NEAR(w.state(rolls).V_WB.linear.x, 3, 1e-12);
  EXPECT_NEAR(w.state(slides).V_WB.linear.x, 5, 1e-12);
}

TEST(PlanarBall, ATorqueRollsIt) {
  World w;
  const InstanceId id = w.add(hollow_ball(0), at(0, 0));
  // About y: forward along x. T / r = 5/3 m a.
  const Wrench wrench{w.engine.bodies(id)[0], {}, {0, 0.43 * 0.11 * 5 / 3 / h_s, 0}};
  w.engine.apply({&wrench, 1});
  w.run(1);
  EXPECT_NEAR(w.state(id).V_WB.linear.x, 1, 1e-12);
  EXPECT_NEAR(w.state(id).V_WB.linear.y, 0, 1e-12);
}

TEST(PlanarBall, OfABounceItsSpinTakesALargePart) {
  for (const double e : {1.0, 0.8, 0.6}) {
    World w;
    auto wall = model_of(Box{{0.1, 10, 1}}, true);
    wall->links[0].collisions[0].surface.mu = 0;
    w.add(wall, at(1.05, 0, 0, 0.5));
    const InstanceId ball = w.add(hollow_ball(e), at(0, 0));
    kick(w, ball, {2, 0, 0}, 0, 0.43 * 5 / 3);
    w.run(80);
    // It leaves with -e v and the spin of v: 0.6 (-e) + 0.4 of v. For e = 0.6 that is 0.04: it stays at the wall.
    EXPECT_NEAR(w.state(ball).V_WB.linear.x, e > 0.7 ? 2 * (0.4 - 0.6 * e) : 0, 2e-6) << e;
  }
}

TEST(PlanarBall, OfTwoTheOneThatIsHitRollsOnWithThreeFifths) {
  World w;
  const InstanceId a = w.add(hollow_ball(1), at(0, 0)), b = w.add(hollow_ball(1), at(0.5, 0));
  kick(w, a, {2, 0, 0}, 0, 0.43 * 5 / 3);
  w.run(30);
  // They exchange velocities and keep their spins: 0.4 and 0.6 of 2 m/s when both roll.
  EXPECT_NEAR(w.state(a).V_WB.linear.x, 0.8, 1e-9);
  EXPECT_NEAR(w.state(b).V_WB.linear.x, 1.2, 1e-9);
}

TEST(PlanarGround, TheSmallerMuOfBodyAndFloorCounts) {
  World w;
  auto ice = model_of(Box{{2, 20, 0.2}}, true);
  ice->links[0].collisions[0].surface.mu = 0.1;
  w.add(ice, at(3, 0, 0, -0.1));
  const InstanceId id = w.add(solid(Cylinder{0.1, 0.2}, 2, 0, 0.5, 0.1), at(0, 0));
  kick(w, id, {5, 0, 0}, 0, 2);
  // From 0 to 2 with mu 0.5 (the default floor has 1), then with 0.1.
  w.run(40);
  EXPECT_NEAR(w.state(id).V_WB.linear.x, 5 - 0.5 * g * 0.4, 1e-9);
  double before = 5;
  while (w.p(id).x < 2.3) w.run(1), before = w.state(id).V_WB.linear.x;
  w.run(10);
  EXPECT_NEAR(w.state(id).V_WB.linear.x, before - 0.1 * g * 0.1, 1e-9);
}

TEST(PlanarContact, APushedBoxMovesOnceTheForceBeatsFriction) {
  World w;
  const InstanceId box = w.add(solid(Box{{0.4, 0.4, 0.2}}, 5, 0, 0.5, 0.1), at(0, 0));
  const auto push = [&](double newton, int steps) {
    for (int i = 0; i < steps; ++i) {
      const Wrench wrench{w.engine.bodies(box)[0], {newton, 0, 0}, {}};
      w.engine.apply({&wrench, 1});
      w.run(1);
    }
  };
  push(0.99 * 0.5 * 5 * g, 100);
  EXPECT_EQ(w.p(box).x, 0);
  push(0.5 * 5 * g + 10, 50);
  EXPECT_NEAR(w.state(box).V_WB.linear.x, 10.0 / 5 * 0.5, 1e-9);
}

TEST(PlanarContact, ARobotPushesARowOfBoxesUpToAWallAndStops) {
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(2.05, 0, 0, 0.5));
  const InstanceId robot = w.add(robot_model(10), at(0, 0));
  std::vector<InstanceId> boxes;
  for (int i = 0; i < 3; ++i)
    boxes.push_back(w.add(solid(Box{{0.2, 0.2, 0.2}}, 1, 0, 0.3, 0.1), at(0.5 + 0.3 * i, 0)));
  w.drive(robot, 0.5, 0, 0, 5);
  w.run(600);
  // Wall at 2, three boxes of 0.2, the robot's radius 0.2; each of four contacts yields by the slop and a
  // little.
  EXPECT_NEAR(w.p(robot).x, 2 - 0.6 - 0.2, 2e-3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(w.p(boxes[i]).x, 2 - 0.1 - 0.2 * static_cast<double>(2 - i), 2e-3);
    EXPECT_NEAR(w.p(boxes[i]).y, 0, 5e-3);  // a round nose holds a row in no stable way
    EXPECT_NEAR(w.state(boxes[i]).V_WB.linear.x, 0, 1e-3);
  }
}

TEST(PlanarContact, FrictionTurnsAWallsBlowIntoSpin) {
  // A ball that meets a wall aslant: while it slips all along, the impulses are J = 2 m v_n and mu J. As a solid ball it
  // rolls on with J / (1.4 m), and I dw = R mu J.
  World w;
  auto wall = model_of(Box{{0.1, 10, 1}}, true);
  wall->links[0].collisions[0].surface.mu = 0.1;
  w.add(wall, at(1.05, 0, 0, 0.5));
  const InstanceId disc = w.add(solid(Sphere{0.1}, 1, 1, 0.2, 0.1), at(0, 0));
  kick(w, disc, {1, 1, 0}, 0, 1.4);
  w.run(150);
  const double inertia = 0.4 * 0.01;
  EXPECT_NEAR(w.state(disc).V_WB.linear.x, 1 - 2 / 1.4, 1e-12);
  EXPECT_NEAR(w.state(disc).V_WB.linear.y, 1 - 0.1 * 2 / 1.4, 1e-12);
  EXPECT_NEAR(w.state(disc).V_WB.angular.z, -0.1 * 0.2 / inertia, 1e-9);
}

TEST(PlanarContact, ForcesAreTold) {
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(1.05, 0, 0, 0.5));
  const InstanceId box = w.add(solid(Cylinder{0.2, 0.2}, 5, 0, 0, 0.1), at(0.8, 0));
  for (int i = 0; i < 20; ++i) {
    const Wrench wrench{w.engine.bodies(box)[0], {12, 0, 0}, {}};
    w.engine.apply({&wrench, 1});
    w.run(1);
  }
  ASSERT_EQ(w.engine.contacts().size(), 1u);
  EXPECT_NEAR(w.engine.contacts()[0].force_W.x, -12, 1e-9);
  EXPECT_NEAR(w.engine.contacts()[0].force_W.y, 0, 1e-9);
}

TEST(PlanarFast, ABallPassesNothingHoweverFastAndThin) {
  for (const double speed : {3.0, 30.0, 300.0}) {
    World w;
    w.add(model_of(Box{{0.001, 200, 1}}, true), at(-1, 0, 0, 0.5));
    w.add(model_of(Box{{0.001, 200, 1}}, true), at(1, 0, 0, 0.5));
    w.add(solid(Cylinder{0.02, 0.2}, 1e3, 1, 0, 0.1), at(0.5, 0.3));
    const InstanceId ball = w.add(solid(Sphere{0.01}, 0.1, 1, 0, 0.01), at(0, 0));
    kick(w, ball, {speed, 0.3 * speed, 0}, 0, 0.1);
    for (int i = 0; i < 50; ++i) {
      w.run(1);
      ASSERT_LT(std::abs(w.p(ball).x), 1 - 0.01 + 1e-3) << speed << " " << i;
    }
    const Vec3 v = w.state(ball).V_WB.linear;
    EXPECT_NEAR(norm(v), speed * std::sqrt(1.09), 0.01 * speed);
  }
}

TEST(PlanarFast, AFastBallHitsASmallOneAtRest) {
  World w;
  const InstanceId a = w.add(solid(Sphere{0.02}, 1, 1, 0, 0.02), at(0, 0)),
                   b = w.add(solid(Sphere{0.02}, 1, 1, 0, 0.02), at(0.5, 0));
  kick(w, a, {40, 0, 0}, 0, 1);
  w.run(10);
  EXPECT_NEAR(w.state(a).V_WB.linear.x, 0, 1e-9);
  EXPECT_NEAR(w.state(b).V_WB.linear.x, 40, 1e-9);
  EXPECT_NEAR(w.p(a).x, 0.46, 1e-3);
}

}  // namespace
}  // namespace sandlot::planar
