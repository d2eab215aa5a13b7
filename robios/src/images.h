#pragma once
/// Image processing of both generations: pictures row by row, grey or red green blue.
#include <cstddef>
#include <cstdint>

namespace robios::images {

using Byte = std::uint8_t;

void laplace(const Byte* in, Byte* out, int width, int height);  ///< 0 along the edge
void sobel(const Byte* in, Byte* out, int width, int height);    ///< 0 along the edge
void gray(const Byte* rgb, Byte* out, std::size_t pixels);
struct Hsi {
  Byte hue, saturation, intensity;
};
Hsi hsi(Byte r, Byte g, Byte b);

}  // namespace robios::images
