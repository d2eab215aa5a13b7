#include "controllers/playback/playback.h"

#include <gtest/gtest.h>

namespace sandlot::controllers::playback {
namespace {

Description description() {
  Description robot;
  robot.robot = "rover";
  robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
  return robot;
}

Playback player(std::string samples) {
  Playback out;
  out.spec.samples = std::move(samples);
  return out;
}

Status init(Playback& controller) {
  Outputs none("rover/controller");
  return controller.init(description(), none);
}

/// vx, vy, wz ordered at `now_s`.
std::vector<double> ordered(Playback& controller, double now_s) {
  const Observation obs(Time::from_s(now_s), {}, {}, Stream(1, 2, Purpose::controller, 3));
  Command cmd;
  controller.step(obs, cmd);
  EXPECT_EQ(cmd.orders().size(), 1u);
  ByteReader r(cmd.bytes(cmd.orders()[0]));
  msg::Twist twist;
  read(r, twist);
  return {twist.linear.x, twist.linear.y, twist.angular.z};
}
using V = std::vector<double>;

TEST(Playback, ASampleHoldsUntilTheNextAndTheLastEndsIt) {
  Playback controller = player("0.5 1 2 3\n1, -0.25, 0, 4\r\n\n2;0;0;9\n");
  ASSERT_TRUE(init(controller));
  EXPECT_EQ(ordered(controller, 0.4), (V{0, 0, 0})) << "before the first";
  EXPECT_EQ(ordered(controller, 0.5), (V{1, 2, 3}));
  EXPECT_EQ(ordered(controller, 0.9), (V{1, 2, 3}));
  EXPECT_EQ(ordered(controller, 1.0), (V{-0.25, 0, 4}));
  EXPECT_EQ(ordered(controller, 1.99), (V{-0.25, 0, 4}));
  EXPECT_EQ(ordered(controller, 2.0), (V{0, 0, 0}));
  EXPECT_EQ(ordered(controller, 99), (V{0, 0, 0}));
}

TEST(Playback, StartAndRateMoveTheTimesAndLeaveTheVelocities) {
  Playback controller = player("0 1 0 0\n1 2 0 0\n2 0 0 0");
  controller.spec.start_s = 10;
  controller.spec.rate = 4;
  ASSERT_TRUE(init(controller));
  EXPECT_EQ(ordered(controller, 9.99), (V{0, 0, 0}));
  EXPECT_EQ(ordered(controller, 10), (V{1, 0, 0}));
  EXPECT_EQ(ordered(controller, 10.24), (V{1, 0, 0}));
  EXPECT_EQ(ordered(controller, 10.25), (V{2, 0, 0}));
  EXPECT_EQ(ordered(controller, 10.5), (V{0, 0, 0}));
}

TEST(Playback, ALoopBeginsAgainAtTheTimeOfTheLastSample) {
  Playback controller = player("0 1 0 0\n1 2 0 0\n3 7 0 0");
  controller.spec.loop = true;
  ASSERT_TRUE(init(controller));
  EXPECT_EQ(ordered(controller, 2.9), (V{2, 0, 0}));
  EXPECT_EQ(ordered(controller, 3.0), (V{1, 0, 0}));
  EXPECT_EQ(ordered(controller, 301.5), (V{2, 0, 0})) << "1.5 s into round 100";
}

TEST(Playback, PublishesForAnotherProgramInsteadOfOrdering) {
  Playback controller = player("0 1 2 3\n1 0 0 0");
  controller.spec.publish = "cmd_vel";
  Outputs outputs("rover/joystick");
  ASSERT_TRUE(controller.init({.robot = "rover"}, outputs)) << "it needs no drive";
  Command cmd;
  cmd.bind(&outputs);
  controller.step(Observation(Time::from_s(0.5), {}, {}, Stream(1, 2, Purpose::controller, 3)), cmd);
  outputs.commit(Time::from_s(0.5));
  EXPECT_TRUE(cmd.orders().empty());
  ASSERT_EQ(outputs.all().size(), 1u);
  const auto* const shown = topic_cast<msg::Twist>(outputs.all()[0].topic.get());
  EXPECT_EQ(shown->name(), "/rover/joystick/cmd_vel");
  EXPECT_EQ(shown->message.linear.y, 2);
  EXPECT_EQ(shown->message.angular.z, 3);
  controller.spec.to = "drive";
  EXPECT_EQ(controller.init(description(), outputs).error().path, "/publish");
}

TEST(Playback, TextKeepsEveryBitOfASample) {
  const std::vector<Sample> samples{{0.1, 1.0 / 3, -0.0, 1e-300}, {0.30000000000000004, 2, 3, 4}};
  const auto again = read_samples(samples_text(samples));
  ASSERT_TRUE(again);
  ASSERT_EQ(again->size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*again)[i].time_s, samples[i].time_s);
    EXPECT_EQ((*again)[i].vx_mps, samples[i].vx_mps);
    EXPECT_EQ((*again)[i].wz_radps, samples[i].wz_radps);
  }
}

TEST(Playback, RefusesWhatItCannotPlay) {
  const auto complaint = [](std::string samples) {
    Playback controller = player(std::move(samples));
    const Status ready = init(controller);
    return ready ? "" : ready.error().what;
  };
  EXPECT_EQ(complaint(""), "there is nothing to play back");
  EXPECT_EQ(complaint(" \n,\n"), "there are no samples");
  EXPECT_EQ(complaint("0 1 2"), "row 1 has 3 numbers");
  EXPECT_EQ(complaint("0 1 2 3 4"), "row 1 has more than 4 numbers");
  EXPECT_EQ(complaint("0 1 2 3\n1 2 fast 4"), "row 2: 'fast' is not a number here");
  EXPECT_EQ(complaint("0 1 2 nan"), "row 1: 'nan' is not a number here");
  EXPECT_EQ(complaint("1 0 0 0\n0.5 0 0 0"), "row 2 is earlier than the one above it");
  Playback unread;
  unread.spec.file = "run.mcap";
  EXPECT_EQ(init(unread).error().what, "the recording 'run.mcap' was not read");
  Playback still = player("0 1 0 0");
  still.spec.loop = true;
  EXPECT_EQ(init(still).error().path, "/loop");
}

}  // namespace
}  // namespace sandlot::controllers::playback
