#pragma once
/// White Gaussian noise: independent errors of one standard deviation per sample, for one scalar channel.
///
///   y[k] = x[k] + std * w[k],   w ~ Normal(0, 1), independent
///
/// Units    the channel's unit U. The deviation holds per sample, whatever the sample rate; for noise given
///          as a density (U/sqrt(Hz)) see noise/drifting_bias.h.
/// Errors   none at run time: a spec is validated once, when it is read.
/// Cost     one normal per sample, no allocation.
/// Source   S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), sec. 6.3.1 (p_hit).
/// Not modelled   correlation in time or between channels, outliers, quantisation.
#include "base/fields.h"
#include "base/random.h"

namespace sandlot {

struct WhiteNoiseSpec {
  double std = 0.0;  ///< [U]

  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "", "Standard deviation per sample, in the channel's unit.", 0, 1e6, Field::tunable},
          s.std);
  }

  /// @param truth  [U]
  double corrupt(double truth, Stream& random) const { return truth + std * random.normal(); }
};

}  // namespace sandlot
