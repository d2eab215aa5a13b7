#include "navigation/planning/pursuit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sandlot::navigation {
namespace {

constexpr std::array<EnumName<Drive>, 3> pursuit_drives{
    {{"differential", Drive::differential}, {"car", Drive::car}, {"omni", Drive::omni}}};

Vec2 pursuit_point(const PathPose& at) { return {at.pose.x, at.pose.y}; }
double pursuit_distance(Vec2 a, Vec2 b) { return math::hypot(a.x - b.x, a.y - b.y); }

enum class PursuitWay { forward, backward, turn };
PursuitWay pursuit_way(const PathPose& at, Drive drive) {
  if (drive == Drive::omni) return PursuitWay::forward;
  return at.direction_B == Vec2{0, 0} ? PursuitWay::turn
         : at.direction_B.x < 0       ? PursuitWay::backward
                                      : PursuitWay::forward;
}

/// Last pose of the section that goes on from a pose.
std::size_t pursuit_section_end(std::span<const PathPose> path, std::size_t at, Drive drive) {
  std::size_t end = std::min(at + 1, path.size() - 1);
  while (end + 1 < path.size() && pursuit_way(path[end + 1], drive) == pursuit_way(path[end], drive)) ++end;
  return end;
}

/// Point where the path, from a pose on, first leaves the circle about a centre; the section's end if it does not.
Vec2 pursuit_target(std::span<const PathPose> path, std::size_t at, std::size_t end, Vec2 centre,
                    double radius) {
  for (std::size_t i = at; i < end; ++i) {
    const Vec2 a = pursuit_point(path[i]) - centre, d = pursuit_point(path[i + 1]) - pursuit_point(path[i]);
    const Vec2 b = a + d;
    if (dot(b, b) < radius * radius) continue;
    const double dd = dot(d, d), ad = dot(a, d), rest = dot(a, a) - radius * radius;
    if (rest >= 0 || !(dd > 0)) return pursuit_point(path[i + (rest >= 0 ? 0 : 1)]);
    const double t = (-ad + std::sqrt(ad * ad - dd * rest)) / dd;
    return pursuit_point(path[i]) + std::clamp(t, 0.0, 1.0) * d;
  }
  return pursuit_point(path[end]);
}

/// Turn rate that ends at an angle: the greatest from which the robot still stops in time.
double pursuit_turn_rate(const PursuitSpec& spec, double angle, double dt_s) {
  const double braking = std::sqrt(2 * spec.turn_acceleration_radps2 * std::abs(angle));
  const double rate = std::min({spec.max_turn_rate_radps, braking, std::abs(angle) / dt_s});
  return angle < 0 ? -rate : rate;
}

/// The pose's share of the way along the path: moves on while that comes nearer, within two lookaheads.
double pursuit_advance(const PursuitSpec& spec, PursuitState& state, std::span<const PathPose> path,
                       std::size_t end, Vec2 p) {
  double nearest = pursuit_distance(pursuit_point(path[state.at]), p), along = 0;
  std::size_t best = state.at;
  for (std::size_t i = state.at; i < end && along < 2 * spec.max_lookahead_m; ++i) {
    along += pursuit_distance(pursuit_point(path[i]), pursuit_point(path[i + 1]));
    const double d = pursuit_distance(pursuit_point(path[i + 1]), p);
    if (d > nearest) continue;
    nearest = d;
    best = i + 1;
  }
  // The pose before the nearest one, so that the side in between stays ahead.
  state.at = static_cast<std::uint32_t>(best == end && best > state.at ? best - 1 : best);
  return nearest;
}

}  // namespace

std::span<const EnumName<Drive>> enum_names(Drive) { return pursuit_drives; }

