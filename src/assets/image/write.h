#pragma once
/// Raster images as files' bytes: PNG and JPEG from what is in memory.
///
/// Output   the same bytes for the same pixels and library version; no time stamps.
/// Cost     PNG at its fastest compression: about 25 ns per RGB pixel; JPEG about 5 ns.
#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"

namespace sandlot::assets {

/// Rows from the top, channels interleaved: 1 grey, 3 red green blue; PNG also 2 and 4 with alpha last.
struct Pixels8 {
  int width = 0, height = 0, channels = 3;
  std::span<const std::uint8_t> data;  ///< width * height * channels
};
struct Pixels16 {
  int width = 0, height = 0, channels = 1;
  std::span<const std::uint16_t> data;
};

/// @pre sizes are positive and `data` has them
std::string png_of(const Pixels8& pixels);
std::string png_of(const Pixels16& pixels);
/// @param quality  1 to 100. Colours are halved in resolution (4:2:0) below 90. @pre 1 or 3 channels
std::string jpeg_of(const Pixels8& pixels, int quality = 90);

Status write_png(const std::string& path, const Pixels8& pixels);
Status write_png(const std::string& path, const Pixels16& pixels);
Status write_jpeg(const std::string& path, const Pixels8& pixels, int quality = 90);

}  // namespace sandlot::assets
