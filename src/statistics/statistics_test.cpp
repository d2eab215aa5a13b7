/// Samples and intervals against published numbers.
#include <gtest/gtest.h>

#include "statistics/intervals.h"

namespace sandlot::statistics {
namespace {

TEST(Sample, HasTheMomentsOfItsNumbers) {
  Sample sample;
  for (const double x : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0})
    sample.add(x);  // squares about the mean: 32
  EXPECT_EQ(sample.count(), 8u);
  EXPECT_DOUBLE_EQ(sample.mean(), 5);
  EXPECT_DOUBLE_EQ(sample.variance(), 32.0 / 7);
  EXPECT_EQ(sample.min(), 2);
  EXPECT_EQ(sample.max(), 9);
  EXPECT_EQ(Sample().variance(), 0);
}

TEST(Sample, KeepsItsDigitsFarFromZero) {
  Sample sample;
  for (const double x : {1e9 + 4, 1e9 + 7, 1e9 + 13, 1e9 + 16}) sample.add(x);  // squares: 36 + 9 + 9 + 36
  EXPECT_DOUBLE_EQ(sample.variance(), 30);
}

TEST(Intervals, OfTheMeanAreStudents) {
  Sample sample;
  for (int i = 0; i < 10; ++i) sample.add(i);               // variance 82.5 / 9
  const double half = 2.262157 * std::sqrt(82.5 / 9 / 10);  // t of 9 degrees of freedom, from tables
  EXPECT_NEAR(mean_interval(sample).low, 4.5 - half, 1e-6);
  EXPECT_NEAR(mean_interval(sample).high, 4.5 + half, 1e-6);
  EXPECT_NEAR(mean_interval(sample, 0.99).high, 4.5 + 3.249836 * std::sqrt(82.5 / 9 / 10), 1e-6);
  Sample one;
  one.add(3);
  EXPECT_TRUE(std::isinf(mean_interval(one).low) && std::isinf(mean_interval(one).high));
}

TEST(Intervals, OfTheDeviationAreThoseOfChiSquare) {
  Sample sample;
  for (int i = 0; i < 10; ++i)
    sample.add(i);  // (n - 1) s^2 = 82.5; chi^2 of 9 degrees of freedom: 2.700389 and 19.022768
  EXPECT_NEAR(deviation_interval(sample).low, std::sqrt(82.5 / 19.022768), 1e-6);
  EXPECT_NEAR(deviation_interval(sample).high, std::sqrt(82.5 / 2.700389), 1e-6);
  EXPECT_EQ(deviation_interval(Sample()).low, 0);
  EXPECT_TRUE(std::isinf(deviation_interval(Sample()).high));
}

TEST(Intervals, OfProbabilitiesAreWilsons) {
  // R. G. Newcombe, Two-sided confidence intervals for the single proportion (1998), table I, method 3.
  struct Row {
    std::uint64_t successes, trials;
    double low, high;
  };
  for (const Row& row : {Row{81, 263, 0.2553, 0.3662}, Row{15, 148, 0.0624, 0.1605}, Row{0, 20, 0, 0.1611},
                         Row{1, 29, 0.0061, 0.1718}}) {
    const Interval found = wilson_interval(row.successes, row.trials);
    EXPECT_NEAR(found.low, row.low, 5e-5) << row.successes;
    EXPECT_NEAR(found.high, row.high, 5e-5) << row.successes;
    const Interval mirrored = wilson_interval(row.trials - row.successes, row.trials);
    EXPECT_NEAR(mirrored.low, 1 - found.high, 1e-12);
    EXPECT_NEAR(mirrored.high, 1 - found.low, 1e-12);
  }
  EXPECT_EQ(wilson_interval(0, 0).high, 1);
}

}  // namespace
}  // namespace sandlot::statistics
