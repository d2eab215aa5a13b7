#include "base/math_list.h"

#include <sleef.h>

#include "base/check.h"

namespace sandlot::math {

void sincos(std::span<const double> rad, std::span<SinCos> out) {
  SL_CHECK(rad.size() == out.size());
  std::size_t i = 0;
#if defined(__AVX__)
  // Of one width and without fused operations on every processor: its bits are those of the scalar function.
  for (; i + 4 <= rad.size(); i += 4) {
    const Sleef___m256d_2 r = Sleef_cinz_sincosd4_u10avx(_mm256_loadu_pd(&rad[i]));
    double sin[4], cos[4];
    _mm256_storeu_pd(sin, r.x);
    _mm256_storeu_pd(cos, r.y);
    for (std::size_t lane = 0; lane < 4; ++lane) out[i + lane] = {sin[lane], cos[lane]};
  }
#endif
  for (; i < rad.size(); ++i) out[i] = sincos(rad[i]);
}

}  // namespace sandlot::math
