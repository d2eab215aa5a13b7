/// Any bytes: parse_image answers with as many samples as it promises or with one error; the heights are in range.
#include "assets/image/image.h"
#include "base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto image = assets::parse_image(bytes, "/nowhere/fuzz.png", {.max_bytes = 1 << 16, .max_side = 512});
  if (!image) {
    SL_CHECK(!image.error().what.empty() && image.error().place.file);
    return 0;
  }
  SL_CHECK(image->width > 0 && image->width <= 512 && image->height > 0 && image->height <= 512);
  SL_CHECK(image->channels >= 1 && image->channels <= 4 && (image->bits == 8 || image->bits == 16));
  SL_CHECK(image->data.size() == static_cast<std::size_t>(image->width * image->height * image->channels));
  Diagnostics diagnostics;
  const auto grid = assets::heightmap_of(*image, "/nowhere/fuzz.png", {10, 20, 3}, {0, 0, 1}, diagnostics);
  SL_CHECK(bool(grid) == (image->width > 1 && image->height > 1));
  if (grid)
    for (const float z : grid->height_m) SL_CHECK(z >= 1 && z <= 4);
  return 0;
}
