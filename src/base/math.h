#pragma once
/// Scalar mathematics that gives the same bits on every CPU and with every compiler.
///
/// The functions of <cmath> differ between C library versions and CPU generations in the last bit, which is
/// enough to send two runs apart. These wrap SLEEF's deterministic (`cinz`) functions, whose result is within
/// 1.0 ulp; `std::` versions are banned in src/ by tools/check_layers.py. std::sqrt, abs, floor, ceil and
/// friends are exact by IEEE 754 and stay allowed.
///
/// Cost    sine about 27 ns: hot paths keep headings as unit vectors instead of angles.
#include <cmath>
#include <numbers>

namespace sandlot::math {

inline constexpr double pi = std::numbers::pi;
inline constexpr double tau = 2 * std::numbers::pi;

struct SinCos {
  double sin, cos;
};

double sin(double rad);
double cos(double rad);
SinCos sincos(double rad);
double tan(double rad);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double exp(double x);
double log(double x);
double pow(double x, double y);
double hypot(double x, double y);
double tanh(double x);
/// Remainder with the sign of x, |result| < |y|; exact.
double fmod(double x, double y);

/// The angle in (-pi, pi] that equals `rad` modulo 2 pi.
double wrap_angle(double rad);

}  // namespace sandlot::math
