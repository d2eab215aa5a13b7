#include "app/detector_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"
#include "statistics/dense.h"

namespace sandlot::app {
namespace {

using Values = std::vector<double>;

/// Least squares with parameters >= 0: the best of all choices of parameters that are 0. For up to three of
/// them that is quick.
/// @param rows  factors of the parameters in each equation
template <std::size_t n>
std::array<double, n> fit_not_negative(const std::vector<std::array<double, n>>& rows, const Values& values,
                                       const Values& weights) {
  statistics::Dense normal(n, n);
  std::array<double, n> right{}, best{};
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t i = 0; i < n; ++i) {
      const double weighted = rows[k][i] * weights[k];
      right[i] += weighted * values[k];
      for (std::size_t j = 0; j < n; ++j) normal(i, j) += weighted * rows[k][j];
    }
  double best_gain = 0;
  for (unsigned chosen = 1; chosen < 1u << n; ++chosen) {
    std::vector<std::size_t> at;
    for (std::size_t i = 0; i < n; ++i)
      if (chosen >> i & 1) at.push_back(i);
    statistics::Dense part(at.size(), at.size());
    Values b;
    for (std::size_t i = 0; i < at.size(); ++i) {
      for (std::size_t j = 0; j < at.size(); ++j) part(i, j) = normal(at[i], at[j]);
      b.push_back(right[at[i]]);
    }
    const statistics::Factors factors(std::move(part));
    if (!(factors.least_pivot() > 1e-14)) continue;
    const Values x = factors.solve(b);
    if (!(*std::min_element(x.begin(), x.end()) >= 0)) continue;
    const double gain = statistics::dot(b, x);  // by so much less than with all of them 0
    if (gain <= best_gain) continue;
    best_gain = gain;
    best.fill(0);
    for (std::size_t i = 0; i < at.size(); ++i) best[at[i]] = x[i];
  }
  return best;
}

template <std::size_t n>
double inner(const std::array<double, n>& a, const std::array<double, n>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

DetectorFit fit_detector(std::span<const Sighted> sighted, int ghosts, double seconds) {
  DetectorFit fit;
  if (seconds > 0) fit.ghost_rate_hz = ghosts / seconds;
  if (sighted.empty()) return fit;
  fit.nearest_m = fit.farthest_m = sighted[0].range_m;
  std::vector<const Sighted*> found;  // with its own label: of the others it is less sure what they are
  int confused = 0;
  for (const Sighted& s : sighted) {
    fit.nearest_m = std::min(fit.nearest_m, s.range_m);
    fit.farthest_m = std::max(fit.farthest_m, s.range_m);
    if (s.found && !s.confused) found.push_back(&s);
    confused += s.confused;
  }

  std::vector<std::array<double, 3>> columns;
  Values missed, weights(sighted.size(), 1);
  for (const Sighted& s : sighted) {
    columns.push_back({1, s.range_m, std::max(0.0, 1 - s.visible)});
    missed.push_back(s.found ? 0 : 1);
  }
  std::array<double, 3> rates{};
  for (int round = 0; round < 20; ++round) {
    rates = fit_not_negative(columns, missed, weights);
    // Not below half a miss in all: where none is expected a single one would count without bound.
    const double least = 0.5 / static_cast<double>(sighted.size());
    for (std::size_t i = 0; i < sighted.size(); ++i) {
      const double p = std::clamp(inner(columns[i], rates), least, 1 - least);
      weights[i] = 1 / (p * (1 - p));
    }
  }
  fit.miss_rate = std::min(1.0, rates[0]);
  fit.miss_rate_per_m = std::min(1.0, rates[1]);
  fit.miss_rate_hidden = std::min(1.0, rates[2]);
  if (confused > 0)
    fit.confusion = confused / static_cast<double>(found.size() + static_cast<std::size_t>(confused));
  if (found.empty()) return fit;

  const auto seen = static_cast<double>(found.size());
  std::vector<std::array<double, 2>> ranges;
  Values off, trust(found.size(), 1);
  double bearings = 0;
  for (const Sighted* const s : found) {
    ranges.push_back({1, s->range_m});
    off.push_back(std::abs(s->range_error_m) * std::sqrt(math::pi / 2));
    bearings += s->bearing_error_rad * s->bearing_error_rad;
    fit.bearing_mean_rad += s->bearing_error_rad / seen;
    fit.range_mean_m += s->range_error_m / seen;
  }
  fit.bearing_std_rad = std::sqrt(bearings / seen);
  std::array<double, 2> deviation{};
  for (int round = 0; round < 20; ++round) {
    deviation = fit_not_negative(ranges, off, trust);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double sigma = std::max(1e-6, inner(ranges[i], deviation));
      trust[i] = 1 / (sigma * sigma);
    }
  }
  fit.range_std_m = deviation[0];
  fit.range_std_per_m = deviation[1];
  return fit;
}

}  // namespace sandlot::app
