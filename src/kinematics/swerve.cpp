#include "kinematics/swerve.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::kinematics {

SteeringMode steering_mode(const PlanarMotion& v) {
  const bool moves = v.x != 0 || v.y != 0;
  if (v.turn == 0) return moves ? SteeringMode::crab : SteeringMode::stop;
  return moves ? SteeringMode::turn : SteeringMode::spin;
}

std::optional<Direction> centre_of_rotation(const PlanarMotion& v) {
  if (v.turn == 0) return std::nullopt;
  return Direction{-v.y / v.turn, v.x / v.turn};
}

WheelMotion wheel_motion(const PlanarMotion& velocity, double x_m, double y_m) {
  const Direction u = motion_of_point(velocity, x_m, y_m);
  const double speed = std::sqrt(u.x * u.x + u.y * u.y);
  if (!(speed > 0)) return {};
  return {speed, math::atan2(u.y, u.x), math::acos(std::clamp(u.x / speed, -1.0, 1.0))};
}

Direction wheel_acceleration(const PlanarMotion& v, const PlanarMotion& change, double x_m, double y_m) {
  return {change.x - v.turn * v.y - x_m * v.turn * v.turn - y_m * change.turn,
          change.y + v.turn * v.x - y_m * v.turn * v.turn + x_m * change.turn};
}

Steering steer_towards(double direction_rad, Steering now, const SteeringLimits& limits) {
  // Angles that give this direction are nearest + k pi; with k odd the wheel rolls backward.
  const double nearest = now.angle_rad + math::wrap_angle(direction_rad - now.angle_rad);
  std::optional<Steering> best;
  double least = 0;
  for (int k = -2; k <= 2; ++k) {
    const Steering candidate{nearest + k * math::pi, k % 2 != 0};
    constexpr double rounding = 1e-9;
    if (candidate.angle_rad < limits.lower_rad - rounding ||
        candidate.angle_rad > limits.upper_rad + rounding)
      continue;
    const double cost = std::abs(candidate.angle_rad - now.angle_rad) +
                        (candidate.backward != now.backward ? limits.hysteresis_rad : 0);
    if (!best || cost < least) best = candidate, least = cost;
  }
  if (best) return {std::clamp(best->angle_rad, limits.lower_rad, limits.upper_rad), best->backward};
  // Out of reach either way: the end of the range from which the wheel's line differs least.
  const auto miss = [&](double end) {
    const double off = std::abs(math::wrap_angle(direction_rad - end));
    return std::min(off, math::pi - off);
  };
  const double end = miss(limits.lower_rad) < miss(limits.upper_rad) ? limits.lower_rad : limits.upper_rad;
  return {end, std::abs(math::wrap_angle(direction_rad - end)) > 0.5 * math::pi};
}

}  // namespace sandlot::kinematics
