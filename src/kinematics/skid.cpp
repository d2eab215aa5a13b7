#include "kinematics/skid.h"

#include <algorithm>
#include <cmath>

namespace sandlot::kinematics {

WheelSpeeds Skid::inverse(const PlanarMotion& velocity) const {
  const double side = 0.5 * track_ratio * track_m * velocity.turn;
  return {(velocity.x - side) / radius_m, (velocity.x + side) / radius_m};
}

PlanarMotion Skid::forward(WheelSpeeds speeds) const {
  const double turn = radius_m * (speeds.right_radps - speeds.left_radps) / (track_ratio * track_m);
  return {0.5 * radius_m * (speeds.right_radps + speeds.left_radps), -turn * pivot_x_m, turn};
}

double track_ratio(std::span<const double> x_m, double track_m) {
  SL_CHECK(!x_m.empty() && track_m > 0);
  double farthest = 0;
  for (const double x : x_m) farthest = std::max(farthest, std::abs(x));
  // The sum grows with c; it is not negative at c = 2 max(x)^2 / T, where no term is.
  double low = 0, high = 2 * farthest * farthest / track_m;
  for (int i = 0; i < 60 && low < high; ++i) {
    const double c = 0.5 * (low + high);
    double sum = 0;
    for (const double x : x_m) sum += (0.5 * track_m * c - x * x) / std::sqrt(c * c + x * x);
    (sum < 0 ? low : high) = c;
  }
  return 1 + (low + high) / track_m;
}

}  // namespace sandlot::kinematics
