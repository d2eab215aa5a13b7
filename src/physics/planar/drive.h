#pragma once
/// Ideal drives: a base that moves in its plane as if it ran on rails.
///
/// The velocity approaches its target at no more than the allowed acceleration. Linear velocity is limited as
/// a vector, so a robot that changes direction does not turn sharper than it may. Within a step the ramp is
/// followed exactly and then replaced by its mean velocity, with which the base runs on an arc.
///
/// Exact    constant velocities (the base stays on its circle for ever), accelerating on a line or on the
///          spot.
/// Limits   accelerating and turning at once: the shape of the arc has an error of order h^3.
#include <cmath>

#include "physics/planar/turn.h"

namespace sandlot::planar {

/// Velocity in the plane, in the moving frame.
struct Twist {
  Vec2 v_mps;
  double w_radps = 0;
  friend constexpr bool operator==(const Twist&, const Twist&) = default;
};

/// Moves `velocity` towards `target` for h seconds and returns its mean over that time.
/// @param accel  largest |dv/dt|, >= 0
inline Vec2 ramp(Vec2& velocity, Vec2 target, double accel, double h_s) {
  const Vec2 missing = target - velocity;
  const double size = std::sqrt(dot(missing, missing));
  const double reach = accel * h_s;
  if (size > reach) {
    const Vec2 before = velocity;
    velocity = before + (reach / size) * missing;
    return 0.5 * (before + velocity);
  }
  velocity = target;
  // Reached after size / accel; from there on at the target.
  return size > 0 ? target - (0.5 * size / reach) * missing : target;
}

/// Moves a frame along the arc of constant velocity (dp = R v h sinc, source: closed form of the planar
/// twist).
inline void advance(Vec2& p, Turn& heading, Twist mean, double h_s) {
  const double half = 0.5 * mean.w_radps * h_s;
  if (half == 0) {
    p = p + h_s * rotate(heading, mean.v_mps);
    return;
  }
  // The chord points half way between the headings at both ends.
  Turn turn;
  double sinc;
  if (std::abs(half) <= math::pi / 4) {
    sinc = small_sinc(half);
    turn = {small_cos(half), half * sinc};
  } else {
    turn = turn_of(half);
    sinc = turn.s / half;
  }
  const Turn middle = heading * turn;
  p = p + (h_s * sinc) * rotate(middle, mean.v_mps);
  heading = tidied(middle * turn);
}

}  // namespace sandlot::planar
