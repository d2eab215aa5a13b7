/// Wheels on the ground, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/planar/test_world.h"

namespace sandlot::planar::wheels_test {
namespace {

using namespace test;

constexpr double g = 9.81, radius = 0.1, wheel_kg = 0.2;

struct WheelAt {
  double x, y, yaw = 0;
  std::optional<double> roller_rad = {};
  bool steered = false;
};

/// A box of 10 kg on wheels; positive spin rolls along the wheel's own x.
std::shared_ptr<model::Model> cart(const std::vector<WheelAt>& wheels, double mu = 0.8, double mass_kg = 10) {
  auto m = model_of(Box{{0.4, 0.3, 0.1}}, false, mass_kg, {{0, 0, 0.15}, {}});
  m->links[0].inertial.moments = inertia_kg_m2(Box{{0.4, 0.3, 0.1}}, mass_kg);
  for (const WheelAt& at : wheels) {
    const std::string name = "wheel" + std::to_string(m->joints.size());
    std::uint32_t parent = 0;
    if (at.steered) {
      model::Link fork;
      fork.name = name + "_fork";
      fork.X_ML = pose_from_rpy({at.x, at.y, radius}, {0, 0, at.yaw});
      fork.inertial = {.mass_kg = 0.1, .moments = {1e-4, 1e-4, 1e-4}};
      parent = static_cast<std::uint32_t>(m->links.size());
      m->links.push_back(fork);
      m->joints.push_back(
          {.name = name + "_steer", .type = model::JointType::revolute, .parent = 0, .child = parent});
    }
    model::Link wheel;
    wheel.name = name;
    wheel.X_ML = pose_from_rpy({at.x, at.y, radius}, {0, 0, at.yaw});
    wheel.inertial.mass_kg = wheel_kg;
    wheel.inertial.moments = {wheel_kg * radius * radius / 4, wheel_kg * radius * radius / 2,
                              wheel_kg * radius * radius / 4};
    if (!at.roller_rad) {
      wheel.collisions.push_back({"tyre", {}, Sphere{radius}, {}, {}});
      wheel.collisions[0].surface.mu = mu;
    }
    model::Joint axle{.name = name,
                      .type = model::JointType::continuous,
                      .parent = parent,
                      .child = static_cast<std::uint32_t>(m->links.size()),
                      .axis_J = {0, 1, 0}};
    if (at.roller_rad) {
      axle.rollers = model::RollerWheel{.radius_m = radius, .angle_rad = *at.roller_rad, .roller_mass_kg = 0};
      axle.rollers->surface.mu = mu;
    }
    m->links.push_back(wheel);
    m->joints.push_back(axle);
  }
  return m;
}

const std::vector<WheelAt> four{{0.2, 0.25}, {0.2, -0.25}, {-0.2, 0.25}, {-0.2, -0.25}};

/// So slowly that no wheel slips on the way.
void spin(World& w, InstanceId id, const std::vector<double>& radps) {
  std::vector<double> before;
  for (std::size_t i = 0; i < radps.size(); ++i)
    before.push_back(w.engine.joint_states()[w.engine.joints(id)[i].index].velocity);
  for (int step = 1; step <= 100; ++step) {
    for (std::size_t i = 0; i < radps.size(); ++i) {
      const JointTarget t{w.engine.joints(id)[i], JointTarget::Mode::velocity,
                          before[i] + (radps[i] - before[i]) * step / 100, 1e3};
      w.engine.set_targets({&t, 1});
    }
    w.run(1);
  }
}

TEST(PlanarWheel, WeightIsSharedByEquilibrium) {
  // Three on a triangle have one solution: moments about each side.
  const Vec2 three[] = {{1, 0}, {-1, 1}, {-1, -1}};
  double shares[4];
  share_weight(12, three, std::span(shares, 3));
  EXPECT_NEAR(shares[0], 6, 1e-7);
  EXPECT_NEAR(shares[1], 3, 1e-7);
  EXPECT_NEAR(shares[2], 3, 1e-7);
  // A pair in a line with the middle, and one that would have to pull.
  const Vec2 line[] = {{3, 0}, {-1, 0}};
  share_weight(4, line, std::span(shares, 2));
  EXPECT_NEAR(shares[0], 1, 1e-7);
  const Vec2 outside[] = {{1, 0}, {-1, 0}, {3, 0}, {4, 0}};
  share_weight(1, outside, std::span(shares, 4));
  EXPECT_GE(*std::min_element(shares, shares + 4), 0);
  EXPECT_NEAR(shares[0] + shares[1] + shares[2] + shares[3], 1, 1e-12);
  EXPECT_NEAR(shares[0] - shares[1] + 3 * shares[2] + 4 * shares[3], 0, 1e-7);
}

TEST(PlanarWheel, ARobotDrivesAsItsWheelsTurn) {
  World w;
  const InstanceId id = w.add(cart(four), at(0, 0));
  spin(w, id, {5, 5, 5, 5});
  w.run(200);
  EXPECT_NEAR(w.state(id).V_WB.linear.x, 0.5, 1e-7);
  EXPECT_NEAR(w.p(id).y, 0, 1e-6);
  EXPECT_NEAR(w.engine.joint_states()[w.engine.joints(id)[0].index].velocity, 5, 1e-12);
}

TEST(PlanarWheel, ASkiddingRobotTurnsAsCoulombSays) {
  // Moments about the middle vanish at w = V b / (a^2 + b^2), a = 0.2, b = 0.25, V = 0.5: 1.2195 rad/s.
  for (const double h : {0.001, 0.01}) {
    World w;
    const InstanceId id = w.add(cart(four), at(0, 0));
    for (std::size_t i = 0; i < 4; ++i) {
      const JointTarget t{w.engine.joints(id)[i], JointTarget::Mode::velocity, i % 2 ? 5.0 : -5.0, 1e3};
      w.engine.set_targets({&t, 1});
    }
    for (int i = 0; i < 2 / h; ++i) w.engine.step(h, 0);
    EXPECT_NEAR(w.state(id).V_WB.angular.z, 0.5 * 0.25 / (0.04 + 0.0625), 0.01 * 1.2195) << h;
    EXPECT_NEAR(norm(w.p(id)), 0, 1e-5);  // passes end at 1e-10 m/s
  }
}

TEST(PlanarWheel, TorqueAcceleratesRobotAndSpins) {
  World w;
  const InstanceId id = w.add(cart(four), at(0, 0));
  for (const JointId joint : w.engine.joints(id)) {
    const JointTarget t{.joint = joint, .mode = JointTarget::Mode::effort, .effort = 0.5};
    w.engine.set_targets({&t, 1});
  }
  w.run(100);
  // a = 4 tau / r / (M + 4 I / r^2); each of 4 wheels has I = m r^2 / 2.
  EXPECT_NEAR(w.state(id).V_WB.linear.x, 4 * 0.5 / radius / (10.8 + 0.4), 1e-4);
}

TEST(PlanarWheel, GripEndsAtMuTimesTheWeight) {
  World w;
  const InstanceId id = w.add(cart(four, 0.3), at(0, 0));
  for (const JointId joint : w.engine.joints(id)) {
    const JointTarget t{.joint = joint, .mode = JointTarget::Mode::effort, .effort = 20};
    w.engine.set_targets({&t, 1});
  }
  w.run(50);
  EXPECT_NEAR(w.state(id).V_WB.linear.x, 0.3 * g * 0.5, 1e-9);
  // I dw/dt = tau - r mu N with a quarter of the weight
  const double spin_up = (20 - radius * 0.3 * g * 10.8 / 4) / (wheel_kg * radius * radius / 2);
  EXPECT_NEAR(w.engine.joint_states()[w.engine.joints(id)[0].index].velocity, spin_up * 0.5, 1e-6 * spin_up);
}

TEST(PlanarWheel, WithoutMotorsItCoastsAndABendTakesNoSpeed) {
  World w;
  const InstanceId id = w.add(cart({{0, 0.2}, {0, -0.2}}), at(0, 0));
  spin(w, id, {8, 12});
  w.run(200);
  for (const JointId joint : w.engine.joints(id)) {
    const JointTarget loose{.joint = joint};
    w.engine.set_targets({&loose, 1});
  }
  const double before = norm(w.state(id).V_WB.linear);
  w.run(500);  // ten turns' worth of bend: 1 rad/s for 5 s
  EXPECT_NEAR(norm(w.state(id).V_WB.linear), before, 0.01 * before);
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 0.4 / 0.4, 0.01);
}

TEST(PlanarWheel, ItDoesNotSlipSideways) {
  World w;
  const InstanceId id = w.add(cart(four), at(0, 0));
  for (int i = 0; i < 100; ++i) {
    const Wrench wrench{w.engine.bodies(id)[0], {0, 0.9 * 0.8 * 10.8 * g, 0}, {}};
    w.engine.apply({&wrench, 1});
    w.run(1);
  }
  EXPECT_NEAR(w.p(id).y, 0, 1e-9);
  EXPECT_NEAR(w.p(id).x, 0, 1e-9);
}

// The body turns by some 1e-4 rad while it sets off: a step's impulses are found by passes over the wheels.
TEST(PlanarWheel, OmniWheelsMoveItAnyWay) {
  const double b = 0.2;
  std::vector<WheelAt> wheels;
  for (int i = 0; i < 3; ++i) {
    const double a = math::tau * i / 3;
    wheels.push_back({b * math::cos(a), b * math::sin(a), a + math::pi / 2, math::pi / 2});
  }
  World w;
  const InstanceId id = w.add(cart(wheels), at(0, 0));
  // Wheel i rolls along its own x: r s = v . t_i + b w
  const double vx = 0.3, vy = -0.2, wz = 0.0;
  std::vector<double> s;
  for (int i = 0; i < 3; ++i) {
    const double a = math::tau * i / 3;
    s.push_back((-math::sin(a) * vx + math::cos(a) * vy + b * wz) / radius);
  }
  spin(w, id, s);
  w.run(100);
  EXPECT_NEAR(w.state(id).V_WB.linear.x, vx, 1e-4);
  EXPECT_NEAR(w.state(id).V_WB.linear.y, vy, 1e-4);
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 0, 1e-6);
  spin(w, id, {2, 2, 2});
  w.run(100);
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 2 * radius / b, 1e-6);
}

