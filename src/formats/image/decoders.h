#pragma once
/// The decoders behind parse_image(). Not for use outside this folder.
#include "formats/image/image.h"

namespace sandlot::formats::image {

/// What a decoder says of a file: "" when all is well.
std::string decode_png(std::string_view bytes, const ImageLimits& limits, Image& out);
std::string decode_jpeg(std::string_view bytes, const ImageLimits& limits, Image& out);

/// "" when an image of this size is allowed.
std::string judge_size(std::uint64_t width, std::uint64_t height, const ImageLimits& limits);

}  // namespace sandlot::formats::image
