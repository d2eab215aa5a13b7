#pragma once
/// Tracking of the ball and of other robots.
///
/// Ball     a Kalman filter of place and velocity, the same variances along both axes. Rolling slows it by `rolling_mps2`; kicks
///          come as an acceleration of 3 m/s^2 at random, and as sightings too far off: two of them in a row begin the track anew,
///          with the velocity between them.
/// Robots   a sighting within 0.7 m of a known robot moves it, half of the way; others become new ones. Who was not seen for
///          0.8 s is forgotten.
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

void see_robot(std::vector<Obstacle>& robots, Vec3 at, double now_s);
void predict_robots(std::vector<Obstacle>& robots, double dt_s, double now_s);

/// The ball as the whole team sees it: the own estimate and those that mates told, weighted by their variances where they agree
/// within 1.2 m with the best. @return not known when nobody saw it within 1.5 s
Ball team_ball(const Ball& own, const std::vector<Mate>& mates, double now_s);

}  // namespace sandlot::controllers::soccer_player
