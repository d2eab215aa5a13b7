#pragma once
/// Colours: linear red, green, blue and opacity, each 0..1.
#include "base/fields.h"

namespace sandlot {

struct Color {
  float r = 0.7f, g = 0.7f, b = 0.7f, a = 1;
  friend constexpr bool operator==(const Color&, const Color&) = default;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"r", "1", "Red."}, s.r);
    visit(Field{"g", "1", "Green."}, s.g);
    visit(Field{"b", "1", "Blue."}, s.b);
    visit(Field{"a", "1", "Opacity."}, s.a);
  }
};

}  // namespace sandlot
