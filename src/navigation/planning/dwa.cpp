#include "navigation/planning/dwa.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandlot::navigation {
namespace {

struct DwaWindow {
  double low = 0, high = 0;
  double at(int k, int samples) const { return samples < 2 ? low : low + (high - low) * k / (samples - 1); }
};

/// Velocities reachable within a period. A robot that is faster than its limits may brake.
DwaWindow dwa_window(double now, double low, double high, double change) {
  const double from = std::clamp(now - change, low, high), to = std::clamp(now + change, low, high);
  if (now - change > high) return {now - change, now - change};
  if (now + change < low) return {now + change, now + change};
  return {from, to};
}

/// Samples of a window, with 0 in place of the one nearest to it: standing still and straight on are exact.
double dwa_sample(const DwaWindow& window, int k, int samples) {
  const double value = window.at(k, samples);
  if (window.low > 0 || window.high < 0) return value;
  const double step = samples < 2 ? 0 : (window.high - window.low) / (samples - 1);
  if (samples < 2) return 0;
  return std::abs(value) <= step / 2 && (value >= 0 || std::abs(value) < step / 2) ? 0 : value;
}

/// Time in which the robot stops along its arc: all velocities fall in proportion.
double dwa_braking_s(const DwaSpec& spec, const PlanarTwist& v) {
  return std::max({std::abs(v.vx_mps) / spec.acceleration_mps2, std::abs(v.vy_mps) / spec.acceleration_mps2,
                   std::abs(v.w_radps) / spec.turn_acceleration_radps2});
}

struct DwaRollout {
  Pose2 end;
  double map_s = 0,
         disc_s = 0;  ///< time until the footprint touches the map, or a disc; the horizon if it does not
  int greatest_cost = 0;
  double clear_s() const { return std::min(map_s, disc_s); }
};

class DwaRound {
 public:
  DwaRound(const DwaSpec& spec, const CostMap& map, const Footprint& footprint, const Pose2& X,
           std::span<const MovingDisc> discs)
      : spec_(spec), map_(map), frame_(map.geometry), footprint_(footprint), X_(X), discs_(discs) {
    // Of a disc that is nearer already, it comes no nearer.
    for (const MovingDisc& disc : discs)
      keep_.push_back(disc.radius_m +
                      std::clamp(footprint_distance(footprint, X, disc.centre_M) - disc.radius_m - 0.01, 0.0,
                                 spec.disc_clearance_m));
  }

  DwaRollout drive(const PlanarTwist& v) const {
    // Steps of at most half a cell for every point of the footprint, and a tenth of a second.
    const double speed = math::hypot(v.vx_mps, v.vy_mps) + std::abs(v.w_radps) * footprint_.circumscribed_m();
    const double wanted = spec_.horizon_s * std::max(2 * speed / map_.geometry.resolution_m, 10.0);
    const int steps = static_cast<int>(std::clamp(std::ceil(wanted), 1.0, 1000.0));
    DwaRollout out{X_, spec_.horizon_s, spec_.horizon_s};
    for (int k = 1; k <= steps; ++k) {
      const double t = spec_.horizon_s * k / steps, before = spec_.horizon_s * (k - 1) / steps;
      const Pose2 at = driven(X_, v, t);
      if (footprint_contact(map_, frame_, footprint_, at) != Contact::none) {
        out.map_s = before;
        return out;
      }
      if (out.disc_s >= spec_.horizon_s && touches_disc(at, t)) out.disc_s = before;
      if (out.disc_s < spec_.horizon_s) continue;
      out.end = at;
      out.greatest_cost = std::max(out.greatest_cost,
                                   int{map_.cost[map_.geometry.index(*frame_.cell({at.x, at.y}))]});
    }
    return out;
  }

