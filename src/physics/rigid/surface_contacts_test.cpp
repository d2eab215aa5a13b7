/// Surfaces against formulas: substances, belts, skins, resistance against rolling, zones, the user's rule;
/// and bodies that explode.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "model/substance.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/substance.h"
#include "physics/test_world.h"

namespace sandlot::rigid::surface_contacts_test {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr double g = 9.81, h = 0.001;
const Settings awake = {{"sleeping", "false"}};

struct Rigid : World {
  explicit Rigid(Vec3 gravity = {0, 0, -g}, const Settings& config = awake)
      : World(rigid::engine, settings(config), gravity) {}
};

/// Gravity as a slope of `angle` would turn it, falling towards +x.
Vec3 slope(double angle) {
  const auto [s, c] = math::sincos(angle);
  return {g * s, 0, -g * c};
}

model::Surface of(const char* substance) {
  model::Surface s;
  s.substance = model::substance_from(substance)->substance;
  return s;
}
model::Surface rubbing(double mu) {
  model::Surface s;
  s.mu = s.mu2 = mu;
  return s;
}

/// A block that lies on four corners, flat enough that a slope loads them evenly.
model::Instance block(const model::Surface& surface, Pose X = {{0, 0, 0.005}, {}}, double mass = 1) {
  return body_of("block", Box{{0.2, 0.2, 0.01}}, mass, X, surface);
}

TEST(Matter, ABlockOfASubstanceSlidesAboveTheSlopeOfR1R2) {
  // metal(0.4) on plastic(0.5): mu = 0.2. Sliding, it gains g (sin - mu cos).
  const double steep = 0.3;
  Rigid world(slope(steep));
  world.add(ground(of("plastic(0.5)")));
  const InstanceId id = world.add(block(of("metal(0.4)")));
  world.run(500, h);  // by then it is much faster than slip * force
  const double v = world.state(id).V_WB.linear.x;
  world.run(500, h);
  const double expected = g * (math::sin(steep) - 0.2 * math::cos(steep));
  // Friction is kept below its limit by up to 32e-7 of it (collide.cpp).
  EXPECT_NEAR(world.state(id).V_WB.linear.x - v, 0.5 * expected, 1e-5);
}

TEST(Matter, BelowThatSlopeItCreepsWithSlipTimesForce) {
  const double gentle = 0.15;  // tan = 0.151
  Rigid world(slope(gentle));
  world.add(ground(of("plastic(0.5)")));
  const InstanceId id = world.add(block(of("metal(0.4)")));
  world.run(3000, h);
  ASSERT_EQ(world.engine->contacts().size(), 4u);
  const double force = g * math::sin(gentle) / 4;  // of each corner: they all slip alike
  EXPECT_NEAR(world.state(id).V_WB.linear.x, 0.02 * force, 1e-5 * force);
}

TEST(Matter, ABallRestsWeightOverStiffnessDeep) {
  for (const char* substance : {"metal(0.5)", "rubber(10)", "foam(2)", "snow(0.3)"}) {
    Rigid world;
    world.add(ground(of("plastic")));
    const double mass = 0.2;
    const model::Surface surface = of(substance);
    const InstanceId id = world.add(body_of("ball", Sphere{0.1}, mass, {{0, 0, 0.1}, {}}, surface));
    world.run(6000, h);
    const double depth = mass * g / combine(*surface.substance, {}).stiffness_N_per_m;
    // What is left of the bouncing: rubber(10) has the weakest damping, exp(-3.4 * 6).
    EXPECT_NEAR(world.state(id).X_WB.p.z, 0.1 - depth, 1e-8) << substance;
  }
}

TEST(Matter, ABallBouncesAsTheSpringAndDamperOfItsContact) {
  // The reference is the same spring integrated by hand: v' = v + h (f / m - g), f = max(0, kp (d - h v') -
  // kd v').
  const double mass = 0.3, kp = 100 * 40 * 200 / 240.0, kd = 50 * (0.5 * 200 + 0.2 * 40) / 240;
  Rigid world;
  world.add(ground(of("plastic")));
  const InstanceId id = world.add(body_of("ball", Sphere{0.1}, mass, {{0, 0, 0.4}, {}}, of("metal(0.5)")));
  double z = 0.4, v = 0, farthest = 0;
  for (int i = 0; i < 1500; ++i) {
    const double d = 0.1 - z, free = v - h * g;
    const double f = d > 0 ? std::max(0.0, (kp * d - (kd + h * kp) * free) / (1 + h * (kd + h * kp) / mass))
                           : 0;
    v = free + h * f / mass;
    z += h * v;
    world.run(1, h);
    farthest = std::max(farthest, std::abs(world.state(id).X_WB.p.z - z));
  }
  EXPECT_LT(farthest, 1e-10);
}

TEST(Matter, HowFastItBouncesOffIsTheClosedFormOfASpringThatDoesNotPull) {
  const double mass = 1, step = 1e-5;
  Rigid world(Vec3{});
  world.add(ground(of("metal(0.5)")));
  const InstanceId id = world.add(body_of("ball", Sphere{0.1}, mass, {{0, 0, 0.1}, {}}, of("metal(0.5)")));
  world.push(id, {0, 0, -1 / step});
  world.run(5000, step);
  // Two metals: kp 10000 N/m; kd 10 N s/m, to which the implicit step adds kp h. With b = kd / 2m and w^2 =
  // kp / m - b^2 the force ends before the depth does: e = exp(-b/w (pi - atan2(2 b w, w^2 - b^2))) (Schwager
  // and Poschel 2007).
  const double b = (10 + 1e4 * step) / 2, w = std::sqrt(1e4 - b * b);
  const double e = math::exp(-b / w * (math::pi - math::atan2(2 * b * w, w * w - b * b)));
  EXPECT_NEAR(world.state(id).V_WB.linear.z, e, 1e-3);
  EXPECT_NEAR(e, 0.862, 0.01) << "the formula itself";
}

TEST(Matter, SprungContactsOfSdfAreNotCorrectedFasterThanAllowed) {
  model::Surface soft;
  soft.stiffness_N_per_m = 1e6, soft.damping_N_s_per_m = 1;
  soft.max_correction_mps = 0.05;
  Rigid world;
  world.add(ground());
  const InstanceId id = world.add(body_of("ball", Sphere{0.1}, 1, {{0, 0, 0.08}, {}}, soft));
  world.run(100, h);
  // It rises from 2 cm deep at what the correction leaves over: v = 0.05 - CFM m g.
  const double v = 0.05 - g / (h * 1e6 + 1);
  EXPECT_NEAR(world.state(id).V_WB.linear.z, v, 1e-9);
  EXPECT_NEAR(world.state(id).X_WB.p.z, 0.08 + 0.1 * v, 1.5 * h * v);  // CFM / m of a second to get going
}

TEST(Matter, AConveyorCarriesAtItsOwnSpeed) {
  model::Surface belt = rubbing(0.5);
  belt.belt_velocity_mps = {0.7, 0, 0};
  const double yaw = 0.6;
  Rigid world({0, 0, -g}, {});  // with sleeping
  world.add(static_of("belt", Box{{10, 1, 0.2}}, {{0, 0, -0.1}, quat_from_rpy(0, 0, yaw)}, belt));
  const InstanceId id = world.add(block(rubbing(1)));
  const Vec3 along{math::cos(yaw), math::sin(yaw), 0};
  world.run(100, h);
  EXPECT_NEAR(dot(world.state(id).V_WB.linear, along), 0.5 * g * 0.1, 1e-4);  // mu g t
  world.run(900, h);
  EXPECT_NEAR(norm(world.state(id).V_WB.linear - 0.7 * along), 0, 1e-9);
  EXPECT_NEAR(norm(world.state(id).V_WB.angular), 0, 1e-9);
}

TEST(Matter, WhatIsHeldBackOnABeltGoesOnWhenItIsLetGo) {
  model::Surface belt = rubbing(0.5);
  belt.belt_velocity_mps = {0.7, 0, 0};
  Rigid world({0, 0, -g}, {});
  world.add(static_of("belt", Box{{10, 1, 0.2}}, {{0, 0, -0.1}, {}}, belt));
  const InstanceId gate = world.add(static_of("gate", Box{{0.1, 1, 1}}, {{0.2, 0, 0}, {}}));
  const InstanceId front = world.add(block(rubbing(0.5), {{0.05, 0, 0.005}, {}}));
  const InstanceId back = world.add(block(rubbing(0.5), {{-0.15, 0, 0.005}, {}}));
  world.run(1500, h);
  ASSERT_LT(norm(world.state(back).V_WB.linear), 1e-3);
  world.engine->set_pose(gate, {{0, 0, 50}, {}});
  world.run(1000, h);
  EXPECT_NEAR(world.state(front).V_WB.linear.x, 0.7, 1e-6);
  EXPECT_NEAR(world.state(back).V_WB.linear.x, 0.7, 1e-6);
}

TEST(Matter, ABodyWithABeltDrivesOnIt) {
  model::Surface track = rubbing(0.5);
  track.belt_velocity_mps = {-0.3, 0, 0};  // what touches the ground moves backwards
  Rigid world;
  world.add(ground(rubbing(1)));
  const InstanceId id = world.add(block(track, {{0, 0, 0.005}, quat_from_rpy(0, 0, 1)}));
  world.run(300, h);
  // Where it points after the start, which turned it by some 1e-5 rad.
  const Vec3 forward = rotate(world.state(id).X_WB.q, Vec3{1, 0, 0});
  EXPECT_NEAR(dot(forward, Vec3{math::cos(1), math::sin(1), 0}), 1, 1e-6);
  EXPECT_NEAR(norm(world.state(id).V_WB.linear - 0.3 * forward), 0, 1e-9);
}

TEST(Matter, ResistanceAgainstRollingSlowsABallByFiveSeventhsOfRhoGOverR) {
  // m a = -F, (2/5) m r^2 (a / r) = F r - rho m g, F the friction at the contact: a = -(5/7) rho g / r.
  for (const double heading : {0.0, 0.5, 2.0}) {
    const Vec3 along{math::cos(heading), math::sin(heading), 0};
    const double r = 0.1, rho = 0.002;
    model::Surface ball, carpet;
    ball.rolling_resistance_m = 0.0005, carpet.rolling_resistance_m = 0.0015;
    Rigid world;
    world.add(ground(carpet));
    const InstanceId id = world.add(body_of("ball", Sphere{r}, 2, {{0, 0, r}, {}}, ball));
    // An impulse J at the centre with a moment 2/5 J r makes it roll at once.
    world.push(id, 2 / h * along, 0.4 * 2 * r / h * Vec3{-along.y, along.x, 0});
    world.run(1, h);
    const Vec3 before = world.state(id).V_WB.linear;
    EXPECT_NEAR(norm(before), 1, 1e-2);
    world.run(500, h);
    const Vec3 after = world.state(id).V_WB.linear;
    const double a = 5.0 / 7 * rho * g / r;
    EXPECT_NEAR(norm(after - before + 0.5 * a * along), 0, 1e-4) << heading;
    world.run(static_cast<int>(norm(after) / a / h) + 50, h);
    EXPECT_NEAR(norm(world.state(id).V_WB.linear), 0, 1e-4) << heading;
    EXPECT_NEAR(norm(world.state(id).V_WB.angular), 0, 1e-3) << heading;
  }
}

TEST(Matter, ABallStaysOnASlopeUpToRhoOverRAndSpinsFreely) {
  const double r = 0.1, rho = 0.01;  // holds up to tan = 0.1
  for (const double angle : {0.09, 0.11}) {
    model::Surface ball;
    ball.rolling_resistance_m = rho;
    Rigid world(slope(angle));
    world.add(ground());
    const InstanceId id = world.add(body_of("ball", Sphere{r}, 2, {{0, 0, r}, {}}, ball));
    world.push(id, {}, {0, 0, 0.4 * 2 * r * r * 5 / h});
    world.run(500, h);
    const double a = 5.0 / 7 * (g * math::sin(angle) - rho / r * g * math::cos(angle));
    EXPECT_NEAR(world.state(id).V_WB.linear.x, std::max(0.0, 0.5 * a), 2e-3) << angle;
    EXPECT_NEAR(world.state(id).V_WB.angular.z, 5, 1e-3) << "nothing brakes it on the spot";
  }
}

TEST(Matter, ASkinSlidesAlongItsAxisOnly) {
  model::Surface scales = rubbing(0.5);
  scales.skin = model::Skin{{1, 0, 0}, 0.2};
  for (const double yaw : {0.0, 0.7}) {
    // Along: 0.1 g brakes it, across 0.5 g.
    const Vec3 along{math::cos(yaw), math::sin(yaw), 0}, across{-along.y, along.x, 0};
    for (const auto& [direction, mu] : {std::pair{along, 0.1}, std::pair{across, 0.5}}) {
      Rigid world;
      world.add(ground(rubbing(1)));
      const InstanceId id = world.add(block(scales, {{0, 0, 0.005}, quat_from_rpy(0, 0, yaw)}));
      world.run(100, h);
      world.push(id, 1 / h * direction);
      world.run(1, h);
      const double v = dot(world.state(id).V_WB.linear, direction);
      world.run(100, h);
      EXPECT_NEAR(dot(world.state(id).V_WB.linear, direction), v - mu * g * 0.1, 1e-4) << yaw << " " << mu;
    }
  }
}

TEST(Matter, AZoneHoldsFromItsBorderOn) {
  // A puck of 2 cm slides over carpet of mu 0.6 from x = 0 and over ice of mu 0.05 beyond x = 0.5:
  // v^2 = v0^2 - 2 g (0.6 * 0.5 + 0.05 (x - 0.5)).
  model::SurfaceZone carpet{
      "carpet", {{-5, -5, 0}, {0.5, -5, 0}, {0.5, 5, 0}, {-5, 5, 0}}, {}, 0, rubbing(0.6), {}};
  model::SurfaceZone belt{"belt", {}, {20, 0, 0}, 1, rubbing(0.5), {}};
  belt.surface.belt_velocity_mps = {0, 0.4, 0};
  Rigid world;
  world.engine->set_zones(std::vector{carpet, belt});
  world.add(ground(rubbing(0.05)));
  const InstanceId id = world.add(body_of("puck", Box{{0.02, 0.02, 0.005}}, 1, {{0, 0, 0.0025}, {}}));
  // Zones belong to what stands: on top of a body that moves there are none.
  const InstanceId cart = world.add(body_of("cart", Box{{1, 1, 0.1}}, 50, {{-3, 0, 0.05}, {}}, rubbing(1)));
  const InstanceId rider = world.add(block(rubbing(0.01), {{-3, 0, 0.105}, {}}));
  const InstanceId carried = world.add(block(rubbing(1), {{20, 0, 0.005}, {}}));
  world.run(10, h);
  world.push(id, {3 / h, 0, 0});
  world.push(rider, {1 / h, 0, 0});
  world.run(800, h);
  const double x = world.state(id).X_WB.p.x, v = world.state(id).V_WB.linear.x;
  ASSERT_GT(x, 1);
  // The two front corners cross before the two others, each with its half of the weight: the middle counts. A
  // step of h more or less of carpet is 0.6 g h = 0.006 m/s, and the load shifts between the corners while
  // they differ.
  EXPECT_NEAR(v, std::sqrt(9 - 2 * g * (0.6 * 0.5 + 0.05 * (x - 0.5))), 0.01);
  EXPECT_GT(world.state(rider).V_WB.linear.x - world.state(cart).V_WB.linear.x, 0.9);
  EXPECT_NEAR(world.state(carried).V_WB.linear.y, 0.4, 1e-6);
}

TEST(Matter, WhatDoesNotTouchFallsThrough) {
  model::Surface none;
  none.touches = false;
  Rigid world;
  world.add(ground());
  const InstanceId ghost = world.add(body_of("ghost", Sphere{0.1}, 1, {{0, 0, 0.2}, {}}, none));
  const InstanceId ball = world.add(body_of("ball", Sphere{0.1}, 1, {{5, 0, 0.1}, {}}));
  model::SurfaceZone hole{"hole", {}, {5, 0, 0}, 1, none, {}};
  world.run(500, h);
  EXPECT_LT(world.state(ghost).X_WB.p.z, -0.9);
  EXPECT_NEAR(world.state(ball).X_WB.p.z, 0.1, 1e-4);
  world.engine->set_zones(std::span(&hole, 1));
  world.run(500, h);
  EXPECT_LT(world.state(ball).X_WB.p.z, -0.9);
}

TEST(Matter, TheUsersRuleHasTheLastWord) {
  Rigid world;
  int asked = 0;
  world.engine->set_contact_rule(
      [&](const ContactSide& a, const ContactSide& b, Vec3 point, Vec3 normal, PairSurface& pair) {
        ++asked;
        EXPECT_EQ(a.instance, "ground");
        EXPECT_EQ(a.collision.name, "body");
        EXPECT_NEAR(normal.z, 1, 1e-12) << "from a towards b";
        EXPECT_NEAR(point.z, 0, b.instance == "ghost" ? 1 : 0.01);
        EXPECT_EQ(pair.mu, 0.3);
        if (b.instance == "ghost") pair.touches = false;
        if (b.instance == "skater") pair.mu = pair.mu2 = 0;
        if (b.instance == "rider") pair.belt_velocity_W_mps = {0, 0, 0}, pair.mu = pair.mu2 = 1;
      });
  world.add(ground(rubbing(0.3)));
  std::vector<InstanceId> ids;
  for (const char* name : {"ghost", "skater", "plain", "rider"})
    ids.push_back(world.add(body_of(name, Box{{0.2, 0.2, 0.01}}, 1,
                                    {{0, 2.0 * static_cast<double>(ids.size()), 0.005}, {}}, rubbing(1))));
  world.run(10, h);
  for (const InstanceId id : ids) world.push(id, {2 / h, 0, 0});
  world.run(101, h);
  EXPECT_GT(asked, 400);
  EXPECT_LT(world.state(ids[0]).X_WB.p.z, -0.05);
  EXPECT_NEAR(world.state(ids[1]).V_WB.linear.x, 2, 1e-9);
  const auto braked = [&](double mu) { return 2 - mu * g * 0.101; };
  EXPECT_NEAR(world.state(ids[2]).V_WB.linear.x, braked(0.3),
              0.01);  // of which 0.003 in the step of the push
  EXPECT_NEAR(world.state(ids[3]).V_WB.linear.x, braked(1), 0.02);
}

TEST(Matter, ASnapshotAmidSoftContactsGoesOnTheSame) {
  const auto build = [](Rigid& world) {
    model::Surface belt = of("rubber(20)");
    belt.belt_velocity_mps = {0.7, 0, 0};
    belt.rolling_resistance_m = 0.01;
    world.add(static_of("belt", Box{{4, 4, 0.2}}, {{0, 0, -0.1}, {}}, belt));
    std::vector<InstanceId> ids;
    for (const char* substance : {"metal(0.5)", "plastic", "foam(3)", "snow(0.2)"}) {
      const double at = 0.25 * static_cast<double>(ids.size());
      ids.push_back(
          world.add(body_of(substance, Sphere{0.1}, 1, {{0.1 * at, 0, 0.3 + at}, {}}, of(substance))));
    }
    return ids;
  };
  Rigid first;
  const auto ids = build(first);
  first.run(400, h);
  Rigid second;
  const auto again = build(second);
  second.steps = first.steps;
  for (std::size_t i = 0; i < ids.size(); ++i) ASSERT_TRUE(second.load(again[i], first.bytes(ids[i])));
  first.run(400, h);
  second.run(400, h);
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(first.bytes(ids[i]), second.bytes(again[i])) << i;
}

TEST(Matter, ABodyThatExplodesEndsTheRunWithTheStateOfBefore) {
  for (const bool spins : {false, true}) {
    Rigid world;
    world.add(ground());
    const InstanceId calm = world.add(block(rubbing(1)));
    const InstanceId wild = world.add(body_of("wild", Sphere{0.1}, 1, {{3, 0, 5}, {}}));
    world.run(10, h);
    const auto before = world.bytes(wild), calm_before = world.bytes(calm);
    if (spins) world.push(wild, {}, {0, 0, 0.004 * 1.1e5 / h});
    else world.push(wild, {1.1e4 / h, 0, 0});
    world.run(3, h);
    const Status status = world.engine->check_finite();
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().what, HasSubstr("'wild/body' has exploded"));
    EXPECT_THAT(status.error().what, HasSubstr(spins ? "max_spin, 1e+05 rad/s" : "at 11000 m/s"));
    EXPECT_THAT(status.error().fix, HasSubstr("smaller time step"));
    EXPECT_EQ(world.bytes(wild), before);
    EXPECT_EQ(world.bytes(calm), calm_before);
  }
  Rigid fast({0, 0, 0}, {{"max_speed", "2e4"}});
  const InstanceId bullet = fast.add(body_of("bullet", Sphere{0.1}, 1));
  fast.push(bullet, {1.1e4 / h, 0, 0});
  fast.run(3, h);
  EXPECT_TRUE(fast.engine->check_finite());
}

}  // namespace
}  // namespace sandlot::rigid::surface_contacts_test
