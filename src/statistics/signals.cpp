#include "statistics/signals.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sandlot::statistics {
namespace {

constexpr std::size_t fewest_samples = 4;

Status check_signals(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size())
    return Error{
        "the signals have " + std::to_string(a.size()) + " and " + std::to_string(b.size()) + " samples",
        "sample both at the same times"};
  if (a.empty()) return Error{"the signals have no samples", "give at least one"};
  for (const std::span<const double> signal : {a, b})
    for (std::size_t i = 0; i < signal.size(); ++i)
      if (!(std::abs(signal[i]) < 1e100))
        return Error{"sample " + std::to_string(i) + " is not a number that can be compared",
                     "leave out times at which a signal has no value"};
  return {};
}

bool signal_varies(std::span<const double> signal) {
  return std::any_of(signal.begin(), signal.end(), [&](double x) { return x != signal.front(); });
}

/// Pearson's coefficient; 0 where one of the two is constant.
double signal_correlation(std::span<const double> a, std::span<const double> b) {
  const double n = static_cast<double>(a.size());
  double mean_a = 0, mean_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i] / n, mean_b += b[i] / n;
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a[i] - mean_a, y = b[i] - mean_b;
    aa += x * x, bb += y * y, ab += x * y;
  }
  return aa > 0 && bb > 0 ? std::clamp(ab / (std::sqrt(aa) * std::sqrt(bb)), -1.0, 1.0) : 0;
}

}  // namespace

Result<double> percent_error(std::span<const double> commanded, std::span<const double> measured) {
  SL_TRY(check_signals(commanded, measured));
  double error = 0, size = 0;
  for (std::size_t i = 0; i < commanded.size(); ++i) {
    error += std::abs(measured[i] - commanded[i]);
    size += std::abs(commanded[i]);
  }
  if (!(size > 0)) return Error{"the command is zero throughout", "there is nothing to take a percentage of"};
  return 100 * error / size;
}

Result<Lag> lag(std::span<const double> leader, std::span<const double> follower, double dt_s,
                double max_lag_s) {
  SL_TRY(check_signals(leader, follower));
  if (!(dt_s > 0) || !std::isfinite(dt_s) || !(max_lag_s > 0) || !std::isfinite(max_lag_s))
    return Error{"the interval and the largest lag must be positive", "give both in seconds"};
  if (!signal_varies(leader) || !signal_varies(follower))
    return Error{"a signal is constant", "a lag needs signals that change"};
  const std::size_t n = leader.size();
  const double steps = std::floor(max_lag_s / dt_s + 1e-9);
  if (steps < 1) return Error{"the largest lag is shorter than a sample", "make it larger"};
  if (n < fewest_samples || steps > static_cast<double>(n - fewest_samples))
    return Error{"a shift of " + std::to_string(max_lag_s) + " s leaves fewer than 4 samples",
                 "make the largest lag smaller or record longer"};
  const auto most = static_cast<std::ptrdiff_t>(steps);
  std::vector<double> r;
  for (std::ptrdiff_t k = -most; k <= most; ++k) {
    const auto shift = static_cast<std::size_t>(std::abs(k)), overlap = n - shift;
    r.push_back(k >= 0 ? signal_correlation(leader.first(overlap), follower.last(overlap))
                       : signal_correlation(leader.last(overlap), follower.first(overlap)));
  }
  const auto best = static_cast<std::size_t>(std::max_element(r.begin(), r.end()) - r.begin());
  if (best == 0 || best + 1 == r.size())
    return Error{"the signals correlate best at the largest lag that was tried",
                 "make the largest lag larger"};
  const double before = r[best - 1], at = r[best], after = r[best + 1];
  const double bend = 2 * at - before - after;
  const double part = bend > 0 ? 0.5 * (after - before) / bend : 0;
  return Lag{dt_s * (static_cast<double>(best) - static_cast<double>(most) + part), at};
}

}  // namespace sandlot::statistics
