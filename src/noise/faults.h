#pragma once
/// Stages that go wrong now and then: dropouts, outliers. Symbols as in noise/additive.h.
///
/// Errors   a bad spec is refused when it is read.
/// Cost     one draw per value (outliers: two where one occurs); no allocation after the first sample.
/// Source   E. N. Gilbert, Capacity of a Burst-Noise Channel (1960); S. Thrun et al., Probabilistic Robotics
///          (2005), sec. 6.3 (p_rand, p_max).
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "noise/additive.h"

namespace sandlot {

/// Probability that something which happens `rate` times per sample or `per_second` times per second happens
/// in one sample.
inline double odds_per_sample(double rate, double per_second, const NoiseSample& sample) {
  if (per_second > 0) return 1 - math::exp(-per_second * sample.errors * sample.dt_s);
  return std::min(1.0, rate * sample.errors);
}

/// Values that are not there, alone or in bursts: a two-state Markov chain, lost or not.
///
/// Given per sample (`rate` p <- min(1, e p), `burst` L):   P(lost | not lost) = p,   P(lost | lost) = 1 - (1 - p) / L.
/// Fraction lost f = p / (p + (1 - p) / L), mean length of a burst L / (1 - p). With L = 1 losses are
/// independent, f = p.
///
/// Given per second (`per_second` r <- e r, `burst_time` T): the process that begins bursts at the rate r
/// while nothing is lost and ends them at the rate 1 / T, sampled exactly: f = r T / (1 + r T) and
/// correlation exp(-lag (r + 1 / T)), whatever the sample rate. T = 0 loses one sample each: f = 1 - exp(-r
/// dt).
///
/// For many values at once the chain runs along the values, one after the other, and restarts in each sample;
/// with `whole` it runs over the samples and loses all values at once, and all channels of a device that has
/// several. `hold` shows what the same beam showed before.
struct DropoutsSpec {
  static constexpr const char* name = "dropouts";
  static constexpr const char* help = "Values that are lost, alone or in bursts.";
  enum class Shows : std::uint8_t { nan, inf, hold, value };
  double rate = 0, burst = 1, per_second = 0, burst_time_s = 0;
  Shows shows = Shows::nan;
  double value = 0;
  bool whole = false;

  struct State {
    bool lost = false, begun = false;
    double held = 0;
    std::vector<float> held_values;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"lost", "", "Whether the sample lies in a burst of losses."}, s.lost);
      visit(Field{"begun", "", "Whether a value was shown before."}, s.begun);
      visit(Field{"held", "", "Value shown last."}, s.held);
      visit(Field{"held_values", "", "Values shown last."}, s.held_values);
    }
  };

  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"rate", "1", "Probability that a burst of losses begins with a sample.", 0, 1, Field::tunable},
        s.rate);
    visit(Field{"burst", "1", "Mean number of samples lost in one burst.", 1, 1e6, Field::tunable}, s.burst);
    visit(Field{"per_second", "Hz", "Number of bursts per second, instead of rate.", 0, 1e6, Field::tunable},
          s.per_second);
    visit(Field{"burst_time", "s", "Mean duration of a burst, with per_second.", 0, 1e6, Field::tunable},
          s.burst_time_s);
    visit(Field{"shows", "", "Output for a lost sample: no number, no hit, the value before, or `value`."},
          s.shows);
    visit(Field{"value", "", "Output for a lost sample with `shows: value`.", -1e12, 1e12, Field::tunable},
          s.value);
    visit(Field{"whole", "", "Whether all values of the device's sample are lost at once."}, s.whole);
  }
  Status check(const Node& node, const std::string& path) const {
    if (rate > 0 && per_second > 0)
      return node.error("rate and per_second are both given", "keep one of them", path);
    if (rate > 0 && burst_time_s > 0)
      return node.error("burst_time goes with per_second", "give burst with rate", path);
    if (per_second > 0 && burst > 1)
      return node.error("burst goes with rate", "give burst_time with per_second", path);
    return {};
  }

  struct Odds {
    double begin, stay;
    double lost() const { return begin > 0 ? begin / (begin + 1 - stay) : 0; }
  };
  Odds odds(const NoiseSample& sample) const {
    const double begin = odds_per_sample(rate, per_second, sample);
    if (per_second > 0 && burst_time_s > 0) {
      const double r = per_second * sample.errors, end = 1 / burst_time_s;
      const double lost = r / (r + end), forgets = 1 - math::exp(-(r + end) * sample.dt_s);
      return {lost * forgets, 1 - (1 - lost) * forgets};
    }
    return {begin, 1 - (1 - begin) / (per_second > 0 ? 1.0 : burst)};
  }

  double corrupt(State& state, double x, const NoiseSample& sample, Stream& random) const {
    const Odds p = odds(sample);
    state.lost = random.uniform() < (state.lost ? p.stay : p.begin);
    if (state.lost) return instead(state.begun ? state.held : x);
    state.begun = true;
    state.held = x;
    return x;
  }
  void corrupt(State& state, std::span<float> values, const NoiseSample& sample, Stream& random) const {
    const Odds p = odds(sample);
    const bool holds = shows == Shows::hold;
    if (holds && state.held_values.size() != values.size()) {
      state.held_values.assign(values.begin(), values.end());
    }
    bool lost = random.uniform() < (!whole ? p.lost() : state.lost ? p.stay : p.begin);
    state.lost = whole && lost;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0 && !whole) lost = random.uniform() < (lost ? p.stay : p.begin);
      if (lost)
        values[i] = static_cast<float>(instead(static_cast<double>(holds ? state.held_values[i] : 0)));
      else if (holds) state.held_values[i] = values[i];
    }
  }

 private:
  double instead(double held) const {
    switch (shows) {
      case Shows::nan: return std::numeric_limits<double>::quiet_NaN();
      case Shows::inf: return std::numeric_limits<double>::infinity();
      case Shows::hold: return held;
      case Shows::value: return value;
    }
    return held;
  }
};
inline std::span<const EnumName<DropoutsSpec::Shows>> enum_names(DropoutsSpec::Shows) {
  using Shows = DropoutsSpec::Shows;
  static constexpr EnumName<Shows> names[] = {
      {"nan", Shows::nan}, {"inf", Shows::inf}, {"hold", Shows::hold}, {"value", Shows::value}};
  return names;
}

