#include "navigation/maps/distance.h"

#include <algorithm>
#include <cstddef>

#include "base/check.h"
#include "navigation/maps/grid.h"

namespace sandlot::navigation {

std::vector<std::uint32_t> squared_distances(std::span<const std::uint8_t> marked, int width, int height) {
  SL_CHECK(width >= 1 && height >= 1 && width <= max_side && height <= max_side);
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  SL_CHECK(marked.size() == w * h);
  std::vector<std::uint32_t> out(w * h);
  // First pass: distance to the nearest mark in the same column; `none` is more than any that exists.
  constexpr std::uint32_t none = 1u << 20;
  for (std::size_t x = 0; x < w; ++x) out[x] = marked[x] ? 0 : none;
  for (std::size_t y = 1; y < h; ++y)
    for (std::size_t x = 0, i = y * w; x < w; ++x, ++i)
      out[i] = marked[i] ? 0 : std::min(none, out[i - w] + 1);
  for (std::size_t y = h - 1; y-- > 0;)
    for (std::size_t x = 0, i = y * w; x < w; ++x, ++i) out[i] = std::min(out[i], out[i + w] + 1);

  // Second pass: lower envelope of the parabolas (x - u)^2 + column[u]^2 of each row. Parabola k is the
  // lowest from `from[k]` to `from[k + 1] - 1`.
  std::vector<std::int64_t> column(w), apex(w), from(w);
  for (std::size_t y = 0; y < h; ++y) {
    std::uint32_t* row = out.data() + y * w;
    std::size_t count = 0;
    for (std::size_t x = 0; x < w; ++x) {
      column[x] = row[x];
      if (row[x] >= none) continue;
      const auto u = static_cast<std::int64_t>(x);
      std::int64_t start = 0;
      while (count > 0) {
        // Parabola u is at most as high as the last one, v, from this column on (rounded up).
        const std::int64_t v = apex[count - 1], g = column[x], gv = column[static_cast<std::size_t>(v)];
        const std::int64_t top = u * u - v * v + g * g - gv * gv, below = 2 * (u - v);
        start = top <= 0 ? 0 : (top + below - 1) / below;
        if (start > from[count - 1]) break;
        --count;
        start = 0;
      }
      if (start >= static_cast<std::int64_t>(w)) continue;
      apex[count] = u;
      from[count] = start;
      ++count;
    }
    if (count == 0) {
      std::fill(row, row + w, no_distance);
      continue;
    }
    for (std::size_t x = w, k = count - 1; x-- > 0;) {
      while (k > 0 && from[k] > static_cast<std::int64_t>(x)) --k;
      const std::int64_t off = static_cast<std::int64_t>(x) - apex[k],
                         g = column[static_cast<std::size_t>(apex[k])];
      row[x] = static_cast<std::uint32_t>(off * off + g * g);
    }
  }
  return out;
}

}  // namespace sandlot::navigation
