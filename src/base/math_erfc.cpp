#include "base/math_erfc.h"

#include <sleef.h>

namespace sandlot::math {

double erfc(double x) { return Sleef_cinz_erfcd1_u15purec(x); }

}  // namespace sandlot::math
