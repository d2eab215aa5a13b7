#pragma once
/// Raster images: PNG and JPEG, grey or colour.
///
/// Output   rows from the top, pixels from the left, channels grey | grey alpha | red green blue | red green blue alpha.
///          PNG: palettes become colours, 1 2 4 bit grey becomes 8 bit, 16 bit stays. JPEG: grey or RGB, 8 bit.
/// Limits   sizes are judged before anything is decoded; no colour management (gamma, profiles), no CMYK, no animation.
/// Errors   not an image, too large, truncated, damaged: one error. What a JPEG decoder would patch up is an error too.
/// Cost     the decoded image once, and libpng's or libjpeg's rows.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "geometry/height_grid.h"
#include "geometry/vec3.h"

namespace sandlot::assets {

struct Image {
  int width = 0, height = 0;
  int channels = 0;                 ///< 1 to 4
  int bits = 8;                     ///< 8 or 16 per channel
  std::vector<std::uint16_t> data;  ///< width * height * channels, whatever `bits` says

  std::uint16_t at(int x, int y, int channel) const {
    const auto w = static_cast<std::size_t>(width), c = static_cast<std::size_t>(channels);
    return data[(static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)) * c +
                static_cast<std::size_t>(channel)];
  }
};

struct ImageLimits {
  std::size_t max_bytes = std::size_t{128} << 20;  ///< of the file
  int max_side = 8192;                             ///< pixels
};

Result<Image> read_image(const std::string& path, const ImageLimits& limits = {});
/// From memory; `file` is for messages. The first bytes tell the format.
Result<Image> parse_image(std::string_view bytes, const std::string& file, const ImageLimits& limits = {});

/// A heightmap as SDF has it: the first channel of an image, black at the bottom.
///
/// Frame    the image's middle lies at `pos_m`; its upper edge is +y, its right edge +x.
/// Heights  pixel / brightest pixel of the image * size z, as Gazebo has it: something always reaches size z (an image
///          that is black all over is flat, at 0).
/// Limits   2 x 2 to 4097 x 4097 pixels. `pos_m` moves up and down only; Gazebo's sideways shift is a warning.
/// Errors   as of images; a size that is not positive; a digital elevation model (.tif, .dem, ...): how to convert it.
Result<HeightGrid> read_heightmap(const std::string& path, Vec3 size_m, Vec3 pos_m, Diagnostics& diagnostics);
Result<HeightGrid> heightmap_of(const Image& image, const std::string& file, Vec3 size_m, Vec3 pos_m,
                                Diagnostics& diagnostics);

}  // namespace sandlot::assets
