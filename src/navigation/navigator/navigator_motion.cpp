/// Checks of the navigator's motions: against obstacles, moving discs and what is not known.
#include <algorithm>
#include <cmath>

#include "navigation/navigator/navigator.h"

namespace sandlot::navigation {

Footprint Navigator::fitting_footprint(const Pose2& X) const {
  const GridFrame frame(local_.geometry);
  const auto fits = [&](const Footprint& f) {
    return footprint_contact(local_, frame, f, X) == Contact::none;
  };
  if (fits(grown_)) return grown_;
  if (fits(footprint_)) return footprint_;
  Footprint out = footprint_;
  for (double scale = 0.95; scale > 0.25 && !fits(out); scale -= 0.05) {
    std::vector<Vec2> corners(footprint_.corners().begin(), footprint_.corners().end());
    for (Vec2& c : corners) c = scale * c;
    if (auto smaller = corners.empty() ? Footprint::circle(scale * footprint_.circumscribed_m())
                                       : Footprint::polygon(std::move(corners)))
      out = std::move(*smaller);
  }
  return out;
}

void Navigator::mark_driven(const Pose2& X) {
  const GridFrame frame(area_);
  if (!frame.cell({X.x, X.y})) return;
  const Vec2 g = frame.to_grid({X.x, X.y});
  const double reach = footprint_.circumscribed_m() / area_.resolution_m + 1;
  // Cells whose centres it covers, as in pose_known(): more of them, and a robot could creep into the unknown.
  for (int y = std::max(0, static_cast<int>(std::floor(g.y - reach)));
       y <= std::min(area_.height - 1, static_cast<int>(g.y + reach)); ++y)
    for (int x = std::max(0, static_cast<int>(std::floor(g.x - reach)));
         x <= std::min(area_.width - 1, static_cast<int>(g.x + reach)); ++x)
      if (footprint_distance(footprint_, X, frame.to_map({x + 0.5, y + 0.5})) <= 0)
        state_.layer.free[area_.index({x, y})] = 255;
}

bool Navigator::pose_known(const Pose2& X, double slack_m) const {
  const GridFrame frame(area_);
  const Vec2 g = frame.to_grid({X.x, X.y});
  const double reach = footprint_.circumscribed_m() / area_.resolution_m;
  if (!(g.x >= reach && g.y >= reach && g.x + reach < area_.width && g.y + reach < area_.height))
    return false;
  for (int y = static_cast<int>(g.y - reach); y <= static_cast<int>(g.y + reach); ++y)
    for (int x = static_cast<int>(g.x - reach); x <= static_cast<int>(g.x + reach); ++x) {
      const std::size_t i = area_.index({x, y});
      // What is an obstacle is known, too: a contact, which others look for.
      if (state_.layer.free[i] == 0 && state_.layer.trust[i] == 0 &&
          footprint_distance(footprint_, X, frame.to_map({x + 0.5, y + 0.5})) <= -slack_m)
        return false;
    }
  return true;
}

bool Navigator::motion_known(const Pose2& X, const PlanarTwist& v, double slack_m) const {
  const double speed = math::hypot(v.vx_mps, v.vy_mps);
  const double ahead_s = dwa_.period_s + std::max(speed / spec_.limits.acceleration_mps2, 0.3);
  return pose_known(driven(X, v, ahead_s / 2), slack_m) && pose_known(driven(X, v, ahead_s), slack_m);
}

PlanarTwist Navigator::within_limits(const PlanarTwist& v) const {
  double share = 1;
  const auto limit = [&](double value, double most) {
    if (std::abs(value) > most) share = std::min(share, most / std::abs(value));
  };
  limit(v.vx_mps, v.vx_mps < 0 ? spec_.limits.backward_mps : spec_.limits.speed_mps);
  limit(v.vy_mps, spec_.limits.sideways_mps);
  limit(v.w_radps, spec_.limits.turn_radps);
  return share < 1 ? PlanarTwist{share * v.vx_mps, share * v.vy_mps, share * v.w_radps} : v;
}

bool Navigator::command_safe(const Footprint& outline, const Pose2& X, const PlanarTwist& v) const {
  const GridFrame frame(local_.geometry);
  const double speed = math::hypot(v.vx_mps, v.vy_mps);
  const double ahead_s = dwa_.period_s + std::max(speed / spec_.limits.acceleration_mps2, 0.3);
  for (int k = 1; k <= 20; ++k) {
    const double t = ahead_s * k / 20;
    const Pose2 at = driven(X, v, t);
    if (footprint_contact(local_, frame, outline, at) != Contact::none) return false;
  }
  return !nears_disc(X, v);
}

bool Navigator::nears_disc(const Pose2& X, const PlanarTwist& v) const {
  const double speed = math::hypot(v.vx_mps, v.vy_mps);
  if (speed == 0) return false;
  const double ahead_s = dwa_.period_s + std::max(speed / spec_.limits.acceleration_mps2, 1.0);
  for (const MovingDisc& disc : discs_)
    for (int k = 1; k <= 20; ++k) {
      const double t = ahead_s * k / 20;
      const Vec2 there = disc.centre_M + t * disc.velocity_M_mps;
      const double then = footprint_distance(footprint_, driven(X, v, t), there);
      // A robot that stands may have to let a disc come.
      if (then < disc.radius_m + spec_.disc_clearance_m && then < footprint_distance(footprint_, X, there))
        return true;
    }
  return false;
}

}  // namespace sandlot::navigation
