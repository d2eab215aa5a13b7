#pragma once
/// Stages that add an error: gaussian, white, uniform, proportional, drift, bias, walk.
///
/// x is what comes in, y what goes out, e the factor `errors`, dt the time since the previous sample; n ~
/// Normal(0, 1) and u ~ Uniform(0, 1) are independent draws. U is the channel's unit. What is not finite
/// stays as it is.
///
/// For many values at once (the beams of a scan) gaussian, white, uniform and proportional draw for each
/// value separately; drift, bias and walk are one error that all values share.
///
/// Cost     one draw per value or sample (bias: none after the start); no allocation.
/// Source   P. S. Maybeck, Stochastic Models, Estimation and Control, vol. 1 (1979), sec. 4.11 (drift, walk);
///          IEEE Std 952, annex C (terms of data sheets); S. Thrun et al., Probabilistic Robotics (2005),
///          sec. 6.3 (gaussian).
#include <cmath>

#include "base/math.h"
#include "base/random.h"
#include "base/read.h"
#include "noise/sample.h"

namespace sandlot {

inline constexpr double max_error = 1e6;  ///< [U]

/// y = x + e (mean + std n).   Mean e mean, variance e^2 std^2, whatever the rate.
struct GaussianSpec {
  static constexpr const char* name = "gaussian";
  static constexpr const char* help =
      "Independent normal errors, with the same standard deviation for every sample.";
  double std = 0, mean = 0;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "", "Standard deviation of each sample's own error.", 0, max_error,
                Field::tunable | Field::required},
          s.std);
    visit(Field{"mean", "", "Mean of the error.", -max_error, max_error, Field::tunable}, s.mean);
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    return x + sample.errors * (mean + std * random.normal());
  }
  double variance(double) const { return std * std; }
};

/// y = x + e density / sqrt(dt) n.   Variance e^2 density^2 / dt: the mean over a second has the same variance,
/// density^2 / 1 s, at every rate.
struct WhiteSpec {
  static constexpr const char* name = "white";
  static constexpr const char* help =
      "White noise given as a density: averages down over time alike at every rate.";
  double density = 0;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"density", "U/sqrt(Hz)", "Noise density: standard deviation of the mean over one second.", 0,
                max_error, Field::tunable | Field::required},
          s.density);
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    return x + sample.errors * density / std::sqrt(sample.dt_s) * random.normal();
  }
  double variance(double dt_s) const { return density * density / dt_s; }
};

/// y = x + e (min + (max - min) u).   Mean e (min + max) / 2, variance e^2 (max - min)^2 / 12.
struct UniformSpec {
  static constexpr const char* name = "uniform";
  static constexpr const char* help = "Independent errors, uniform between min and max.";
  double min = 0, max = 0;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned flags = Field::tunable | Field::required;
    visit(Field{"min", "", "Smallest error.", -max_error, max_error, flags}, s.min);
    visit(Field{"max", "", "Largest error.", -max_error, max_error, flags}, s.max);
  }
  Status check(const Node& node, const std::string& path) const {
    if (min <= max) return {};
    return node.error("min is greater than max", "exchange them", path);
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    return x + sample.errors * (min + (max - min) * random.uniform());
  }
  double variance(double) const { return (max - min) * (max - min) / 12; }
};

/// y = x + e std |x| n.   Variance e^2 std^2 x^2: an error of so many per cent of the value.
struct ProportionalSpec {
  static constexpr const char* name = "proportional";
  static constexpr const char* help = "Independent normal errors that grow with the value.";
  double std = 0;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "1", "Standard deviation per unit of the value: 1 % of it is 0.01.", 0, 1e3,
                Field::tunable | Field::required},
          s.std);
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    const double n = random.normal();  // drawn in any case: what comes in moves nobody's numbers
    return std::isfinite(x) ? x + sample.errors * std * std::abs(x) * n : x;
  }
};

