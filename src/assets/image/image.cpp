#include "assets/image/image.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "assets/image/decoders.h"
#include "files/text.h"

namespace sandlot::assets {

namespace image {

std::string judge_size(std::uint64_t width, std::uint64_t height, const ImageLimits& limits) {
  const auto side = static_cast<std::uint64_t>(limits.max_side);
  if (width == 0 || height == 0) return "has no pixels";
  if (width <= side && height <= side) return "";
  return "is too large: " + std::to_string(width) + " x " + std::to_string(height) + " pixels, at most " +
         std::to_string(side) + " x " + std::to_string(side) + " are read";
}

}  // namespace image

namespace {

constexpr int max_heightmap_side = 4097;

}  // namespace

Result<Image> parse_image(std::string_view bytes, const std::string& file, const ImageLimits& limits) {
  Image out;
  std::string problem;
  if (bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n") problem = image::decode_png(bytes, limits, out);
  else if (bytes.substr(0, 3) == "\xFF\xD8\xFF") problem = image::decode_jpeg(bytes, limits, out);
  else
    return Error{bytes.empty() ? "is empty" : "is neither a PNG nor a JPEG image", "convert it to PNG",
                 place_in(file)};
  if (!problem.empty()) return Error{problem, "", place_in(file)};
  return out;
}

Result<Image> read_image(const std::string& path, const ImageLimits& limits) {
  SL_ASSIGN(const std::string bytes, read_text_file(path, limits.max_bytes));
  return parse_image(bytes, path, limits);
}

Result<HeightGrid> heightmap_of(const Image& image, const std::string& file, Vec3 size_m, Vec3 pos_m,
                                Diagnostics& diagnostics) {
  const auto refuse = [&](std::string what, std::string fix) {
    return Error{std::move(what), std::move(fix), place_in(file)};
  };
  constexpr double largest_m = 1e6;
  const auto fits = [&](double x, double low) { return x > low && x <= largest_m; };
  if (!fits(size_m.x, 0) || !fits(size_m.y, 0) || !(size_m.z >= 0 && size_m.z <= largest_m))
    return refuse("the size of a heightmap is three lengths", "x and y above 0, z not below, at most 1e6 m");
  if (!is_finite(pos_m) || !fits(pos_m.z, -largest_m))
    return refuse("the position of a heightmap is three lengths", "at most 1e6 m");
  if (image.width < 2 || image.height < 2)
    return refuse("has " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels",
                  "a heightmap has 2 x 2 or more");
  if (pos_m.x != 0 || pos_m.y != 0)
    diagnostics.warn(refuse("the heightmap is not moved sideways by its position", "use the pose around it"));
  HeightGrid out;
  out.columns = image.width, out.rows = image.height;
  out.size_x_m = size_m.x, out.size_y_m = size_m.y;
  out.source = file;
  out.source_height_m = size_m.z;
  int brightest = 1;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) brightest = std::max(brightest, int{image.at(x, y, 0)});
  out.height_m.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row)
    for (int x = 0; x < image.width; ++x)
      out.height_m.push_back(
          static_cast<float>(pos_m.z + size_m.z * image.at(x, image.height - 1 - row, 0) / brightest));
  return out;
}

Result<HeightGrid> read_heightmap(const std::string& path, Vec3 size_m, Vec3 pos_m,
                                  Diagnostics& diagnostics) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* const elevation : {".tif", ".tiff", ".dem", ".hgt", ".asc", ".nc", ".vrt"})
    if (extension == elevation)
      return Error{
          "digital elevation models are not read",
          "convert it: gdal_translate -of PNG -ot UInt16 -scale IN.tif OUT.png; the <size> z is then the "
          "highest minus the lowest elevation",
          place_in(path)};
  SL_ASSIGN(const Image image, read_image(path, {.max_side = max_heightmap_side}));
  return heightmap_of(image, path, size_m, pos_m, diagnostics);
}

}  // namespace sandlot::assets
