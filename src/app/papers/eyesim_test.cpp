/// Arithmetic of the report on EyeSim: twists, matrices, checks.
#include "app/papers/eyesim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/math.h"

namespace sandlot::app::eyesim {
namespace {

constexpr double pi = std::numbers::pi;

TEST(EyesimReport, ATwistIsTheOneThatMakesThePoses) {
  // v = (0.3, -0.1), w = 1.5 for 3 s in steps of 0.05 s, from an oblique pose: x(t) = R(a) / w [s v - (1 - c) v'...] in closed form.
  const double vx = 0.3, vy = -0.1, w = 1.5, a = 0.7;
  std::vector<Pose2> poses;
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.05 * i, s = math::sin(w * t) / w, c = (1 - math::cos(w * t)) / w;
    const double x = s * vx - c * vy, y = c * vx + s * vy;
    poses.push_back({2 + math::cos(a) * x - math::sin(a) * y, -1 + math::sin(a) * x + math::cos(a) * y,
                     math::wrap_angle(a + w * t)});
  }
  // 4.5 rad in all: more than half a turn, which the ends alone do not show.
  const Twist twist = twist_through(poses, 3);
  EXPECT_NEAR(twist.x_mps, vx, 1e-12);
  EXPECT_NEAR(twist.y_mps, vy, 1e-12);
  EXPECT_NEAR(twist.turn_radps, w, 1e-12);
  const std::vector<Pose2> straight{{1, 1, pi / 2}, {1, 3, pi / 2}};
  EXPECT_NEAR(twist_through(straight, 4).x_mps, 0.5, 1e-15);
  EXPECT_NEAR(twist_through(straight, 4).y_mps, 0, 1e-15);
}

TEST(EyesimReport, MatricesAreThoseOfThePaper) {
  const Twist two = paper_differential(0.001, 0.1, 100, 300);
  EXPECT_NEAR(two.x_mps, 0.2, 1e-15);
  EXPECT_NEAR(two.turn_radps, 2, 1e-15);
  // Sideways: FL and BR back. As printed the third row is the second over d; rolling wheels do not turn.
  const std::array<double, 4> sideways{-100, 100, 100, -100}, turn{-100, 100, -100, 100};
  EXPECT_NEAR(paper_mecanum(0.001, 0.2, sideways).y_mps, 0.1, 1e-15);
  EXPECT_NEAR(paper_mecanum(0.001, 0.2, sideways).turn_radps, 0.5, 1e-15);
  EXPECT_NEAR(rolling_mecanum(0.001, 0.2, sideways).turn_radps, 0, 1e-15);
  EXPECT_NEAR(rolling_mecanum(0.001, 0.2, turn).turn_radps, 0.5, 1e-15);
  EXPECT_NEAR(rolling_mecanum(0.001, 0.2, turn).y_mps, 0, 1e-15);
}

TEST(EyesimReport, AFormulaHoldsWithinItsInterval) {
  statistics::Sample sample;
  for (int i = 0; i < 1000; ++i) sample.add(i % 2 == 0 ? -1 : 1);
  // Student's t for 0.1 % and 999 degrees of freedom is 3.300, the standard error 1.0005 / sqrt(1000).
  const Check mean = mean_check("", "mm", 0, sample, 1000);
  EXPECT_NEAR(mean.high, 1000 * 3.300 * 1.0005 / std::sqrt(1000.0), 0.1);
  EXPECT_TRUE(mean.holds());
  EXPECT_FALSE(mean_check("", "mm", 110, sample, 1000).holds());
  EXPECT_TRUE(deviation_check("", "", 1, sample).holds());
  EXPECT_FALSE(deviation_check("", "", 1.1, sample).holds());
  EXPECT_TRUE(rate_check("", 0.5, 500, 1000).holds());
  EXPECT_FALSE(rate_check("", 0.56, 500, 1000).holds());  // 3.29 standard deviations of 1.58 % are 5.2 %
  EXPECT_EQ(rate_check("", 0, 0, 0).measured, 0);
}

}  // namespace
}  // namespace sandlot::app::eyesim
