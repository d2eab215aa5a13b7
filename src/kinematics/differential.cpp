#include "kinematics/differential.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::kinematics {

WheelSpeeds Differential::inverse(DriveVelocity velocity) const {
  const double side = 0.5 * wheel_separation_m * velocity.omega_radps;
  return {(velocity.v_mps - side) / wheel_radius_m, (velocity.v_mps + side) / wheel_radius_m};
}

DriveVelocity Differential::forward(WheelSpeeds speeds) const {
  return {0.5 * wheel_radius_m * (speeds.right_radps + speeds.left_radps),
          wheel_radius_m * (speeds.right_radps - speeds.left_radps) / wheel_separation_m};
}

WheelSpeeds limited(WheelSpeeds speeds, double max_radps) {
  const double fastest = std::max(std::abs(speeds.left_radps), std::abs(speeds.right_radps));
  if (!(fastest > max_radps)) return speeds;
  const double scale = max_radps / fastest;
  return {scale * speeds.left_radps, scale * speeds.right_radps};
}

PlanarPose integrate(const Differential& drive, PlanarPose from, double left_rad, double right_rad) {
  return along_arc(from, 0.5 * drive.wheel_radius_m * (right_rad + left_rad),
                   drive.wheel_radius_m * (right_rad - left_rad) / drive.wheel_separation_m);
}

PlanarPose along_arc(PlanarPose from, double length_m, double turn_rad) {
  const double half = 0.5 * turn_rad;
  // sin(h)/h; below 1e-4 its series 1 - h^2/6 is exact to h^4/120 < 1e-18.
  const double sinc = std::abs(half) < 1e-4 ? 1 - half * half / 6 : math::sin(half) / half;
  const auto [s, c] = math::sincos(from.theta_rad + half);
  return {from.x_m + length_m * sinc * c, from.y_m + length_m * sinc * s, from.theta_rad + turn_rad};
}

Pose to_pose(const PlanarPose& pose) {
  return {{pose.x_m, pose.y_m, 0}, quat_from_axis_angle({0, 0, 1}, pose.theta_rad)};
}

}  // namespace sandlot::kinematics
