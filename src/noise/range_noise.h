#pragma once
/// Errors of a sensor that measures many distances at once (the beams of a scan, the pixels of a depth image).
///
///   y[k][i] = clamp(round(x[k][i] + c + b[k] + white * w[k][i]), min, max)    for finite x
///
/// c is the device's own constant error: `mean` plus a draw at the start, uniform within +-systematic. round() goes to
/// multiples of `resolution`. b[k] is the error that all beams of sample k share: a drifting bias (noise/drifting_bias.h, including its own
/// white part); w[k][i] ~ Normal(0, 1) is drawn for each beam anew.
///
/// Output   distances without a hit (+inf) or too near (-inf) stay as they are: noise never turns a hit into a miss.
/// Time     b depends on the time since the previous sample; w does not.
/// Limits   no outliers, reflectance, mixed pixels, or growth of the error with distance.
/// Cost     one normal per finite distance if `white` > 0, two more per sample if a bias is configured.
/// Source   S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), sec. 6.3.1 (the "hit" term only).
#include <algorithm>
#include <cmath>
#include <span>

#include "noise/drifting_bias.h"
#include "noise/white.h"

namespace sandlot {

struct RangeNoiseSpec {
  double white_m = 0.0;       ///< standard deviation per beam
  DriftingBiasSpec bias;      ///< U = m
  double mean_m = 0.0;        ///< constant error of every device
  double systematic_m = 0.0;  ///< bound of this device's own constant error
  double resolution_m = 0.0;  ///< step of the values; 0: none

  static void fields(auto& s, auto&& visit) {
    visit(Field{"white", "m", "Standard deviation of each beam's own error.", 0, 1e6, Field::tunable},
          s.white_m);
    visit(Field{"bias", "m", "Error that all beams of a sample share."}, s.bias);
    visit(Field{"mean", "m", "Constant error.", -1e6, 1e6}, s.mean_m);
    visit(Field{"systematic", "m", "Further constant error, drawn at the start within +- this.", 0, 1e6},
          s.systematic_m);
    visit(Field{"resolution", "m", "Distances are multiples of this; 0: any.", 0, 1e6}, s.resolution_m);
  }
};

/// The constant error c of one device. No State: the same stream yields it again.
inline double constant_error_m(const RangeNoiseSpec& s, Stream& random) {
  return s.systematic_m > 0 ? s.mean_m + random.uniform(-s.systematic_m, s.systematic_m) : s.mean_m;
}

/// Corrupts one sample in place.
/// @param dt_s        [s] since the previous sample, > 0
/// @param constant_m  c, from constant_error_m()
inline void corrupt_ranges(const RangeNoiseSpec& s, DriftingBias& bias, double dt_s, Stream& random,
                           double min_m, double max_m, std::span<float> ranges_m, double constant_m = 0) {
  const bool shared = s.bias.bias_std > 0 || s.bias.white_density > 0;
  const double offset_m = constant_m + (shared ? bias.corrupt(s.bias, 0.0, dt_s, random) : 0.0);
  if (offset_m == 0 && s.white_m == 0 && s.resolution_m == 0) return;
  const WhiteNoiseSpec white{s.white_m};
  for (float& range_m : ranges_m) {
    if (!std::isfinite(range_m)) continue;
    const double shifted_m = static_cast<double>(range_m) + offset_m;
    double read_m = white.std > 0 ? white.corrupt(shifted_m, random) : shifted_m;
    if (s.resolution_m > 0) read_m = std::floor(read_m / s.resolution_m + 0.5) * s.resolution_m;
    range_m = static_cast<float>(std::clamp(read_m, min_m, max_m));
  }
}

}  // namespace sandlot
