#pragma once
/// Colour classes of objects, and the table that sorts pixels into them.
///
/// A range is a box in hue, saturation and value (Smith's HSV, 1978): hue stays what it is when the light
/// changes, so its range is narrow, and those of the other two are wide. A table of 32 x 32 x 32 cells
/// answers for a pixel in one look, as robots of soccer have done it since Bruce, Balch and Veloso, Fast and
/// inexpensive color image segmentation (IROS 2000).
///
/// Limits   a cell is 8 of 256 levels wide in each channel: ranges are no sharper than that.
#include <cstdint>
#include <span>
#include <vector>

#include "base/fields.h"

namespace sandlot::perception {

struct Hsv {
  double hue_rad = 0;  ///< from 0 (red) over 2 pi / 3 (green) to 2 pi; 0 for greys
  double saturation = 0, value = 0;
};
Hsv hsv_of(double r, double g, double b);  ///< of channels from 0 to 1

struct ColourRange {
  double hue_rad = 0.35, hue_tolerance_rad = 0.25;
  double min_saturation = 0.45, max_saturation = 1;
  double min_value = 0.15, max_value = 1;

  bool holds(const Hsv& colour) const;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"hue", "rad", "Hue of the colour: 0 red, 120 deg green, 240 deg blue.", -10, 10}, s.hue_rad);
    visit(Field{"hue_tolerance", "rad", "Largest difference from the hue; 180 deg: any.", 0, 4},
          s.hue_tolerance_rad);
    visit(Field{"min_saturation", "1", "Smallest saturation.", 0, 1}, s.min_saturation);
    visit(Field{"max_saturation", "1", "Largest saturation.", 0, 1}, s.max_saturation);
    visit(Field{"min_value", "1", "Smallest brightness.", 0, 1}, s.min_value);
    visit(Field{"max_value", "1", "Largest brightness.", 0, 1}, s.max_value);
  }
};

/// Whites, greys and blacks have no hue worth the name: a saturation below 0.25.
bool has_hue(const Hsv& colour);
/// The range around a colour of a thing as its maker declares it, in whatever light; what has no hue gets a
/// range of values instead.
ColourRange range_around(double r, double g, double b);

class ColourTable {
 public:
  ColourTable() = default;
  /// @pre at most 255 ranges. Of several that hold a colour the first counts.
  explicit ColourTable(std::span<const ColourRange> ranges);
  /// 0: none of them; else the index of the range + 1. @pre made from ranges
  std::uint8_t of(std::uint8_t r, std::uint8_t g, std::uint8_t b) const {
    return cells_[static_cast<std::size_t>(r >> 3 << 10 | g >> 3 << 5 | b >> 3)];
  }

 private:
  std::vector<std::uint8_t> cells_;
};

}  // namespace sandlot::perception
