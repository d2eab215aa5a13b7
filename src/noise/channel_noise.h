#pragma once
/// Errors of one scalar channel (one axis of a gyroscope, one pressure): what data sheets and SDF's <noise>
/// give, as a map of a few keys, and then any stages (noise/chain.h). A list in place of the map is those
/// stages alone.
///
///   y[k] = stages(clamp(round(x[k] + e (c + b[k] + white * w[k])), -limit, limit))
///
/// c = mean + mean_std * n, drawn once at the start; b is a drifting bias (noise/drifting_bias.h, with its
/// own white density); w, n ~ Normal(0, 1). round() goes to multiples of e * `resolution`. e is the factor
/// `errors`.
///
/// Units    the channel's unit U.
/// Time     b depends on the time since the previous sample; w does not.
/// Random   what the keys of the map ask for is drawn from the device's stream, one after the other; each
///          stage has a stream of its own.
/// Errors   none at run time: a spec is validated once, when it is read.
/// Cost     one normal per sample for each of white and bias that is configured; nothing without any.
/// Source   noise/drifting_bias.h, noise/white.h, noise/chain.h.
/// Not modelled   non-orthogonal axes, temperature.
#include <algorithm>
#include <cmath>

#include "noise/chain.h"
#include "noise/drifting_bias.h"
#include "noise/white.h"

namespace sandlot {

struct ChannelNoiseSpec {
  static constexpr const char* list_key = "stages";
  double white = 0;       ///< [U] standard deviation per sample
  double mean = 0;        ///< [U]
  double mean_std = 0;    ///< [U]
  DriftingBiasSpec bias;  ///< U
  double resolution = 0;  ///< [U]; 0: none
  double limit = 1e12;    ///< [U]
  std::vector<StageSpec> stages;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"white", "", "Standard deviation of each sample's own error.", 0, 1e6, Field::tunable},
          s.white);
    visit(Field{"mean", "", "Constant part of the error.", -1e6, 1e6, Field::tunable}, s.mean);
    visit(
        Field{"mean_std", "", "Standard deviation of a further constant error, drawn at the start.", 0, 1e6},
        s.mean_std);
    visit(Field{"bias", "", "Drifting part of the error."}, s.bias);
    visit(Field{"resolution", "", "Step of the values; 0: none.", 0, 1e6}, s.resolution);
    visit(Field{"limit", "", "Largest magnitude of the values.", 0, 1e12}, s.limit);
    visit(stages_field, s.stages);
  }
  /// Variance of one sample's error about the channel's constant error.
  double variance(double dt_s, double errors = 1) const {
    return errors * errors *
               (white * white + bias.bias_std * bias.bias_std +
                bias.white_density * bias.white_density / dt_s + resolution * resolution / 12) +
           variance_of(stages, dt_s, errors);
  }
};

struct ChannelNoise {
  DriftingBias bias;
  double drawn = 0;  ///< [U] the part of c that was drawn at the start
  ChannelChain chain;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"bias", "", "Drifting part of the error."}, s.bias);
    visit(Field{"drawn", "", "Constant part of the error that was drawn at the start."}, s.drawn);
    visit(Field{"stages", "", "States of the noise stages."}, s.chain);
  }

  /// @param random   stream of the device, Purpose::initial
  /// @param channel  distinguishes several channels of one device: "gyro/x"
  void reset(const ChannelNoiseSpec& s, Stream& random, std::string_view channel = "") {
    bias.reset(s.bias, random);
    drawn = s.mean_std * random.normal();
    chain.reset(s.stages, random, channel);
  }
  /// @param dt_s    [s] since the previous sample, > 0
  /// @param random  stream of the device for this sample, Purpose::noise
  /// @param errors  factor on all of it
  double corrupt(const ChannelNoiseSpec& s, double truth, double dt_s, Stream& random, double errors = 1) {
    double y = truth + errors * s.mean + errors * drawn;
    if (s.bias.bias_std > 0 || s.bias.white_density > 0) y = bias.corrupt(s.bias, y, dt_s, random, errors);
    if (s.white > 0) y += errors * s.white * random.normal();
    if (const double step = errors * s.resolution; step > 0) y = std::floor(y / step + 0.5) * step;
    y = std::clamp(y, -s.limit, s.limit);
    return s.stages.empty() ? y : chain.corrupt(s.stages, y, dt_s, random, errors);
  }
};

}  // namespace sandlot