  /// Whether the robot comes too near to a disc while it drives on for a period and then brakes along its arc.
  bool safe_from_discs(const PlanarTwist& v, double braking_s) const {
    if (discs_.empty()) return true;
    const double total = spec_.period_s + braking_s;
    const int steps = std::clamp(static_cast<int>(std::ceil(total / 0.05)), 1, 400);
    for (int k = 1; k <= steps; ++k) {
      const double t = total * k / steps, brake = std::max(0.0, t - spec_.period_s);
      const double along = t - (braking_s > 0 ? brake * brake / (2 * braking_s) : 0);
      if (touches_disc(driven(X_, v, along), t)) return false;
    }
    return true;
  }

 private:
  bool touches_disc(const Pose2& at, double t) const {
    for (std::size_t i = 0; i < discs_.size(); ++i) {
      const Vec2 c = discs_[i].centre_M + t * discs_[i].velocity_M_mps;
      const double keep = keep_[i], dx = c.x - at.x, dy = c.y - at.y,
                   far = keep + footprint_.circumscribed_m();
      if (dx * dx + dy * dy < far * far && footprint_distance(footprint_, at, c) < keep) return true;
    }
    return false;
  }

  const DwaSpec& spec_;
  const CostMap& map_;
  GridFrame frame_;
  const Footprint& footprint_;
  Pose2 X_;
  std::span<const MovingDisc> discs_;
  std::vector<double> keep_;  ///< distance of each disc's centre from the footprint
};

/// Velocity nearest to a wanted one that the windows hold.
double dwa_within(const DwaWindow& window, double wanted) {
  return std::clamp(wanted, window.low, window.high);
}

/// Velocity of pure pursuit towards a point of the path, as far as the windows allow: the arc that meets the point, on the spot
/// towards one that lies aside; sideways for a robot that can.
PlanarTwist dwa_pursuit(const DwaSpec& spec, const DwaWindow& x, const DwaWindow& y, const DwaWindow& w,
                        const Pose2& X, const Pose2& target, double to_goal) {
  const auto [s, c] = math::sincos(X.theta);
  const double dx = target.x - X.x, dy = target.y - X.y;
  const Vec2 t{c * dx + s * dy, -s * dx + c * dy};
  const double far = std::max(math::hypot(t.x, t.y), 1e-6);
  // The robot can stop at the goal, with half of its deceleration.
  double speed = std::min(spec.max_vx_mps, std::sqrt(spec.acceleration_mps2 * to_goal));
  const auto turn_towards = [&](double angle) {
    const double rate = std::min(2 * std::abs(angle),
                                 std::sqrt(2 * spec.turn_acceleration_radps2 * std::abs(angle)));
    return dwa_within(w, std::copysign(rate, angle));
  };
  if (spec.max_vy_mps > 0) {
    if (std::abs(t.y) * speed > far * spec.max_vy_mps) speed = far * spec.max_vy_mps / std::abs(t.y);
    if (t.x < 0 && -t.x * speed > far * -spec.min_vx_mps) speed = far * spec.min_vx_mps / t.x;
    return {dwa_within(x, speed * t.x / far), dwa_within(y, speed * t.y / far),
            turn_towards(math::wrap_angle(target.theta - X.theta))};
  }
  const double aside = math::atan2(t.y, t.x);
  if (std::abs(aside) > spec.turn_first_rad) return {dwa_within(x, 0), 0, turn_towards(aside)};
  const double curvature = 2 * t.y / (far * far);
  // In a curve, no faster than the turn rate that can be had at once.
  const double rate = dwa_within(w, curvature * speed);
  if (std::abs(curvature) * speed > std::abs(rate) || rate * curvature < 0)
    speed = rate * curvature > 0 ? rate / curvature : 0;
  const double vx = dwa_within(x, speed);
  return {vx, 0, dwa_within(w, curvature * vx)};
}

double dwa_distance(const PathPose& a, const Pose2& b) { return math::hypot(a.pose.x - b.x, a.pose.y - b.y); }

/// Distance of a point from a side of the path.
double dwa_from_side(const PathPose& a, const PathPose& b, const Pose2& p) {
  const Vec2 d{b.pose.x - a.pose.x, b.pose.y - a.pose.y}, r{p.x - a.pose.x, p.y - a.pose.y};
  const double square = dot(d, d), t = square > 0 ? std::clamp(dot(r, d) / square, 0.0, 1.0) : 0;
  return math::hypot(r.x - t * d.x, r.y - t * d.y);
}

}  // namespace

