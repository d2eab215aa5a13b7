#include "statistics/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::statistics {
namespace {

using Residuals = std::optional<std::vector<double>>;

Evaluate each(const std::function<Residuals(const std::vector<double>&)>& f) {
  return [f](const std::vector<std::vector<double>>& points) {
    std::vector<Residuals> out;
    for (const auto& point : points) out.push_back(f(point));
    return out;
  };
}
Residuals rosenbrock(const std::vector<double>& x) {
  return std::vector<double>{10 * (x[1] - x[0] * x[0]), 1 - x[0]};
}

TEST(LeastSquares, FindsTheEndOfRosenbrocksValley) {
  const auto fit = least_squares({{-1.2, -2, 2}, {1, -2, 2}}, {.most_evaluations = 600}, each(rosenbrock));
  ASSERT_TRUE(fit) << fit.error().text();
  EXPECT_NEAR(fit->parameters[0].value, 1, 1e-4);
  EXPECT_NEAR(fit->parameters[1].value, 1, 2e-4);
  EXPECT_LE(fit->evaluations, 600);
}

TEST(LeastSquares, StopsAtABoundAndDoesNotCountItAsFree) {
  // With x at most 0.5 the best y is its square.
  const auto fit = least_squares({{-1.2, -2, 0.5}, {1, -2, 2}}, {.most_evaluations = 600}, each(rosenbrock));
  ASSERT_TRUE(fit) << fit.error().text();
  EXPECT_TRUE(fit->parameters[0].at_high);
  EXPECT_EQ(fit->parameters[0].value, 0.5);
  EXPECT_EQ(fit->parameters[0].low, fit->parameters[0].high);
  EXPECT_FALSE(fit->parameters[1].at_high);
  EXPECT_NEAR(fit->parameters[1].value, 0.25, 1e-4);
}

/// y = a exp(-b t) at 40 times, with errors of +- 0.01 that alternate.
Residuals decay(const std::vector<double>& x) {
  std::vector<double> out;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.05 * i;
    out.push_back(x[0] * math::exp(-x[1] * t) - 2 * math::exp(-3 * t) - (i % 2 ? 0.01 : -0.01));
  }
  return out;
}

TEST(LeastSquares, TheIntervalOfADecayIsThatOfTheCovarianceByHand) {
  for (const bool logarithmic : {false, true}) {
    const auto fit = least_squares({{0.5, 0.1, 10, logarithmic}, {0.3, 0.1, 10, logarithmic}}, {},
                                   each(decay));
    ASSERT_TRUE(fit) << fit.error().text();
    const double a = fit->parameters[0].value, b = fit->parameters[1].value;
    EXPECT_NEAR(a, 2, 0.02);
    EXPECT_NEAR(b, 3, 0.05);
    double aa = 0, ab = 0, bb = 0, squares = 0;
    const Residuals residuals = decay({a, b});
    for (int i = 0; i < 40; ++i) {
      const double t = 0.05 * i, da = math::exp(-b * t), db = -a * t * da;
      aa += da * da, ab += da * db, bb += db * db;
      squares += (*residuals)[static_cast<std::size_t>(i)] * (*residuals)[static_cast<std::size_t>(i)];
    }
    const double determinant = aa * bb - ab * ab, variance = squares / 38;
    // Student's 97.5 % quantile of 38 degrees of freedom is 2.0244. On a logarithmic scale the interval is that of
    // the logarithm, whose ratio of ends is exp(2 half / value).
    const double half = 2.0244 * std::sqrt(variance * aa / determinant);
    if (logarithmic)
      EXPECT_NEAR(math::log(fit->parameters[1].high / fit->parameters[1].low), 2 * half / b, 0.01 * half / b);
    else EXPECT_NEAR(fit->parameters[1].high - fit->parameters[1].low, 2 * half, 0.01 * half);
    const double by_hand = -ab / std::sqrt(aa * bb);
    EXPECT_NEAR(fit->correlation[0][1], by_hand, 0.01);
    EXPECT_TRUE(fit->converged);
  }
}

