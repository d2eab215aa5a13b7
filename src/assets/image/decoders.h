#pragma once
/// The decoders behind parse_image(). Not for use outside this folder.
#include "assets/image/image.h"

namespace sandlot::assets::image {

/// What a decoder says of a file: "" when all is well.
std::string decode_png(std::string_view bytes, const ImageLimits& limits, Image& out);
std::string decode_jpeg(std::string_view bytes, const ImageLimits& limits, Image& out);

/// "" when an image of this size is allowed.
std::string judge_size(std::uint64_t width, std::uint64_t height, const ImageLimits& limits);

}  // namespace sandlot::assets::image
