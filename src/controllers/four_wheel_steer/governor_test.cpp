#include "controllers/four_wheel_steer/governor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/math.h"
#include "base/random.h"

namespace sandlot::controllers::four_wheel_steer {
namespace {

constexpr double dt = 0.01, radius = 0.075;

std::vector<Wheel> modules() {
  return {{0.21, 0.21, radius}, {0.21, -0.21, radius}, {-0.21, 0.21, radius}, {-0.21, -0.21, radius}};
}

/// A governor whose servos follow their set points exactly, a step later, plus an error that a test sets.
struct Bench {
  Governor governor;
  Setting setting;
  Orders orders;
  std::vector<double> measured;
  double error_rad = 0;  ///< of the first wheel's servo

  explicit Bench(const Limits& limits = {}, std::vector<double> start = {0, 0, 0, 0})
      : governor(modules(), limits), measured(std::move(start)) {
    setting = governor.start(measured);
  }
  void step(const Motion& command) {
    governor.step(command, measured, dt, setting, orders);
    measured = setting.steering_rad;
    measured[0] += error_rad;
  }
  void run(const Motion& command, double time_s) {
    for (long k = 0; k < std::lround(time_s / dt); ++k) step(command);
  }
  double most_rate() const {
    double most = 0;
    for (const double rate : orders.rate_radps) most = std::max(most, std::abs(rate));
    return most;
  }
};

TEST(FourWheelGovernor, SettlesAtTheInverseKinematicsInEachMode) {
  for (const Motion& v : {Motion{0.5, 0, 0}, Motion{0.3, 0.4, 0}, Motion{0, 0, 1}, Motion{0.5, 0.1, 0.4545},
                          Motion{-0.4, 0.2, 0.6}}) {
    Bench bench;
    bench.run(v, 3);
    EXPECT_EQ(bench.setting.phase, Phase::driving);
    EXPECT_EQ(bench.orders.mode, mode_of(v));
    for (std::size_t i = 0; i < 4; ++i) {
      const WheelMotion want = inverse(v, modules()[i]);
      const double off = math::wrap_angle(bench.setting.steering_rad[i] - want.steering_rad);
      const bool flipped = std::abs(off) > 1;
      EXPECT_NEAR(flipped ? std::abs(off) - math::pi : off, 0, 1e-12);
      EXPECT_NEAR(bench.orders.rate_radps[i], flipped ? -want.rate_radps : want.rate_radps, 1e-12);
      EXPECT_LE(std::abs(bench.setting.steering_rad[i]), 1.5708);
    }
  }
}

TEST(FourWheelGovernor, ACommandThatIsTooFastIsScaledAsAWhole) {
  Bench bench({.max_wheel_speed_radps = 10});
  const Motion command{1, 0, 2};  // the right wheels run at sqrt(1.42^2 + 0.42^2) = 1.4808 m/s, 19.74 rad/s
  bench.run(command, 3);
  const double scale = 10 / (std::sqrt(1.42 * 1.42 + 0.42 * 0.42) / radius);
  EXPECT_NEAR(bench.orders.scale, scale, 1e-12);
  EXPECT_NEAR(bench.most_rate(), 10, 1e-9);
  EXPECT_NEAR(bench.setting.motion.x, scale * 1, 1e-12);
  EXPECT_NEAR(bench.setting.motion.turn, scale * 2, 1e-12);
  EXPECT_NEAR(centre_of_rotation(bench.setting.motion)->y, 0.5, 1e-12);
}

TEST(FourWheelGovernor, StartsAndStopsAtTheAccelerationOfAWheelOnOneCentre) {
  Bench bench({.max_wheel_acceleration_radps2 = 20});
  // Straight on: 1 m/s is 13.33 rad/s, 66.7 steps of 0.2 rad/s.
  bench.step({1, 0, 0});
  EXPECT_NEAR(bench.most_rate(), 0.2, 1e-12);
  bench.run({1, 0, 0}, 0.65);
  EXPECT_NEAR(bench.most_rate(), 66 * 0.2, 1e-9);
  bench.step({1, 0, 0});
  EXPECT_NEAR(bench.most_rate(), 1 / radius, 1e-9);
  EXPECT_NEAR(bench.orders.change.x, (1 - 66 * 0.2 * radius) / dt, 1e-6);
  // On a curve: the outer wheels set the pace, and the centre does not move.
  Bench curve;
  curve.run({0.5, 0, 1}, 1);
  const Motion before = curve.setting.motion;
  curve.step({});
  EXPECT_EQ(curve.setting.phase, Phase::braking);
  const Vec2 lost = wheel_velocity(before - curve.setting.motion, modules()[1]);
  EXPECT_NEAR(std::sqrt(dot(lost, lost)), 30 * radius * dt, 1e-12);
  EXPECT_NEAR(centre_of_rotation(curve.setting.motion)->y, 0.5, 1e-12);
  EXPECT_EQ(curve.orders.mode, Mode::stop);
  const std::vector<double> angles = curve.setting.steering_rad;
  curve.run({}, 1);
  EXPECT_EQ(curve.setting.phase, Phase::standing);
  EXPECT_EQ(curve.most_rate(), 0);
  EXPECT_EQ(curve.setting.steering_rad, angles) << "a stop leaves the steering where it is";
}

TEST(FourWheelGovernor, SteersBeforeItDrivesAndAllWheelsArriveTogether) {
  Bench bench;
  // A spin: wheels to 135 degrees or -45, here -45, 45, 45, -45. At 4 rad/s: 0.7854 / 0.04 = 19.6 steps.
  for (int k = 1; k <= 19; ++k) {
    bench.step({0, 0, 1});
    EXPECT_EQ(bench.setting.phase, Phase::steering);
    EXPECT_EQ(bench.most_rate(), 0);
    EXPECT_NEAR(std::abs(bench.setting.steering_rad[0]), 0.04 * k, 1e-12);
  }
  EXPECT_LT(bench.setting.steering_rad[0], 0);
  EXPECT_GT(bench.setting.steering_rad[1], 0);
  bench.step({0, 0, 1});  // within `aligned` now
  EXPECT_EQ(bench.setting.phase, Phase::driving);
  EXPECT_GT(bench.most_rate(), 0);
  // To a curve on which wheels have different ways: they arrive in one step.
  Bench curve;
  int steps[4] = {0, 0, 0, 0};
  for (int k = 0; k < 60; ++k) {
    const std::vector<double> before = curve.setting.steering_rad;
    curve.step({0.2, 0.1, 1});
    for (std::size_t i = 0; i < 4; ++i)
      if (std::abs(curve.setting.steering_rad[i] - before[i]) > 1e-12) steps[i] = k;
  }
  EXPECT_GT(steps[0], 5);
  for (const int last : steps) EXPECT_EQ(last, steps[0]);
}

TEST(FourWheelGovernor, BackIsTheSameAngleAndTheOtherWayRound) {
  Bench bench;
  bench.run({0.5, 0.2, 0}, 2);
  const std::vector<double> angles = bench.setting.steering_rad;
  const double rate = bench.orders.rate_radps[0];
  bench.run({-0.5, -0.2, 0}, 2);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(bench.setting.steering_rad[i], angles[i], 1e-12);
  EXPECT_NEAR(bench.orders.rate_radps[0], -rate, 1e-12);
}

TEST(FourWheelGovernor, AtTheEndOfItsRangeAWheelStaysForTheHysteresis) {
  Bench bench({.steering_lower_rad = -math::pi / 2, .steering_upper_rad = math::pi / 2});
  const auto along = [](double rad) { return Motion{0.4 * math::cos(rad), 0.4 * math::sin(rad), 0}; };
  bench.run(along(1.5), 2);
  EXPECT_NEAR(bench.setting.steering_rad[0], 1.5, 1e-9);
  bench.run(along(math::pi / 2 + 0.08), 1);
  EXPECT_NEAR(bench.setting.steering_rad[0], math::pi / 2, 1e-9);
  EXPECT_GT(bench.orders.rate_radps[0], 5);
  bench.run(along(math::pi / 2 + 0.12), 3);  // beyond 0.1: round to the other side
  EXPECT_NEAR(bench.setting.steering_rad[0], -math::pi / 2 + 0.12, 1e-9);
  EXPECT_LT(bench.orders.rate_radps[0], -5);
  bench.run(along(math::pi / 2 - 0.05), 1);
  EXPECT_NEAR(bench.setting.steering_rad[0], -math::pi / 2, 1e-9);
}

TEST(FourWheelGovernor, ErrorsOfSteeringSlowItDownByTheirCosineAndThenStopIt) {
  Bench bench;
  bench.run({0.5, 0, 0}, 1);
  bench.error_rad = 0.2;
  bench.run({0.5, 0, 0}, 1);
  EXPECT_NEAR(bench.setting.motion.x, 0.5 * math::cos(0.2), 1e-12);
  EXPECT_EQ(bench.setting.phase, Phase::driving);
  bench.error_rad = 0.4;  // above steer_first
  bench.run({0.5, 0, 0}, 1);
  EXPECT_EQ(bench.setting.phase, Phase::steering);
  EXPECT_EQ(bench.most_rate(), 0);
  bench.error_rad = 0.2;  // above `aligned`: it does not start
  bench.run({0.5, 0, 0}, 1);
  EXPECT_EQ(bench.setting.phase, Phase::steering);
  bench.error_rad = 0.04;
  bench.run({0.5, 0, 0}, 1);
  EXPECT_NEAR(bench.setting.motion.x, 0.5 * math::cos(0.04), 1e-12);
}

TEST(FourWheelGovernor, AWheelThatMustGoFarRoundStopsTheRobotFirst) {
  // 80 degrees to 100: the servos end at 90, so the wheels go round to -80. It brakes on the old course first.
  Bench bench;
  bench.run({0.5 * math::cos(1.4), 0.5 * math::sin(1.4), 0}, 2);
  const Motion across{0.5 * math::cos(1.75), 0.5 * math::sin(1.75), 0};
  bool braked = false, steered = false;
  for (int k = 0; k < 300; ++k) {
    bench.step(across);
    braked = braked || bench.setting.phase == Phase::braking;
    steered = steered || bench.setting.phase == Phase::steering;
    const bool on_the_way = std::abs(bench.setting.steering_rad[0]) < 1.3;
    EXPECT_EQ(on_the_way ? bench.most_rate() : 0, 0) << k;
  }
  EXPECT_TRUE(braked && steered);
  EXPECT_NEAR(bench.setting.steering_rad[0], 1.75 - math::pi, 1e-9);
  EXPECT_NEAR(bench.setting.motion.y, across.y, 1e-12);
}

TEST(FourWheelGovernor, WhatNoAngleFitsIsReportedAndNotDriven) {
  Bench bench({.steering_lower_rad = -0.6, .steering_upper_rad = 0.6});
  bench.run({0.5, 0, 0}, 1);
  EXPECT_TRUE(bench.orders.reachable);
  bench.run({0, 0.5, 0}, 1);
  EXPECT_FALSE(bench.orders.reachable);
  EXPECT_EQ(bench.setting.phase, Phase::standing);
  EXPECT_EQ(bench.most_rate(), 0);
}

TEST(FourWheelGovernor, TinyCommandsAreAStopAndLeaveTheSteeringAlone) {
  Bench bench;
  bench.run({0, 0.004, 0}, 1);
  EXPECT_EQ(bench.orders.mode, Mode::stop);
  EXPECT_EQ(bench.setting.steering_rad, (std::vector<double>{0, 0, 0, 0}));
  bench.run({0, 0.006, 0}, 1);
  EXPECT_EQ(bench.orders.mode, Mode::crab);
  EXPECT_NEAR(bench.setting.steering_rad[0], math::pi / 2, 1e-12);
}

TEST(FourWheelGovernor, ACentreThatPassesAWheelDoesNotHoldItUp) {
  // The centre of rotation goes from (0, 0.6) through the front left wheel to (0.315, 0.015): v = (w c_y, -w c_x).
  Bench bench;
  bench.run({0.6, 0, 1}, 2);
  const Motion to{0.015, -0.315, 1};
  bench.run(to, 4);
  EXPECT_NEAR(bench.setting.motion.x, to.x, 1e-12);
  EXPECT_NEAR(bench.setting.motion.y, to.y, 1e-12);
  // Exactly on the wheel: it stands at whatever angle it has.
  const Motion on_it{0.21, -0.21, 1};
  bench.run(on_it, 4);
  EXPECT_NEAR(bench.setting.motion.y, on_it.y, 1e-12);
  EXPECT_NEAR(bench.orders.rate_radps[0], 0, 1e-9);
  // Off again, in a direction 0.2 rad from where that wheel points: its set point would jump by more than a step may.
  const double before = bench.setting.steering_rad[0], angle = before + (before > 0 ? -0.2 : 0.2);
  const Motion off{0.21 + 0.1 * math::cos(angle), -0.21 + 0.1 * math::sin(angle), 1};
  bench.run(off, 4);
  EXPECT_NEAR(bench.setting.motion.x, off.x, 1e-12);
  EXPECT_NEAR(bench.setting.steering_rad[0], angle, 1e-9);
}

TEST(FourWheelGovernor, CommandsThatAreNoNumbersAreAStop) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double smallest : {0.0, 0.005})
    for (const Motion& bad :
         {Motion{nan, 0, 0}, Motion{0, -inf, 0}, Motion{0.1, 0, nan}, Motion{inf, inf, inf}}) {
      Bench bench({.smallest_speed_mps = smallest});
      bench.run({0.5, 0, 0}, 1);
      bench.run(bad, 1);
      EXPECT_EQ(bench.setting.phase, Phase::standing);
      EXPECT_EQ(bench.most_rate(), 0);
      EXPECT_EQ(bench.orders.mode, Mode::stop);
      EXPECT_TRUE(bench.governor.fits(bench.setting));
    }
}

