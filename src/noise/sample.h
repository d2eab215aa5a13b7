#pragma once
/// What every stage of a chain of errors (noise/chain.h) is told about the sample at hand.
#include "base/fields.h"

namespace sandlot {

struct NoiseSample {
  double dt_s = 0;    ///< [s] since the previous sample, > 0
  double errors = 1;  ///< factor on all errors: 0 none, 1 as configured
};

}  // namespace sandlot
