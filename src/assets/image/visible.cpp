#include "assets/image/visible.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "assets/image/image.h"
#include "base/math.h"

namespace sandlot::assets {
namespace {

using Rgb = std::array<double, 3>;

void put(std::vector<std::uint8_t>& out, const Rgb& color) {
  for (const double c : color)
    out.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(c, 0.0, 1.0))));
}

/// From near (0) to far (1).
Rgb ramp(double t) {
  static constexpr std::array<Rgb, 5> stops{
      {{1, 0.95, 0.35}, {0.95, 0.45, 0.2}, {0.75, 0.15, 0.4}, {0.3, 0.1, 0.5}, {0.05, 0.05, 0.3}}};
  const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double f = at - static_cast<double>(i);
  Rgb out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = stops[i][k] * (1 - f) + stops[i + 1][k] * f;
  return out;
}

/// Hues a golden section apart: neighbouring labels look different.
Rgb label_colour(std::uint32_t label) {
  if (label == 0) return {0, 0, 0};
  const double turn = 0.618033988749895 * label;
  const double hue = 6 * (turn - std::floor(turn));
  const double value = label % 2 ? 1 : 0.7;
  const auto channel = [&](double offset) {
    const double h = hue + offset >= 6 ? hue + offset - 6 : hue + offset;
    return value * (0.25 + 0.75 * std::clamp(std::abs(h - 3) - 1, 0.0, 1.0));
  };
  return {channel(0), channel(4), channel(2)};
}

template <class T>
T read_as(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

}  // namespace

std::vector<std::uint8_t> distance_colours(std::span<const float> distances) {
  const auto there = [](float d) { return d > 0 && std::isfinite(d); };
  float near = 0, far = 0;
  for (const float d : distances) {
    if (!there(d)) continue;
    near = near > 0 ? std::min(near, d) : d;
    far = std::max(far, d);
  }
  const double low = near > 0 ? math::log(near) : 0;
  const double span = far > near ? math::log(far) - low : 1;
  std::vector<std::uint8_t> out;
  out.reserve(3 * distances.size());
  for (const float d : distances) put(out, there(d) ? ramp((math::log(d) - low) / span) : Rgb{0, 0, 0});
  return out;
}

std::vector<std::uint8_t> label_colours(std::span<const std::uint32_t> labels) {
  std::vector<std::uint8_t> out;
  out.reserve(3 * labels.size());
  for (const std::uint32_t label : labels) put(out, label_colour(label));
  return out;
}

Result<Picture> visible(const msg::Image& image) {
  struct Encoding {
    const char* name;
    std::size_t bytes;                  ///< per pixel
    std::array<std::size_t, 3> places;  ///< of red, green, blue in it
  };
  static constexpr Encoding encodings[] = {
      {"rgb8", 3, {0, 1, 2}},   {"bgr8", 3, {2, 1, 0}},  {"rgba8", 4, {0, 1, 2}},
      {"bgra8", 4, {2, 1, 0}},  {"mono8", 1, {0, 0, 0}}, {"8UC1", 1, {0, 0, 0}},
      {"mono16", 2, {1, 1, 1}}, {"16UC1", 2, {0, 0, 0}}, {"32FC1", 4, {0, 0, 0}}};
  const auto* const encoding = std::find_if(std::begin(encodings), std::end(encodings),
                                            [&](const Encoding& e) { return image.encoding == e.name; });
  if (encoding == std::end(encodings))
    return Error{"an image of the encoding '" + image.encoding + "' cannot be shown"};
  if (image.width < 1 || image.height < 1 || image.width > 8192 || image.height > 8192 ||
      image.step < image.width * encoding->bytes ||
      image.data.size() < std::size_t{image.step} * image.height)
    return Error{"the image's size does not fit its data"};
  const auto pixel = [&](std::size_t x, std::size_t y) {
    return image.data.data() + y * image.step + x * encoding->bytes;
  };
  Picture out{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  const bool metres = image.encoding == "32FC1", millimetres = image.encoding == "16UC1";
  if (metres || millimetres) {
    std::vector<float> distances;
    distances.reserve(std::size_t{image.width} * image.height);
    for (std::size_t y = 0; y < image.height; ++y)
      for (std::size_t x = 0; x < image.width; ++x)
        distances.push_back(metres ? read_as<float>(pixel(x, y))
                                   : static_cast<float>(read_as<std::uint16_t>(pixel(x, y))) * 1e-3f);
    out.rgb = distance_colours(distances);
    return out;
  }
  out.rgb.reserve(3 * std::size_t{image.width} * image.height);
  for (std::size_t y = 0; y < image.height; ++y)
    for (std::size_t x = 0; x < image.width; ++x)
      for (const std::size_t place : encoding->places) out.rgb.push_back(pixel(x, y)[place]);
  return out;
}

Result<Picture> visible(const msg::CompressedImage& message) {
  SL_ASSIGN(
      const Image image,
      parse_image({reinterpret_cast<const char*>(message.data.data()), message.data.size()}, "the image"));
  Picture out{image.width, image.height, {}};
  const auto channels = static_cast<std::size_t>(image.channels);
  const std::size_t pixels = image.data.size() / channels;
  out.rgb.reserve(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      out.rgb.push_back(
          static_cast<std::uint8_t>(image.data[i * channels + (channels < 3 ? 0 : k)] >> (image.bits - 8)));
  return out;
}

Picture shrunk(const Picture& from, int side) {
  const int factor = (std::max(from.width, from.height) + side - 1) / side;
  if (factor <= 1) return from;
  // Whole blocks; those at the right and lower edge may be cut.
  Picture out{(from.width + factor - 1) / factor, (from.height + factor - 1) / factor, {}};
  out.rgb.reserve(3 * static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const int x1 = std::min((x + 1) * factor, from.width), y1 = std::min((y + 1) * factor, from.height);
      std::array<unsigned, 3> sum{};
      unsigned count = 0;
      for (int v = y * factor; v < y1; ++v)
        for (int u = x * factor; u < x1; ++u, ++count)
          for (std::size_t k = 0; k < 3; ++k)
            sum[k] += from.rgb[3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(from.width) +
                                    static_cast<std::size_t>(u)) +
                               k];
      for (const unsigned s : sum) out.rgb.push_back(static_cast<std::uint8_t>((s + count / 2) / count));
    }
  return out;
}

}  // namespace sandlot::assets
