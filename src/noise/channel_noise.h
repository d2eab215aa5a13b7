#pragma once
/// Errors of one scalar channel (one axis of a gyroscope, one pressure): all that data sheets and SDF's <noise> give.
///
///   y[k] = clamp(round(x[k] + c + b[k] + white * w[k]), -limit, limit)
///
/// c = mean + mean_std * n, drawn once at the start; b is a drifting bias (noise/drifting_bias.h, with its own white
/// density); w, n ~ Normal(0, 1). round() goes to multiples of `resolution`.
///
/// Units    the channel's unit U.
/// Time     b depends on the time since the previous sample; w does not.
/// Errors   none at run time: a spec is validated once, when it is read.
/// Cost     one normal per sample for each of white and bias that is configured.
/// Source   noise/drifting_bias.h, noise/white.h.
/// Not modelled   scale factor, non-orthogonal axes, temperature, outliers.
#include <algorithm>
#include <cmath>

#include "noise/drifting_bias.h"
#include "noise/white.h"

namespace sandlot {

struct ChannelNoiseSpec {
  double white = 0;       ///< [U] standard deviation per sample
  double mean = 0;        ///< [U]
  double mean_std = 0;    ///< [U]
  DriftingBiasSpec bias;  ///< U
  double resolution = 0;  ///< [U]; 0: none
  double limit = 1e12;    ///< [U]

  static void fields(auto& s, auto&& visit) {
    visit(Field{"white", "", "Standard deviation of each sample's own error.", 0, 1e6, Field::tunable},
          s.white);
    visit(Field{"mean", "", "Constant error.", -1e6, 1e6, Field::tunable}, s.mean);
    visit(
        Field{"mean_std", "", "Standard deviation of a further constant error, drawn at the start.", 0, 1e6},
        s.mean_std);
    visit(Field{"bias", "", "Error that drifts."}, s.bias);
    visit(Field{"resolution", "", "Values are multiples of this; 0: any.", 0, 1e6}, s.resolution);
    visit(Field{"limit", "", "Largest magnitude shown.", 0, 1e12}, s.limit);
  }
  /// Of the error of one sample about the channel's constant error.
  double variance(double dt_s) const {
    return white * white + bias.bias_std * bias.bias_std + bias.white_density * bias.white_density / dt_s +
           resolution * resolution / 12;
  }
};

struct ChannelNoise {
  DriftingBias bias;
  double drawn = 0;  ///< [U] the part of c that was drawn at the start

  static void fields(auto& s, auto&& visit) {
    visit(Field{"bias", "", "Error that drifts."}, s.bias);
    visit(Field{"drawn", "", "Constant error drawn at the start."}, s.drawn);
  }

  void reset(const ChannelNoiseSpec& s, Stream& random) {
    bias.reset(s.bias, random);
    drawn = s.mean_std * random.normal();
  }
  /// @param dt_s  [s] since the previous sample, > 0
  double corrupt(const ChannelNoiseSpec& s, double truth, double dt_s, Stream& random) {
    double y = truth + s.mean + drawn;
    if (s.bias.bias_std > 0 || s.bias.white_density > 0) y = bias.corrupt(s.bias, y, dt_s, random);
    if (s.white > 0) y += s.white * random.normal();
    if (s.resolution > 0) y = std::floor(y / s.resolution + 0.5) * s.resolution;
    return std::clamp(y, -s.limit, s.limit);
  }
};

}  // namespace sandlot