PursuitStep pursue(const PursuitSpec& spec, PursuitState& state, std::span<const PathPose> path,
                   const Pose2& X, const CostMap* map, double dt_s) {
  PursuitStep out;
  const auto stop = [&](Following status) {
    state.speed_mps = 0;
    out.status = status;
    out.command = {};
    return out;
  };
  if (path.empty() || !is_finite(X) || !(dt_s > 0) || state.at >= path.size()) return stop(Following::lost);
  const Vec2 p{X.x, X.y};
  const auto [s, c] = math::sincos(X.theta);
  const auto in_robot = [&, s = s, c = c](Vec2 point) {
    const Vec2 d = point - p;
    return Vec2{c * d.x + s * d.y, -s * d.x + c * d.y};
  };

  for (;;) {
    const std::size_t end = pursuit_section_end(path, state.at, spec.drive);
    const bool last = end + 1 >= path.size();
    const Pose2& end_pose = path[end].pose;
    const double to_heading = math::wrap_angle(end_pose.theta - X.theta);
    const PursuitWay way = pursuit_way(path[end], spec.drive);
    if (way == PursuitWay::turn) {
      out.target_M = pursuit_point(path[end]);
      if (std::abs(to_heading) > spec.goal_tolerance_rad) {
        state.speed_mps = 0;
        out.status = Following::driving;
        out.command = {0, 0, pursuit_turn_rate(spec, to_heading, dt_s)};
        return out;
      }
      if (last) return stop(Following::arrived);
      state.at = static_cast<std::uint32_t>(end);
      continue;
    }

    out.deviation_m = pursuit_advance(spec, state, path, end, p);
    if (out.deviation_m > spec.max_deviation_m) return stop(Following::lost);
    const double sign = way == PursuitWay::backward ? -1 : 1;
    const Vec2 end_B = in_robot(pursuit_point(path[end]));
    const double to_end = math::hypot(end_B.x, end_B.y);
    // The end is passed when it lies abeam of a robot that has come to it.
    const bool near_end = state.at + 2 >= end + 1 || to_end <= spec.goal_tolerance_m;
    const bool passed = near_end && (spec.drive != Drive::omni) && sign * end_B.x <= 0 &&
                        std::abs(end_B.y) < spec.min_lookahead_m + spec.goal_tolerance_m;
    if (to_end <= spec.goal_tolerance_m || (passed && (!last || spec.drive == Drive::car))) {
      if (!last) {
        state.at = static_cast<std::uint32_t>(end);
        continue;
      }
      if (to_end > spec.goal_tolerance_m) return stop(Following::missed);
      if (spec.drive == Drive::car || std::abs(to_heading) <= spec.goal_tolerance_rad)
        return stop(Following::arrived);
      if (spec.drive == Drive::differential) {
        state.speed_mps = 0;
        out.status = Following::driving;
        out.target_M = pursuit_point(path[end]);
        out.command = {0, 0, pursuit_turn_rate(spec, to_heading, dt_s)};
        return out;
      }
    }

    const double lookahead = std::clamp(spec.lookahead_time_s * std::abs(state.speed_mps),
                                        spec.min_lookahead_m,
                                        std::max(spec.min_lookahead_m, spec.max_lookahead_m));
    out.target_M = pursuit_target(path, state.at, end, p, lookahead);
    out.status = Following::driving;
    const Vec2 t = in_robot(out.target_M);
    const double square = std::max(dot(t, t), 1e-12), aside = math::atan2(sign * t.y, sign * t.x);

    // Turn first where the target lies aside; go on until it lies well ahead.
    if (spec.drive == Drive::differential) {
      if (std::abs(aside) > spec.turn_first_rad) state.turning = true;
      if (std::abs(aside) < spec.turn_first_rad / 4) state.turning = false;
      if (state.turning) {
        state.speed_mps = 0;
        out.command = {0, 0, pursuit_turn_rate(spec, aside, dt_s)};
        return out;
      }
    }

    double curvature = 2 * t.y / square;
    if (spec.drive == Drive::car)
      curvature = std::clamp(curvature, -1 / spec.turning_radius_m, 1 / spec.turning_radius_m);
    double speed = spec.speed_mps;
    if (spec.drive != Drive::omni && std::abs(curvature) * spec.curve_radius_m > 1)
      speed = spec.speed_mps / (std::abs(curvature) * spec.curve_radius_m);
    if (map && spec.obstacle_distance_m > 0)
      if (const auto cell = GridFrame(map->geometry).cell(p)) {
        const double distance = static_cast<double>(map->distance_m[map->geometry.index(*cell)]);
        speed = std::min(speed, spec.speed_mps * std::min(1.0, distance / spec.obstacle_distance_m));
      }
    if (spec.approach_distance_m > 0)
      speed = std::min(speed, spec.speed_mps * std::min(1.0, to_end / spec.approach_distance_m));
    speed = std::max(speed, std::min(spec.min_speed_mps, spec.speed_mps));
    if (sign < 0) speed = std::min(speed, spec.backward_speed_mps);
    if (spec.drive != Drive::omni && std::abs(curvature) * speed > spec.max_turn_rate_radps)
      speed = spec.max_turn_rate_radps / std::abs(curvature);
    const double change = spec.acceleration_mps2 * dt_s;
    state.speed_mps = std::clamp(sign * speed, state.speed_mps - change, state.speed_mps + change);

    if (spec.drive == Drive::omni) {
      // Heading of the path where the target lies, in front of the robot by the lookahead.
      std::size_t facing = state.at;
      while (facing < end && pursuit_distance(pursuit_point(path[facing]), p) < lookahead) ++facing;
      const double length = std::sqrt(square), x = t.x / length, y = t.y / length;
      double v = std::min(std::abs(state.speed_mps), length / dt_s);
      if (v * -x > spec.backward_speed_mps) v = spec.backward_speed_mps / -x;
      if (v * std::abs(y) > spec.sideways_speed_mps) v = spec.sideways_speed_mps / std::abs(y);
      out.command = {v * x, v * y,
                     pursuit_turn_rate(spec, math::wrap_angle(path[facing].pose.theta - X.theta), dt_s)};
    } else {
      out.command = {state.speed_mps, 0, state.speed_mps * curvature};
    }
    return out;
  }
}

}  // namespace sandlot::navigation
