#pragma once
/// Motions of a robot in the plane: velocity, moves along straights, arcs and turns on the spot, and paths of
/// poses.
///
/// Frame    poses in the map's frame M, directions and velocities in the robot's: x forward, y left, angles
///          counter-clockwise.
#include <span>
#include <vector>

#include "base/fields.h"
#include "navigation/maps/grid.h"

namespace sandlot::navigation {

/// Velocity of the robot in its own frame.
struct PlanarTwist {
  double vx_mps = 0, vy_mps = 0, w_radps = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"vx", "m/s", "Velocity forward."}, s.vx_mps);
    visit(Field{"vy", "m/s", "Velocity to the left."}, s.vy_mps);
    visit(Field{"w", "rad/s", "Turn rate, counter-clockwise."}, s.w_radps);
  }
};

/// Move of constant curvature, or a turn on the spot.
struct Move {
  Vec2 direction_B{1, 0};  ///< unit vector; (0, 0): a turn on the spot
  double curvature_pm =
      0;              ///< [1/m] of a move forward or backward, left positive; sign of a turn on the spot
  double amount = 0;  ///< [m], or [rad] of a turn on the spot; >= 0
};

/// Pose after a part of a move. @param amount  [m] or [rad]
Pose2 moved(const Pose2& from, const Move& move, double amount);

/// Pose of a path, and the direction of travel that leads to it.
struct PathPose {
  Pose2 pose;
  Vec2 direction_B{1, 0};  ///< as in Move
};

/// Appends poses along a move, the last one included, at most `spacing_m` apart and, of a turn, `spacing_rad`.
void append_poses(std::vector<PathPose>& path, const Pose2& from, const Move& move, double spacing_m,
                  double spacing_rad);

/// Path for a robot that drives forward along a line of points at most `spacing_m` apart,
/// with headings along it. Points closer than a millimetre are left out; empty for fewer than two. Corners appear
/// once, with the heading of the side that leads to them. @pre spacing_m > 0
std::vector<PathPose> path_through(std::span<const Vec2> points, double spacing_m);

/// Pose after a time with a constant twist: the exact arc.
Pose2 driven(const Pose2& from, const PlanarTwist& twist, double dt_s);

}  // namespace sandlot::navigation
