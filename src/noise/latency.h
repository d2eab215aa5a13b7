#pragma once
/// Stage latency: what is shown was measured a while ago.
///
///   y(t) = x(t_m),   t_m = the last time of a sample at or before t - d,   d = max(0, e (delay + jitter (2 u - 1)))
///
/// u is drawn per sample. What is shown never goes back in time, so that of two samples the later one never
/// shows the older value. Until a value is old enough the first one is shown. Of many values at once all are
/// of one time.
///
/// Limits   what is shown changes with the device's own samples only. At most `max_held` samples are kept (of
///          scans as many as hold `max_held_values` values): a longer delay shows the oldest of them.
/// Cost     a copy of the sample; no allocation once as many samples are kept as the delay needs.
#include <algorithm>
#include <span>
#include <vector>

#include "noise/additive.h"

namespace sandlot {

struct LatencySpec {
  static constexpr const char* name = "latency";
  static constexpr const char* help = "Delay: shows the value of an earlier time.";
  static constexpr std::size_t max_held = 4096, max_held_values = 4'000'000;
  double delay_s = 0, jitter_s = 0;

  struct State {
    double now_s = 0;            ///< since the first sample
    std::vector<double> time_s;  ///< of the samples kept, the one shown last first
    std::vector<double> held;    ///< of one value
    std::vector<float> held_values;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"now", "s", "Time since the first sample."}, s.now_s);
      visit(Field{"time", "s", "Times of the stored samples."}, s.time_s);
      visit(Field{"held", "", "Stored samples."}, s.held);
      visit(Field{"held_values", "", "Stored scans."}, s.held_values);
    }
  };

  static void fields(auto& s, auto&& visit) {
    visit(Field{"delay", "s", "Age of the value shown.", 0, 1e3, Field::tunable | Field::required},
          s.delay_s);
    visit(Field{"jitter", "s", "Largest variation of the age either way, uniform.", 0, 1e3, Field::tunable},
          s.jitter_s);
  }

  double corrupt(State& state, double x, const NoiseSample& sample, Stream& random) const {
    state.held_values.clear();
    corrupt_row<double>(state, state.held, {&x, 1}, sample, random);
    return x;
  }
  void corrupt(State& state, std::span<float> values, const NoiseSample& sample, Stream& random) const {
    state.held.clear();
    if (!values.empty()) corrupt_row<float>(state, state.held_values, values, sample, random);
  }

 private:
  template <class Value>
  void corrupt_row(State& state, std::vector<Value>& held, std::span<Value> row, const NoiseSample& sample,
                   Stream& random) const {
    const std::size_t n = row.size();
    // A state from a damaged snapshot, or of another number of values, is forgotten.
    if (held.size() != state.time_s.size() * n) held.clear(), state.time_s.clear();
    if (!held.empty()) state.now_s += sample.dt_s;
    state.time_s.push_back(state.now_s);
    held.insert(held.end(), row.begin(), row.end());
    const double delay_now_s = std::max(0.0,
                                        sample.errors * (delay_s + jitter_s * (2 * random.uniform() - 1)));
    // Sums of intervals miss whole multiples by rounding: a nanosecond does not count as a delay.
    const double shown_s = state.now_s - delay_now_s + 1e-9;
    std::size_t shown = 0;
    while (shown + 1 < state.time_s.size() && state.time_s[shown + 1] <= shown_s) ++shown;
    const std::size_t room = std::clamp<std::size_t>(max_held_values / n, 1, max_held);
    if (state.time_s.size() - shown > room) shown = state.time_s.size() - room;
    std::copy_n(held.begin() + static_cast<std::ptrdiff_t>(shown * n), n, row.begin());
    held.erase(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(shown * n));
    state.time_s.erase(state.time_s.begin(), state.time_s.begin() + static_cast<std::ptrdiff_t>(shown));
  }
};

}  // namespace sandlot
