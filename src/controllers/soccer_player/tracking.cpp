#include "controllers/soccer_player/tracking.h"

#include <algorithm>

namespace sandlot::controllers::soccer_player {

Vec3 ball_after(Vec3 at, Vec3 velocity, double after_s) {
  const double speed = norm(velocity);
  if (speed < 1e-6) return at;
  const double t = std::min(after_s, speed / rolling_mps2);
  return at + (t - 0.5 * rolling_mps2 * t * t / speed) * velocity;
}

namespace {

/// Variances of a place and velocity after a time in which accelerations with this power density [m^2/s^3] came.
void widen(auto& track, double dt_s, double density) {
  track.var_p += dt_s * (2 * track.cov_pv + dt_s * track.var_v) + 1e-6;
  track.cov_pv += dt_s * track.var_v;
  track.var_v = std::min(100.0, track.var_v + density * dt_s);
  track.var_p = std::min(100.0, track.var_p);
  track.cov_pv = std::min(50.0, track.cov_pv);
}

/// Corrects place and velocity by a sighting with this variance.
void correct(auto& track, Vec3 off, double r) {
  const double s = track.var_p + r, k = track.var_p / s, l = track.cov_pv / s;
  track.at += k * off;
  track.velocity += l * off;
  track.var_v = std::max(1e-4, track.var_v - l * track.cov_pv);
  track.cov_pv *= 1 - k;
  track.var_p = std::max(1e-6, track.var_p * (1 - k));
}

}  // namespace

void predict_ball(Ball& ball, double dt_s) {
  if (!ball.known) return;
  ball.at = ball_after(ball.at, ball.velocity, dt_s);
  const double speed = norm(ball.velocity);
  if (speed > 1e-6) ball.velocity = (std::max(0.0, speed - rolling_mps2 * dt_s) / speed) * ball.velocity;
  widen(ball, dt_s, 0.9);
}

void see_ball(Ball& ball, Vec3 at, double std_m, double now_s) {
  if (!is_finite(at)) return;
  at = flat(at);
  const double r = std_m * std_m;
  if (!ball.known || now_s - ball.seen_s > 2) {
    ball = {at, {}, r, 0, 4, now_s, 0, true};
    return;
  }
  const Vec3 off = at - ball.at;
  if (dot(off, off) > 25 * (ball.var_p + r)) {
    if (++ball.refused < 2) return;
    ball = {at, {}, r, 0, 16, now_s, 0, true};
    return;
  }
  ball.refused = 0;
  correct(ball, off, r);
  ball.seen_s = now_s;
}

void hold_ball(Ball& ball, Vec3 at, Vec3 velocity, double now_s) {
  ball = {flat(at), flat(velocity), 1e-3, 0, 0.3, now_s, 0, true};
}

void see_robot(std::vector<Obstacle>& robots, Vec3 at, double std_m, double now_s) {
  if (!is_finite(at)) return;
  at = flat(at);
  const double r = std_m * std_m;
  Obstacle* nearest = nullptr;
  double best = 1;
  for (Obstacle& each : robots) {
    const Vec3 off = at - each.at;
    const double part = dot(off, off) / std::clamp(9 * (each.var_p + r), 0.49, 2.25);
    if (part < best) best = part, nearest = &each;
  }
  if (nearest == nullptr) {
    if (robots.size() < most_obstacles) robots.push_back({at, {}, r, 0, 1, now_s});
    return;
  }
  correct(*nearest, at - nearest->at, r);
  const double speed = norm(nearest->velocity);
  if (speed > 4) nearest->velocity = (4 / speed) * nearest->velocity;
  nearest->seen_s = now_s;
}

void predict_robots(std::vector<Obstacle>& robots, double dt_s, double now_s) {
  std::erase_if(robots, [&](const Obstacle& each) { return now_s - each.seen_s > 0.8; });
  for (Obstacle& each : robots) {
    each.at += dt_s * each.velocity;
    widen(each, dt_s, 1);
  }
}

Ball team_ball(const Ball& own, const std::vector<Mate>& mates, double now_s) {
  constexpr double too_old_s = 1.5;
  const auto variance = [&](double std_m, double age_s) {
    return std_m * std_m + 0.25 * age_s * age_s + 1e-4;
  };
  Ball best;
  double least = 1e9;
  if (own.known && now_s - own.seen_s < too_old_s) {
    best = own;
    least = variance(std::sqrt(own.var_p), now_s - own.seen_s);
  }
  for (const Mate& mate : mates) {
    const double age = now_s - mate.ball_seen_s;
    if (!mate.ball_known || age > too_old_s) continue;
    const double v = variance(mate.ball_std_m, age) + 0.01;
    if (v >= least) continue;
    least = v;
    best = Ball{ball_after(mate.ball, mate.ball_velocity, std::clamp(age, 0.0, too_old_s)),
                mate.ball_velocity,
                v,
                0,
                1,
                mate.ball_seen_s,
                0,
                true};
  }
  if (!best.known) {
    best.at = own.at;
    return best;
  }
  // Weighted with those that agree.
  const Vec3 middle = best.at;
  Vec3 sum = (1 / least) * middle;
  double weight = 1 / least;
  const auto add = [&](Vec3 at, double v) {
    const Vec3 off = at - middle;
    if (dot(off, off) > 1.44 || off == Vec3{}) return;
    sum += (1 / v) * at;
    weight += 1 / v;
  };
  if (own.known && now_s - own.seen_s < too_old_s)
    add(own.at, variance(std::sqrt(own.var_p), now_s - own.seen_s));
  for (const Mate& mate : mates) {
    const double age = now_s - mate.ball_seen_s;
    if (mate.ball_known && age < too_old_s)
      add(ball_after(mate.ball, mate.ball_velocity, std::clamp(age, 0.0, too_old_s)),
          variance(mate.ball_std_m, age) + 0.01);
  }
  best.at = (1 / weight) * sum;
  return best;
}

}  // namespace sandlot::controllers::soccer_player
