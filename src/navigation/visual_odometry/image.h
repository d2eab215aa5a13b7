#pragma once
/// Grey images of visual odometry: a view of the caller's pixels, and a copy with padded rows.
///
/// Pixels   (u, v) = (column, row); integers are the centres of pixels, (0, 0) is that of the upper left one.
/// Limits   32 to 4096 pixels a side. 8 bits; others are converted by the caller.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/fields.h"
#include "base/result.h"

namespace sandlot::navigation::vo {

inline constexpr int least_side_px = 32, greatest_side_px = 4096;

/// View of an image of 8 bits per pixel, rows from the top.
struct GreyImage {
  std::span<const std::uint8_t> pixels;
  int width = 0, height = 0;
  int stride = 0;  ///< bytes from one row to the next
};

/// The error names what does not fit: sides out of the limits, a stride below the width, too few bytes.
Status check(const GreyImage& image);

/// Image whose rows are padded with zeros, so that loads of 32 pixels from anywhere in a row stay inside.
struct PaddedImage {
  int width = 0, height = 0, stride = 0;
  std::vector<std::uint8_t> pixels;

  const std::uint8_t* row(int v) const {
    return pixels.data() + static_cast<std::ptrdiff_t>(v) * static_cast<std::ptrdiff_t>(stride);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"width", "1", "Number of columns.", 0, greatest_side_px}, s.width);
    visit(Field{"height", "1", "Number of rows.", 0, greatest_side_px}, s.height);
    visit(Field{"stride", "1", "Number of bytes per row.", 0, 2 * greatest_side_px}, s.stride);
    visit(Field{"pixels", "1", "Grey values.", 0, 255, Field::none, 1 << 26}, s.pixels);
  }
};

/// @pre  check(image) succeeds
PaddedImage padded(const GreyImage& image);
/// Mean of each two by two pixels, rounded. An odd last column or row is dropped. Pixel (u, v) lies at (2u + 0.5, 2v + 0.5).
/// @pre  both sides are 2 at least
PaddedImage halved(const PaddedImage& image);
/// Mean of each three by three pixels with weights 1 2 1 along both, rounded; pixels at the edges stay as they are. Takes away the
/// finest detail, of which bilinear interpolation makes errors.
PaddedImage smoothed(const PaddedImage& image);
/// Whether the number of pixels fits the sides. False for an image from a damaged snapshot, and for an empty one.
bool sound(const PaddedImage& image);

}  // namespace sandlot::navigation::vo
