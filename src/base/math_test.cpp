#include "base/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"

namespace sandlot::math {
namespace {

/// Distance in units of the last place of the true value.
double ulps(double got, long double truth) {
  const double near = static_cast<double>(truth);
  const double spacing = std::nextafter(std::abs(near), std::numeric_limits<double>::infinity()) -
                         std::abs(near);
  return static_cast<double>(std::abs(static_cast<long double>(got) - truth)) / spacing;
}

struct Case {
  const char* name;
  double (*ours)(double);
  long double (*truth)(long double);
  double low, high;
  double limit;
};

// SLEEF promises 1.0 ulp; the reference is the C library in long double, whose own error of an ulp of its 64
// bits is 0.0005 of ours.
TEST(Math, WithinOneUlpOfTheTruth) {
  const Case cases[] = {
      // lint-ok: these are the references
      {"sin", sin, std::sin, -100, 100, 1.01},       {"cos", cos, std::cos, -100, 100, 1.01},
      {"tan", tan, std::tan, -100, 100, 1.01},       {"asin", asin, std::asin, -1, 1, 1.01},
      {"acos", acos, std::acos, -1, 1, 1.01},        {"atan", atan, std::atan, -50, 50, 1.01},
      {"exp", exp, std::exp, -700, 700, 1.01},       {"log", log, std::log, 1e-10, 1e10, 1.01},
      {"tanh", tanh, std::tanh, -20, 20, 1.01},      {"sin small", sin, std::sin, -1e-5, 1e-5, 1.01},
      {"log near 1", log, std::log, 0.9, 1.1, 1.01}, {"sin large", sin, std::sin, -1e9, 1e9, 1.01},
  };
  Stream random(1, 2, Purpose::experiment, 3);
  for (const Case& c : cases) {
    double worst = 0;
    for (int i = 0; i < 20'000; ++i) {
      const double x = random.uniform(c.low, c.high);
      worst = std::max(worst, ulps(c.ours(x), c.truth(static_cast<long double>(x))));
    }
    EXPECT_LE(worst, c.limit) << c.name;
  }
}

TEST(Math, TwoArgumentsWithinOneUlp) {
  Stream random(1, 2, Purpose::experiment, 4);
  double atan2_worst = 0, hypot_worst = 0, pow_worst = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double x = random.uniform(-10, 10), y = random.uniform(-10, 10);
    const auto lx = static_cast<long double>(x), ly = static_cast<long double>(y);
    atan2_worst = std::max(atan2_worst, ulps(atan2(y, x), std::atan2(ly, lx)));  // lint-ok: reference
    hypot_worst = std::max(hypot_worst, ulps(hypot(x, y), std::hypot(lx, ly)));  // lint-ok: reference
    pow_worst = std::max(pow_worst,
                         ulps(pow(std::abs(x), y), std::pow(std::abs(lx), ly)));  // lint-ok: reference
    const auto [s, c] = sincos(x);
    EXPECT_LE(ulps(s, std::sin(lx)), 1.01);  // lint-ok: reference
    EXPECT_LE(ulps(c, std::cos(lx)), 1.01);  // lint-ok: reference
  }
  EXPECT_LE(atan2_worst, 1.01);
  EXPECT_LE(hypot_worst, 0.51);
  EXPECT_LE(pow_worst, 1.01);
}

TEST(Math, SpecialValues) {
  EXPECT_EQ(sin(0.0), 0.0);
  EXPECT_EQ(cos(0.0), 1.0);
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(log(1.0), 0.0);
  EXPECT_EQ(atan2(0.0, -1.0), pi);
  EXPECT_EQ(atan2(-0.0, -1.0), -pi);
  EXPECT_EQ(atan2(1.0, 0.0), pi / 2);
  EXPECT_EQ(atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(asin(1.0), pi / 2);
  EXPECT_EQ(acos(-1.0), pi);
  EXPECT_EQ(exp(-1000.0), 0.0);
  EXPECT_TRUE(std::isinf(exp(1000.0)));
  EXPECT_TRUE(std::isnan(asin(1.5)));
  EXPECT_TRUE(std::isnan(log(-1.0)));
  EXPECT_TRUE(std::isnan(sin(NAN)));
}

TEST(Math, RemaindersAreExact) {
  Stream random(1, 2, Purpose::experiment, 5);
  for (int i = 0; i < 20'000; ++i) {
    const double x = random.uniform(-1e6, 1e6), y = random.uniform(1e-3, 10);
    EXPECT_EQ(fmod(x, y), std::fmod(x, y));  // lint-ok: exact by the C standard
  }
}

TEST(Math, WrapAngleKeepsTheDirectionAndItsRange) {
  EXPECT_EQ(wrap_angle(pi), pi);
  EXPECT_EQ(wrap_angle(-pi), pi);
  EXPECT_EQ(wrap_angle(0.0), 0.0);
  EXPECT_EQ(wrap_angle(tau), 0.0);
  EXPECT_EQ(wrap_angle(3 * pi), pi);
  EXPECT_EQ(wrap_angle(std::nextafter(pi, 4)), std::nextafter(pi, 4) - tau);
  EXPECT_TRUE(std::isnan(wrap_angle(NAN)));
  EXPECT_TRUE(std::isnan(wrap_angle(INFINITY)));
  Stream random(1, 2, Purpose::experiment, 6);
  for (int i = 0; i < 20'000; ++i) {
    const double x = random.uniform(-1000, 1000), wrapped = wrap_angle(x);
    EXPECT_GT(wrapped, -pi);
    EXPECT_LE(wrapped, pi);
    // The double tau is 2.4e-16 short of 2 pi: 160 turns are off by 4e-14.
    EXPECT_NEAR(sin(wrapped), sin(x), 5e-14);
    EXPECT_NEAR(cos(wrapped), cos(x), 5e-14);
  }
}

}  // namespace
}  // namespace sandlot::math
