#pragma once
/// Closed forms of the differential drive: two wheels on one axle, rolling without slip.
///
///   inverse   w_left  = (v - omega d/2) / r        forward   v     = r (w_right + w_left) / 2
///             w_right = (v + omega d/2) / r                  omega = r (w_right - w_left) / d
///
///   odometry  over an interval with constant wheel speeds the axle's centre runs on an exact arc:
///             s = r (dphi_right + dphi_left) / 2,  a = r (dphi_right - dphi_left) / d,
///             the chord has length s sin(a/2) / (a/2) and points along theta + a/2.
///
/// Frame    D: centre of the axle on the ground, x forward, y left; omega counter-clockwise.
/// Limits   no slip, no sideways motion, both wheels of one radius; several wheels on one side count as one
///          at their mean speed.
/// Cost     integrate: two sine-cosine pairs; no allocation.
/// Source   R. Siegwart, I. R. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed.
///          (2011), sec. 3.2.2 (forward kinematics); G. Klancar et al., Wheeled Mobile Robotics (2017), sec.
///          2.3.1 (odometry, "exact integration").
#include "geometry/pose.h"

namespace sandlot::kinematics {

/// Velocity of the axle's centre D, in D.
struct DriveVelocity {
  double v_mps = 0;  ///< along x
  double omega_radps = 0;
};

struct WheelSpeeds {
  double left_radps = 0, right_radps = 0;
};

struct Differential {
  double wheel_radius_m = 0.1;      ///< > 0
  double wheel_separation_m = 0.5;  ///< between the wheels' centre planes, > 0

  WheelSpeeds inverse(DriveVelocity velocity) const;
  DriveVelocity forward(WheelSpeeds speeds) const;
};

/// The fastest motion on the same arc (same v / omega) whose wheels stay within `max_radps`.
WheelSpeeds limited(WheelSpeeds speeds, double max_radps);

/// A pose in the plane whose heading counts turns.
struct PlanarPose {
  double x_m = 0, y_m = 0;
  double theta_rad = 0;  ///< unwrapped

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Position along x."}, s.x_m);
    visit(Field{"y", "m", "Position along y."}, s.y_m);
    visit(Field{"theta", "rad", "Heading, unwrapped."}, s.theta_rad);
  }
};

/// The pose after both wheels turned by these angles at constant speeds.
PlanarPose integrate(const Differential& drive, PlanarPose from, double left_rad, double right_rad);
/// The pose after driving `length_m` on an arc that turns by `turn_rad`.
PlanarPose along_arc(PlanarPose from, double length_m, double turn_rad);

Pose to_pose(const PlanarPose& pose);

}  // namespace sandlot::kinematics
