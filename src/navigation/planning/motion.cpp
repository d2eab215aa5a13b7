#include "navigation/planning/motion.h"

#include <algorithm>
#include <cmath>

namespace sandlot::navigation {

Pose2 moved(const Pose2& from, const Move& move, double amount) {
  if (move.direction_B == Vec2{0, 0})
    return {from.x, from.y, math::wrap_angle(from.theta + (move.curvature_pm < 0 ? -amount : amount))};
  const auto [s, c] = math::sincos(from.theta);
  if (move.curvature_pm == 0) {
    const Vec2 d = move.direction_B;
    return {from.x + amount * (c * d.x - s * d.y), from.y + amount * (s * d.x + c * d.y), from.theta};
  }
  const double turn = (move.direction_B.x < 0 ? -amount : amount) * move.curvature_pm;
  const auto [s1, c1] = math::sincos(from.theta + turn);
  return {from.x + (s1 - s) / move.curvature_pm, from.y + (c - c1) / move.curvature_pm,
          math::wrap_angle(from.theta + turn)};
}

void append_poses(std::vector<PathPose>& path, const Pose2& from, const Move& move, double spacing_m,
                  double spacing_rad) {
  if (!(move.amount > 0)) return;
  const double spacing = move.direction_B == Vec2{0, 0} ? spacing_rad : spacing_m;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::min(move.amount / spacing, 1e6) - 1e-9)));
  for (int k = 1; k <= steps; ++k)
    path.push_back({moved(from, move, move.amount * k / steps), move.direction_B});
}

std::vector<PathPose> path_through(std::span<const Vec2> points, double spacing_m) {
  std::vector<PathPose> path;
  for (std::size_t i = 1, last = 0; i < points.size(); ++i) {
    const Vec2 a = points[last], d = points[i] - a;
    const double length = math::hypot(d.x, d.y);
    if (!(length > 1e-3)) continue;
    const Pose2 from{a.x, a.y, math::atan2(d.y, d.x)};
    if (path.empty()) path.push_back({from});
    append_poses(path, from, {.amount = length}, spacing_m, 1);
    last = i;
  }
  return path;
}

Pose2 driven(const Pose2& from, const PlanarTwist& twist, double dt_s) {
  // The chord of the arc: velocity turned by half the angle, shortened by sin(a / 2) / (a / 2).
  const double turn = twist.w_radps * dt_s, half = turn / 2;
  const double chord = std::abs(half) < 1e-4 ? 1 - half * half / 6 : math::sin(half) / half;
  const auto [s, c] = math::sincos(from.theta + half);
  const double dx = twist.vx_mps * dt_s * chord, dy = twist.vy_mps * dt_s * chord;
  return {from.x + c * dx - s * dy, from.y + s * dx + c * dy, math::wrap_angle(from.theta + turn)};
}

}  // namespace sandlot::navigation
