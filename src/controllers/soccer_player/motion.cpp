#include "controllers/soccer_player/motion.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::controllers::soccer_player {
namespace {

constexpr double horizon_s = 1.2;
// Turns of 0, 15, -15, 30 ... 90 degrees: cosine and sine of the positive ones.
constexpr double cosines[] = {
    1, 0.9659258262890683, 0.8660254037844386, 0.7071067811865476, 0.5, 0.2588190451025208, 0};
constexpr double sines[] = {
    0, 0.25881904510252074, 0.5, 0.7071067811865475, 0.8660254037844386, 0.9659258262890683, 1};

/// Time after which a disc is met; beyond the horizon: the horizon.
double time_free(Vec3 from, Vec3 velocity, const Moving& disc) {
  const Vec3 off = flat(disc.at - from), relative = flat(velocity - disc.velocity);
  const double b = dot(off, relative), a = dot(relative, relative);
  const double c = dot(off, off) - disc.radius_m * disc.radius_m;
  if (c <= 0) return b > 0 ? 0 : horizon_s;  // inside: out of it is free
  if (b <= 0 || a < 1e-9) return horizon_s;
  const double under = b * b - a * c;
  if (under <= 0) return horizon_s;
  return std::min(horizon_s, (b - std::sqrt(under)) / a);
}

double speed_for(double distance, const Limits& limits) {
  return std::min({limits.speed_mps, 3.5 * distance, std::sqrt(2 * limits.acceleration_mps2 * distance)});
}

}  // namespace

Vec3 velocity_to(Vec3 from, Vec3 to, Vec3 moves_on, const Limits& limits) {
  const Vec3 off = flat(to - from);
  const double distance = norm(off);
  Vec3 v = flat(moves_on);
  if (distance > 1e-6) v += (speed_for(distance, limits) / distance) * off;
  const double speed = norm(v);
  return speed > limits.speed_mps ? (limits.speed_mps / speed) * v : v;
}

Vec3 around(Vec3 from, Vec3 wanted, std::span<const Moving> discs) {
  const double speed = norm(wanted);
  if (speed < 0.02 || discs.empty()) return wanted;
  Vec3 best = wanted;
  double least = 1e9;
  for (int k = 0; k < 13; ++k) {
    const int turn = (k + 1) / 2;
    const double s = k % 2 == 1 ? sines[turn] : -sines[turn];
    const Vec3 candidate = turned(wanted, s, cosines[turn]);
    double free_s = horizon_s;
    for (const Moving& disc : discs) free_s = std::min(free_s, time_free(from, candidate, disc));
    const double loss = (1 - cosines[turn]) + 2.5 * (1 - free_s / horizon_s);
    if (loss < least - 1e-12) {
      least = loss;
      // What comes too soon is met slowly.
      best = (free_s < 0.5 ? std::max(0.15, 2 * free_s) : 1.0) * candidate;
    }
  }
  return best;
}

msg::Twist drive(const Self& self, Vec3 velocity, double yaw_rad, const Limits& limits, bool holonomic) {
  msg::Twist twist;
  const auto turn_rate = [&](double error) {
    const double most = limits.turn_speed_radps, size = std::abs(error);
    const double rate = std::min({most, 5 * size, std::sqrt(2 * 4.0 * size)});
    return error > 0 ? rate : -rate;
  };
  if (holonomic) {
    const double error = math::wrap_angle(yaw_rad - self.yaw_rad);
    const auto [s, c] = math::sincos(-self.yaw_rad);
    const Vec3 v_B = turned(velocity, s, c);
    twist.linear = {v_B.x, v_B.y, 0};
    twist.angular.z = turn_rate(error);
    return twist;
  }
  const double speed = norm(velocity);
  if (speed < 0.1) {
    twist.angular.z = turn_rate(math::wrap_angle(yaw_rad - self.yaw_rad));
    return twist;
  }
  const double error = math::wrap_angle(math::atan2(velocity.y, velocity.x) - self.yaw_rad);
  twist.angular.z = turn_rate(error);
  twist.linear.x = std::abs(error) < 1.2 ? speed * math::cos(error) : 0;
  return twist;
}

Vec3 beside_goals(const soccer::Dimensions& field, Vec3 from, Vec3 to) {
  constexpr double margin_m = 0.28, back_m = 0.7, beside_m = 0.3, posts_m = 0.9;
  const double line = 0.5 * field.length_m, aside = std::abs(to.y - from.y);
  if (std::abs(from.x) < line - margin_m || aside < beside_m) return to;
  if (std::abs(from.y) > 0.5 * field.goal_width_m + posts_m) return to;  // clear of it
  return {std::copysign(line - back_m, from.x), from.y, 0};
}

}  // namespace sandlot::controllers::soccer_player
