#pragma once
/// Estimate of a player's place: odometry carries it on, fixes of heading and place correct it.
///
/// Method   a Kalman filter for the place (2 x 2 covariance) and one for the heading. The way of the odometry is turned by the
///          believed heading; its error grows with way and turn. A fix of the place more than four standard deviations off is
///          refused; after ten of them in a row the place is not known any more and the next fix is taken as it is.
/// Limits   place and heading are taken as independent: an error of the heading shows in the place only through later fixes.
/// Cost     a sine and cosine per odometry, no allocation.
#include <optional>

#include "controllers/soccer_player/beliefs.h"
#include "soccer/field.h"

namespace sandlot::controllers::soccer_player {

/// Carries the estimate on by an odometry's pose and twist (of B in B).
void move_by_odometry(Self& self, Vec3 at_m, double yaw_rad, Vec3 twist_mps, double rate_radps);

void fix_heading(Self& self, double yaw_rad, double std_rad);

struct Fix {
  Vec3 at;
  double var_xx = 0, var_xy = 0, var_yy = 0;
};
void fix_place(Self& self, const Fix& fix);

/// Place of the robot from a goal that it sees: the middle of the goal stands at (+-goal_x, 0), the nearer to what it believed, else
/// the one ahead.
/// @param seen_B  the middle of the goal in the robot's frame
/// @return none when no end of the field fits
std::optional<Fix> place_from_goal(const Self& self, const soccer::Dimensions& field, Vec3 seen_B);

}  // namespace sandlot::controllers::soccer_player