TEST(FourWheelGovernor, KeepsAllLimitsAndOneCentreWhateverIsCommanded) {
  const Limits limits;
  Stream random(1, 2, Purpose::experiment, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  Bench bench(limits);
  Motion command;
  int driven = 0, consistent = 0;
  for (int k = 0; k < 40'000; ++k) {
    if (random.below(20) == 0) {
      command = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-3, 3)};
      if (random.below(4) == 0) command.turn = 0;
      if (random.below(6) == 0) command.x = 0;
      if (random.below(50) == 0) command.y = nan;
      if (random.below(50) == 0) command.x = -inf;
      if (random.below(50) == 0) command = 1e200 * command;
    }
    const Setting before = bench.setting;
    bench.step(command);
    double projected = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double angle = bench.setting.steering_rad[i];
      ASSERT_LE(std::abs(angle), 1.5708 + 1e-12);
      ASSERT_LE(std::abs(angle - before.steering_rad[i]), 4 * dt + 1e-12) << k;
      ASSERT_LE(std::abs(bench.orders.rate_radps[i]), 20 + 1e-9);
      const Vec2 change = wheel_velocity(bench.setting.motion - before.motion, modules()[i]);
      ASSERT_LE(std::sqrt(dot(change, change)), 30 * radius * dt + 1e-9) << k;
      projected = std::max(projected, std::abs(slip_of(bench.setting.motion, modules()[i], angle)));
    }
    if (bench.setting.phase == Phase::driving) ++driven, consistent += projected < 1e-6 ? 1 : 0;
    const bool at_rest = bench.setting.phase == Phase::steering || bench.setting.phase == Phase::standing;
    ASSERT_EQ(at_rest ? bench.most_rate() : 0, 0);
  }
  EXPECT_GT(driven, 5'000);
  // All but the steps where a wheel starts within `aligned`, is held at the end of its range, or is passed by the centre.
  EXPECT_GT(consistent, driven * 8 / 10);
}

TEST(FourWheelGovernor, ASettingOfOtherSizesOrNumbersDoesNotFit) {
  const Bench bench;
  EXPECT_TRUE(bench.governor.fits(bench.setting));
  Setting forged = bench.setting;
  forged.steering_rad.pop_back();
  EXPECT_FALSE(bench.governor.fits(forged));
  forged = bench.setting;
  forged.motion.turn = std::nan("");
  EXPECT_FALSE(bench.governor.fits(forged));
  forged = bench.setting;
  forged.backward.clear();
  EXPECT_FALSE(bench.governor.fits(forged));
}

}  // namespace
}  // namespace sandlot::controllers::four_wheel_steer
