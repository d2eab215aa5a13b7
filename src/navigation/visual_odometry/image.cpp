#include "navigation/visual_odometry/image.h"

#include <algorithm>
#include <string>

namespace sandlot::navigation::vo {
namespace {

constexpr int image_lanes = 32;

PaddedImage image_of_size(int width, int height) {
  PaddedImage out;
  out.width = width;
  out.height = height;
  out.stride = (width + image_lanes - 1) / image_lanes * image_lanes + image_lanes;
  out.pixels.resize(static_cast<std::size_t>(out.stride) * static_cast<std::size_t>(height));
  return out;
}

// With inner loops of constant length, which gcc 12 at -O2 vectorises.
void image_sum_rows(const std::uint8_t* __restrict upper, const std::uint8_t* __restrict middle,
                    const std::uint8_t* __restrict lower, std::uint16_t* __restrict sum, int length) {
  for (int at = 0; at < length; at += image_lanes)
    for (int i = 0; i < image_lanes; ++i)
      sum[at + i] = static_cast<std::uint16_t>(upper[at + i] + 2 * middle[at + i] + lower[at + i]);
}
void image_sum_columns(const std::uint16_t* __restrict sum, std::uint8_t* __restrict out, int count) {
  const auto mean = [&](int u) {
    return static_cast<std::uint8_t>((sum[u] + 2 * sum[u + 1] + sum[u + 2] + 8) / 16);
  };
  int at = 0;
  for (; at + image_lanes <= count; at += image_lanes)
    for (int i = 0; i < image_lanes; ++i) out[at + i] = mean(at + i);
  for (; at < count; ++at) out[at] = mean(at);
}

}  // namespace

Status check(const GreyImage& image) {
  const auto side = [](int n) { return n >= least_side_px && n <= greatest_side_px; };
  if (!side(image.width) || !side(image.height))
    return Error{
        "the image has " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels",
        "each side must lie in [" + std::to_string(least_side_px) + ", " + std::to_string(greatest_side_px) +
            "]"};
  if (image.stride < image.width)
    return Error{"the image's rows are " + std::to_string(image.stride) + " bytes apart",
                 "at least its width, " + std::to_string(image.width)};
  const std::size_t needed = static_cast<std::size_t>(image.stride) *
                                 static_cast<std::size_t>(image.height - 1) +
                             static_cast<std::size_t>(image.width);
  if (image.pixels.size() < needed)
    return Error{"the image has " + std::to_string(image.pixels.size()) + " bytes",
                 "its sides and stride need " + std::to_string(needed)};
  return {};
}

PaddedImage padded(const GreyImage& image) {
  PaddedImage out = image_of_size(image.width, image.height);
  for (int v = 0; v < image.height; ++v)
    std::copy_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(v) * image.stride, image.width,
                out.pixels.begin() + static_cast<std::ptrdiff_t>(v) * out.stride);
  return out;
}

PaddedImage halved(const PaddedImage& image) {
  PaddedImage out = image_of_size(image.width / 2, image.height / 2);
  for (int v = 0; v < out.height; ++v) {
    const std::uint8_t *upper = image.row(2 * v), *lower = image.row(2 * v + 1);
    std::uint8_t* to = out.pixels.data() + static_cast<std::ptrdiff_t>(v) * out.stride;
    for (int u = 0; u < out.width; ++u)
      to[u] = static_cast<std::uint8_t>(
          (upper[2 * u] + upper[2 * u + 1] + lower[2 * u] + lower[2 * u + 1] + 2) / 4);
  }
  return out;
}

PaddedImage smoothed(const PaddedImage& image) {
  PaddedImage out = image;
  std::vector<std::uint16_t> column(static_cast<std::size_t>(image.stride));
  for (int v = 1; v + 1 < image.height; ++v) {
    image_sum_rows(image.row(v - 1), image.row(v), image.row(v + 1), column.data(), image.stride);
    image_sum_columns(column.data(), out.pixels.data() + static_cast<std::ptrdiff_t>(v) * out.stride + 1,
                      image.width - 2);
  }
  return out;
}

bool sound(const PaddedImage& image) {
  const auto side = [](int n) { return n >= least_side_px / 2 && n <= greatest_side_px; };
  return side(image.width) && side(image.height) && image.stride >= image.width + image_lanes &&
         image.pixels.size() ==
             static_cast<std::size_t>(image.stride) * static_cast<std::size_t>(image.height);
}

}  // namespace sandlot::navigation::vo
