/// The loop of numbers of the report on LpzRobots, whose model and world are known.
#include "app/papers/lpzrobots.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandlot::app::lpzrobots {
namespace {

LoopResult run(const LoopSpec& spec) {
  auto result = run_loop(spec);
  EXPECT_TRUE(static_cast<bool>(result));
  return result ? *result : LoopResult();
}

TEST(LpzrobotsLoop, NoPredictionIsBetterThanTheNoise) {
  // Uniform within 0.05: 0.05 / sqrt(3) = 0.0289 root mean square; 10^4 samples scatter by 0.6 % (five deviations of 0.45 / sqrt(10^4)
  // are 2.2 %).
  const double floor = 0.05 / std::sqrt(3.0);
  const LoopResult alone = run({});
  EXPECT_GT(alone.surprise, floor * 0.978);
  // A model that fits predicts all but the noise; what learning at a rate of 0.1 adds is below half of it.
  EXPECT_LT(alone.surprise, 1.5 * floor);
  // Without a world there is no S to miss.
  EXPECT_EQ(alone.world_error, 0);
}

TEST(LpzrobotsLoop, AModelWithoutSMissesAllOfTheWorld) {
  // |0.4 R|: a turn has the Frobenius norm sqrt(2).
  const LoopResult plain = run({.world = true});
  EXPECT_NEAR(plain.world_error, 0.4 * std::sqrt(2.0), 1e-12);
  const LoopResult extended = run({.world = true, .extended_model = true});
  // While the agent drives, its motors follow the sensors: S takes a part of the error only.
  EXPECT_LT(extended.world_error, plain.world_error);
  EXPECT_LT(extended.model_error, plain.model_error);
}

TEST(LpzrobotsLoop, IndependentMotorsTellTheModelFromTheWorld) {
  // Descent by single samples at the rate e keeps weights that scatter by about sqrt(e / 2) times the noise, here sqrt(0.05) 0.0289 =
  // 0.0065 each, 0.013 for four: three times that.
  const LoopResult out = run({.world = true, .extended_model = true, .babbling = true});
  EXPECT_LT(out.model_error, 0.039);
  EXPECT_LT(out.world_error, 0.039);
}

TEST(LpzrobotsLoop, TeachingBringsTheMotorsNearerToWhatIsTaught) {
  EXPECT_LT(run({.taught = true}).off_taught, 0.5 * run({}).off_taught);
}

TEST(LpzrobotsLoop, TheSameSeedIsTheSameRun) {
  EXPECT_EQ(run({.seed = 7}).model_error, run({.seed = 7}).model_error);
  EXPECT_NE(run({.seed = 7}).model_error, run({.seed = 8}).model_error);
}

}  // namespace
}  // namespace sandlot::app::lpzrobots
