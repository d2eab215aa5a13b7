#include "statistics/intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "statistics/quantiles.h"

namespace sandlot::statistics {

Interval mean_interval(const Sample& sample, double confidence) {
  SL_CHECK(confidence > 0 && confidence < 1);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (sample.count() < 2) return {-infinity, infinity};
  const double n = static_cast<double>(sample.count());
  const double t = students_t_quantile(0.5 + confidence / 2, n - 1);
  const double half = t * sample.deviation() / std::sqrt(n);
  return {sample.mean() - half, sample.mean() + half};
}

Interval deviation_interval(const Sample& sample, double confidence) {
  SL_CHECK(confidence > 0 && confidence < 1);
  if (sample.count() < 2) return {0, std::numeric_limits<double>::infinity()};
  const double freedom = static_cast<double>(sample.count() - 1), squares = freedom * sample.variance();
  return {std::sqrt(squares / chi_squared_quantile(0.5 + confidence / 2, freedom)),
          std::sqrt(squares / chi_squared_quantile(0.5 - confidence / 2, freedom))};
}

Interval wilson_interval(std::uint64_t successes, std::uint64_t trials, double confidence) {
  SL_CHECK(confidence > 0 && confidence < 1 && successes <= trials);
  if (trials == 0) return {0, 1};
  const double n = static_cast<double>(trials), p = static_cast<double>(successes) / n;
  const double z = normal_quantile(0.5 + confidence / 2);
  const double whole = 1 + z * z / n, middle = (p + z * z / (2 * n)) / whole;
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / whole;
  return {successes == 0 ? 0 : std::max(0.0, middle - half),
          successes == trials ? 1 : std::min(1.0, middle + half)};
}

}  // namespace sandlot::statistics
