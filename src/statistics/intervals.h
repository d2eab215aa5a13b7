#pragma once
/// Confidence intervals of what repeated runs give.
///
/// Quantiles of the distributions are Boost.Math's. Nothing here is State: the last digits may differ between machines.
#include <cstdint>

#include "statistics/sample.h"

namespace sandlot::statistics {

struct Interval {
  double low = 0, high = 0;
};

/// Student's interval of the mean; from -infinity to infinity for fewer than two numbers.
/// @param confidence  in (0, 1)
Interval mean_interval(const Sample& sample, double confidence = 0.95);

/// Interval of the standard deviation of normal numbers, by the chi-square distribution of (n - 1) s^2 / sigma^2; from 0 to infinity
/// for fewer than two numbers.
Interval deviation_interval(const Sample& sample, double confidence = 0.95);

/// Wilson's score interval of a probability; from 0 to 1 without trials. It holds for few trials and at 0 and 1 too.
/// Source   E. B. Wilson, Probable inference, the law of succession, and statistical inference (1927).
/// @pre successes <= trials
Interval wilson_interval(std::uint64_t successes, std::uint64_t trials, double confidence = 0.95);

}  // namespace sandlot::statistics
