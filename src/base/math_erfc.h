#pragma once
/// Complementary error function, with the same bits on every CPU and with every compiler, as base/math.h.

namespace sandlot::math {

/// 2 / sqrt(pi) times the integral of exp(-t^2) from x on; within 1.5 ulp.
double erfc(double x);

}  // namespace sandlot::math
