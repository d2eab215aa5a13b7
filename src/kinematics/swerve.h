#pragma once
/// Four-wheel drive and steering (4WD4S, swerve): every wheel is driven and steered by itself.
///
///   v_i = v_c + w z x W_i:   v_ix = v_cx - W_iy w      v_iy = v_cy + W_ix w
///   phi'_i = |v_i| / r       psi_i = atan2(v_iy, v_ix)       gamma_i = acos(v_ix / |v_i|)
///   centre of rotation  c = (-v_cy, v_cx) / w,  |c| = |v_c| / w
///   a_ix = v'_cx - w v_cy - W_ix w^2 - W_iy w'       a_iy = v'_cy + w v_cx - W_iy w^2 + W_ix w'
///
/// The paper prints v_iy = v_cy - W_ix w; its own equation 3 gives the plus. Its four modes follow from the
/// command: stop, all wheels parallel (crab), turn on the spot, turn about a centre.
///
/// A wheel at psi that turns forward is the same as one at psi +- 180 degrees that turns backward.
/// steer_towards() takes the one nearer to where the wheel is, and keeps to it until the other is nearer by
/// `hysteresis`: a command that lies across does not make the wheel tremble.
///
/// Frame    C: middle of the robot, x forward, y left; all angles counter-clockwise.
/// Source   M. Sharifi, M. S. Young, X. Chen, D. Clucas, C. Pretty, modelling and simulation of the 4WD4S
///          robot MARIO, eq. 3-13 and sec. 3.1; shortest turn and hysteresis are ours.
#include <optional>

#include "kinematics/wheels.h"

namespace sandlot::kinematics {

enum class SteeringMode { stop, crab, spin, turn };
SteeringMode steering_mode(const PlanarMotion& velocity);

/// Centre of rotation of the chassis, in its frame; nothing while it does not turn.
std::optional<Direction> centre_of_rotation(const PlanarMotion& velocity);

/// Speed and direction of a wheel's point of contact.
struct WheelMotion {
  double speed_mps = 0;     ///< |v_i|
  double steering_rad = 0;  ///< psi, 0 while it stands still
  double slip_rad = 0;      ///< gamma: between the wheel's motion and the robot's x axis, 0..pi
};
WheelMotion wheel_motion(const PlanarMotion& velocity, double x_m, double y_m);

/// @param change  of the velocity's components in the body frame [m/s^2, rad/s^2]
Direction wheel_acceleration(const PlanarMotion& velocity, const PlanarMotion& change, double x_m,
                             double y_m);

struct SteeringLimits {
  double lower_rad = -1e16, upper_rad = 1e16;
  double hysteresis_rad = 0.1;
};
struct Steering {
  double angle_rad = 0;
  bool backward = false;  ///< the wheel turns backward to roll in the requested direction
};
/// @param direction_rad  of motion of the wheel, modulo a turn
/// @param now            angle of the joint (it counts turns), and which way the wheel rolls at present
/// If the limits leave no angle, the nearest end of the range is taken.
Steering steer_towards(double direction_rad, Steering now, const SteeringLimits& limits);

}  // namespace sandlot::kinematics
