/// The IMU on both engines against closed forms.
#include <gtest/gtest.h>

#include "messages/messages.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

constexpr double g = 9.81;

/// A cylinder that stands on the ground, or falls from 5 m, with an IMU at (0.3, 0, 0) of its centre.
model::Setup cylinder(const std::string& engine, bool grounded) {
  model::Setup setup;
  setup.engine = engine;
  setup.step = Time::from_s(0.01);
  setup.substeps = 5;
  if (grounded) setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  setup.instances.push_back(
      placed("robot", one_shape("robot", Cylinder{0.2, 0.4}, 2), {{0, 0, grounded ? 0.2 : 5}, {}}));
  setup.instances.back().is_robot = true;
  setup.instances.back().devices.push_back(device("imu", "imu", map({{"rate", "20"}}), {{0.3, 0, 0}, {}}));
  return setup;
}

const msg::Imu& reading(const Simulation& simulation) {
  return topic_cast<msg::Imu>(simulation.find_topic("robot/imu"))->message;
}

TEST(ImuOnEngines, StandingItShowsGravity) {
  for (const char* engine : {"rigid", "planar"}) {
    const auto simulation = build(cylinder(engine, true));
    advance(*simulation, 100);
    EXPECT_NEAR(reading(*simulation).linear_acceleration.x, 0, 1e-3) << engine;
    EXPECT_NEAR(reading(*simulation).linear_acceleration.z, g, 1e-3) << engine;
  }
}

TEST(ImuOnEngines, FallingItShowsNothing) {
  const auto simulation = build(cylinder("rigid", false));
  advance(*simulation, 50);
  EXPECT_NEAR(norm(reading(*simulation).linear_acceleration), 0, 1e-9);
}

TEST(ImuOnEngines, OnATurntableItShowsTheCentripetalForce) {
  // w = 2 rad/s at r = 0.3 m: w^2 r = 1.2 m/s^2 inwards, less by (w h)^2 / 24 = 7e-7 of it for h = 2 ms.
  for (const char* engine : {"rigid", "planar"}) {
    model::Setup setup = cylinder(engine, true);
    Node mover = Node::map();
    Node& turn = mover.set("initial_angular", Node::sequence());
    for (const char* x : {"0", "0", "2"}) turn.push(Node::scalar(x));
    setup.instances.back().devices.push_back(device("mover", "body_velocity", std::move(mover)));
    const auto simulation = build(std::move(setup));
    advance(*simulation, 200);
    const msg::Imu& m = reading(*simulation);
    EXPECT_NEAR(m.angular_velocity.z, 2, 1e-3) << engine;
    EXPECT_NEAR(m.linear_acceleration.x, -1.2, 5e-3) << engine;
    EXPECT_NEAR(m.linear_acceleration.y, 0, 5e-3) << engine;
    EXPECT_NEAR(m.linear_acceleration.z, g, 5e-3) << engine;
  }
}

}  // namespace
}  // namespace sandlot::test
