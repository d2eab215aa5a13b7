#pragma once
/// SIMD lanes: eight floats, one per ray of a packet.
///
/// Vector types of the compiler instead of loops that it may or may not vectorise: every lane gets the same
/// IEEE operations in the same order at every optimisation level, so the bits are the same in all builds.
#include <cstring>

#if defined(__AVX__)
#include <immintrin.h>
#else
#include <cmath>
#endif

namespace sandlot::lanes {

inline constexpr int width = 8;
typedef float F __attribute__((vector_size(32)));
typedef int I __attribute__((vector_size(32)));  ///< masks: -1 true, 0 false

inline F broadcast(float x) { return F{x, x, x, x, x, x, x, x}; }
inline I broadcast(int x) { return I{x, x, x, x, x, x, x, x}; }
// Intrinsics, where the compiler does not find the instruction: it takes two or three for each.
#if defined(__AVX__)
inline F select(I mask, F yes, F no) { return F(_mm256_blendv_ps(__m256(no), __m256(yes), __m256(F(mask)))); }
inline I select(I mask, I yes, I no) { return I(select(mask, F(yes), F(no))); }
/// `b` where the comparison with NaN decides, as in (a < b ? a : b).
inline F min(F a, F b) { return F(_mm256_min_ps(__m256(a), __m256(b))); }
inline F max(F a, F b) { return F(_mm256_max_ps(__m256(a), __m256(b))); }
#else
inline F select(I mask, F yes, F no) { return mask ? yes : no; }
inline I select(I mask, I yes, I no) { return mask ? yes : no; }
inline F min(F a, F b) { return select(a < b, a, b); }
inline F max(F a, F b) { return select(a > b, a, b); }
#endif

inline F sqrt(F x) {
#if defined(__AVX__)
  return F(_mm256_sqrt_ps(__m256(x)));
#else
  F r;
  for (int i = 0; i < width; ++i) r[i] = std::sqrt(x[i]);
  return r;
#endif
}

/// Bit i is set where lane i is true.
inline unsigned bits(I mask) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(__m256(F(mask))));
#else
  unsigned out = 0;
  for (int i = 0; i < width; ++i) out |= mask[i] ? 1u << i : 0u;
  return out;
#endif
}

inline bool any(I mask) {
#if defined(__AVX__)
  return _mm256_movemask_ps(__m256(F(mask))) != 0;
#else
  int together = 0;
  for (int i = 0; i < width; ++i) together |= mask[i];
  return together != 0;
#endif
}

/// The first `count` <= 8 lanes from memory, the others zero.
template <class V>
V load(const void* from, unsigned count = width) {
  V v{};
  if (count == width) std::memcpy(&v, from, sizeof v);
  else std::memcpy(&v, from, count * 4);
  return v;
}
template <class V>
void store(void* to, V v, unsigned count = width) {
  if (count == width) std::memcpy(to, &v, sizeof v);
  else std::memcpy(to, &v, count * 4);
}

}  // namespace sandlot::lanes
