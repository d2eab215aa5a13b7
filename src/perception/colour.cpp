#include "perception/colour.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/math.h"

namespace sandlot::perception {

Hsv hsv_of(double r, double g, double b) {
  const double most = std::max({r, g, b}), least = std::min({r, g, b}), span = most - least;
  Hsv out{0, most > 0 ? span / most : 0, most};
  if (!(span > 0)) return out;
  const double sixth = math::pi / 3;
  if (most == r) out.hue_rad = sixth * (g - b) / span;
  else if (most == g) out.hue_rad = sixth * (2 + (b - r) / span);
  else out.hue_rad = sixth * (4 + (r - g) / span);
  if (out.hue_rad < 0) out.hue_rad += 2 * math::pi;
  return out;
}

bool ColourRange::holds(const Hsv& colour) const {
  if (colour.saturation < min_saturation || colour.saturation > max_saturation || colour.value < min_value ||
      colour.value > max_value)
    return false;
  double off = std::abs(colour.hue_rad - hue_rad);
  while (off > 2 * math::pi) off -= 2 * math::pi;
  return std::min(off, 2 * math::pi - off) <= hue_tolerance_rad;
}

bool has_hue(const Hsv& colour) { return colour.saturation >= 0.25; }

ColourRange range_around(double r, double g, double b) {
  const Hsv colour = hsv_of(r, g, b);
  ColourRange range;
  if (has_hue(colour)) {
    // Light from the side takes value, highlights take saturation.
    range.hue_rad = colour.hue_rad;
    range.min_saturation = 0.6 * colour.saturation;
    range.min_value = std::min(0.15, 0.5 * colour.value);
    return range;
  }
  range.hue_tolerance_rad = 4;
  range.min_saturation = 0;
  range.max_saturation = 0.3;
  range.min_value = colour.value < 0.25 ? 0 : 0.6 * colour.value;
  range.max_value = colour.value < 0.25 ? 0.3 : 1;
  return range;
}

ColourTable::ColourTable(std::span<const ColourRange> ranges) : cells_(32 * 32 * 32) {
  SL_CHECK(ranges.size() <= 255);
  const auto middle = [](std::size_t cell) { return (static_cast<double>(cell) * 8 + 3.5) / 255; };
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Hsv colour = hsv_of(middle(i >> 10), middle(i >> 5 & 31), middle(i & 31));
    for (std::size_t k = 0; k < ranges.size() && cells_[i] == 0; ++k)
      if (ranges[k].holds(colour)) cells_[i] = static_cast<std::uint8_t>(k + 1);
  }
}

}  // namespace sandlot::perception
