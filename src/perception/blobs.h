#pragma once
/// Connected patches of one colour in an image.
///
/// Rows are cut into runs of one colour, runs that touch (diagonals count) are united. Specks of noise are
/// bridged: up to `gap` other pixels within a row, and as many rows, do not part a patch.
///
/// Pixels   (column, row) from the upper left.
/// Errors   image_view() refuses images whose sizes, step and data disagree, and encodings other than rgb8
///          and bgr8.
/// Cost     one look into a table per pixel; memory of at most 12 bytes per pixel, kept for the next image.
/// Source   J. Bruce, T. Balch, M. Veloso, Fast and inexpensive color image segmentation for interactive
///          robots (2000).
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "messages/sensor_images.h"
#include "perception/colour.h"

namespace sandlot::perception {

/// Pixels of somebody else. @pre data.size() >= step * (height - 1) + 3 * width, step >= 3 * width
struct ImageView {
  int width = 0, height = 0;
  std::size_t step = 0;  ///< bytes from row to row
  bool bgr = false;
  std::span<const std::uint8_t> data;
};
/// At most 8192 pixels a side.
Result<ImageView> image_view(const msg::Image& image);

struct Run {
  std::uint16_t row, begin, end;  ///< columns [begin, end)
  std::uint8_t colour;            ///< index of the range + 1
  std::uint32_t blob;             ///< index into blobs(); no_blob for those too small
};
inline constexpr std::uint32_t no_blob = ~0u;

struct Blob {
  std::uint8_t colour = 0;                       ///< index of the range
  std::uint32_t pixels = 0;                      ///< of its colour
  int left = 0, top = 0, right = 0, bottom = 0;  ///< first and last column and row
  double u = 0, v = 0;                           ///< middle of its pixels
};

class BlobFinder {
 public:
  /// Finds all patches of at least min_pixels, in the order of their first rows.
  void find(const ImageView& image, const ColourTable& colours, int gap, int min_pixels);
  std::span<const Blob> blobs() const { return blobs_; }
  std::span<const Run> runs() const { return runs_; }

 private:
  std::uint32_t root(std::uint32_t run);
  std::vector<Run> runs_;
  std::vector<std::size_t> row_begin_;
  std::vector<Blob> blobs_;
  std::vector<std::uint32_t> blob_of_root_;
};

}  // namespace sandlot::perception
