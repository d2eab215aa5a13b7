#include "controllers/soccer_player/localisation.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::controllers::soccer_player {
namespace {

constexpr std::uint32_t most_refused = 10;
constexpr double gate = 16;  // squared: four standard deviations

}  // namespace

void move_by_odometry(Self& self, Vec3 at_m, double yaw_rad, Vec3 twist_mps, double rate_radps) {
  if (self.moved) {
    const auto [s0, c0] = math::sincos(-self.odometry_yaw_rad);
    const Vec3 way_B = turned({at_m.x - self.odometry_x_m, at_m.y - self.odometry_y_m, 0}, s0, c0);
    const double turn = math::wrap_angle(yaw_rad - self.odometry_yaw_rad);
    const auto [s, c] = math::sincos(self.yaw_rad);
    self.at += turned(way_B, s, c);
    self.yaw_rad = math::wrap_angle(self.yaw_rad + turn);
    // Wheels slip: errors of 15 % of the way, 30 % of the turn, and of the heading across the way.
    const double d2 = dot(way_B, way_B), grown = 0.0225 * d2 + self.var_yaw * d2 + 1e-7;
    self.var_xx += grown;
    self.var_yy += grown;
    self.var_yaw += 0.09 * turn * turn + 1e-4 * d2 + 1e-6;
  }
  const auto [s, c] = math::sincos(self.yaw_rad);
  self.velocity = turned(twist_mps, s, c);
  self.rate_radps = rate_radps;
  self.odometry_x_m = at_m.x;
  self.odometry_y_m = at_m.y;
  self.odometry_yaw_rad = yaw_rad;
  self.moved = true;
}

void fix_heading(Self& self, double yaw_rad, double std_rad) {
  const double variance = std::max(1e-8, std_rad * std_rad);
  if (!self.yaw_known) {
    self.yaw_rad = math::wrap_angle(yaw_rad);
    self.var_yaw = variance;
    self.yaw_known = true;
    return;
  }
  const double off = math::wrap_angle(yaw_rad - self.yaw_rad);
  const double gain = self.var_yaw / (self.var_yaw + variance);
  self.yaw_rad = math::wrap_angle(self.yaw_rad + gain * off);
  self.var_yaw *= 1 - gain;
}

void fix_place(Self& self, const Fix& fix) {
  if (!is_finite(fix.at)) return;
  if (!self.known) {
    self.at = flat(fix.at);
    self.var_xx = fix.var_xx;
    self.var_xy = fix.var_xy;
    self.var_yy = fix.var_yy;
    self.known = true;
    self.refused = 0;
    return;
  }
  const double sxx = self.var_xx + fix.var_xx, sxy = self.var_xy + fix.var_xy, syy = self.var_yy + fix.var_yy;
  const double det = sxx * syy - sxy * sxy;
  if (!(det > 0)) return;
  const double dx = fix.at.x - self.at.x, dy = fix.at.y - self.at.y;
  const double distance2 = (syy * dx * dx - 2 * sxy * dx * dy + sxx * dy * dy) / det;
  if (distance2 > gate) {
    if (++self.refused >= most_refused) self.known = false;
    return;
  }
  self.refused = 0;
  // K = P S^-1
  const double pxx = self.var_xx, pxy = self.var_xy, pyy = self.var_yy;
  const double kxx = (pxx * syy - pxy * sxy) / det, kxy = (pxy * sxx - pxx * sxy) / det;
  const double kyx = (pxy * syy - pyy * sxy) / det, kyy = (pyy * sxx - pxy * sxy) / det;
  self.at.x += kxx * dx + kxy * dy;
  self.at.y += kyx * dx + kyy * dy;
  self.var_xx = std::max(1e-8, pxx - (kxx * pxx + kxy * pxy));
  self.var_xy = pxy - (kxx * pxy + kxy * pyy);
  self.var_yy = std::max(1e-8, pyy - (kyx * pxy + kyy * pyy));
}

std::optional<Fix> place_from_goal(const Self& self, const soccer::Dimensions& field, Vec3 seen_B) {
  if (!self.yaw_known) return {};
  const auto [s, c] = math::sincos(self.yaw_rad);
  const Vec3 seen = turned(seen_B, s, c);
  const double range = norm(seen);
  if (range < 0.5) return {};
  const double goal_x = 0.5 * field.length_m + 0.5 * field.goal_depth_m;
  // Who stands on the field sees the goal at positive x ahead and the other one behind. Beside a goal that does not hold: there what
  // it believed before tells the two apart.
  double side = seen.x > 0 ? 1 : -1;
  if (self.known || self.refused > 0) {
    const auto off = [&](double each) { return norm(Vec3{each * goal_x, 0, 0} - seen - self.at); };
    side = off(1) < off(-1) ? 1 : -1;
  }
  Fix fix{Vec3{side * goal_x, 0, 0} - seen};
  if (std::abs(fix.at.x) > 0.5 * field.length_m + 1.5 || std::abs(fix.at.y) > 0.5 * field.width_m + 2)
    return {};
  const double along = 0.1 + 0.05 * range, across = 0.05 + (0.015 + std::sqrt(self.var_yaw)) * range;
  const double u = seen.x / range, v = seen.y / range, a2 = along * along, b2 = across * across;
  fix.var_xx = a2 * u * u + b2 * v * v;
  fix.var_xy = (a2 - b2) * u * v;
  fix.var_yy = a2 * v * v + b2 * u * u;
  return fix;
}

}  // namespace sandlot::controllers::soccer_player
