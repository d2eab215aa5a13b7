/// MARIO round a loop of 40 m through the vineyard (scenarios/vineyard_loop.yaml): how far from the truth wheels, eyes and both filters end,
/// and whether the filters know it. A run takes two minutes of two processors: one seed is a slow test, the others are long ones.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "command.h"

namespace sandlot::test {
namespace {

/// Distances from the truth in the plane [m].
struct VineyardErrors {
  double wheels = 0, eyes = 0, fused = 0, deviation = 0, located = 0, located_deviation = 0;
  static constexpr const char* names[] = {"wheels",    "eyes",    "fused",
                                          "deviation", "located", "located_deviation"};
  double* values() { return &wheels; }
};

struct VineyardRun {
  VineyardErrors end;     ///< at the last tick
  VineyardErrors square;  ///< means of the squares on the way
  std::size_t rows = 0;
};

VineyardRun vineyard_run(int seed, const std::string& settings = "",
                         const std::string& scenario = "scenarios/vineyard_loop.yaml") {
  const TestFolder scratch;
  const std::string file = scratch.file("loop.csv");
  const Printed printed = sandlot(
      "run " + scenario + " --headless --seed " + std::to_string(seed) + " --log " + file +
      " --log-values 'wheels,eyes,fused,deviation,located,located_deviation' " + settings);
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
  std::ifstream in(file);
  std::string line, cell;
  std::getline(in, line);
  VineyardRun run;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::getline(row, cell, ',');  // time
    for (std::size_t i = 0; i < 6; ++i) {
      std::getline(row, cell, ',');
      if (!cell.empty()) run.end.values()[i] = std::stod(cell);  // none yet: it stands
      run.square.values()[i] += run.end.values()[i] * run.end.values()[i];
    }
    ++run.rows;
  }
  for (std::size_t i = 0; i < 6; ++i) run.square.values()[i] /= static_cast<double>(run.rows);
  EXPECT_GT(run.rows, 8000u);
  std::printf("seed %2d:", seed);
  for (std::size_t i = 0; i < 6; ++i) std::printf("  %s %.3f", VineyardErrors::names[i], run.end.values()[i]);
  std::printf("  %s\n", settings.c_str());
  std::fflush(stdout);
  return run;
}

/// Mean of the squares of error by deviation, where the deviation is of both axes together: 1 when the covariance is right. For n runs it is
/// below chi-square(2 n) / (2 n) of axes alike; these are the quantiles of 99.9 %.
constexpr double too_sure_5 = 29.6 / 10, too_sure_20 = 73.4 / 40;

void expect_closed(const VineyardRun& run) {
  EXPECT_LT(run.end.fused, 0.3);
  EXPECT_LT(run.end.located, 0.3);
  EXPECT_LT(run.end.fused, 3 * run.end.deviation);
  EXPECT_LT(run.end.located, 3 * run.end.located_deviation);
  EXPECT_LT(run.square.fused, run.square.wheels);
  EXPECT_LT(run.square.located, run.square.fused);
}

TEST(SlowVineyardLoop, IsClosedByFusionAndTheFiltersKnowHowWell) {
  const VineyardRun run = vineyard_run(1);
  expect_closed(run);
  // On the whole way; at its end the errors of a calibration have turned round once.
  EXPECT_LT(run.square.fused, run.square.eyes);
  EXPECT_LT(run.end.located_deviation, run.end.deviation);
}

TEST(LongVineyardLoop, IsClosedInNineteenOfTwentySeeds) {
  constexpr int runs = 20;
  int closed = 0;
  double wheels = 0, eyes = 0, fused = 0, by_deviation = 0, located_by_deviation = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const VineyardRun run = vineyard_run(seed);
    const VineyardErrors& end = run.end;
    closed += end.fused < 0.3;
    // On the whole way: at the end of a loop a constant relative error of the eyes has turned round and cancels in their path, whereas a
    // filter that shares the way between wheels and eyes and turns by both keeps what is left of either.
    wheels += run.square.wheels, eyes += run.square.eyes, fused += run.square.fused;
    by_deviation += std::pow(end.fused / end.deviation, 2) / runs;
    located_by_deviation += std::pow(end.located / end.located_deviation, 2) / runs;
  }
  EXPECT_GE(closed, 19);
  EXPECT_LT(fused, wheels);
  EXPECT_LT(fused, eyes);
  EXPECT_LT(by_deviation, too_sure_20);
  EXPECT_LT(located_by_deviation, too_sure_20);
  RecordProperty("fused_by_deviation", std::to_string(by_deviation));
  RecordProperty("located_by_deviation", std::to_string(located_by_deviation));
}

/// Another ground and other vines.
TEST(LongVineyardLoop, IsClosedInAnotherVineyard) {
  const TestFolder scratch;
  const std::string folder = scratch.file("other");
  ASSERT_EQ(shell("python3 tools/make_vineyard.py --seed 3 " + folder).exit_code, 0);
  expect_closed(
      vineyard_run(1, "--set world=" + folder + "/vineyard.sdf --set start_z=0.417 --set start_pitch=0.053"));
}

/// The eyes steer, and no device on the robot tells the truth: nothing can have read it.
TEST(LongVineyardLoop, IsClosedWithoutADeviceThatTellsTheTruth) {
  const TestFolder scratch;
  std::ifstream in("scenarios/vineyard_loop.yaml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string root = std::filesystem::current_path().string();
  for (const auto& [before, after] :
       {std::pair<std::string, std::string>{"      truth: {kind: ground_truth}\n", ""},
        {"model: ../models/", "model: " + root + "/models/"},
        {"world: ../worlds/", "world: " + root + "/worlds/"}}) {
    ASSERT_NE(text.find(before), std::string::npos) << before;
    text.replace(text.find(before), before.size(), after);
  }
  scratch.write("loop.yaml", text);
  expect_closed(vineyard_run(1, "--set driver=eyes/odometry", scratch.file("loop.yaml")));
}

/// Five seeds with a device that is dead from 20 s on.
/// @return  sums over the runs of (error / deviation)^2, of both filters
void expect_honest_without(const std::string& device) {
  double by_deviation = 0, located_by_deviation = 0;
  for (int seed = 1; seed <= 5; ++seed) {
    const VineyardErrors end = vineyard_run(seed, "--set 'robots[0].devices." + device +
                                                      ".failures=[{kind: dead, from: 20 s}]'")
                                   .end;
    by_deviation += std::pow(end.fused / end.deviation, 2) / 5;
    located_by_deviation += std::pow(end.located / end.located_deviation, 2) / 5;
    if (device == "gps") { EXPECT_GT(end.located_deviation, 0.5 * end.deviation); }
  }
  EXPECT_LT(by_deviation, too_sure_5);
  EXPECT_LT(located_by_deviation, too_sure_5);
}

TEST(LongVineyardFailures, WithoutSatellites) { expect_honest_without("gps"); }
TEST(LongVineyardFailures, WithoutEyes) { expect_honest_without("stereo"); }
TEST(LongVineyardFailures, WithoutTheInertialUnit) { expect_honest_without("imu"); }

}  // namespace
}  // namespace sandlot::test
