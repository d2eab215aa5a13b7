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
inline F3 select(I mask, const F3& a, const F3& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
inline F3 broadcast3(const float* a) { return {broadcast(a[0]), broadcast(a[1]), broadcast(a[2])}; }
inline F3 normalised(const F3& a) { return (1 / sqrt(dot(a, a))) * a; }

inline F abs(F x) { return F(I(x) & 0x7fffffff); }
inline F clamp(F x, float low, float high) { return min(max(x, broadcast(low)), broadcast(high)); }
inline F to_float(I x) { return __builtin_convertvector(x, F); }
/// Towards zero. @pre |x| < 2^31
inline I truncate(F x) { return __builtin_convertvector(x, I); }
/// The largest integer not above x, as a float. @pre |x| < 2^31
inline F floor(F x) {
#if defined(__AVX__)
  return F(_mm256_floor_ps(__m256(x)));
#else
  const F t = to_float(truncate(x));
  return select(t > x, t - 1, t);
#endif
}
inline float horizontal_max(F x) {
  typedef float F4 __attribute__((vector_size(16)));
  F4 halves[2];
  std::memcpy(halves, &x, sizeof x);
  const F4 a = halves[0] > halves[1] ? halves[0] : halves[1];
  const float b = a[0] > a[1] ? a[0] : a[1], c = a[2] > a[3] ? a[2] : a[3];
  return b > c ? b : c;
}
inline bool all(I mask) { return !any(~mask); }

/// @pre x > 0 and no denormal
inline F binary_log(F x) {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)); log m = 2 artanh((m - 1) / (m + 1)).
  const I shifted = I(x) - 0x3f3504f3, e = shifted >> 23;
  const F m = F(I(x) - (e << 23)), z = (m - 1) / (m + 1), q = z * z;
  return to_float(e) + z * (2.885390082f + q * (0.961796694f + q * (0.577078016f + q * 0.412198583f)));
}

/// 0 below 2^-126. @pre x < 128
inline F power_of_two(F x) {
  const F n = floor(x + 0.5f), f = (x - n) * 0.693147181f;
  const F p = 1 + f * (1 + f * (0.5f + f * (0.166666667f + f * (0.0416666667f +
                                                                f * (0.00833333333f + f * 0.00138888889f)))));
  const F scale = F((truncate(max(n, broadcast(-126.0f))) + 127) << 23);
  return select(x < -126, broadcast(0.0f), p * scale);
}

/// x^y for x >= 0; 0^y = 0.
inline F power(F x, F y) {
  return select(x < 1e-30f, broadcast(0.0f), power_of_two(y * binary_log(max(x, broadcast(1e-30f)))));
}

inline F angle_of(F y, F x) {
  const F ax = abs(x), ay = abs(y), high = max(ax, ay), low = min(ax, ay);
  const F t = low / max(high, broadcast(1e-37f));
  const I far = t > 0.414213562f;  // beyond pi / 8: from pi / 4
  const F s = select(far, (t - 1) / (t + 1), t), q = s * s;
  F a = s *
        (1 - q * (0.333333333f - q * (0.2f - q * (0.142857143f - q * (0.111111111f - q * 0.0909090909f)))));
  a = select(far, a + 0.785398163f, a);
  a = select(ay > ax, 1.570796327f - a, a);
  a = select(x < 0, 3.141592654f - a, a);
  return select(y < 0, -a, a);
}

}  // namespace sandlot::lanes
