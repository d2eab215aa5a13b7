#include "statistics/signals.h"

#include <algorithm>
#include <cmath>
#include <optional>
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

Result<std::vector<double>> lag_correlations(std::span<const double> leader, std::span<const double> follower,
                                             double dt_s, double max_lag_s) {
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
  return r;
}

Result<Lag> lag(std::span<const double> leader, std::span<const double> follower, double dt_s,
                double max_lag_s) {
  SL_ASSIGN(const std::vector<double> r, lag_correlations(leader, follower, dt_s, max_lag_s));
  const std::size_t most = r.size() / 2;
  const auto best = static_cast<std::size_t>(std::max_element(r.begin(), r.end()) - r.begin());
  if (best == 0 || best + 1 == r.size())
    return Error{"the signals correlate best at the largest lag that was tried",
                 "make the largest lag larger"};
  const double before = r[best - 1], at = r[best], after = r[best + 1];
  const double bend = 2 * at - before - after;
  const double part = bend > 0 ? 0.5 * (after - before) / bend : 0;
  return Lag{dt_s * (static_cast<double>(best) - static_cast<double>(most) + part), at};
}

Result<StepResponse> step_response(std::span<const double> signal, double from, double to, double dt_s) {
  constexpr double settled = 0.02;
  if (from == to || !std::isfinite(from) || !std::isfinite(to) || !(dt_s > 0) || !std::isfinite(dt_s))
    return Error{"a step goes from one set point to another, at a positive interval of samples"};
  if (signal.size() < fewest_samples) return Error{"a step response has at least 4 samples"};
  SL_TRY(check_signals(signal, signal));
  // As a share of the step: 0 before it, 1 at its end.
  std::vector<double> share;
  for (const double each : signal) share.push_back((each - from) / (to - from));
  const auto crossing = [&](double level) -> std::optional<double> {
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (share[i] < level) continue;
      const double part = i == 0 ? 0 : (level - share[i - 1]) / (share[i] - share[i - 1]);
      return dt_s * (static_cast<double>(i) - (i == 0 ? 0 : 1) + part);
    }
    return std::nullopt;
  };
  const auto begin = crossing(0.1), end = crossing(0.9);
  if (!begin || !end) return Error{"the signal does not reach 90 % of the step", "record longer"};
  StepResponse out;
  out.rise_s = *end - *begin;
  out.overshoot = std::max(0.0, *std::max_element(share.begin(), share.end()) - 1);
  std::size_t last = share.size();  // the last sample outside
  for (std::size_t i = share.size(); i-- > 0 && last == share.size();)
    if (std::abs(share[i] - 1) > settled) last = i;
  if (last == share.size()) last = 0;
  else if (last + 1 == share.size()) return Error{"the signal has not settled", "record longer"};
  if (last + 1 < share.size() && std::abs(share[last] - 1) > settled) {
    const double level = share[last] > 1 ? 1 + settled : 1 - settled;
    out.settle_s = dt_s *
                   (static_cast<double>(last) + (level - share[last]) / (share[last + 1] - share[last]));
  }
  out.error = signal.back() - to;
  return out;
}

}  // namespace sandlot::statistics
