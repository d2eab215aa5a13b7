#pragma once
/// Dimensions of a field of robot soccer, as the rule book gives them.
///
/// Frame    F: origin in the middle, x along the field, y to the left of who looks along x, z up.
/// Measure  lines belong to the areas that they bound: lengths are to the outside of lines.
/// Source   Middle Size League, rule book of 2023 (24.1), for 22 m x 14 m; CAMBADA's software, which measures to the middle of
///          lines, for 18 m x 12 m; for 12 m x 8 m, about the size of 2005, the areas of 18 m x 12 m by two thirds, since the rule book
///          of then is not at hand.
#include <cstdint>
#include <span>

#include "base/fields.h"

namespace sandlot::soccer {

enum class FieldSize : std::uint8_t { m22x14, m18x12, m12x8 };
inline std::span<const EnumName<FieldSize>> enum_names(FieldSize) {
  static constexpr EnumName<FieldSize> names[] = {
      {"22x14", FieldSize::m22x14}, {"18x12", FieldSize::m18x12}, {"12x8", FieldSize::m12x8}};
  return names;
}

struct Dimensions {
  double length_m = 22, width_m = 14;
  double penalty_area_width_m = 6.9, penalty_area_depth_m = 2.25;
  double goal_area_width_m = 3.9, goal_area_depth_m = 0.75;
  double corner_radius_m = 0.75, circle_radius_m = 2;
  double penalty_mark_m = 3.6, mark_diameter_m = 0.15;
  double restart_y_m = 3.5;
  double line_m = 0.125, border_m = 1;
  double goal_width_m = 2.4, goal_height_m = 1, goal_depth_m = 0.6;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"length", "m", "Length of the field.", 2, 200}, s.length_m);
    visit(Field{"width", "m", "Width of the field.", 1, 200}, s.width_m);
    visit(Field{"penalty_area_width", "m", "Width of the penalty areas, across the field.", 0, 200},
          s.penalty_area_width_m);
    visit(Field{"penalty_area_depth", "m", "Depth of the penalty areas, along the field.", 0, 100},
          s.penalty_area_depth_m);
    visit(Field{"goal_area_width", "m", "Width of the goal areas, across the field.", 0, 200},
          s.goal_area_width_m);
    visit(Field{"goal_area_depth", "m", "Depth of the goal areas, along the field.", 0, 100},
          s.goal_area_depth_m);
    visit(Field{"corner_radius", "m", "Radius of the arcs at the corners.", 0, 100}, s.corner_radius_m);
    visit(Field{"circle_radius", "m", "Radius of the circle in the middle.", 0, 100}, s.circle_radius_m);
    visit(Field{"penalty_mark", "m", "Distance of the penalty marks from the goal lines.", 0, 100},
          s.penalty_mark_m);
    visit(Field{"mark_diameter", "m", "Diameter of the marks.", 0, 10}, s.mark_diameter_m);
    visit(Field{"restart_y", "m", "Distance of the restart spots from the field's long axis.", 0, 100},
          s.restart_y_m);
    visit(Field{"line", "m", "Width of the lines.", 0.001, 1}, s.line_m);
    visit(Field{"border", "m", "Width of the green border outside the lines.", 0, 100}, s.border_m);
    visit(Field{"goal_width", "m", "Distance between the posts of a goal.", 0.1, 100}, s.goal_width_m);
    visit(Field{"goal_height", "m", "Height of a goal's bar.", 0.1, 100}, s.goal_height_m);
    visit(Field{"goal_depth", "m", "Distance from a goal line to the back of the net.", 0.05, 100},
          s.goal_depth_m);
  }
};

constexpr Dimensions dimensions_of(FieldSize size) {
  Dimensions d;
  if (size == FieldSize::m18x12) {
    d.length_m = 18;
    d.width_m = 12;
    d.penalty_area_width_m = 6.5;
    d.goal_area_width_m = 3.5;
    d.penalty_mark_m = 3;
    d.restart_y_m = 3;
    d.goal_width_m = 2;
  } else if (size == FieldSize::m12x8) {
    d.length_m = 12;
    d.width_m = 8;
    d.penalty_area_width_m = 4.3;
    d.penalty_area_depth_m = 1.5;
    d.goal_area_width_m = 3;
    d.goal_area_depth_m = 0.5;
    d.corner_radius_m = 0.5;
    d.circle_radius_m = 1.35;
    d.penalty_mark_m = 2;
    d.restart_y_m = 2;
    d.goal_width_m = 2;
    d.line_m = 0.1;
  }
  return d;
}

}  // namespace sandlot::soccer