/// y = x + e b,   b[k] = a b[k-1] + std sqrt(1 - a^2) n,   a = exp(-dt / correlation).
/// The exact discretisation of dB/dt = -B / tau + N_B, which it agrees with at any rate: variance e^2 std^2,
/// autocovariance e^2 std^2 exp(-lag / tau). A density q of N_B [U/s/sqrt(Hz)] gives std = q sqrt(tau / 2).
/// The first b is drawn from the stationary distribution, so that a run has no warm-up.
struct DriftSpec {
  static constexpr const char* name = "drift";
  static constexpr const char* help = "Error that wanders about zero (first-order Gauss-Markov process).";
  double std = 0, correlation_s = 100;
  struct State {
    double error = 0;  ///< [U] b, unscaled
    static void fields(auto& s, auto&& visit) {
      visit(Field{"error", "", "Present error, before the factor `errors`."}, s.error);
    }
  };

  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "", "Stationary standard deviation.", 0, max_error, Field::tunable | Field::required},
          s.std);
    visit(Field{"correlation", "s", "Correlation time of the error, tau.", 1e-6, 1e9,
                Field::tunable | Field::required},
          s.correlation_s);
  }
  void reset(State& state, Stream& random) const { state.error = std * random.normal(); }
  void advance(State& state, const NoiseSample& sample, Stream& random) const {
    const double keep = math::exp(-sample.dt_s / correlation_s);
    state.error = keep * state.error + std * std::sqrt(1.0 - keep * keep) * random.normal();
  }
  double show(const State& state, double x, const NoiseSample& sample) const {
    return x + sample.errors * state.error;
  }
  double variance(double) const { return std * std; }
};

/// y = x + e (mean + std n + half_width (2 u - 1)),   n and u drawn once at the start.
/// Constant in a run; over devices or seeds mean e mean and variance e^2 (std^2 + half_width^2 / 3).
struct BiasSpec {
  static constexpr const char* name = "bias";
  static constexpr const char* help = "Constant error, drawn when the device is made.";
  double mean = 0, std = 0, half_width = 0;
  struct State {
    double normal = 0, uniform = 0;  ///< the draws
    static void fields(auto& s, auto&& visit) {
      visit(Field{"normal", "1", "Normal draw that std multiplies."}, s.normal);
      visit(Field{"uniform", "1", "Uniform draw within +-1 that half_width multiplies."}, s.uniform);
    }
  };

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mean", "", "Constant part that is the same for every device.", -max_error, max_error,
                Field::tunable},
          s.mean);
    visit(Field{"std", "", "Standard deviation of the normal part.", 0, max_error, Field::tunable}, s.std);
    visit(Field{"half_width", "", "Bound of the uniform part.", 0, max_error, Field::tunable}, s.half_width);
  }
  void reset(State& state, Stream& random) const {
    state.normal = random.normal();
    state.uniform = 2 * random.uniform() - 1;
  }
  void advance(State&, const NoiseSample&, Stream&) const {}
  double show(const State& state, double x, const NoiseSample& sample) const {
    return x + sample.errors * (mean + std * state.normal + half_width * state.uniform);
  }
};

/// y = x + e b,   b[k] = b[k-1] + density sqrt(dt) n,   b = 0 at the start.
/// Variance e^2 density^2 t after the time t, whatever the rate.
struct WalkSpec {
  static constexpr const char* name = "walk";
  static constexpr const char* help = "Error that wanders off (random walk).";
  double density = 0;
  using State = DriftSpec::State;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"density", "U/sqrt(s)", "Standard deviation of the error after one second.", 0, max_error,
                Field::tunable | Field::required},
          s.density);
  }
  void reset(State& state, Stream&) const { state.error = 0; }
  void advance(State& state, const NoiseSample& sample, Stream& random) const {
    state.error += density * std::sqrt(sample.dt_s) * random.normal();
  }
  double show(const State& state, double x, const NoiseSample& sample) const {
    return x + sample.errors * state.error;
  }
};

}  // namespace sandlot