/// With the probability p per value: y = x + g, or y = g with `replace`;   g = std n, or uniform in [min, max].
/// p = min(1, e rate), or 1 - exp(-e per_second dt). The factor changes how often, not how far.
/// Variance of an added outlier p (std^2), or p ((max - min)^2 / 12 + (1 - p) ((min + max) / 2)^2).
/// For many values at once there is one draw for each; only `replace` touches a value that is not finite.
struct OutliersSpec {
  static constexpr const char* name = "outliers";
  static constexpr const char* help = "Outliers: occasional values that are far off.";
  double rate = 0, per_second = 0, std = 0, min = 0, max = 0;
  bool replace = false;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rate", "1", "Probability of an outlier per value.", 0, 1, Field::tunable}, s.rate);
    visit(
        Field{"per_second", "Hz", "Number of outliers per second, instead of rate.", 0, 1e6, Field::tunable},
        s.per_second);
    visit(Field{"std", "", "Standard deviation of normal outliers.", 0, max_error, Field::tunable}, s.std);
    visit(Field{"min", "", "Smallest of uniform outliers.", -max_error, max_error, Field::tunable}, s.min);
    visit(Field{"max", "", "Largest of uniform outliers.", -max_error, max_error, Field::tunable}, s.max);
    visit(Field{"replace", "", "Whether outliers replace the value instead of being added to it."},
          s.replace);
  }
  Status check(const Node& node, const std::string& path) const {
    if (rate > 0 && per_second > 0)
      return node.error("rate and per_second are both given", "keep one of them", path);
    if (min > max) return node.error("min is greater than max", "exchange them", path);
    if (std > 0 && (min != 0 || max != 0))
      return node.error("std and min, max are both given",
                        "give std for normal ones, min and max for uniform", path);
    return {};
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    if (random.uniform() >= odds_per_sample(rate, per_second, sample)) return x;
    const double g = std > 0 ? std * random.normal() : min + (max - min) * random.uniform();
    return replace ? g : x + g;
  }
  double variance(double dt_s) const {
    const double p = odds_per_sample(rate, per_second, {dt_s, 1});
    const double mean = 0.5 * (min + max);
    return p * (std > 0 ? std * std : (max - min) * (max - min) / 12 + (1 - p) * mean * mean);
  }
};

}  // namespace sandlot
