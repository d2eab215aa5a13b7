#pragma once
/// Tracking of the ball and of other robots.
///
/// Ball     a Kalman filter of place and velocity, the same variances along both axes. Rolling slows it by `rolling_mps2`; kicks
///          come as an acceleration of 3 m/s^2 at random, and as sightings too far off: two of them in a row begin the track anew,
///          with the velocity between them.
/// Robots   the same filter, with accelerations of 2 m/s^2 at random; a sighting within three standard deviations of a known
///          robot, but at least 0.7 and at most 1.5 m, is of it, others become new ones. Who was not seen for 0.8 s is forgotten.
/// Cost     a few operations; no allocation beyond the bounded list.
#include "controllers/soccer_player/beliefs.h"

namespace sandlot::controllers::soccer_player {

inline constexpr double rolling_mps2 = 0.25;

/// Place of a ball after a time, rolling straight on.
Vec3 ball_after(Vec3 at, Vec3 velocity, double after_s);

/// Carries the ball on to now. @param dt_s  since the call before
void predict_ball(Ball& ball, double dt_s);
void see_ball(Ball& ball, Vec3 at, double std_m, double now_s);
/// The ball is held: it is where the handler is.
void hold_ball(Ball& ball, Vec3 at, Vec3 velocity, double now_s);

void see_robot(std::vector<Obstacle>& robots, Vec3 at, double std_m, double now_s);
void predict_robots(std::vector<Obstacle>& robots, double dt_s, double now_s);

/// The ball as the whole team sees it: the own estimate and those that mates told, weighted by their variances where they agree
/// within 1.2 m with the best. @return not known when nobody saw it within 1.5 s
Ball team_ball(const Ball& own, const std::vector<Mate>& mates, double now_s);

}  // namespace sandlot::controllers::soccer_player