TEST(PlanarWheel, MecanumWheelsGoSidewaysAndSpin) {
  // Rollers at +-45 degrees so that they meet the ground as an X seen from above: with the roller's axis
  // along (cos, -sin) of the angle from the axle, front left and rear right share one sign, the others the
  // other.
  const double q = math::pi / 4;
  World w;
  const InstanceId id = w.add(
      cart({{0.2, 0.25, 0, q}, {0.2, -0.25, 0, -q}, {-0.2, 0.25, 0, -q}, {-0.2, -0.25, 0, q}}), at(0, 0));
  // Along the roller's axis g = (sin q, cos q): g . (v + w x arm) = r s sin q
  const auto speeds = [&](double vx, double vy, double wz) {
    std::vector<double> s;
    const double x[] = {0.2, 0.2, -0.2, -0.2}, y[] = {0.25, -0.25, 0.25, -0.25}, sign[] = {1, -1, -1, 1};
    for (int i = 0; i < 4; ++i) s.push_back((vx - wz * y[i] + sign[i] * (vy + wz * x[i])) / radius);
    return s;
  };
  spin(w, id, speeds(0, 0.4, 0));
  w.run(100);
  EXPECT_NEAR(w.state(id).V_WB.linear.y, 0.4, 1e-4);
  EXPECT_NEAR(w.state(id).V_WB.linear.x, 0, 1e-4);
  spin(w, id, speeds(0, 0, 1));
  w.run(100);
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 1, 1e-6);
  EXPECT_NEAR(norm(w.state(id).V_WB.linear), 0, 1e-6);
}

