#pragma once
/// Quasistatic motion of a vehicle whose wheels turn at given speeds on ground with dry friction, found
/// without any engine.
///
/// Without inertia, of all velocities (v, w) of the chassis the one comes about at which friction dissipates
/// least,
///
///   P(v, w) = sum_i N_i |d_i|,   d_i = v + w z x p_i - s_i,
///
/// which means that the forces of friction balance each other. Contact i, at p_i and loaded with N_i, slips
/// by d_i against a surface of the vehicle that runs over the ground with -s_i; of a contact on a roller only
/// the part of d_i along the roller's axis e_i counts. P is convex; it is minimised by least squares with
/// weights N_i / |d_i| (Weiszfeld's iteration).
///
/// A force F on the middle (the centrifugal one) adds -F . (v, w); `push` is F as a share of the most that
/// friction can hold.
///
/// Units    m, m/s, rad/s; N in any unit: friction coefficient and weight do not matter.
/// Limits   loads are given, not found: no transfer of load. Where several (v, w) dissipate equally
///          little, one of them.
/// Source   M. A. Peshkin, A. C. Sanderson, The principle of minimum power, IEEE Trans. Robotics and
///          Automation 5 (1989); E. Weiszfeld, Tohoku Math. J. 43 (1937) 355-386.
#include <span>
#include <vector>

namespace sandlot::validation {

/// Velocity in the robot's own plane.
struct Twist {
  double vx_mps = 0, vy_mps = 0, wz_radps = 0;
};

struct Patch {
  double x_m = 0, y_m = 0;        ///< p
  double sx_mps = 0, sy_mps = 0;  ///< s: how the chassis would move here if this contact alone held
  double ex = 0, ey = 0;          ///< e, unit; zero: it holds all ways
  double load = 1;
};

struct Push {
  double x = 0, y = 0;
};
Twist least_dissipation(std::span<const Patch> patches, Push push = {});

/// Adds the contacts of a cylinder of this half width: its two edges, or its middle where it has none.
void add_wheel(std::vector<Patch>& patches, double x_m, double y_m, double half_width_m, double rim_mps,
               double load = 1);

/// The roller on which a Mecanum wheel of joint angle `turned_rad` stands, as builders/mecanum_robot makes
/// it: its axis is tilted by `angle_rad`, and it touches where that axis passes over the lowest line of the
/// rim.
///
/// A roller f past the bottom stands (R - r) tan f / tan(angle) to the side of the wheel's middle, and its
/// axis lies on the ground along (sin(angle) cos f, cos(angle)).
void add_mecanum_wheel(std::vector<Patch>& patches, double x_m, double y_m, double radius_m,
                       double roller_radius_m, int rollers, double angle_rad, double turned_rad,
                       double speed_radps);

}  // namespace sandlot::validation
