#include "noise/deviates.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "base/math.h"

namespace sandlot {
namespace {

constexpr std::uint32_t half = 32768;

/// The positive half: the values z with P(|Z| < z) = (k + 1/2) / half. The distribution is summed up in small
/// steps (trapezium rule, its error is below 1e-8) and looked up backwards.
std::vector<float> make_table() {
  std::vector<double> z(half);
  constexpr double step = 1e-3;
  const double scale = 2 / std::sqrt(math::tau);
  double low = 0, density = scale;
  std::size_t k = 0;
  for (int i = 1; k < half; ++i) {
    const double here = step * i, next = scale * math::exp(-0.5 * here * here);
    const double high = low + 0.5 * step * (density + next);
    for (; k < half && (static_cast<double>(k) + 0.5) / half <= high; ++k)
      z[k] = here - step + step * ((static_cast<double>(k) + 0.5) / half - low) / (high - low);
    low = high;
    density = next;
  }
  double squares = 0;
  for (const double each : z) squares += each * each / half;
  std::vector<float> out(half);
  for (std::size_t i = 0; i < half; ++i) out[i] = static_cast<float>(z[i] / std::sqrt(squares));
  return out;
}

constexpr std::size_t batch = 64;  ///< words drawn at once

}  // namespace

void fill_normals(const Stream& random, std::uint32_t block, std::span<float> out) {
  static const std::vector<float> table = make_table();
  const float* const value = table.data();
  // The sign goes in as a bit: as a choice it would be guessed wrong half of the time.
  const auto of = [value](std::uint32_t bits) {
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value[bits & (half - 1)]) | (bits & half) << 16);
  };
  std::array<std::uint32_t, batch> words;
  for (std::size_t i = 0; i < out.size(); i += 2 * batch) {
    const std::size_t count = std::min(2 * batch, out.size() - i);
    random.words(block, {words.data(), (count + 1) / 2});
    block += batch / 4;
    for (std::size_t k = 0; k + 1 < count; k += 2) {
      out[i + k] = of(words[k / 2] & 0xffff);
      out[i + k + 1] = of(words[k / 2] >> 16);
    }
    if (count % 2 == 1) out[i + count - 1] = of(words[count / 2] & 0xffff);
  }
}

void fill_uniforms(const Stream& random, std::uint32_t block, std::span<float> out) {
  std::array<std::uint32_t, batch> words;
  for (std::size_t i = 0; i < out.size(); i += batch) {
    const std::size_t count = std::min(batch, out.size() - i);
    random.words(block, {words.data(), count});
    block += batch / 4;
    for (std::size_t k = 0; k < count; ++k) out[i + k] = static_cast<float>(words[k] >> 8) * 0x1p-24F;
  }
}

}  // namespace sandlot
