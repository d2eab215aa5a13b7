#pragma once
/// Car-like steering: a rear axle that points ahead and two steered wheels in front, all tangential to one
/// centre.
///
/// With the wheelbase L, the track T between the steered wheels' pins, and the curvature k = w / v of the
/// rear axle's middle:
///
///   bicycle    tan(steering) = L k                      the wheel that a bicycle in the middle would have
///   wheels     tan(left)  = L k / (1 - k T/2)           the one inside of the turn is turned more
///              tan(right) = L k / (1 + k T/2)
///
/// Frame    D: middle of the rear axle, x forward, y left; w and angles counter-clockwise.
/// Limits   no slip; |k| < 2 / T, so that the centre stays outside the axle.
/// Cost     two arc tangents.
/// Source   R. Siegwart, I. R. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed.
///          (2011), sec. 3.2; P. Corke, Robotics, Vision and Control, 2nd ed. (2017), sec. 4.1.1 (bicycle and
///          Ackermann).
#include "kinematics/wheels.h"

namespace sandlot::kinematics {

struct SteeringAngles {
  double left_rad = 0, right_rad = 0;
};

struct Ackermann {
  double wheelbase_m = 1;         ///< L; negative: the steered axle is behind
  double track_m = 0.5;           ///< T, >= 0
  double max_steering_rad = 0.6;  ///< of the inner wheel, below 90 degrees

  /// Curvature of the tightest turn: 1 / (L / tan(max) + T/2).
  double max_curvature() const;
  SteeringAngles wheels(double curvature) const;
  /// The bicycle's angle.
  double steering(double curvature) const;
  /// The curvature that angles of the wheels belong to; of two that do not fit, the mean.
  double curvature(SteeringAngles angles) const;
  double curvature_of_bicycle(double steering_rad) const;
  /// Nearest velocity that this car can follow: v stays, w is cut to the tightest turn; it does not move
  /// sideways.
  PlanarMotion possible(const PlanarMotion& wanted) const;
};

}  // namespace sandlot::kinematics
