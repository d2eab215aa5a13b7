/// Devices that are loaded and unloaded while the world runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "messages/messages.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

Status ask(Simulation& simulation, Request request) {
  const std::uint64_t number = simulation.submit(std::move(request));
  SL_TRY(simulation.tick());
  for (const Outcome& outcome : simulation.outcomes())
    if (outcome.sequence == number) return outcome.status;
  return Error{"no outcome"};
}

CommandRequest number(const char* target, double value) {
  ByteWriter w;
  write(w, msg::Float64{value});
  return {target, msg::Float64::ros_type, w.buffer()};
}

/// A plate on the ground that carries a flywheel about the vertical: inertia 0.5 kg m^2, no friction, no gravity.
model::Setup flywheel(Node motor, const char* level) {
  auto made = std::make_shared<model::Model>();
  made->name = "stand";
  for (const char* name : {"base", "wheel"}) {
    model::Link link;
    link.name = name;
    link.X_ML.p = {0, 0, made->links.empty() ? 0.05 : 0.5};
    link.inertial.mass_kg = made->links.empty() ? 1e6 : 1;
    link.inertial.moments = made->links.empty() ? Vec3{1e6, 1e6, 1e6} : Vec3{0.5, 0.5, 0.5};
    link.gravity = false;
    made->links.push_back(link);
  }
  model::Joint joint;
  joint.name = "axle";
  joint.type = model::JointType::continuous;
  joint.parent = 0;
  joint.child = 1;
  made->joints.push_back(joint);
  model::Setup setup;
  setup.gravity = {};
  setup.step = Time::from_s(0.002);
  setup.substeps = 2;
  setup.instances.push_back(placed("stand", made, {}));
  setup.instances.back().is_robot = true;
  motor.set("joint", Node::scalar("axle"));
  motor.set("level", Node::scalar(level));
  setup.instances.back().devices.push_back(device("motor", "joint_motor", std::move(motor)));
  setup.instances.back().devices.push_back(device("joints", "joint_state", map({{"rate", "0"}})));
  return setup;
}

double angle(const Simulation& simulation) {
  return topic_cast<msg::JointState>(simulation.find_topic("stand/joints"))->message.position[0];
}
double speed(const Simulation& simulation) {
  return topic_cast<msg::JointState>(simulation.find_topic("stand/joints"))->message.velocity[0];
}

TEST(JointController, AStepOfHalfARadianFollowsTheSecondOrderSystem) {
  // J y'' = p (r - y) - d y' with J = 0.5: w = sqrt(p / J) = 8, zeta = d / (2 w J) = 0.4. The joint stands at 0.5 and
  // is told to go to 0: y = 0.5 exp(-zeta w t) (cos(wd t) + zeta / sqrt(1 - zeta^2) sin(wd t)), wd = w sqrt(1 - zeta^2).
  // The effort is held for h = 1 ms: a delay of h / 2, so an error of about h / 2 times the steepest slope, 0.5 w.
  Node motor = Node::map();
  motor.set("position", map({{"p", "32"}, {"d", "3.2"}}));
  const auto simulation = build(flywheel(std::move(motor), "position"));
  ASSERT_TRUE(ask(*simulation, number("stand/motor", 0.5)));
  advance(*simulation, 3000);
  ASSERT_NEAR(angle(*simulation), 0.5, 1e-6);
  ASSERT_NEAR(speed(*simulation), 0, 1e-6);
  const double w = 8, zeta = 0.4, root = std::sqrt(1 - zeta * zeta);
  const auto exact = [&](double t) {
    return 0.5 * math::exp(-zeta * w * t) * (math::cos(w * root * t) + zeta / root * math::sin(w * root * t));
  };
  ASSERT_TRUE(ask(*simulation, number("stand/motor", 0.0)));
  double lowest = 0, worst = std::abs(angle(*simulation) - exact(0.002));
  for (int k = 2; k <= 1000; ++k) {
    advance(*simulation, 1);
    worst = std::max(worst, std::abs(angle(*simulation) - exact(0.002 * k)));
    lowest = std::min(lowest, angle(*simulation));
  }
  EXPECT_LT(worst, 0.5 * w * 0.0005);
  EXPECT_NEAR(lowest, -0.5 * math::exp(-math::pi * zeta / root), 0.001);  // the overshoot, 25 %
  EXPECT_NEAR(angle(*simulation), 0, 1e-3);
}

TEST(JointController, StoppedTheJointTurnsFreelyOn) {
  const auto simulation = build(flywheel(map({{"servo", "exact"}}), "velocity"));
  ASSERT_TRUE(ask(*simulation, number("stand/motor", 2.0)));
  advance(*simulation, 10);
  EXPECT_NEAR(speed(*simulation), 2, 1e-4);
  ASSERT_TRUE(ask(*simulation, ParameterRequest{"stand/motor", "active", Node::scalar("false")}));
  ASSERT_TRUE(ask(*simulation, number("stand/motor", -5.0)));
  const double before = speed(*simulation);
  advance(*simulation, 100);
  EXPECT_NEAR(speed(*simulation), before, 1e-3);
}

