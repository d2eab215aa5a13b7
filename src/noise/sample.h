#pragma once
/// Sample at hand, as every stage of a chain of errors (noise/chain.h) receives it.
#include "base/fields.h"

namespace sandlot {

struct NoiseSample {
  double dt_s = 0;    ///< [s] since the previous sample, > 0
  double errors = 1;  ///< factor on all errors: 0 none, 1 as configured
};

}  // namespace sandlot
