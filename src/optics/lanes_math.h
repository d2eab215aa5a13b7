#pragma once
/// Geometry and elementary functions for eight rays at a time.
///
/// Precision   logarithm, power of two and arc tangent: a few float epsilon, from their series.
#include <cstring>

#include "optics/lanes.h"

namespace sandlot::lanes {

struct F3 {
  F x, y, z;
};
inline F3 operator+(const F3& a, const F3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline F3 operator-(const F3& a, const F3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline F3 operator*(F s, const F3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline F3 operator*(const F3& a, const F3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline F dot(const F3& a, const F3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline F3 cross(const F3& a, const F3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline F3 choose(I mask, const F3& a, const F3& b) {
  return {choose(mask, a.x, b.x), choose(mask, a.y, b.y), choose(mask, a.z, b.z)};
}
inline F3 all3(const float* a) { return {all(a[0]), all(a[1]), all(a[2])}; }
inline F3 normalised(const F3& a) { return (1 / root(dot(a, a))) * a; }

inline F magnitude(F x) { return F(I(x) & 0x7fffffff); }
inline F clamp(F x, float low, float high) { return lesser(greater(x, all(low)), all(high)); }
inline F whole(I x) { return __builtin_convertvector(x, F); }
/// Towards zero. @pre |x| < 2^31
inline I truncated(F x) { return __builtin_convertvector(x, I); }
/// The largest integer not above x, as a float. @pre |x| < 2^31
inline F floor(F x) {
#if defined(__AVX__)
  return F(_mm256_floor_ps(__m256(x)));
#else
  const F t = whole(truncated(x));
  return choose(t > x, t - 1, t);
#endif
}
inline float largest(F x) {
  typedef float F4 __attribute__((vector_size(16)));
  F4 halves[2];
  std::memcpy(halves, &x, sizeof x);
  const F4 a = halves[0] > halves[1] ? halves[0] : halves[1];
  const float b = a[0] > a[1] ? a[0] : a[1], c = a[2] > a[3] ? a[2] : a[3];
  return b > c ? b : c;
}
inline bool every(I mask) { return !any(~mask); }

/// @pre x > 0 and no denormal
inline F binary_log(F x) {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)); log m = 2 artanh((m - 1) / (m + 1)).
  const I shifted = I(x) - 0x3f3504f3, e = shifted >> 23;
  const F m = F(I(x) - (e << 23)), z = (m - 1) / (m + 1), q = z * z;
  return whole(e) + z * (2.885390082f + q * (0.961796694f + q * (0.577078016f + q * 0.412198583f)));
}

/// 0 below 2^-126. @pre x < 128
inline F power_of_two(F x) {
  const F n = floor(x + 0.5f), f = (x - n) * 0.693147181f;
  const F p = 1 + f * (1 + f * (0.5f + f * (0.166666667f + f * (0.0416666667f +
                                                                f * (0.00833333333f + f * 0.00138888889f)))));
  const F scale = F((truncated(greater(n, all(-126.0f))) + 127) << 23);
  return choose(x < -126, all(0.0f), p * scale);
}

/// x^y for x >= 0; 0^y = 0.
inline F power(F x, F y) {
  return choose(x < 1e-30f, all(0.0f), power_of_two(y * binary_log(greater(x, all(1e-30f)))));
}

inline F angle_of(F y, F x) {
  const F ax = magnitude(x), ay = magnitude(y), high = greater(ax, ay), low = lesser(ax, ay);
  const F t = low / greater(high, all(1e-37f));
  const I far = t > 0.414213562f;  // beyond pi / 8: from pi / 4
  const F s = choose(far, (t - 1) / (t + 1), t), q = s * s;
  F a = s *
        (1 - q * (0.333333333f - q * (0.2f - q * (0.142857143f - q * (0.111111111f - q * 0.0909090909f)))));
  a = choose(far, a + 0.785398163f, a);
  a = choose(ay > ax, 1.570796327f - a, a);
  a = choose(x < 0, 3.141592654f - a, a);
  return choose(y < 0, -a, a);
}

}  // namespace sandlot::lanes
