#include "statistics/signals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/math.h"
#include "base/random.h"

namespace sandlot::statistics {
namespace {

using Signal = std::vector<double>;

TEST(PercentError, IsTheMeanErrorOverTheMeanCommand) {
  // Errors 0.1, 0.2, 0.1, 0; commands 2, 4, 2, 0: 100 * 0.4 / 8.
  EXPECT_NEAR(*percent_error(Signal{2, -4, 2, 0}, Signal{2.1, -3.8, 1.9, 0}), 5, 1e-12);
  // Not the mean of the percentages of samples, which has no value here; motion that was not commanded counts.
  EXPECT_NEAR(*percent_error(Signal{0, 2}, Signal{0.5, 2}), 25, 1e-12);
  EXPECT_EQ(*percent_error(Signal{3, -4}, Signal{3, -4}), 0);
}

TEST(PercentError, RefusesWhatHasNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(percent_error({}, {}));
  EXPECT_FALSE(percent_error(Signal{1, 2}, Signal{1}));
  EXPECT_FALSE(percent_error(Signal{0, 0}, Signal{1, 1}));
  EXPECT_FALSE(percent_error(Signal{1, nan}, Signal{1, 1}));
  EXPECT_FALSE(percent_error(Signal{1, 1}, Signal{1, inf}));
}

/// Two sinusoids without a common period, delayed.
Signal wave(std::size_t n, double dt_s, double delay_s, double gain = 1, double offset = 0) {
  Signal out;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) * dt_s - delay_s;
    out.push_back(offset + gain * (math::sin(2 * t) + 0.5 * math::sin(3.7 * t + 1)));
  }
  return out;
}

TEST(Lag, FindsDelaysOfPartsOfASample) {
  // Highest frequency 3.7 rad/s, dt 0.02: the parabola errs by less than dt (w dt)^2 / 24 = 5e-6 s. The window has 30 s, about
  // ten periods of the difference frequency; its ends bend r(k) by parts of a percent of a sample: 1e-4 s.
  constexpr double dt = 0.02;
  for (const double delay : {0.0, 0.19, 0.1934, -0.07, 0.005}) {
    const auto found = lag(wave(1500, dt, 0), wave(1500, dt, delay), dt, 0.5);
    ASSERT_TRUE(found) << delay;
    EXPECT_NEAR(found->lag_s, delay, 1e-4) << delay;
    EXPECT_GT(found->correlation, 0.999);
  }
}

TEST(Lag, GainAndOffsetDoNotMatterAndAWrongSignDoes) {
  constexpr double dt = 0.02;
  const auto scaled = lag(wave(1500, dt, 0), wave(1500, dt, 0.19, 0.2, 7), dt, 0.5);
  ASSERT_TRUE(scaled);
  EXPECT_NEAR(scaled->lag_s, 0.19, 1e-4);
  const auto mirrored = lag(wave(1500, dt, 0), wave(1500, dt, 0.19, -1), dt, 0.5);
  EXPECT_TRUE(!mirrored || mirrored->correlation < 0.9);
}

TEST(Lag, WhiteNoiseThatIsShiftedIsFoundToTheSample) {
  // Shifted by 7 samples: r(7) = 1, all others about 1 / sqrt(n).
  Stream random(1, 2, Purpose::experiment, 3);
  Signal noise;
  for (int i = 0; i < 500; ++i) noise.push_back(random.normal());
  const Signal later(noise.begin(), noise.end() - 7), first(noise.begin() + 7, noise.end());
  const auto found = lag(first, later, 0.1, 2);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->lag_s, 0.7,
              0.01);  // neighbours of 5 / sqrt(493) would move it by 0.1 * 0.23 / 2 at most
  EXPECT_NEAR(found->correlation, 1, 1e-12);
}

TEST(Lag, RefusesWhatHasNone) {
  const Signal good = wave(100, 0.1, 0), flat(100, 3.0);
  EXPECT_FALSE(lag(good, flat, 0.1, 1));
  EXPECT_FALSE(lag(flat, good, 0.1, 1));
  EXPECT_FALSE(lag(good, wave(99, 0.1, 0), 0.1, 1));
  EXPECT_FALSE(lag({}, {}, 0.1, 1));
  EXPECT_FALSE(lag(good, good, 0, 1));
  EXPECT_FALSE(lag(good, good, 0.1, 0.05));
  EXPECT_FALSE(lag(good, good, 0.1, 9.7));
  EXPECT_FALSE(lag(good, good, 0.1, 1e300));
  EXPECT_FALSE(lag(good, good, std::nan(""), 1));
  Signal broken = good;
  broken[5] = std::nan("");
  EXPECT_FALSE(lag(good, broken, 0.1, 1));
  // The true lag of 0.19 s lies beyond 0.1 s.
  EXPECT_FALSE(lag(wave(1500, 0.02, 0), wave(1500, 0.02, 0.19), 0.02, 0.1));
}

TEST(Lag, IsThePeakOfItsCurve) {
  constexpr double dt = 0.02;
  const auto curve = lag_correlations(wave(1500, dt, 0), wave(1500, dt, 0.2), dt, 0.5);
  ASSERT_TRUE(curve);
  ASSERT_EQ(curve->size(), 51u);  // 25 shifts to each side
  EXPECT_EQ(std::max_element(curve->begin(), curve->end()) - curve->begin(), 25 + 10);
  EXPECT_NEAR((*curve)[35], 1, 1e-9);
}

/// Response of a loop of the second order with damping ratio z and undamped frequency w to a step from `from` to `to`.
Signal second_order(double z, double w, double from, double to, double dt_s, double end_s) {
  Signal out;
  const double wd = w * std::sqrt(1 - z * z);
  for (double t = 0; t < end_s; t += dt_s)
    out.push_back(to +
                  (from - to) * math::exp(-z * w * t) * (math::cos(wd * t) + z * w / wd * math::sin(wd * t)));
  return out;
}

TEST(StepResponse, HasTheFiguresOfASecondOrderLoop) {
  // Overshoot exp(-pi z / sqrt(1 - z^2)); a first-order loop rises in ln 9 time constants and settles in ln 50 of them.
  const auto found = step_response(second_order(0.5, 10, 0.5, 0, 1e-3, 3), 0.5, 0, 1e-3);
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_NEAR(found->overshoot, math::exp(-math::pi * 0.5 / std::sqrt(0.75)), 1e-4);
  EXPECT_NEAR(found->error, 0, 1e-6);
  Signal slow;
  for (int i = 0; i < 2000; ++i) slow.push_back(3 - 2 * math::exp(-i * 1e-3 / 0.2));
  const auto first = step_response(slow, 1, 3, 1e-3);
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_NEAR(first->rise_s, 0.2 * 2.197225, 1e-4);
  EXPECT_NEAR(first->settle_s, 0.2 * 3.912023, 1e-4);
  EXPECT_EQ(first->overshoot, 0);
}

TEST(StepResponse, RefusesWhatHasNone) {
  const Signal early(second_order(0.5, 10, 0.5, 0, 1e-3, 0.4));  // beyond the end, on its way back
  EXPECT_FALSE(step_response(early, 0.5, 0, 1e-3));
  EXPECT_FALSE(step_response(Signal(100, 0.5), 0.5, 0, 1e-3));
  EXPECT_FALSE(step_response(early, 0, 0, 1e-3));
  EXPECT_FALSE(step_response(early, 0.5, 0, 0));
  EXPECT_FALSE(step_response(Signal{0.5, 0, 0}, 0.5, 0, 1e-3));
}

}  // namespace
}  // namespace sandlot::statistics
