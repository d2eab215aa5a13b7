#include "images.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace robios::images {
namespace {

/// `value(p)` of each inner pixel p; `in` and `out` may be the same.
template <class Value>
void filter(const Byte* in, Byte* out, int width, int height, Value value) {
  if (width < 1 || height < 1) return;
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  std::vector<Byte> copy;
  if (in == out) {
    copy.assign(in, in + w * h);
    in = copy.data();
  }
  for (std::size_t y = 0; y < h; y++) {
    for (std::size_t x = 0; x < w; x++) {
      const bool edge = x == 0 || y == 0 || x + 1 == w || y + 1 == h;
      out[y * w + x] = edge ? Byte{0} : static_cast<Byte>(std::min(value(in + y * w + x), 255));
    }
  }
}

}  // namespace

void laplace(const Byte* in, Byte* out, int width, int height) {
  const std::ptrdiff_t w = width;
  filter(in, out, width, height,
         [=](const Byte* p) { return std::abs(4 * p[0] - p[-1] - p[1] - p[-w] - p[w]); });
}

void sobel(const Byte* in, Byte* out, int width, int height) {
  const std::ptrdiff_t w = width;
  filter(in, out, width, height, [=](const Byte* p) {
    const int dx = p[1 - w] + 2 * p[1] + p[1 + w] - p[-1 - w] - 2 * p[-1] - p[w - 1];
    const int dy = p[w - 1] + 2 * p[w] + p[w + 1] - p[-w - 1] - 2 * p[-w] - p[1 - w];
    return std::abs(dx) + std::abs(dy);
  });
}

void gray(const Byte* rgb, Byte* out, std::size_t pixels) {
  for (std::size_t i = 0; i < pixels; i++)
    out[i] = static_cast<Byte>((rgb[3 * i] + rgb[3 * i + 1] + rgb[3 * i + 2]) / 3);
}

Hsi hsi(Byte r, Byte g, Byte b) {
  const int high = std::max({r, g, b}), low = std::min({r, g, b}), range = high - low;
  const int sum = r + g + b;
  Hsi result{0, 0, static_cast<Byte>(sum / 3)};
  if (range == 0) return result;
  result.saturation = static_cast<Byte>(255 - 255 * 3 * low / sum);
  // Sixths of the circle, from red over green to blue.
  const double sixths = high == r   ? static_cast<double>(g - b) / range
                        : high == g ? 2 + static_cast<double>(b - r) / range
                                    : 4 + static_cast<double>(r - g) / range;
  result.hue = static_cast<Byte>(std::lround((sixths < 0 ? sixths + 6 : sixths) / 6 * 256) & 255);
  return result;
}

}  // namespace robios::images
