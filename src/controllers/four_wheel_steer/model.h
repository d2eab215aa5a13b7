#pragma once
/// Kinematics of a chassis whose wheels are each driven and steered (4WD4S): the model of a model-based controller.
///
///   v_i = v_c + w k x W_i                                             (3)
///   phi'_i = |v_i| / r,   psi_i = atan2(v_iy, v_ix)                   (4)
///   v_ix = v_cx - W_iy w,   v_iy = v_cy + W_ix w                      (5)
///   gamma_i = acos(v_ix / |v_i|)                                      (6)
///   c = (-v_cy, v_cx) / w,   |c| = |v_c| / w                          (7)
///   a_i = a_c + w' k x W_i - w^2 W_i,   a_c = (v'_x - w v_y, v'_y + w v_x)      (8, 9)
///   a_ix = v'_x - w v_y - W_ix w^2 - W_iy w'                          (10)
///   a_iy = v'_y + w v_x - W_iy w^2 + W_ix w'                          (11)
///   A = P^T Q = V S W^T,   R = W diag(1, 1, d) V^T,   d = sign(det(W V^T))      (12, 13)
///
/// The paper prints v_iy = v_cy - W_ix w in (5); its own (3) gives the plus, which stands here. It calls (6) the slip
/// angle: it is the angle between the motion of the wheel and the robot's x axis, without a sign.
///
/// Odometry   P holds the places of the wheels before a step, Q those after it, when each has rolled r dphi along its
///            heading. In the plane (12, 13) come to theta = atan2(sum p x q, sum p . q) of the centred points. The
///            chassis turns during the step, so that a wheel runs on an arc whose chord points half the turn further:
///            found in three passes. The root mean square distance that the fit leaves (RMSD) is zero for wheels that
///            roll, and so a measure of their slip.
/// Frame      C: any point of the chassis, x forward, y left; angles counter-clockwise from x.
/// Units      SI.
/// Errors     none at run time. @pre finite numbers, radii > 0, at least two wheels at different places
/// Limits     motion in the plane; wheels touch the ground where they are steered (no castor offset).
/// Cost       a few dozen operations and an arc tangent or two per wheel; no allocation.
/// Source     M. Sharifi, X. Chen, C. Pretty, D. Clucas, E. Cabon-Lunel, Modelling and simulation of a non-holonomic
///            omnidirectional mobile robot for offline programming and system performance analysis, eq. 3-13 and sec. 3.1.
#include <cstdint>
#include <optional>
#include <span>

#include "base/fields.h"
#include "geometry/vec2.h"

namespace sandlot::controllers::four_wheel_steer {

/// Velocity of the chassis at C in C [m/s, rad/s], or its displacement [m, rad].
struct Motion {
  double x = 0, y = 0, turn = 0;

  friend constexpr bool operator==(const Motion&, const Motion&) = default;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m/s", "Velocity forward."}, s.x);
    visit(Field{"y", "m/s", "Velocity to the left."}, s.y);
    visit(Field{"turn", "rad/s", "Turning rate, counter-clockwise."}, s.turn);
  }
};
constexpr Motion operator*(double k, const Motion& m) { return {k * m.x, k * m.y, k * m.turn}; }
constexpr Motion operator+(const Motion& a, const Motion& b) {
  return {a.x + b.x, a.y + b.y, a.turn + b.turn};
}
constexpr Motion operator-(const Motion& a, const Motion& b) {
  return {a.x - b.x, a.y - b.y, a.turn - b.turn};
}

/// Wheel module: where it stands and is steered, in C.
struct Wheel {
  double x_m = 0, y_m = 0;
  double radius_m = 0.1;
};

/// Mode of steering, as the commanded velocity selects it.
enum class Mode : std::uint8_t { stop, crab, spin, turn };
Mode mode_of(const Motion& velocity);

/// Velocity of a wheel's point of contact (3, 5).
constexpr Vec2 wheel_velocity(const Motion& v, const Wheel& wheel) {
  return {v.x - wheel.y_m * v.turn, v.y + wheel.x_m * v.turn};
}

struct WheelMotion {
  double rate_radps = 0;    ///< of its rotation, not negative (4)
  double steering_rad = 0;  ///< psi (4); 0 while it stands still
  double slip_rad = 0;      ///< gamma (6), 0..pi; 0 while it stands still
};
/// Inverse kinematics of one wheel.
WheelMotion inverse(const Motion& velocity, const Wheel& wheel);

/// Centre of rotation in C (7); nothing while the chassis does not turn.
std::optional<Vec2> centre_of_rotation(const Motion& velocity);

/// Acceleration of a wheel's point (8-11), in the axes of C.
/// @param change  derivatives v'_x, v'_y, w' of the velocity's components
Vec2 wheel_acceleration(const Motion& velocity, const Motion& change, const Wheel& wheel);

/// Rigid motion that takes points to where they are now best, in the sense of least squares (12, 13).
struct Fit {
  double x_m = 0, y_m = 0, turn_rad = 0;  ///< pose of the frame after in the frame before
  double rmsd_m = 0;
};
/// @pre sizes agree and are 2 or more
Fit kabsch(std::span<const Vec2> before, std::span<const Vec2> after);

/// Most wheels of a chassis.
inline constexpr std::size_t most_wheels = 16;

/// Motion of C over a step by what its wheels rolled: its pose after in the frame before.
/// @param turns_rad     rotation of each wheel during the step
/// @param steering_rad  mean heading of each wheel during the step
/// @pre sizes agree, 2..most_wheels
Fit rolled(std::span<const Wheel> wheels, std::span<const double> turns_rad,
           std::span<const double> steering_rad);

/// Constant velocity with which C comes from one pose to the other on an arc: of a fit over dt.
Motion velocity_of(const Fit& fit, double dt_s);

/// Angle from the heading of a wheel to the velocity of its point, as an angle between lines: -pi/2..pi/2. Zero for a
/// wheel that rolls, and for one that stands.
double slip_of(const Motion& velocity, const Wheel& wheel, double steering_rad);

}  // namespace sandlot::controllers::four_wheel_steer
