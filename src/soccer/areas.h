#pragma once
/// Areas and spots of a field of robot soccer.
///
/// Frame   F of soccer/field.h. A side is +1 for the goal at positive x and -1 for the one at negative x.
#include <algorithm>
#include <cmath>

#include "geometry/vec3.h"
#include "soccer/field.h"

namespace sandlot::soccer {

inline double length_half_m(const Dimensions& field) { return field.length_m / 2; }
inline double width_half_m(const Dimensions& field) { return field.width_m / 2; }

inline bool in_box(const Dimensions& field, Vec3 p, int side, double depth_m, double width_m) {
  const double out_m = length_half_m(field) - side * p.x;  // distance from the goal line, into the field
  return out_m < depth_m && out_m > -field.goal_depth_m && std::abs(p.y) < width_m / 2;
}
/// The goal area of a side, with the goal behind it.
inline bool in_goal_area(const Dimensions& field, Vec3 p, int side) {
  return in_box(field, p, side, field.goal_area_depth_m, field.goal_area_width_m);
}
inline bool in_penalty_area(const Dimensions& field, Vec3 p, int side) {
  return in_box(field, p, side, field.penalty_area_depth_m, field.penalty_area_width_m);
}
inline bool in_any_penalty_area(const Dimensions& field, Vec3 p) {
  return in_penalty_area(field, p, 1) || in_penalty_area(field, p, -1);
}

inline Vec3 penalty_mark(const Dimensions& field, int side) {
  return {side * (length_half_m(field) - field.penalty_mark_m), 0, 0};
}
/// The spot of a side that is nearest to a place, for goal kicks and what happened in a penalty area.
inline Vec3 restart_spot(const Dimensions& field, Vec3 near, int side) {
  return {side * (length_half_m(field) - field.penalty_mark_m),
          near.y < 0 ? -field.restart_y_m : field.restart_y_m, 0};
}
/// Spot of a free kick or dropped ball: the place itself, within the lines, out of penalty areas.
inline Vec3 free_spot(const Dimensions& field, Vec3 p) {
  constexpr double margin_m = 0.4;
  if (in_any_penalty_area(field, p)) return restart_spot(field, p, p.x < 0 ? -1 : 1);
  const double x = length_half_m(field) - margin_m, y = width_half_m(field) - margin_m;
  const Vec3 inside{std::clamp(p.x, -x, x), std::clamp(p.y, -y, y), 0};
  return in_any_penalty_area(field, inside) ? restart_spot(field, inside, inside.x < 0 ? -1 : 1) : inside;
}
inline Vec3 throw_in_spot(const Dimensions& field, Vec3 out) {
  constexpr double inside_m = 0.15;
  const double x = length_half_m(field) - 0.4, y = width_half_m(field) - inside_m;
  return {std::clamp(out.x, -x, x), out.y < 0 ? -y : y, 0};
}
inline Vec3 corner_spot(const Dimensions& field, Vec3 out) {
  constexpr double inside_m = 0.4;
  const double x = length_half_m(field) - inside_m, y = width_half_m(field) - inside_m;
  return {out.x < 0 ? -x : x, out.y < 0 ? -y : y, 0};
}

}  // namespace sandlot::soccer
