#include "controllers/four_wheel_steer/model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "base/math.h"

namespace sandlot::controllers::four_wheel_steer {
namespace {

/// sin(x) / x; below 1e-4 the next term of the series is x^4 / 120 < 1e-18.
double sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : math::sin(x) / x; }

/// A wheel that moves slower than this has no direction.
constexpr double still_mps = 1e-9;

}  // namespace

Mode mode_of(const Motion& v) {
  const bool moves = v.x != 0 || v.y != 0;
  if (v.turn == 0) return moves ? Mode::crab : Mode::stop;
  return moves ? Mode::turn : Mode::spin;
}

WheelMotion inverse(const Motion& velocity, const Wheel& wheel) {
  const Vec2 u = wheel_velocity(velocity, wheel);
  const double speed = std::sqrt(dot(u, u));
  if (!(speed > 0)) return {};
  return {speed / wheel.radius_m, math::atan2(u.y, u.x), math::acos(std::clamp(u.x / speed, -1.0, 1.0))};
}

std::optional<Vec2> centre_of_rotation(const Motion& v) {
  if (v.turn == 0) return std::nullopt;
  return Vec2{-v.y / v.turn, v.x / v.turn};
}

Vec2 wheel_acceleration(const Motion& v, const Motion& change, const Wheel& wheel) {
  const double w = v.turn;
  return {change.x - w * v.y - wheel.x_m * w * w - wheel.y_m * change.turn,
          change.y + w * v.x - wheel.y_m * w * w + wheel.x_m * change.turn};
}

Fit kabsch(std::span<const Vec2> before, std::span<const Vec2> after) {
  SL_CHECK(before.size() == after.size() && before.size() >= 2);
  const double share = 1 / static_cast<double>(before.size());
  Vec2 p_mean, q_mean;
  for (std::size_t i = 0; i < before.size(); ++i) {
    p_mean = p_mean + share * before[i];
    q_mean = q_mean + share * after[i];
  }
  // Two loops: in one, g++ 12 makes fused operations of a difference of products beside a sum (gcc bug 107647).
  double cross = 0, along = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vec2 p = before[i] - p_mean, q = after[i] - q_mean;
    cross += p.x * q.y - p.y * q.x;
  }
  for (std::size_t i = 0; i < before.size(); ++i) along += dot(before[i] - p_mean, after[i] - q_mean);
  Fit fit;
  fit.turn_rad = math::atan2(cross, along);
  const auto [s, c] = math::sincos(fit.turn_rad);
  fit.x_m = q_mean.x - (c * p_mean.x - s * p_mean.y);
  fit.y_m = q_mean.y - (s * p_mean.x + c * p_mean.y);
  double squares = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vec2 p = before[i];
    const Vec2 miss = Vec2{c * p.x - s * p.y + fit.x_m, s * p.x + c * p.y + fit.y_m} - after[i];
    squares += dot(miss, miss);
  }
  fit.rmsd_m = std::sqrt(share * squares);
  return fit;
}

Fit rolled(std::span<const Wheel> wheels, std::span<const double> turns_rad,
           std::span<const double> steering_rad) {
  const std::size_t n = wheels.size();
  SL_CHECK(n >= 2 && n <= most_wheels && turns_rad.size() == n && steering_rad.size() == n);
  std::array<Vec2, most_wheels> before, after;
  Fit fit;
  for (int pass = 0; pass < 3; ++pass) {
    const double half = 0.5 * fit.turn_rad, shrink = sinc(half);
    for (std::size_t i = 0; i < n; ++i) {
      const auto [s, c] = math::sincos(steering_rad[i] + half);
      before[i] = {wheels[i].x_m, wheels[i].y_m};
      after[i] = before[i] + (shrink * wheels[i].radius_m * turns_rad[i]) * Vec2{c, s};
    }
    fit = kabsch(std::span(before).first(n), std::span(after).first(n));
  }
  return fit;
}

Motion velocity_of(const Fit& fit, double dt_s) {
  // The chord turned back by half the turn, stretched to the arc.
  const double half = 0.5 * fit.turn_rad, per_s = 1 / dt_s, stretch = per_s / sinc(half);
  const auto [s, c] = math::sincos(half);
  return {stretch * (c * fit.x_m + s * fit.y_m), stretch * (c * fit.y_m - s * fit.x_m), per_s * fit.turn_rad};
}

double slip_of(const Motion& velocity, const Wheel& wheel, double steering_rad) {
  const Vec2 u = wheel_velocity(velocity, wheel);
  if (dot(u, u) < still_mps * still_mps) return 0;
  const double off = math::wrap_angle(math::atan2(u.y, u.x) - steering_rad);
  return off > 0.5 * math::pi ? off - math::pi : off < -0.5 * math::pi ? off + math::pi : off;
}

}  // namespace sandlot::controllers::four_wheel_steer
