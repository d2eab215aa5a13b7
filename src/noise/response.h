#pragma once
/// Stages that are a sensor's or an actuator's way to answer: scale, quantise, clip, dead_zone, lag. Symbols as in
/// noise/additive.h.
///
/// For many values at once scale is one factor that all share; the others work on each value. Only scale
/// draws, once.
/// Cost     a few operations per value; no allocation.
/// Source   B. Widrow, I. Kollar, Quantization Noise (2008), ch. 4 (variance step^2 / 12).
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "noise/additive.h"

namespace sandlot {

/// y = x (1 + e (error + std n)),   n drawn once at the start.   A wrong calibration.
struct ScaleSpec {
  static constexpr const char* name = "scale";
  static constexpr const char* help =
      "Wrong scale, the same for all devices or drawn when the device is made.";
  double error = 0, std = 0;
  struct State {
    double normal = 0;  ///< the draw
    static void fields(auto& s, auto&& visit) {
      visit(Field{"normal", "1", "Normal draw that std multiplies."}, s.normal);
    }
  };

  static void fields(auto& s, auto&& visit) {
    visit(Field{"error", "1", "Relative error: 0.01 shows 1 % too much.", -1e3, 1e3, Field::tunable},
          s.error);
    visit(Field{"std", "1", "Standard deviation of a further relative error.", 0, 1e3, Field::tunable},
          s.std);
  }
  void reset(State& state, Stream& random) const { state.normal = random.normal(); }
  void advance(State&, const NoiseSample&, Stream&) const {}
  double show(const State& state, double x, const NoiseSample& sample) const {
    return x * (1 + sample.errors * (error + std * state.normal));
  }
};

/// y = s floor(x / s + 1/2),   s = e step.   Of values spread over many steps the error has mean 0, variance s^2 / 12.
struct QuantiseSpec {
  static constexpr const char* name = "quantise";
  static constexpr const char* help = "Quantisation: values are multiples of a step.";
  double step = 0;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"step", "", "Distance between two values.", 0, max_error, Field::tunable | Field::required},
          s.step);
  }
  double corrupt(double x, const NoiseSample& sample, Stream&) const {
    const double s = sample.errors * step;
    // Beyond 2^52 steps a double has no finer values anyway; the sum would only lose bits.
    return s > 0 && std::abs(x) < s * 4503599627370496.0 ? std::floor(x / s + 0.5) * s : x;
  }
  double variance(double) const { return step * step / 12; }
};

/// y = min(max(x, min), max).   What the device can show, not an error: the factor `errors` leaves it alone.
struct ClipSpec {
  static constexpr const char* name = "clip";
  static constexpr const char* help = "Saturation: smallest and largest value shown.";
  double min = -1e12, max = 1e12;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"min", "", "Smallest value shown.", -1e12, 1e12, Field::tunable}, s.min);
    visit(Field{"max", "", "Largest value shown.", -1e12, 1e12, Field::tunable}, s.max);
  }
  Status check(const Node& node, const std::string& path) const {
    if (min <= max) return {};
    return node.error("min is greater than max", "exchange them", path);
  }
  double corrupt(double x, const NoiseSample&, Stream&) const {
    return std::isfinite(x) ? std::clamp(x, min, max) : x;
  }
};

/// y = 0 for |x| < e width, else x.
struct DeadZoneSpec {
  static constexpr const char* name = "dead_zone";
  static constexpr const char* help = "Dead zone: small values show as zero.";
  double width = 0;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"width", "", "Magnitude below which values are zero.", 0, max_error,
                Field::tunable | Field::required},
          s.width);
  }
  double corrupt(double x, const NoiseSample& sample, Stream&) const {
    return std::abs(x) < sample.errors * width ? 0 : x;
  }
};

/// y[k] = y[k-1] + (1 - exp(-dt / (e tau))) (x[k] - y[k-1]),   y = x at the first sample.   First-order lag, exact for an x
/// that is constant between two samples: after a step the difference falls to 1/e = 37 % within tau at any rate.
struct LagSpec {
  static constexpr const char* name = "lag";
  static constexpr const char* help = "First-order lag: follows the value with a time constant.";
  double time_constant_s = 0;
  struct State {
    bool begun = false;
    double value = 0;           ///< [U] the latest y
    std::vector<float> values;  ///< of many values at once
    static void fields(auto& s, auto&& visit) {
      visit(Field{"begun", "", "Whether there was a sample."}, s.begun);
      visit(Field{"value", "", "Value shown last."}, s.value);
      visit(Field{"values", "", "Values of a scan shown last."}, s.values);
    }
  };

  static void fields(auto& s, auto&& visit) {
    visit(Field{"time_constant", "s", "Time constant tau.", 0, 1e6, Field::tunable | Field::required},
          s.time_constant_s);
  }
  double corrupt(State& state, double x, const NoiseSample& sample, Stream&) const {
    if (!std::isfinite(x)) return x;
    if (!state.begun || !std::isfinite(state.value)) state.value = x;
    state.begun = true;
    return state.value += share(sample) * (x - state.value);
  }
  void corrupt(State& state, std::span<float> values, const NoiseSample& sample, Stream&) const {
    if (state.values.size() != values.size()) state.values.assign(values.begin(), values.end());
    const auto toward = static_cast<float>(share(sample));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      if (!std::isfinite(state.values[i])) state.values[i] = values[i];
      values[i] = state.values[i] += toward * (values[i] - state.values[i]);
    }
  }

 private:
  double share(const NoiseSample& sample) const {
    const double tau_s = sample.errors * time_constant_s;
    return tau_s > 0 ? 1 - math::exp(-sample.dt_s / tau_s) : 1;
  }
};

}  // namespace sandlot
