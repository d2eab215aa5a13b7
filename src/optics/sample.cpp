#include "optics/sample.h"

#include <bit>

namespace sandlot::optics {
namespace {

using lanes::broadcast;
using lanes::F;
using lanes::F3;
using lanes::I;
using lanes::select;

typedef float F4 __attribute__((vector_size(16)));

/// Mean of four texels, two neighbours in each of two rows. Weights: of the right ones in 256ths, of the
/// lower ones.
inline F4 blend(const std::uint32_t* upper, const std::uint32_t* lower, int right, float down) {
#if defined(__AVX__)
  const __m128i interleave = _mm_setr_epi8(0, -1, 4, -1, 1, -1, 5, -1, 2, -1, 6, -1, 3, -1, 7, -1);
  const __m128i weights = _mm_set1_epi32(right << 16 | (256 - right));
  const auto row = [&](const std::uint32_t* at) {
    const __m128i two = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(at));
    return F4(_mm_cvtepi32_ps(_mm_madd_epi16(_mm_shuffle_epi8(two, interleave), weights)));
  };
#else
  const auto row = [&](const std::uint32_t* at) {
    F4 out;
    for (int k = 0; k < 4; ++k)
      out[k] = static_cast<float>(static_cast<int>(at[0] >> 8 * k & 255) * (256 - right) +
                                  static_cast<int>(at[1] >> 8 * k & 255) * right);
    return out;
  };
#endif
  const F4 a = row(upper), b = row(lower);
  return a + down * (b - a);
}

/// A level of the pyramid for each lane.
struct Levels {
  F width, height;
  I first, stride;
};
Levels levels_of(const Texture& texture, I level) {
  Levels out;
  for (int i = 0; i < lanes::width; ++i) {
    const Texture::Level& l = texture.levels()[static_cast<std::size_t>(level[i])];
    out.width[i] = static_cast<float>(l.width);
    out.height[i] = static_cast<float>(l.height);
    out.first[i] = static_cast<int>(l.first);
    out.stride[i] = static_cast<int>(l.width + 1);
  }
  return out;
}

/// Writes the colour of the lanes around which the texture has only one and returns their mask; black to the
/// others.
///
/// Asked of a level where the longest footprint is at most half a texel long: with the texels that filtering
/// would touch it stays within the eight neighbours.
I plain(const Texture& texture, const Footprint8& f, F longer, I usable, F3& out) {
  const float longest = lanes::horizontal_max(select(usable, longer, broadcast(0.0f)));
  std::size_t level = 1;
  for (float reach = 1; reach < longest && level < texture.levels().size(); reach *= 4) ++level;
  out = {broadcast(0.0f), broadcast(0.0f), broadcast(0.0f)};
  if (level >= texture.levels().size()) return I{};
  const Texture::Level& l = texture.levels()[level];
  const F u = select(usable, f.u - lanes::floor(f.u), broadcast(0.0f)),
          v = select(usable, 1 - (f.v - lanes::floor(f.v)), broadcast(0.0f));
  const I column = lanes::truncate(u * static_cast<float>(l.width)),
          row = lanes::truncate(v * static_cast<float>(l.height));
  alignas(32) std::uint32_t at[lanes::width];
  lanes::store(at, row * static_cast<int>(l.width + 1) + column);
  for (std::uint32_t& i : at) i = texture.texels()[l.first + i];
  const I texel = lanes::load<I>(at);
  const I is = usable & ((texel & (1 << 24)) != 0);
  const auto channel = [&](int shift) {
    return select(is, lanes::to_float((texel >> shift) & 255) * (1 / 255.0f), broadcast(0.0f));
  };
  out = {channel(0), channel(8), channel(16)};
  return is;
}

}  // namespace

F3 sample(const Texture& texture, const Footprint8& f, I valid) {
  const auto w = static_cast<float>(texture.width()), h = static_cast<float>(texture.height());
  F square[2];
  for (int k = 0; k < 2; ++k) {
    const F x = w * f.du[k], y = h * f.dv[k];
    square[k] = x * x + y * y;
  }
  const I turned = square[0] < square[1];
  const F du = select(turned, f.du[1], f.du[0]), dv = select(turned, f.dv[1], f.dv[0]);
  const F longer = lanes::clamp(select(turned, square[1], square[0]), 1e-12f, 1e20f),
          shorter = lanes::clamp(select(turned, square[0], square[1]), 1e-12f, 1e20f);
  // Also false of NaN.
  I usable = valid & (lanes::abs(f.u) < 1e6f) & (lanes::abs(f.v) < 1e6f);
  F3 out;
  usable &= ~plain(texture, f, longer, usable, out);
  if (!lanes::any(usable)) return out;
  // What is magnified needs one tap however long it is.
  const F taps = lanes::clamp(-lanes::floor(-lanes::sqrt(longer / lanes::max(shorter, broadcast(1.0f)))),
                              1.0f, float{most_taps});
  const F detail = lanes::clamp(0.5f * lanes::binary_log(lanes::max(shorter, longer / (taps * taps))), 0.0f,
                                static_cast<float>(texture.levels().size() - 1));
  const F fine = lanes::floor(detail), between = detail - fine;
  const std::uint32_t* const texels = texture.texels();
  F4 sum[lanes::width] = {};
  for (int pass = 0; pass < 2; ++pass) {
    const F weight = (pass == 0 ? 1 - between : between) / (taps * 256);
    const I wanted = usable & (weight > 0);
    if (!lanes::any(wanted)) continue;
    const I last = broadcast(static_cast<int>(texture.levels().size() - 1));
    const I level = lanes::truncate(fine) + pass;
    const Levels at = levels_of(texture, select(level < last, level, last));
    alignas(32) float share[lanes::width];
    alignas(32) int stride[lanes::width];
    lanes::store(share, weight);
    lanes::store(stride, at.stride);
    for (int tap = 0; tap < most_taps; ++tap) {
      const I here = wanted & (taps > static_cast<float>(tap));
      if (!lanes::any(here)) break;
      const F off = (static_cast<float>(tap) + 0.5f) / taps - 0.5f;
      const F u = select(here, f.u + off * du, broadcast(0.0f)),
              v = select(here, f.v + off * dv, broadcast(0.0f));
      const F x = (u - lanes::floor(u)) * at.width - 0.5f, y = (1 - (v - lanes::floor(v))) * at.height - 0.5f;
      const F left = lanes::floor(x), top = lanes::floor(y);
      const I column = lanes::truncate(select(left < 0, left + at.width, left)),
              row = lanes::truncate(select(top < 0, top + at.height, top));
      const I index = at.first + row * at.stride + column, right = lanes::truncate((x - left) * 256 + 0.5f);
      const F down = y - top;
      alignas(32) int place[lanes::width], shift[lanes::width];
      alignas(32) float below[lanes::width];
      lanes::store(place, index);
      lanes::store(shift, right);
      lanes::store(below, down);
      for (unsigned left_over = lanes::bits(here); left_over != 0; left_over &= left_over - 1) {
        const auto i = static_cast<unsigned>(std::countr_zero(left_over));
        const std::uint32_t* upper = texels + place[i];
        sum[i] += share[i] * blend(upper, upper + stride[i], shift[i], below[i]);
      }
    }
  }
  for (int i = 0; i < lanes::width; ++i) {
    if (!usable[i]) continue;
    out.x[i] = sum[i][0] * (1 / 255.0f);
    out.y[i] = sum[i][1] * (1 / 255.0f);
    out.z[i] = sum[i][2] * (1 / 255.0f);
  }
  return out;
}

}  // namespace sandlot::optics
