/// Surfaces in the plane, against closed forms: substances, belts, skins, zones, rolling resistance, the
/// user's rule; and bodies that explode.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "physics/planar/test_world.h"

namespace sandlot::planar {
namespace {

using namespace test;
using ::testing::HasSubstr;

constexpr double g = 9.81;

/// Semi-implicit Euler ends a constant deceleration within one step's way of the closed form.
double one_step(double speed) { return speed * h_s; }

std::shared_ptr<model::Model> box(const model::Surface& surface, bool is_static = false,
                                  Vec3 size = {0.2, 0.2, 0.2}) {
  auto m = model_of(Box{size}, is_static, 1, {{0, 0, 0.5 * size.z}, {}});
  m->links[0].collisions[0].surface = surface;
  return m;
}
model::Surface rubbing(double mu) {
  model::Surface s;
  s.mu = s.mu2 = mu;
  return s;
}
std::shared_ptr<model::Model> floor(const model::Surface& surface) {
  auto m = model_of(Plane{{0, 0, 1}}, true);
  m->links[0].collisions[0].surface = surface;
  return m;
}

struct Surfaces : World {
  void push(InstanceId id, Vec3 impulse_Ns, double angular_Nms = 0) {
    const Wrench w{engine.bodies(id)[0], (1 / h_s) * impulse_Ns, {0, 0, angular_Nms / h_s}};
    engine.apply({&w, 1});
  }
  Vec3 v(InstanceId id) { return state(id).V_WB.linear; }
};

TEST(PlanarSurface, SubstancesRubWithTheProductOfTheirRoughness) {
  Surfaces w;
  model::Surface wood = rubbing(9), ice = rubbing(9);
  wood.substance = model::Substance{.roughness = 0.8};
  ice.substance = model::Substance{.roughness = 0.5};
  w.add(floor(ice), at(0, 0));
  const InstanceId id = w.add(box(wood), at(0, 0));
  w.push(id, {2, 0, 0});
  w.run(200);
  EXPECT_NEAR(w.p(id).x, 2 * 2 / (2 * 0.4 * g), one_step(2));
  EXPECT_EQ(w.v(id).x, 0);
}

TEST(PlanarSurface, ABeltTakesABoxAlong) {
  for (const bool belt_first : {true, false}) {
    Surfaces w;
    model::Surface belt = rubbing(0.5);
    belt.belt_velocity_mps = {0.7, 0, 0};
    const auto m = box(belt, true, {10, 1, 0.2});
    const Pose X_WM = at(0, 0, math::pi / 6, -0.2);
    if (belt_first) w.add(m, X_WM);
    const InstanceId id = w.add(box(rubbing(1)), at(0, 0));
    if (!belt_first) w.add(m, X_WM);
    w.run(200);
    // It slides for v / (mu g) and falls v^2 / (2 mu g) behind. The belt runs along its own x axis.
    const double way = 0.7 * 2 - 0.7 * 0.7 / (2 * 0.5 * g);
    EXPECT_NEAR(w.p(id).x, way * 0.8660254037844386, one_step(0.7));
    EXPECT_NEAR(w.p(id).y, way * 0.5, one_step(0.7));
    EXPECT_NEAR(norm(w.v(id)), 0.7, 1e-12);
  }
}

TEST(PlanarSurface, ABodyWithABeltDrivesOnIt) {
  Surfaces w;
  w.add(floor(rubbing(1)), at(0, 0));
  model::Surface track = rubbing(1);
  track.belt_velocity_mps = {-0.3, 0, 0};
  const InstanceId id = w.add(box(track), at(0, 0, math::pi / 2));
  w.run(100);
  EXPECT_NEAR(w.v(id).y, 0.3, 1e-9);
  EXPECT_NEAR(w.v(id).x, 0, 1e-9);
}

TEST(PlanarSurface, ASkinSlidesAlongItsAxisAndHoldsAcross) {
  model::Surface fur = rubbing(0.5);
  fur.skin = model::Skin{{1, 0, 0}, 0.2};
  for (const double yaw : {0.0, math::pi / 2}) {
    Surfaces w;
    w.add(floor(rubbing(2)), at(0, 0));
    const InstanceId id = w.add(box(fur), at(0, 0, yaw));
    w.push(id, {1, 0, 0});
    w.run(200);
    EXPECT_NEAR(w.p(id).x, 1 / (2 * (yaw == 0 ? 0.1 : 0.5) * g), one_step(1)) << yaw;
  }
  // Pushed obliquely it is turned aside: friction is normal to the ellipse at its end, so in one implicit
  // step the velocities lost are as mu_i^2 times those that are left: 25 to 1.
  Surfaces w;
  w.add(floor(rubbing(2)), at(0, 0));
  const InstanceId id = w.add(box(fur), at(0, 0));
  w.push(id, {1, 1, 0});
  w.run(1);
  EXPECT_NEAR((1 - w.v(id).y) / (1 - w.v(id).x), 25 * w.v(id).y / w.v(id).x, 1e-9);
  // And the friction is on the ellipse.
  const double fx = (1 - w.v(id).x) / (0.1 * g * h_s), fy = (1 - w.v(id).y) / (0.5 * g * h_s);
  EXPECT_NEAR(fx * fx + fy * fy, 1, 1e-9);
}

TEST(PlanarSurface, AZoneOfIceKeepsTheSpeedAndABeltZoneCarries) {
  Surfaces w;
  w.add(floor(rubbing(0.5)), at(0, 0));
  model::SurfaceZone ice{.name = "ice", .outline_W = {{1, -1, 0}, {3, -1, 0}, {3, 1, 0}, {1, 1, 0}}};
  ice.surface = rubbing(0);
  model::SurfaceZone belt{.name = "belt", .centre_W = {0, 5, 0}, .radius_m = 1, .surface = rubbing(1)};
  belt.surface.belt_velocity_mps = {0, 0.4, 0};
  const model::SurfaceZone zones[] = {ice, belt};
  w.engine.set_zones(zones);
  const InstanceId id = w.add(box(rubbing(1)), at(0, 0)), carried = w.add(box(rubbing(1)), at(0, 5));
  w.push(id, {4, 0, 0});
  w.run(400);
  // v^2 = 16 - 2 mu g 1 m on the ice; behind it (16 - 2 mu g) / (2 mu g) more.
  EXPECT_NEAR(w.p(id).x, 3 + (16 - g) / g, 2 * one_step(4));
  // The other has left its zone and stopped just behind the border.
  EXPECT_NEAR(w.p(carried).y, 6 + 0.4 * 0.4 / (2 * 0.5 * g), one_step(0.4));
}

TEST(PlanarSurface, ARollingWheelIsHeldByItsResistance) {
  // A box on two wheels and nothing else: M v' = -F, J s' = F r - rho N, v = r s.
  Surfaces w;
  w.add(floor(rubbing(1)), at(0, 0));
  auto m = box(rubbing(1));
  m->links[0].collisions.clear();
  for (const double y : {0.2, -0.2}) {
    model::Link wheel;
    wheel.X_ML.p = {0, y, 0.1};
    wheel.inertial = {.mass_kg = 0.5, .moments = {1e-3, 4e-3, 1e-3}};
    wheel.collisions.push_back({"tyre", {}, Sphere{0.1}, rubbing(1), {}});
    wheel.collisions[0].surface.rolling_resistance_m = 0.002;
    m->joints.push_back({.name = "axle",
                         .type = model::JointType::continuous,
                         .parent = 0,
                         .child = static_cast<std::uint32_t>(m->links.size()),
                         .axis_J = {0, 1, 0}});
    m->links.push_back(wheel);
  }
  const InstanceId id = w.add(m, at(0, 0));
  w.drive(id, 1, 0, 0);
  w.run(10);
  const RollTarget rolls[] = {{w.engine.joints(id)[0], w.engine.bodies(id)[0], 10},
                              {w.engine.joints(id)[1], w.engine.bodies(id)[0], 10}};
  w.engine.set_rolls(rolls);
  const DriveTarget off{w.engine.bodies(id)[0], false};
  w.engine.set_drive_targets({&off, 1});
  w.run(100);
  const double M = 2, J = 8e-3, r = 0.1;
  EXPECT_NEAR(w.v(id).x, 1 - 0.002 * M * g / (r * (M + J / (r * r))), 1e-6);
}

TEST(PlanarSurface, LockedWheelsGoAlongWithTheBelt) {
  Surfaces w;
  model::SurfaceZone belt{.name = "belt", .radius_m = 10, .surface = rubbing(1)};
  belt.surface.belt_velocity_mps = {0.2, 0.1, 0};
  w.engine.set_zones({&belt, 1});
  auto m = box(rubbing(1), false, {0.2, 0.2, 0.1});
  m->links[0].collisions[0].X_LC.p.z = 0.3;
  for (const Vec3 p : {Vec3{0.1, 0.1, 0.1}, Vec3{0.1, -0.1, 0.1}, Vec3{-0.1, 0, 0.1}}) {
    model::Link wheel;
    wheel.X_ML.p = p;
    wheel.inertial = {.mass_kg = 0.1, .moments = {1e-4, 1e-4, 1e-4}};
    wheel.collisions.push_back({"tyre", {}, Sphere{0.1}, rubbing(1), {}});
    m->joints.push_back({.name = "axle",
                         .type = model::JointType::continuous,
                         .parent = 0,
                         .child = static_cast<std::uint32_t>(m->links.size()),
                         .axis_J = {0, 1, 0}});
    m->links.push_back(wheel);
  }
  const InstanceId id = w.add(m, at(0, 0));
  for (const JointId joint : w.engine.joints(id)) {
    const JointTarget lock{joint, JointTarget::Mode::velocity, 0, 1e6};
    w.engine.set_targets({&lock, 1});
  }
  w.run(100);
  EXPECT_NEAR(w.v(id).x, 0.2, 1e-9);
  EXPECT_NEAR(w.v(id).y, 0.1, 1e-9);
}

TEST(PlanarSurface, AWallThatRunsDragsWhatIsPressedAgainstIt) {
  Surfaces w;
  model::Surface belt = rubbing(0.5);
  belt.belt_velocity_mps = {0, 2, 0};
  w.add(box(belt, true, {1, 20, 1}), at(0.6, 0));
  const InstanceId id = w.add(box(rubbing(0.5)), at(0, 0, 0, 0.01));
  w.add(floor(rubbing(0)), at(0, 0));
  for (int i = 0; i < 10; ++i) {
    w.push(id, {10 * h_s, 0, 0});  // 10 N, so a pull of 5 N on 1 kg
    w.run(1);
  }
  // It may turn by the slop of 0.1 mm over its length of 0.2 m.
  EXPECT_NEAR(w.v(id).y, 0.5, 5e-4);
}

TEST(PlanarSurface, TheRuleIsAskedLastAndInOrderOfCreation) {
  Surfaces w;
  w.add(floor(rubbing(0.5)), at(0, 0));
  auto ghost = box(rubbing(0.5));
  ghost->links[0].name = "ghost";
  const InstanceId id = w.add(ghost, at(0, 0)), stops = w.add(box(rubbing(0.5)), at(0, 3));
  w.add(box(rubbing(0.5), true, {0.2, 10, 1}), at(0.5, 0));
  bool ordered = true;
  w.engine.set_contact_rule(
      [&](const ContactSide& a, const ContactSide& b, Vec3 point, Vec3 normal, PairSurface& pair) {
        const bool ground = std::abs(normal.z) > 0.5;
        if (!ground) {
          pair.touches = a.link.name != "ghost";  // the wall came last
          if (pair.touches)
            ordered = ordered && std::abs(b.X_WC.p.x - 0.5) < 1e-12 && normal.x > 0.9 &&
                      std::abs(a.X_WC.p.x - point.x) < 0.2 && std::abs(a.X_WC.p.z - 0.1) < 1e-12;
        } else {
          ordered = ordered && std::holds_alternative<Plane>(a.collision.shape) && normal.z == 1;
          if (b.link.name == "ghost") pair.mu = pair.mu2 = 0;
        }
      });
  w.push(id, {1, 0, 0});
  w.push(stops, {3, 0, 0});
  w.run(100);
  EXPECT_TRUE(ordered);
  EXPECT_NEAR(w.p(id).x, 1, 1e-9);
  EXPECT_NEAR(w.p(stops).x, 0.3, 3 * 0.5 * g * h_s * h_s);  // friction of the last steps
}

TEST(PlanarSurface, WhatExplodesIsNamedAndTheStateOfBeforeKept) {
  for (const bool spins : {false, true}) {
    Surfaces w;
    w.add(robot_model(), at(5, 5));
    auto m = robot_model();
    m->links[0].name = "mad";
    const InstanceId id = w.add(m, at(0, 0));
    w.run(1);
    ASSERT_TRUE(w.engine.check_finite());
    w.push(id, {spins ? 0.0 : 11000, 0, 0}, spins ? 3e5 : 0);
    w.run(3);
    const Status status = w.engine.check_finite();
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().what, HasSubstr("thing/mad"));
    EXPECT_THAT(status.error().what, HasSubstr(spins ? "max_spin, 1e+05 rad/s" : "at 11000 m/s"));
    EXPECT_THAT(status.error().fix, HasSubstr(spins ? "physics.max_spin" : "physics.max_speed"));
    EXPECT_EQ(w.p(id).x, 0);
    EXPECT_EQ(w.v(id), Vec3{});
  }
}

}  // namespace
}  // namespace sandlot::planar
