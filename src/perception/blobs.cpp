#include "perception/blobs.h"

#include <algorithm>

namespace sandlot::perception {

Result<ImageView> image_view(const msg::Image& image) {
  constexpr std::uint32_t max_side = 8192;
  if (image.encoding != "rgb8" && image.encoding != "bgr8")
    return Error{"an image with the encoding '" + image.encoding.substr(0, 40) + "'",
                 "colours are found in rgb8 and bgr8"};
  if (image.width < 1 || image.height < 1 || image.width > max_side || image.height > max_side)
    return Error{
        "an image of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels",
        "1 to 8192 a side"};
  const std::size_t row = std::size_t{3} * image.width, step = image.step;
  if (step < row || image.data.size() < step * (image.height - 1) + row)
    return Error{"an image with fewer bytes than its pixels need"};
  return ImageView{static_cast<int>(image.width), static_cast<int>(image.height), step,
                   image.encoding == "bgr8", image.data};
}

std::uint32_t BlobFinder::root(std::uint32_t run) {
  // While the union is made, Run::blob is the parent; halving paths keeps them short.
  while (runs_[run].blob != run) {
    runs_[run].blob = runs_[runs_[run].blob].blob;
    run = runs_[run].blob;
  }
  return run;
}

void BlobFinder::find(const ImageView& image, const ColourTable& colours, int gap, int min_pixels) {
  runs_.clear();
  blobs_.clear();
  row_begin_.clear();
  for (int row = 0; row < image.height; ++row) {
    row_begin_.push_back(runs_.size());
    const std::uint8_t* const pixels = image.data.data() + static_cast<std::size_t>(row) * image.step;
    const int red = image.bgr ? 2 : 0;
    std::uint8_t now = 0;
    for (int column = 0; column < image.width; ++column) {
      const std::uint8_t* const p = pixels + 3 * column;
      const std::uint8_t colour = colours.of(p[red], p[1], p[2 - red]);
      if (colour != 0 && colour == now) ++runs_.back().end;
      else if (colour != 0)
        runs_.push_back({static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column),
                         static_cast<std::uint16_t>(column + 1), colour,
                         static_cast<std::uint32_t>(runs_.size())});
      now = colour;
    }
  }
  row_begin_.push_back(runs_.size());

  // A run is united with the ones before it: in its own row across a gap, and in the rows above within reach.
  // Earlier runs become the roots, so that the order of patches is that of their first runs.
  const auto unite = [&](std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    if (a != b) runs_[std::max(a, b)].blob = std::min(a, b);
  };
  const auto rows = static_cast<std::size_t>(image.height);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t begin = row_begin_[row], end = row_begin_[row + 1];
    for (std::size_t i = begin + 1; i < end; ++i)
      for (std::size_t k = i; k-- > begin && runs_[i].begin - runs_[k].end <= gap;)
        if (runs_[k].colour == runs_[i].colour)
          unite(static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(i));
    for (std::size_t up = 1; up <= static_cast<std::size_t>(gap) + 1 && up <= row; ++up) {
      std::size_t k = row_begin_[row - up];
      const std::size_t above_end = row_begin_[row - up + 1];
      for (std::size_t i = begin; i < end; ++i) {
        while (k < above_end && runs_[k].end < runs_[i].begin) ++k;
        for (std::size_t j = k; j < above_end && runs_[j].begin <= runs_[i].end; ++j)
          if (runs_[j].colour == runs_[i].colour)
            unite(static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(i));
      }
    }
  }

  blob_of_root_.assign(runs_.size(), no_blob);
  for (std::uint32_t i = 0; i < runs_.size(); ++i) {
    const Run& run = runs_[i];
    std::uint32_t& index = blob_of_root_[root(i)];
    if (index == no_blob) {
      index = static_cast<std::uint32_t>(blobs_.size());
      blobs_.push_back(
          {static_cast<std::uint8_t>(run.colour - 1), 0, run.begin, run.row, run.begin, run.row, 0, 0});
    }
    Blob& blob = blobs_[index];
    const int pixels = run.end - run.begin;
    blob.pixels += static_cast<std::uint32_t>(pixels);
    blob.u += 0.5 * pixels * (run.begin + run.end - 1);
    blob.v += static_cast<double>(pixels) * run.row;
    blob.left = std::min<int>(blob.left, run.begin);
    blob.right = std::max<int>(blob.right, run.end - 1);
    blob.bottom = run.row;
  }
  // Small ones leave; what stays gets its place in the shorter list.
  std::vector<std::uint32_t>& place = blob_of_root_;
  for (std::uint32_t i = 0; i < runs_.size(); ++i) runs_[i].blob = root(i);
  for (Run& run : runs_) run.blob = place[run.blob];
  place.assign(blobs_.size(), no_blob);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < blobs_.size(); ++i) {
    if (blobs_[i].pixels < static_cast<std::uint32_t>(std::max(1, min_pixels))) continue;
    place[i] = kept;
    blobs_[kept] = blobs_[i];
    blobs_[kept].u /= blobs_[kept].pixels;
    blobs_[kept].v /= blobs_[kept].pixels;
    ++kept;
  }
  blobs_.resize(kept);
  for (Run& run : runs_) run.blob = place[run.blob];
}

}  // namespace sandlot::perception
