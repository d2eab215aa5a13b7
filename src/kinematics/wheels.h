#pragma once
/// Closed forms of a chassis on any number of wheels of any kind, at any place and angle: omni, Mecanum,
/// steered, fixed.
///
/// Wheel i touches the ground at p_i, has the radius r_i and rolls along the unit vector h_i. With the
/// chassis' velocity (v, w), its contact point moves with u_i = v + w z x p_i. What the wheel holds on to
/// depends on its kind:
///
///   ordinary   h . u = r phi'   and   n . u = 0                 n: across h. It rolls along h and holds across.
///   rollers    e . u = r phi' (e . h)                           e: along the axis of the roller on the ground; across
///                                                               it the roller rolls
///
///   inverse    phi'_i = e . u_i / (r (e . h)), of an ordinary wheel h . u_i / r: exact
///   forward    the (v, w) that fits all these equations best in the sense of least squares, each in m/s and
///              of the same weight
///
/// An omni wheel (rollers at 90 degrees, e = h) holds along h alone. A Mecanum wheel has e at 45 degrees:
/// with FL, FR, BL, BR at (+-a, +-b) this is r phi' = vx -+ vy -+ (a + b) w with the signs FL (-,-), FR
/// (+,+), BL (+,-), BR (-,+).
///
/// Frame    D, fixed in the chassis: x forward, y left, w counter-clockwise.
/// Units    m, rad, s. Both ways work on displacements (m, rad) as well as on velocities, per small step.
/// Errors   check(): a geometry that cannot be built or cannot drive.
/// Limits   points of contact that do not move in D; even ground.
/// Cost     a dozen operations per wheel; forward: a 3 x 3 system in addition. No allocation.
/// Source   K. M. Lynch, F. C. Park, Modern Robotics (2017), sec. 13.2 (omni and Mecanum wheels with sliding
///          direction); P. F. Muir, C. P. Neuman, J. Robotic Systems 4 (1987) 281-340 (actuated inverse,
///          sensed forward solution by least squares); G. Campion, G. Bastin, B. d'Andrea-Novel, IEEE Trans.
///          Robotics and Automation 12 (1996) 47-62 (constraints of the wheel types).
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "kinematics/differential.h"

namespace sandlot::kinematics {

/// A velocity [m/s, rad/s] or a displacement per step [m, rad] of the chassis, of D in D.
struct PlanarMotion {
  double x = 0, y = 0, turn = 0;

  friend constexpr bool operator==(const PlanarMotion&, const PlanarMotion&) = default;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m/s", "Displacement forward."}, s.x);
    visit(Field{"y", "m/s", "Displacement to the left."}, s.y);
    visit(Field{"turn", "rad/s", "Counter-clockwise turn."}, s.turn);
  }
};

struct Direction {
  double x = 1, y = 0;
};
Direction direction(double angle_rad);

/// The motion of a point of the chassis.
constexpr Direction motion_of_point(const PlanarMotion& m, double x_m, double y_m) {
  return {m.x - m.turn * y_m, m.y + m.turn * x_m};
}
/// The motion of D when that of the point (x, y), which turns with it, is known.
constexpr PlanarMotion seen_from(const PlanarMotion& of_point, double x_m, double y_m) {
  return {of_point.x + of_point.turn * y_m, of_point.y - of_point.turn * x_m, of_point.turn};
}

struct Wheel {
  double x_m = 0, y_m = 0;  ///< where it touches the ground
  double radius_m = 0.1;
  Direction along;        ///< h: it rolls there when it turns forward
  Direction grip;         ///< e; ignored of an ordinary wheel
  bool ordinary = true;   ///< it holds across h, too
  bool counted = true;    ///< forward() looks at it
  const char* name = "";  ///< for errors
};

/// @param heading_rad  of h from x
Wheel ordinary_wheel(double x_m, double y_m, double radius_m, double heading_rad = 0);
/// @param roller_rad  of the axis of the roller on the ground from the wheel's axis (which points to the left
///                    of h), clockwise seen from above: 90 degrees an omni wheel; model/wheel.h counts the
///                    same way
Wheel roller_wheel(double x_m, double y_m, double radius_m, double heading_rad, double roller_rad);

/// Angular speed of a wheel [rad/s], or its turn [rad], when the chassis moves like this.
double wheel_turn(const Wheel& wheel, const PlanarMotion& motion);
/// All of them. @pre sizes agree
void wheel_turns(std::span<const Wheel> wheels, const PlanarMotion& motion, std::span<double> turns);

/// Motion that fits wheels that turned, by least squares.
struct Estimate {
  PlanarMotion motion;
  double residual = 0;  ///< root mean square of what the equations of motion miss by [m/s or m]: wheels slip
};

/// @param pivot_x_m  of a chassis whose wheels do not hold across (skid steering): the x it turns about;
///                   none: the wheels tell
/// @pre check() of the same wheels, at any steering
Estimate chassis_motion(std::span<const Wheel> wheels, std::span<const double> turns,
                        std::optional<double> pivot_x_m = std::nullopt);

/// Refuses wheels without size, two at one place, rollers that run along the rim's motion, and wheels that
/// together leave a motion free which the drive could then neither command nor measure.
Status check(std::span<const Wheel> wheels, std::optional<double> pivot_x_m = std::nullopt);

/// The pose after a displacement at constant velocity in the body frame: an exact arc.
PlanarPose integrate(PlanarPose from, const PlanarMotion& displacement);

/// The fastest motion in the same direction whose wheels stay within their limits: all are slowed by one
/// factor.
PlanarMotion limited(std::span<const Wheel> wheels, const PlanarMotion& motion, double max_turn);

// --- the usual shapes ---

/// n omni wheels on a circle, the first at `first_rad` from x, each rolling to the left as seen from the
/// centre.
std::vector<Wheel> omni_wheels(int n, double radius_m, double distance_m, double first_rad);

/// FL, FR, BL, BR. `x`: seen from above the axes of the rollers on top point to the middle, as everybody
/// mounts them (those on the ground lie across that). `o`: the other way round, which leaves a square chassis
/// free to turn.
enum class MecanumPattern { x, o };
std::vector<Wheel> mecanum_wheels(double wheelbase_m, double track_m, double radius_m,
                                  MecanumPattern pattern = MecanumPattern::x);

}  // namespace sandlot::kinematics
