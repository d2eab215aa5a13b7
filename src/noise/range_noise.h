#pragma once
/// Errors of a sensor that measures many distances at once (the beams of a scan, the pixels of a depth
/// image): a map of a few keys, and then any stages (noise/chain.h). A list in place of the map is those
/// stages alone.
///
///   y[k][i] = clamp(stages(round(x[k][i] + e (c + b[k] + white * w[k][i]))), min, max)    for finite x
///
/// c is the device's own constant error: `mean` plus a draw at the start, uniform within +-systematic.
/// round() goes to multiples of e * `resolution`. b[k] is the error that all beams of sample k share: a
/// drifting bias (noise/drifting_bias.h, including its own white part); w[k][i] ~ Normal(0, 1) is drawn for
/// each beam separately. e is the factor `errors`.
///
/// Output   distances without a hit (+inf) or too near (-inf) stay as they are: only the stages dropouts and
///          outliers turn a hit into a miss or a miss into a hit.
/// Time     b depends on the time since the previous sample; w does not.
/// Random   as noise/channel_noise.h.
/// Limits   no reflectance; no error that depends on the angle at which a surface is met.
/// Cost     one normal per finite distance if `white` > 0, two more per sample if a bias is configured; the
///          stages.
/// Source   S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), sec. 6.3.1 (the "hit" term);
///          noise/chain.h.
#include <algorithm>
#include <cmath>
#include <span>

#include "noise/chain.h"
#include "noise/drifting_bias.h"
#include "noise/white.h"

namespace sandlot {

struct RangeNoiseSpec {
  static constexpr const char* list_key = "stages";
  double white_m = 0.0;       ///< standard deviation per beam
  DriftingBiasSpec bias;      ///< U = m
  double mean_m = 0.0;        ///< constant error of every device
  double systematic_m = 0.0;  ///< bound of this device's own constant error
  double resolution_m = 0.0;  ///< step of the values; 0: none
  std::vector<StageSpec> stages;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"white", "m", "Standard deviation of each beam's own error.", 0, 1e6, Field::tunable},
          s.white_m);
    visit(Field{"bias", "m", "Error that all beams of a sample share."}, s.bias);
    visit(Field{"mean", "m", "Constant part of the error.", -1e6, 1e6}, s.mean_m);
    visit(Field{"systematic", "m", "Bound of a further constant error, drawn at the start.", 0, 1e6},
          s.systematic_m);
    visit(Field{"resolution", "m", "Step of the distances; 0: none.", 0, 1e6}, s.resolution_m);
    visit(stages_field, s.stages);
  }
};

/// The constant error c of one device. No State: the same stream yields it again.
inline double constant_error_m(const RangeNoiseSpec& s, Stream& random) {
  return s.systematic_m > 0 ? s.mean_m + random.uniform(-s.systematic_m, s.systematic_m) : s.mean_m;
}

/// Corrupts one sample in place: what the keys of the map ask for, without stages.
/// @param dt_s        [s] since the previous sample, > 0
/// @param constant_m  c, from constant_error_m()
/// @param errors      factor on all of it
inline void corrupt_ranges(const RangeNoiseSpec& s, DriftingBias& bias, double dt_s, Stream& random,
                           double min_m, double max_m, std::span<float> ranges_m, double constant_m = 0,
                           double errors = 1) {
  const bool shared = s.bias.bias_std > 0 || s.bias.white_density > 0;
  const double offset_m = errors * constant_m +
                          (shared ? bias.corrupt(s.bias, 0.0, dt_s, random, errors) : 0.0);
  const WhiteNoiseSpec white{errors * s.white_m};
  const double step_m = errors * s.resolution_m;
  if (offset_m == 0 && white.std == 0 && step_m == 0) return;
  for (float& range_m : ranges_m) {
    if (!std::isfinite(range_m)) continue;
    const double shifted_m = static_cast<double>(range_m) + offset_m;
    double read_m = white.std > 0 ? white.corrupt(shifted_m, random) : shifted_m;
    if (step_m > 0) read_m = std::floor(read_m / step_m + 0.5) * step_m;
    range_m = static_cast<float>(std::clamp(read_m, min_m, max_m));
  }
}

/// The errors of one device.
struct RangeNoise {
  DriftingBias bias;
  ChannelChain chain;
  double constant_m = 0;  ///< c; no State: the same stream yields it again

  static void fields(auto& s, auto&& visit) {
    visit(Field{"bias", "", "Part of the error that all beams share."}, s.bias);
    visit(Field{"stages", "", "States of the noise stages."}, s.chain);
  }
  /// @param random  stream of the device, Purpose::initial
  void reset(const RangeNoiseSpec& s, Stream& random) {
    bias.reset(s.bias, random);
    constant_m = constant_error_m(s, random);
    chain.reset(s.stages, random);
  }
  /// Corrupts one sample in place.
  /// @param dt_s    [s] since the previous sample, > 0
  /// @param random  stream of the device for this sample, Purpose::noise
  /// @param errors  factor on all of it
  void corrupt(const RangeNoiseSpec& s, double dt_s, Stream& random, double min_m, double max_m,
               std::span<float> ranges_m, double errors = 1) {
    corrupt_ranges(s, bias, dt_s, random, min_m, max_m, ranges_m, constant_m, errors);
    if (s.stages.empty()) return;
    chain.corrupt(s.stages, ranges_m, dt_s, random, errors);
    for (float& range_m : ranges_m)
      if (std::isfinite(range_m))
        range_m = static_cast<float>(std::clamp(static_cast<double>(range_m), min_m, max_m));
  }
};

}  // namespace sandlot
