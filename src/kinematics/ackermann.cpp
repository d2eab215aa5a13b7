#include "kinematics/ackermann.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::kinematics {

double Ackermann::max_curvature() const {
  const double tangent = math::tan(max_steering_rad);
  return tangent / (std::abs(wheelbase_m) + 0.5 * track_m * tangent);
}

SteeringAngles Ackermann::wheels(double k) const {
  return {math::atan(wheelbase_m * k / (1 - 0.5 * k * track_m)),
          math::atan(wheelbase_m * k / (1 + 0.5 * k * track_m))};
}

double Ackermann::steering(double k) const { return math::atan(wheelbase_m * k); }

double Ackermann::curvature_of_bicycle(double steering_rad) const {
  return math::tan(steering_rad) / wheelbase_m;
}

double Ackermann::curvature(SteeringAngles angles) const {
  // tan = L k / (1 -+ k T/2), solved for k.
  const double left = math::tan(angles.left_rad), right = math::tan(angles.right_rad);
  return 0.5 * (left / (wheelbase_m + 0.5 * track_m * left) + right / (wheelbase_m - 0.5 * track_m * right));
}

PlanarMotion Ackermann::possible(const PlanarMotion& wanted) const {
  const double most = std::abs(wanted.x) * max_curvature();
  return {wanted.x, 0, std::clamp(wanted.turn, -most, most)};
}

}  // namespace sandlot::kinematics