TEST(PlanarWheel, SteeredWheelsLeadItRoundTheirCentre) {
  World w;
  // Bicycle: rear fixed at x = -0.2, front steered at 0.2.
  const InstanceId id = w.add(cart({{-0.2, 0.1}, {-0.2, -0.1}, {0.2, 0, 0, {}, true}}), at(0, 0));
  const auto joints = w.engine.joints(id);  // two wheels, steering, front wheel
  const double angle = 0.3;
  for (int i = 0; i < 300; ++i) {
    const double now = w.engine.joint_states()[joints[2].index].position;
    const JointTarget t[] = {{joints[2], JointTarget::Mode::velocity, (angle - now) / 0.1, 10},
                             {joints[3], JointTarget::Mode::velocity, 5, 100}};
    w.engine.set_targets(t);
    w.run(1);
  }
  EXPECT_NEAR(w.engine.joint_states()[joints[2].index].position, angle, 1e-6);
  // The front goes 0.5 m/s; the bend's centre lies on the rear axle at 0.4 / tan(angle).
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 0.5 * math::sin(angle) / 0.4, 2e-3);
}

TEST(PlanarWheel, BetweenRailsAndWheelsPoseAndVelocityStay) {
  World w;
  const InstanceId id = w.add(cart({{0, 0.2}, {0, -0.2}}), at(0, 0));
  w.drive(id, 0.5, 0, 0.4, 2, 4);
  spin(w, id, {(0.5 - 0.08) / radius, (0.5 + 0.08) / radius});
  w.run(100);
  const BodyState before = w.state(id);
  const DriveTarget release{w.engine.bodies(id)[0], false};
  w.engine.set_drive_targets({&release, 1});
  EXPECT_EQ(w.state(id).X_WB, before.X_WB);
  w.run(1);
  EXPECT_NEAR(norm(w.state(id).V_WB.linear - before.V_WB.linear), 0, 0.5 * 0.4 * 2 * h_s);
  w.run(50);
  EXPECT_NEAR(w.state(id).V_WB.angular.z, 0.4, 1e-3);
  const BodyState there = w.state(id);
  w.drive(id, 0.5, 0, 0.4, 2, 4);
  w.run(1);
  EXPECT_NEAR(norm(w.state(id).V_WB.linear - there.V_WB.linear), 0, 0.5 * 0.4 * 2 * h_s);
}

/// Attitude and height say which wheels stand on the ground: a robot that was laid on its side has others than at first.
TEST(PlanarWheel, TheStateOfARobotThatFellFitsANewEngineWhereItStands) {
  const auto model = cart({{0, 0.2}, {0, -0.2}});
  World before, after;
  const InstanceId id = before.add(model, at(0, 0)), again = after.add(model, at(0, 0));
  before.run(5);
  for (const double roll : {1.5, 0.0, 3.0}) {
    before.engine.set_pose(id, pose_from_rpy({1, 2, 0.3}, {roll, 0, 0.5}));
    before.run(1);
    ByteWriter saved, loaded;
    before.engine.save(id, saved);
    ByteReader reader(saved.bytes());
    ASSERT_TRUE(after.engine.load(again, reader)) << roll;
    EXPECT_EQ(reader.remaining(), 0u) << roll;
    after.engine.save(again, loaded);
    EXPECT_EQ(saved.buffer(), loaded.buffer()) << roll;
    EXPECT_EQ(after.engine.pose(again), before.engine.pose(id)) << roll;
  }
}

}  // namespace
}  // namespace sandlot::planar::wheels_test