double footprint_distance(const Footprint& footprint, const Pose2& X, Vec2 point_M) {
  const auto [s, c] = math::sincos(X.theta);
  const Vec2 d{point_M.x - X.x, point_M.y - X.y}, p{c * d.x + s * d.y, -s * d.x + c * d.y};
  const auto corners = footprint.corners();
  if (corners.empty()) return math::hypot(p.x, p.y) - footprint.circumscribed_m();
  double best = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 a = corners[i], b = corners[i + 1 < corners.size() ? i + 1 : 0], side = b - a, r = p - a;
    const double square = dot(side, side), t = square > 0 ? std::clamp(dot(r, side) / square, 0.0, 1.0) : 0;
    best = std::min(best, math::hypot(r.x - t * side.x, r.y - t * side.y));
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside ? 0 : best;
}

DwaStep choose_velocity(const DwaSpec& spec, DwaState& state, const CostMap& map, const Footprint& footprint,
                        std::span<const PathPose> path, const Pose2& X, const PlanarTwist& velocity,
                        std::span<const MovingDisc> discs) {
  DwaStep out;
  if (path.empty() || state.at >= path.size() || !is_finite(X) || !std::isfinite(velocity.vx_mps) ||
      !std::isfinite(velocity.vy_mps) || !std::isfinite(velocity.w_radps))
    return out;

  // Where the robot is along the path: nearer and nearer, within two lookaheads.
  double along = 0, nearest = dwa_distance(path[state.at], X);
  for (std::size_t i = state.at; i + 1 < path.size() && along < 2 * spec.lookahead_m; ++i) {
    along += dwa_distance(path[i], path[i + 1].pose);
    if (const double d = dwa_distance(path[i + 1], X); d <= nearest) {
      nearest = d;
      state.at = static_cast<std::uint32_t>(i + 1);
    }
  }
  if (nearest > spec.max_deviation_m) return out;
  std::size_t ahead = state.at;
  for (double far = 0; ahead + 1 < path.size() && far < spec.lookahead_m; ++ahead)
    far += dwa_distance(path[ahead], path[ahead + 1].pose);
  const PathPose& target = path[ahead];
  out.target_M = {target.pose.x, target.pose.y};

  const Pose2& goal = path.back().pose;
  const double to_goal = math::hypot(goal.x - X.x, goal.y - X.y),
               off = math::wrap_angle(goal.theta - X.theta);
  const bool last = ahead + 1 >= path.size();
  if (last && to_goal <= spec.goal_tolerance_m) state.turning = true;
  if (to_goal > 2 * spec.goal_tolerance_m) state.turning = false;
  if (state.turning && std::abs(off) <= spec.goal_tolerance_rad) {
    out.status = Driving::arrived;
    out.clear_s = spec.horizon_s;
    return out;
  }

  const double change = spec.acceleration_mps2 * spec.period_s,
               turn_change = spec.turn_acceleration_radps2 * spec.period_s;
  DwaWindow x = dwa_window(velocity.vx_mps, spec.min_vx_mps, spec.max_vx_mps, change),
            y = dwa_window(velocity.vy_mps, -spec.max_vy_mps, spec.max_vy_mps, change);
  const DwaWindow w = dwa_window(velocity.w_radps, -spec.max_w_radps, spec.max_w_radps, turn_change);
  const DwaRound round(spec, map, footprint, X, discs);
  // The path itself, where it is clear: the straight way, which samples that weigh costs swerve from.
  for (const double share : {1.0, 0.6, 0.35}) {
    if (state.turning) break;
    std::size_t at = state.at;
    for (double far = 0; at < ahead && far < share * spec.lookahead_m; ++at)
      far += dwa_distance(path[at], path[at + 1].pose);
    const PlanarTwist v = dwa_pursuit(spec, x, y, w, X, path[at].pose, to_goal);
    const double speed = math::hypot(v.vx_mps, v.vy_mps), away = dwa_distance(path[at], X),
                 braking_s = dwa_braking_s(spec, v);
    const DwaRollout rollout = round.drive(v);
    const double needed_s = std::max(spec.period_s + braking_s, away / std::max(speed, 1e-3));
    if (rollout.map_s < std::min(spec.horizon_s, needed_s) || rollout.disc_s < spec.horizon_s ||
        !round.safe_from_discs(v, braking_s))
      continue;
    out.status = Driving::driving;
    out.command = v;
    out.clear_s = rollout.clear_s();
    return out;
  }

  double best = std::numeric_limits<double>::infinity();
  const bool sideways = spec.max_vy_mps > 0;
  for (int i = 0; i < spec.vx_samples; ++i)
    for (int j = 0; j < (sideways ? spec.vy_samples : 1); ++j)
      for (int k = 0; k < spec.w_samples; ++k) {
        const PlanarTwist v{dwa_sample(x, i, spec.vx_samples),
                            sideways ? dwa_sample(y, j, spec.vy_samples) : 0,
                            dwa_sample(w, k, spec.w_samples)};
        const double speed = math::hypot(v.vx_mps, v.vy_mps);
        if (sideways && speed > spec.max_vx_mps && speed > math::hypot(velocity.vx_mps, velocity.vy_mps))
          continue;
        const DwaRollout rollout = round.drive(v);
        // The robot drives on for a period and then brakes along the same arc.
        const double braking_s = dwa_braking_s(spec, v);
        if (rollout.map_s < std::min(spec.horizon_s, spec.period_s + braking_s) ||
            !round.safe_from_discs(v, braking_s))
          continue;
        double score = spec.obstacle_weight * rollout.greatest_cost / 252 +
                       spec.contact_weight * (1 - rollout.clear_s() / spec.horizon_s);
        if (state.turning) {
          // At the goal: stand still and end at its heading, from which the robot can stop.
          const double rest = math::wrap_angle(goal.theta - X.theta - v.w_radps * spec.period_s),
                       braking = v.w_radps * std::abs(v.w_radps) / (2 * spec.turn_acceleration_radps2);
          score += 10 * speed + std::abs(math::wrap_angle(rest - braking));
        } else {
          const double dx = target.pose.x - rollout.end.x, dy = target.pose.y - rollout.end.y,
                       away = math::hypot(dx, dy);
          double from_path = std::numeric_limits<double>::infinity();
          for (std::size_t n = state.at > 0 ? state.at - 1 : 0; n < ahead; ++n)
            from_path = std::min(from_path, dwa_from_side(path[n], path[n + 1], rollout.end));
          if (!std::isfinite(from_path)) from_path = dwa_distance(path[ahead], rollout.end);
          score += spec.goal_weight * away + spec.path_weight * from_path;
          // Very near to the target its direction says nothing.
          const double course = away > spec.goal_tolerance_m / 2 ? math::atan2(dy, dx) : rollout.end.theta;
          const double facing = sideways ? target.pose.theta : course;
          score += spec.heading_weight * std::abs(math::wrap_angle(facing - rollout.end.theta));
        }
        if (!(score < best)) continue;
        best = score;
        out.command = v;
        out.clear_s = rollout.clear_s();
      }
  out.status = Driving::driving;
  if (std::isfinite(best)) return out;
  // Nothing is admissible: brake as hard as the robot can, along the arc that was found free before.
  const double braking_s = dwa_braking_s(spec, velocity),
               keep = std::max(0.0, 1 - spec.period_s / std::max(braking_s, 1e-9));
  out.status = Driving::blocked;
  out.command = {keep * velocity.vx_mps, keep * velocity.vy_mps, keep * velocity.w_radps};
  return out;
}

}  // namespace sandlot::navigation