TEST(LeastSquares, NamesWhatNoResidualTellsApart) {
  // Only the sum of the first two counts; the third is alone; the fourth changes nothing.
  const auto fit = least_squares(
      {{0.2, 0, 2}, {0.3, 0, 2}, {0.5, 0, 2}, {0.5, 0, 1}}, {}, each([](const std::vector<double>& x) {
        return Residuals({x[0] + x[1] - 1.01, x[0] + x[1] - 0.99, x[2] - 1.51, x[2] - 1.49, 0.01, -0.01});
      }));
  ASSERT_TRUE(fit) << fit.error().text();
  EXPECT_TRUE(fit->parameters[0].undetermined);
  EXPECT_TRUE(fit->parameters[1].undetermined);
  EXPECT_FALSE(fit->parameters[2].undetermined);
  EXPECT_NEAR(fit->parameters[2].value, 1.5, 1e-5);
  EXPECT_TRUE(std::isfinite(fit->parameters[2].high));
  EXPECT_TRUE(fit->parameters[3].without_effect);
  EXPECT_LT(fit->correlation[0][1], -0.99);
}

TEST(LeastSquares, GetsOverPointsThatCannotBeEvaluated) {
  const auto half = [](const std::vector<double>& x) -> Residuals {
    if (x[0] > 3) return std::nullopt;
    if (x[0] < 0.5) return std::vector<double>{std::nan(""), 0};
    return std::vector<double>{x[0] - 2.5, 0.5 * (x[0] - 2.5)};
  };
  const auto fit = least_squares({{9, 0, 10}}, {.screening = 6}, each(half));
  ASSERT_TRUE(fit) << fit.error().text();
  EXPECT_NEAR(fit->parameters[0].value, 2.5, 1e-4);
  EXPECT_TRUE(fit->first.empty());
  EXPECT_GT(fit->failed, 0);
  EXPECT_FALSE(least_squares({{9, 0, 10}}, {}, each(half)));
}

/// A decay as above, seen in steps of 0.02: the differences of small steps are zero or a jump.
TEST(LeastSquares, SeesThroughResidualsWithJumps) {
  const auto seen = [](double a, double b, int i) {
    return std::round((a * math::exp(-b * 0.05 * i)) / 0.02) * 0.02;
  };
  const auto fit = least_squares({{0.5, 0.1, 10, true}, {0.3, 0.1, 10, true}},
                                 {.most_evaluations = 400, .screening = 8},
                                 each([&](const std::vector<double>& x) {
                                   std::vector<double> out;
                                   for (int i = 0; i < 60; ++i)
                                     out.push_back(seen(x[0], x[1], i) - seen(2, 3, i));
                                   return Residuals(out);
                                 }));
  ASSERT_TRUE(fit) << fit.error().text();
  // Rounding to 0.02 errs by 0.0058 (standard deviation) in 60 values: about 0.3 % of a, 0.6 % of b by the covariance above.
  EXPECT_NEAR(fit->parameters[0].value, 2, 0.02);
  EXPECT_NEAR(fit->parameters[1].value, 3, 0.05);
}

TEST(LeastSquares, KeepsTheLimitOfEvaluations) {
  int calls = 0;
  const auto count = [&](const std::vector<double>& x) {
    ++calls;
    return rosenbrock(x);
  };
  for (const int most : {3, 4, 7, 20}) {
    calls = 0;
    const auto fit = least_squares({{-1.2, -2, 2}, {1, -2, 2}}, {.most_evaluations = most, .screening = 2},
                                   each(count));
    ASSERT_TRUE(fit) << fit.error().text();
    EXPECT_LE(calls, most);
    EXPECT_EQ(calls, fit->evaluations);
  }
}

TEST(LeastSquares, RefusesWhatIsNoProblem) {
  const auto refused = [](const std::vector<FitParameter>& parameters) {
    return !least_squares(parameters, {}, each(rosenbrock));
  };
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused({{1, 2, 1}, {1, 0, 2}}));
  EXPECT_TRUE(refused({{1, 0, 2, true}, {1, 0, 2}}));
  EXPECT_TRUE(refused({{3, 0, 2}, {1, 0, 2}}));
  EXPECT_TRUE(refused({{1, 0, 2}, {1, 0, 2}, {1, 0, 2}}));
}

}  // namespace
}  // namespace sandlot::statistics
