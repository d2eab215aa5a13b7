#pragma once
/// White noise plus a slowly drifting bias, for one scalar channel (one gyro axis, one range...).
///
///   y[k] = x[k] + b[k] + white_density / sqrt(dt) * w[k]
///   b[k] = exp(-dt/tau) * b[k-1] + bias_std * sqrt(1 - exp(-2 dt/tau)) * v[k]
///
/// w, v ~ Normal(0, 1), independent. The bias update is the exact discretisation of a first-order
/// Gauss-Markov process, so its variance is bias_std^2 at any sample rate.
///
/// Units    the channel's unit U; dt and tau in seconds.
/// Errors   none at run time: a spec is validated once, when it is read.
/// Cost     two normals per sample, no allocation.
/// Source   P. S. Maybeck, Stochastic Models, Estimation and Control, vol. 1 (1979), sec. 4.11.
///          Terms as in IEEE Std 952, annex C.
/// Not modelled   rate random walk, scale factor, saturation, temperature.
#include <cmath>

#include "base/check.h"
#include "base/fields.h"
#include "base/math.h"
#include "base/random.h"

namespace sandlot {

struct DriftingBiasSpec {
  double white_density = 0.0;    ///< [U/sqrt(Hz)]
  double bias_std = 0.0;         ///< [U], stationary standard deviation
  double correlation_s = 100.0;  ///< [s], tau

  static void fields(auto& s, auto&& visit) {
    visit(Field{"white_density", "U/sqrt(Hz)", "White noise density, in the channel's unit per sqrt(Hz).", 0,
                1e6, Field::tunable},
          s.white_density);
    visit(Field{"bias_std", "", "Stationary standard deviation of the bias, in the channel's unit.", 0, 1e6,
                Field::tunable},
          s.bias_std);
    visit(Field{"correlation", "s", "Correlation time of the bias.", 1e-6, 1e9, Field::tunable},
          s.correlation_s);
  }
};

struct DriftingBias {
  double bias = 0.0;  ///< [U], the present bias; ground truth that a test or a log may read

  static void fields(auto& s, auto&& visit) {
    visit(Field{"bias", "", "Present bias, in the channel's unit."}, s.bias);
  }

  /// @param truth  [U]
  /// @param dt_s   [s] since the previous *sample* (not the physics step), > 0
  /// @param errors factor on what is added
  double corrupt(const DriftingBiasSpec& s, double truth, double dt_s, Stream& random, double errors = 1) {
    SL_CHECK(dt_s > 0.0);
    const double keep = math::exp(-dt_s / s.correlation_s);
    bias = keep * bias + s.bias_std * std::sqrt(1.0 - keep * keep) * random.normal();
    return truth + errors * bias + errors * s.white_density / std::sqrt(dt_s) * random.normal();
  }

  /// Draws the first bias from its stationary distribution, so that a run has no warm-up.
  void reset(const DriftingBiasSpec& s, Stream& random) { bias = s.bias_std * random.normal(); }
};

}  // namespace sandlot
