#pragma once
/// Bitmap font of the screens: ASCII 32 to 126 in 5 x 8 pixels, the last row for descenders; drawn for Sandlot.
#include <cstdint>

namespace robios {

inline constexpr int glyph_width = 5, glyph_height = 8;

/// Whether the character has ink there; a box for characters that the font has not.
bool ink(char character, int x, int y);

}  // namespace robios
