#pragma once
/// Images as people look at them: colours as they are, distances and labels by colours that tell them apart.
///
/// Distances  from yellow (the nearest in the image) to dark blue (the farthest), by their logarithm; black: nothing there.
/// Labels     0 is black, every other number has a colour of its own, the same in every image.
/// Errors     of messages: an encoding that is none of rgb8, bgr8, rgba8, bgra8, mono8, 8UC1, mono16, 16UC1, 32FC1; sizes that do
///            not fit the data; a file that cannot be decoded.
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "messages/sensor_images.h"

namespace sandlot::assets {

/// Rows from the top, red green blue.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// 16UC1 are millimetres, 32FC1 metres, as ROS has depth images. mono16: the upper eight bits.
Result<Picture> visible(const msg::Image& image);
Result<Picture> visible(const msg::CompressedImage& image);

/// Three bytes for each distance [m]; infinite, 0 and NaN are nothing.
std::vector<std::uint8_t> distance_colours(std::span<const float> distances_m);
std::vector<std::uint8_t> label_colours(std::span<const std::uint32_t> labels);

/// The same picture, so small that neither side is larger than `side`: means of whole pixels.
Picture shrunk(const Picture& picture, int side);

}  // namespace sandlot::assets
