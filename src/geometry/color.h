#pragma once
/// Colours: linear red, green, blue and opacity, each 0..1.

namespace sandlot {

struct Color {
  float r = 0.7f, g = 0.7f, b = 0.7f, a = 1;
  friend constexpr bool operator==(const Color&, const Color&) = default;
};

}  // namespace sandlot
