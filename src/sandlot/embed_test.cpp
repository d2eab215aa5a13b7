#include "sandlot/embed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

namespace sandlot::test {
namespace {

using testing::HasSubstr;

constexpr const char* scenario = R"(
version: 1
physics: planar
time: {step: 10 ms}
robots:
  - name: rover
    model: rover
)";

std::unique_ptr<Simulation> rover() { return or_exit(load_simulation_text(scenario)); }

TEST(Embed, AReadingIsTheLatestMessageAndKnowsWhetherItIsNew) {
  const auto sim = rover();
  const auto scan = or_exit(reading<msg::LaserScan>(*sim, "rover/laser"));
  EXPECT_TRUE(scan.valid && scan.fresh) << "the first scan is due at tick 0";
  ASSERT_EQ(scan.message.ranges.size(), 271u);
  for (const float range_m : scan.message.ranges)
    EXPECT_TRUE(std::isinf(range_m) && range_m > 0) << "an empty plane";
  or_exit(sim->tick());
  EXPECT_FALSE(or_exit(reading<msg::LaserScan>(*sim, "rover/laser")).fresh)
      << "10 Hz: the next one is due at 100 ms";
  while (sim->now() < Time::from_s(0.1)) or_exit(sim->tick());
  EXPECT_TRUE(or_exit(reading<msg::LaserScan>(*sim, "rover/laser/ranges")).fresh);
}

TEST(Embed, ACommandMovesTheRobotFromTheNextTickOn) {
  const auto sim = rover();
  or_exit(command(*sim, "rover/drive", msg::Twist{.linear = {0.5, 0, 0}, .angular = {}}));
  EXPECT_EQ(or_exit(pose(*sim, "rover")).p.x, 0.0);
  for (int i = 0; i < 100; ++i) or_exit(sim->tick());
  // 0.5 s at 1 m/s^2, then 0.5 s at 0.5 m/s: 0.375 m. Steps of 10 ms add or lose half a step of the ramp: 2.5
  // mm.
  EXPECT_NEAR(or_exit(pose(*sim, "rover")).p.x, 0.375, 0.0026);
}

TEST(Embed, AServiceIsCalledWithTheNextTick) {
  using msg::std_srvs::Trigger;
  const std::string text = std::string(scenario) + "    devices: {unit: {kind: imu, link: base_link}}\n";
  const auto sim = or_exit(load_simulation_text(text));
  const std::uint64_t number = or_exit(call<Trigger>(*sim, "rover/unit", "calibrate"));
  EXPECT_FALSE(response<Trigger>(*sim, number)) << "no tick has carried it out";
  or_exit(sim->tick());
  const Trigger::Response answer = or_exit(response<Trigger>(*sim, number));
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_THAT(call<Trigger>(*sim, "rover/unit", "calibrat").error().text(),
              HasSubstr("did you mean 'calibrate'?"));
  EXPECT_THAT(call<msg::Console>(*sim, "rover/unit", "calibrate").error().text(),
              HasSubstr("is of type std_srvs/srv/Trigger"));
  EXPECT_THAT(call<Trigger>(*sim, "rover/laser", "calibrate").error().text(),
              HasSubstr("a laser_scanner offers none"));
}

TEST(Embed, TheSecondHalfFromASnapshotEndsInTheSameState) {
  const auto sim = rover();
  or_exit(command(*sim, "rover/drive", msg::Twist{.linear = {0.5, 0, 0}, .angular = {0, 0, 1}}));
  for (int i = 0; i < 30; ++i) or_exit(sim->tick());
  const auto again = or_exit(restore_simulation(sim->snapshot()));
  for (int i = 0; i < 30; ++i) {
    or_exit(sim->tick());
    or_exit(again->tick());
  }
  EXPECT_EQ(again->state_hash(), sim->state_hash());
}

TEST(Embed, ARobotPlaysBackAFileAsItDoesInTheCommand) {
  const std::string file = testing::TempDir() + "sandlot_embed_playback.csv";
  std::ofstream(file) << "time,vx,vy,wz\n0,0.5,0,0\n1,0,0,0\n";
  const auto with = [&](const std::string& name) {
    return load_simulation_text(scenario + ("    controller: {kind: playback, file: " + name + "}\n"));
  };
  const auto sim = or_exit(with(file));
  while (sim->now() < Time::from_s(2)) or_exit(sim->tick());
  // 0.5 m/s ordered for a second; ramps up and down at 1 m/s^2 alike: 0.5 m, give or take a control step of
  // 50 ms.
  EXPECT_NEAR(or_exit(pose(*sim, "rover")).p.x, 0.5, 0.025);

  const auto none = with("not_there.mcap");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text(), testing::AllOf(HasSubstr("scenario.yaml:8"), HasSubstr("not_there.mcap")));
  std::remove(file.c_str());
}

TEST(Embed, WhatIsNotThereIsAnErrorThatNamesWhatThereIs) {
  const auto sim = rover();
  const auto complaint = [](const auto& result) { return result ? std::string() : result.error().text(); };
  EXPECT_THAT(complaint(pose(*sim, "rver")), HasSubstr("did you mean 'rover'?"));
  EXPECT_THAT(complaint(reading<msg::LaserScan>(*sim, "rober/laser")), HasSubstr("did you mean 'rover'?"));
  EXPECT_THAT(complaint(reading<msg::LaserScan>(*sim, "rover/lasr")),
              HasSubstr("did you mean 'rover/laser'?"));
  EXPECT_THAT(complaint(reading<msg::Twist>(*sim, "rover/laser")), HasSubstr("sensor_msgs/msg/LaserScan"));
  EXPECT_THAT(complaint(reading<msg::LaserScan>(*sim, "rover/laser/rays")), HasSubstr("publishes no"));
  EXPECT_THAT(complaint(command(*sim, "rover/drive", msg::Float64{})), HasSubstr("geometry_msgs/msg/Twist"));
  EXPECT_THAT(complaint(command(*sim, "rover/laser", msg::Twist{})), HasSubstr("takes no"));
  EXPECT_THAT(complaint(load_simulation_text("version: 1\nrobts: []\n", "mine.yaml")),
              HasSubstr("mine.yaml:2:"));
  EXPECT_THAT(complaint(load_simulation("nowhere.yaml")), HasSubstr("nowhere.yaml"));
}

TEST(Embed, WarningsGoWhereTheyAreAskedFor) {
  Diagnostics diagnostics;
  // 30 Hz does not divide 100 Hz.
  or_exit(load_simulation_text(std::string(scenario) + "    devices: {laser: {rate: 30}}\n", "s.yaml", {},
                               &diagnostics));
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_THAT(diagnostics.warnings[0].what, HasSubstr("30 Hz"));
}

}  // namespace
}  // namespace sandlot::test
