#include "optics/texture.h"

#include <algorithm>
#include <array>

#include "base/check.h"

namespace sandlot::optics {
namespace {

using Channels = std::array<std::uint32_t, 3>;

Channels split(std::uint32_t texel) { return {texel & 255, texel >> 8 & 255, texel >> 16 & 255}; }
std::uint32_t join_texels(Channels c) { return c[0] | c[1] << 8 | c[2] << 16; }

/// Place of texel `i` of a row of (n + 1) / 2 in a row of n, in units of 1 / (2 * wide) of a texel: three
/// weights that add up to 2 n. An even row has two texels with equal weight; an odd one shares every second
/// between neighbours.
struct Footprint {
  std::uint32_t first;
  std::array<std::uint32_t, 3> weight;
};
Footprint texture_footprint(std::uint32_t i, std::uint32_t n) {
  if (n == 1) return {0, {1, 0, 0}};
  if (n % 2 == 0) return {2 * i, {1, 1, 0}};
  // Texel i covers [i n, (i + 1) n) / half of the row, half = (n + 1) / 2.
  const std::uint32_t half = (n + 1) / 2, begin = i * n, end = begin + n, first = begin / half;
  Footprint f{first, {}};
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t low = std::max(begin, (first + k) * half),
                        high = std::min(end, (first + k + 1) * half);
    f.weight[k] = high > low ? high - low : 0;
  }
  return f;
}

/// While the pyramid is built: one colour all over the texel.
constexpr std::uint32_t even = 1u << 24, plain_texture = 1u << 24;

/// The level with its further column and row, and `plain` where neighbours agree.
void append(const std::vector<std::uint32_t>& level, std::uint32_t width, std::uint32_t height,
            std::vector<std::uint32_t>& texels) {
  const auto at = [&](std::uint32_t x, std::uint32_t y) {
    return level[std::size_t{y % height} * width + x % width];
  };
  for (std::uint32_t y = 0; y <= height; ++y)
    for (std::uint32_t x = 0; x <= width; ++x) {
      const std::uint32_t texel = at(x, y);
      bool same = (texel & even) != 0;
      for (std::uint32_t j = 0; same && j < 3; ++j)
        for (std::uint32_t i = 0; same && i < 3; ++i)
          same = at(x + width + i - 1, y + height + j - 1) == texel;
      texels.push_back((texel & 0xffffff) | (same ? plain_texture : 0));
    }
}

}  // namespace

std::shared_ptr<const Texture> Texture::make(int width, int height, std::span<const std::uint8_t> rgb) {
  SL_CHECK(width >= 1 && height >= 1 && width <= 8192 && height <= 8192);
  const auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
  SL_CHECK(rgb.size() == std::size_t{w} * h * 3);
  const auto texture = std::make_shared<Texture>();
  std::vector<std::uint32_t> fine(std::size_t{w} * h), coarse;
  for (std::size_t i = 0; i < fine.size(); ++i)
    fine[i] = join_texels({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}) | even;
  for (Level level{w, h, 0};;) {
    level.first = static_cast<std::uint32_t>(texture->texels_.size());
    texture->levels_.push_back(level);
    append(fine, level.width, level.height, texture->texels_);
    if (level.width == 1 && level.height == 1) break;
    const Level next{(level.width + 1) / 2, (level.height + 1) / 2, 0};
    coarse.clear();
    for (std::uint32_t y = 0; y < next.height; ++y) {
      const Footprint down = texture_footprint(y, level.height);
      for (std::uint32_t x = 0; x < next.width; ++x) {
        const Footprint right = texture_footprint(x, level.width);
        std::array<std::uint64_t, 3> sum{};
        std::uint64_t weights = 0;
        std::uint32_t all = 0xffffffff, first = 0;  // of the texels below: what they have in common
        for (std::uint32_t j = 0; j < 3; ++j)
          for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint64_t weight = std::uint64_t{down.weight[j]} * right.weight[i];
            if (weight == 0) continue;
            const std::uint32_t texel = fine[std::size_t{down.first + j} * level.width + right.first + i];
            if (weights == 0) first = texel;
            all &= ~(texel ^ first);
            const Channels c = split(texel);
            for (std::size_t k = 0; k < 3; ++k) sum[k] += weight * c[k];
            weights += weight;
          }
        Channels mean;
        for (std::size_t k = 0; k < 3; ++k)
          mean[k] = static_cast<std::uint32_t>((sum[k] + weights / 2) / weights);
        const bool same = all == 0xffffffff && (first & even);
        coarse.push_back(join_texels(mean) | (same ? even : 0));
      }
    }
    fine.swap(coarse);
    level = next;
  }
  // Two texels are read at once: the last one has a neighbour in memory, too.
  texture->texels_.push_back(0);
  return texture;
}

std::shared_ptr<const Texture> Texture::missing() {
  static const std::shared_ptr<const Texture> checker = [] {
    constexpr int side = 64, square = 8;
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const std::uint8_t on = (x / square + y / square) % 2 == 0 ? 255 : 0;
        rgb.insert(rgb.end(), {on, 0, on});
      }
    return make(side, side, rgb);
  }();
  return checker;
}

}  // namespace sandlot::optics