TEST(Mount, AMotorLoadedWhileRunningDrivesAndUnloadedLeavesTheJointFree) {
  const auto simulation = build(flywheel(Node::map(), "effort"));
  ASSERT_TRUE(ask(*simulation, UnloadDeviceRequest{"stand/motor"}));
  EXPECT_THAT(ask(*simulation, number("stand/motor", 1)).error().what, HasSubstr("there is no device"));
  Node keys = map({{"joint", "axle"}, {"level", "velocity"}, {"servo", "exact"}});
  ASSERT_TRUE(ask(*simulation, LoadDeviceRequest{"stand", device("second", "joint_motor", keys)}));
  ASSERT_TRUE(ask(*simulation, number("stand/second", 3.0)));
  advance(*simulation, 10);
  EXPECT_NEAR(speed(*simulation), 3, 1e-4);
  const auto restored = again(*simulation);
  // A command and the end of its device in one tick.
  simulation->submit(number("stand/second", -1.0));
  ASSERT_TRUE(ask(*simulation, UnloadDeviceRequest{"stand/second"}));
  const double before = speed(*simulation);
  advance(*simulation, 100);
  EXPECT_NEAR(speed(*simulation), before, 1e-3);
  EXPECT_GT(before, 2.9);
  advance(*restored, 100);
  EXPECT_NEAR(speed(*restored), 3, 1e-4);  // there it is still held
}

/// The same edits at the same ticks, whatever the threads; with a restore in between or without.
std::vector<std::uint64_t> edited_run(const std::string& engine, int threads, bool restoring) {
  auto simulation = build(arena(engine, 3), {.threads = threads});
  std::vector<std::uint64_t> hashes;
  const auto on = [&](int tick) {
    if (tick == 20) {
      simulation->submit(LoadDeviceRequest{"rover2", device("sonar", "range_finder", map({{"rate", "20"}}))});
      simulation->submit(LoadDeviceRequest{"rover1", device("imu", "imu", map({{"rate", "50"}}))});
    }
    if (tick == 60) simulation->submit(UnloadDeviceRequest{"rover1/truth"});
    if (tick == 80) simulation->submit(LoadDeviceRequest{"rover1", device("truth2", "ground_truth")});
    if (tick == 110) simulation->submit(UnloadDeviceRequest{"rover2/sonar"});
  };
  for (int tick = 0; tick < 150; ++tick) {
    if (restoring && (tick == 50 || tick == 70 || tick == 100 || tick == 130))
      simulation = again(*simulation, {.threads = threads});
    on(tick);
    advance(*simulation, 1);
    for (const Outcome& outcome : simulation->outcomes())
      EXPECT_TRUE(outcome.status) << outcome.status.error().text();
    hashes.push_back(simulation->state_hash());
  }
  return hashes;
}

TEST(Mount, EditsGiveTheSameHashesForAnyThreadsAndAfterARestore) {
  for (const char* engine : {"rigid", "planar"}) {
    const auto once = edited_run(engine, 1, false);
    EXPECT_EQ(once, edited_run(engine, 2, false)) << engine;
    EXPECT_EQ(once, edited_run(engine, 1, true)) << engine;
  }
}

TEST(Mount, WhatBecameARobotStaysAwakeWithARestoreAsWithout) {
  // A crate at rest sleeps after half a second; a robot never does, whether it was one from the start or not.
  const auto run = [](bool restoring) {
    auto simulation = build(arena("rigid", 0));
    advance(*simulation, 10);
    EXPECT_TRUE(ask(*simulation, LoadDeviceRequest{"crate1", device("truth", "ground_truth")}));
    if (restoring) simulation = again(*simulation);
    std::vector<std::uint64_t> hashes;
    for (int tick = 0; tick < 300; ++tick) {
      advance(*simulation, 1);
      hashes.push_back(simulation->state_hash());
    }
    EXPECT_EQ(simulation->engine().counters().awake_bodies, 1u);
    return hashes;
  };
  EXPECT_EQ(run(false), run(true));
}

TEST(Mount, AProgramKeepsWhatItNeeds) {
  const auto simulation = build(arena("planar", 1));
  advance(*simulation, 50);
  EXPECT_FALSE(ask(*simulation, UnloadDeviceRequest{"rover1/laser"}));
  EXPECT_FALSE(ask(*simulation, UnloadDeviceRequest{"rover1/drive"}));
  const Pose before = simulation->engine().pose(*simulation->find_instance("rover1"));
  advance(*simulation, 100);
  const Pose after = simulation->engine().pose(*simulation->find_instance("rover1"));
  EXPECT_GT(norm(after.p - before.p), 0.05);  // it wanders on
}

TEST(Mount, WhatCannotBeIsSaid) {
  const auto simulation = build(arena("planar", 1));
  const auto complaint = [&](Request request) {
    const Status status = ask(*simulation, std::move(request));
    return status ? "" : status.error().text();
  };
  EXPECT_EQ(complaint(LoadDeviceRequest{"rover9", device("x", "imu")}), "there is nothing named 'rover9'");
  EXPECT_EQ(complaint(LoadDeviceRequest{"rover1", device("x", "imo")}),
            "no kind of device 'imo'; did you mean 'imu'?");
  EXPECT_EQ(complaint(LoadDeviceRequest{"rover1", device("", "imu")}), "the device has no name");
  EXPECT_THAT(complaint(LoadDeviceRequest{"rover1", device("laser", "imu")}), HasSubstr("two devices named"));
  EXPECT_THAT(complaint(LoadDeviceRequest{"rover1", device("x", "imu", map({{"rat", "1"}}))}),
              HasSubstr("did you mean 'rate'"));
  model::DeviceDecl nowhere = device("x", "imu");
  nowhere.link = 99;
  EXPECT_THAT(complaint(LoadDeviceRequest{"rover1", nowhere}), HasSubstr("no link 99"));
  EXPECT_EQ(complaint(UnloadDeviceRequest{"rover1/x"}), "there is no device 'rover1/x'");
}

}  // namespace
}  // namespace sandlot::test
