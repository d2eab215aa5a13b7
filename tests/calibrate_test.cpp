/// Calibration: from pictures to error parameters of the level `objects`, and back.
#include <gtest/gtest.h>

#include <cmath>

#include "command.h"

namespace sandlot::test {
namespace {

/// What calibrate counted and fitted.
nlohmann::json calibrated(const std::string& arguments) {
  const Printed printed = sandlot("calibrate " + arguments + " --json");
  if (printed.exit_code != 0) return {{"failed", printed.out}};
  return nlohmann::json::parse(printed.out, nullptr, false);
}
/// Deviation of the range in the middle of what was seen; slope and constant alone are known less well.
double range_std(const nlohmann::json& run, double range_m) {
  return run["objects"]["range_std"].get<double>() +
         run["objects"]["range_std_per_m"].get<double>() * range_m;
}
/// Five standard deviations of the difference of two shares of n each.
double share_noise(double p, double n) { return 5 * std::sqrt(2 * std::max(p, 3 / n) * (1 - p) / n); }

/// A small camera that sees badly: far balls are a few pixels, three pixels in ten of any colour.
constexpr const char* poor_eye =
    " --camera seeker/eye --set robots[0].devices.eye.width=128 --set robots[0].devices.eye.height=96"
    " --set 'robots[0].devices.eye.noise=[{gaussian: {std: 6 %}}, {hundreds_and_thousands: {rate: 30 %}}]'";

TEST(SlowCalibrate, WhatItWritesMakesTheHighLevelErrAsThePicturesDid) {
  const TestFolder scratch;
  const std::string run = "scenarios/ball.yaml" + std::string(poor_eye) + " --samples 1500";
  const auto pictures = calibrated(run + " --out " + scratch.file("eye.yaml"));
  ASSERT_FALSE(pictures.contains("failed")) << pictures["failed"];
  scratch.write("again.yaml", "version: 1\ninclude: [" +
                                  std::filesystem::absolute("scenarios/ball.yaml").string() +
                                  ", eye.yaml]\nvars: {objects: \"${seeker_eye_objects}\"}\n");
  const auto told = calibrated(scratch.file("again.yaml") + poor_eye + " --samples 1500 --detector objects");
  ASSERT_FALSE(told.contains("failed")) << told["failed"];
  SCOPED_TRACE(pictures.dump(1) + told.dump(1));

  // The same things stand in the same places: what was to be seen is the same.
  ASSERT_EQ(told["sighted"], pictures["sighted"]);
  const double n = pictures["sighted"];
  ASSERT_GT(n, 3000);
  const double missed = 1 - pictures["found"].get<double>() / n;
  EXPECT_GT(missed, 0.01) << "a test of misses needs some";
  EXPECT_NEAR(1 - told["found"].get<double>() / n, missed, share_noise(missed, n));
  const double ghosts = pictures["ghosts"];
  EXPECT_GT(ghosts, 20);
  EXPECT_NEAR(told["ghosts"].get<double>(), ghosts, 5 * std::sqrt(2 * ghosts));
  // A deviation of n normal errors is known by the factor 1 +- 0.71 / sqrt(n), from their mean size by 1 +-
  // 0.76 / sqrt(n).
  const double bearing = pictures["objects"]["bearing_std"];
  EXPECT_NEAR(told["objects"]["bearing_std"].get<double>(), bearing, bearing * 5 * 0.71 / std::sqrt(n));
  EXPECT_NEAR(range_std(told, 3), range_std(pictures, 3), range_std(pictures, 3) * 5 * 0.76 / std::sqrt(n));
}

TEST(SlowCalibrate, GivesBackTheErrorsThatTheLevelWasGiven) {
  const auto told = calibrated(
      "scenarios/ball.yaml --camera seeker/eye --samples 1500 --detector objects"
      " --set 'objects={labels: [ball, goal_blue, goal_yellow, magenta, cyan], miss_rate: 0.1, confusion: "
      "0.08,"
      " bearing_std: 0.5 deg, range_std: 2 cm, range_std_per_m: 0.01, ghost_rate: 2}'");
  ASSERT_FALSE(told.contains("failed")) << told["failed"];
  SCOPED_TRACE(told.dump(1));
  const double n = told["sighted"], found = told["found"];
  EXPECT_NEAR(1 - found / n, 0.1, 5 * std::sqrt(0.1 * 0.9 / n));
  EXPECT_NEAR(told["objects"]["confusion"].get<double>(), 0.08, 5 * std::sqrt(0.08 * 0.92 / found));
  EXPECT_NEAR(told["confused"].get<double>() / found, told["objects"]["confusion"].get<double>(), 1e-4);
  EXPECT_NEAR(told["objects"]["bearing_std"].get<double>(), 0.00873, 0.00873 * 5 * 0.71 / std::sqrt(found));
  EXPECT_NEAR(range_std(told, 3), 0.05, 0.05 * 5 * 0.76 / std::sqrt(found));
  const double ghosts = 2 * told["seconds"].get<double>();
  EXPECT_NEAR(told["ghosts"].get<double>(), ghosts, 5 * std::sqrt(ghosts));
}

TEST(Calibrate, OfAClearPictureThereAreHardlyAnyGhosts) {
  const auto pictures = calibrated("scenarios/ball.yaml --camera seeker/eye --samples 300");
  ASSERT_FALSE(pictures.contains("failed")) << pictures["failed"];
  // Edges between a yellow goal and a magenta post, orange as the ball, made one in ten pictures; goals that
  // are half hidden or half out of the picture were both missed and ghosts.
  EXPECT_GT(pictures["found"].get<double>(), 0.99 * pictures["sighted"].get<double>());
  EXPECT_LE(pictures["ghosts"].get<int>(), 3) << pictures.dump(1);
  // Things that are not told by colours are left out, and said to be.
  const Printed field = sandlot("calibrate scenarios/msl_field.yaml --camera cyan2/omni --samples 3");
  EXPECT_EQ(field.exit_code, 0);
  EXPECT_NE(field.out.find("label 'robot' are black, white or grey"), std::string::npos) << field.out;
  EXPECT_EQ(field.out.find("ground"), std::string::npos) << "the level looks for other labels";
}

}  // namespace
}  // namespace sandlot::test
