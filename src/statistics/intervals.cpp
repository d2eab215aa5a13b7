#include "statistics/intervals.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace sandlot::statistics {

Interval mean_interval(const Sample& sample, double confidence) {
  SL_CHECK(confidence > 0 && confidence < 1);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (sample.count() < 2) return {-infinity, infinity};
  const double n = static_cast<double>(sample.count());
  const double t = boost::math::quantile(boost::math::students_t(n - 1), 0.5 + confidence / 2);
  const double half = t * sample.deviation() / std::sqrt(n);
  return {sample.mean() - half, sample.mean() + half};
}

Interval deviation_interval(const Sample& sample, double confidence) {
  SL_CHECK(confidence > 0 && confidence < 1);
  if (sample.count() < 2) return {0, std::numeric_limits<double>::infinity()};
  const double freedom = static_cast<double>(sample.count() - 1), squares = freedom * sample.variance();
  const boost::math::chi_squared law(freedom);
  return {std::sqrt(squares / boost::math::quantile(law, 0.5 + confidence / 2)),
          std::sqrt(squares / boost::math::quantile(law, 0.5 - confidence / 2))};
}

Interval wilson_interval(std::uint64_t successes, std::uint64_t trials, double confidence) {
  SL_CHECK(confidence > 0 && confidence < 1 && successes <= trials);
  if (trials == 0) return {0, 1};
  const double n = static_cast<double>(trials), p = static_cast<double>(successes) / n;
  const double z = boost::math::quantile(boost::math::normal(), 0.5 + confidence / 2);
  const double whole = 1 + z * z / n, middle = (p + z * z / (2 * n)) / whole;
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / whole;
  return {successes == 0 ? 0 : std::max(0.0, middle - half),
          successes == trials ? 1 : std::min(1.0, middle + half)};
}

}  // namespace sandlot::statistics
