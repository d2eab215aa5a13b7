#pragma once
/// Rooms for tests: rectangles with boxes, rasterised into a grid map, and an analytic ray caster that knows no grid.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"
#include "navigation/localisation/planar.h"
#include "navigation/maps/occupancy.h"

namespace sandlot::navigation::test {

/// Obstacle: a rectangle of half sides hx, hy, turned.
struct Box {
  Vec2 centre;
  double hx = 0, hy = 0, turn_rad = 0;

  Vec2 to_box(Vec2 d) const {
    const auto [s, c] = math::sincos(turn_rad);
    return {c * d.x + s * d.y, -s * d.x + c * d.y};
  }
  /// Distance along a ray to its surface; infinite when it misses. By slabs.
  double hit(Vec2 from, Vec2 direction) const {
    const Vec2 p = to_box(from - centre), d = to_box(direction);
    double enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
    const double at[2] = {p.x, p.y}, step[2] = {d.x, d.y}, half[2] = {hx, hy};
    for (int k = 0; k < 2; ++k) {
      if (std::abs(step[k]) < 1e-12) {
        if (std::abs(at[k]) > half[k]) return std::numeric_limits<double>::infinity();
        continue;
      }
      const double a = (-half[k] - at[k]) / step[k], b = (half[k] - at[k]) / step[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave && enter > 0 ? enter : std::numeric_limits<double>::infinity();
  }
  double distance(Vec2 p_M) const {
    const Vec2 p = to_box(p_M - centre);
    return math::hypot(std::max(std::abs(p.x) - hx, 0.0), std::max(std::abs(p.y) - hy, 0.0));
  }
};

/// Interior [0, width] x [0, height] of solid walls, in the map's frame M.
struct Room {
  double width = 0, height = 0;
  std::vector<Box> boxes;

  double cast(Vec2 from, double angle) const {
    const auto [s, c] = math::sincos(angle);
    double out = std::numeric_limits<double>::infinity();
    if (c > 1e-12) out = std::min(out, (width - from.x) / c);
    if (c < -1e-12) out = std::min(out, -from.x / c);
    if (s > 1e-12) out = std::min(out, (height - from.y) / s);
    if (s < -1e-12) out = std::min(out, -from.y / s);
    for (const Box& box : boxes) out = std::min(out, box.hit(from, {c, s}));
    return out;
  }
  double clearance(Vec2 p) const {
    double out = std::min({p.x, p.y, width - p.x, height - p.y});
    for (const Box& box : boxes) out = std::min(out, box.distance(p));
    return out;
  }
  /// Cells whose centre is in a wall or a box are occupied. `turn_rad` turns the grid's axes in M.
  GridMap map(double resolution_m = 0.05, double turn_rad = 0) const {
    // A square about the room that holds it at any turn.
    const double side = turn_rad == 0 ? 0 : math::hypot(width, height);
    const double w = std::max(side, width) + 0.4, h = std::max(side, height) + 0.4;
    const auto [s, c] = math::sincos(turn_rad);
    const Vec2 corner{width / 2 - (c * w - s * h) / 2, height / 2 - (s * w + c * h) / 2};
    GridMap out{{static_cast<int>(std::ceil(w / resolution_m)),
                 static_cast<int>(std::ceil(h / resolution_m)),
                 resolution_m,
                 {corner.x, corner.y, turn_rad}},
                {}};
    const GridFrame frame(out.geometry);
    for (int y = 0; y < out.geometry.height; ++y)
      for (int x = 0; x < out.geometry.width; ++x)
        out.occupancy.push_back(clearance(frame.centre({x, y})) <= 0 ? std::int8_t{100} : std::int8_t{0});
    return out;
  }
};

/// Room of 10 m x 7 m with six boxes, which looks different from everywhere.
inline Room furnished_room() {
  return {10,
          7,
          {{{2.0, 5.8}, 0.9, 0.4, 0},
           {{7.6, 1.1}, 0.5, 0.8, 0},
           {{5.1, 3.6}, 0.35, 0.35, 0.5},
           {{9.3, 5.6}, 0.7, 0.25, 0},
           {{0.5, 1.6}, 0.5, 0.5, 0},
           {{6.2, 6.4}, 0.3, 0.6, -0.3}}};
}

struct Laser {
  int beams = 181;
  double first_rad = -math::pi * 3 / 4, span_rad = math::pi * 3 / 2;
  double range_max_m = 12, deviation_m = 0.01;
  Pose X_BL{{0.1, 0, 0.3}, {}};
};

/// Scan taken with the base at X_MB. A share of the beams ends somewhere before the wall.
inline msg::LaserScan scan_at(const Room& room, const Laser& laser, const Pose2& X_MB, Time stamp,
                              Stream& random, double short_share = 0) {
  msg::LaserScan out;
  out.header.stamp = stamp;
  out.angle_min = static_cast<float>(laser.first_rad);
  out.angle_increment = static_cast<float>(laser.span_rad / (laser.beams - 1));
  out.angle_max = static_cast<float>(laser.first_rad + laser.span_rad);
  out.range_min = 0.05f;
  out.range_max = static_cast<float>(laser.range_max_m);
  const Pose2 X_ML = compose(
      X_MB, {laser.X_BL.p.x, laser.X_BL.p.y, 2 * math::atan2(laser.X_BL.q.z, laser.X_BL.q.w)});
  for (int i = 0; i < laser.beams; ++i) {
    double range = room.cast({X_ML.x, X_ML.y}, X_ML.theta + static_cast<double>(out.angle_min) +
                                                   i * static_cast<double>(out.angle_increment)) +
                   laser.deviation_m * random.normal();
    if (short_share > 0 && random.uniform() < short_share) range *= random.uniform(0.1, 1);
    out.ranges.push_back(range < laser.range_max_m ? static_cast<float>(range)
                                                   : std::numeric_limits<float>::infinity());
  }
  return out;
}

/// Random pose with some room about it.
inline Pose2 placed(const Room& room, Stream& random, double clearance_m = 0.4) {
  for (;;) {
    const Pose2 pose{random.uniform(0, room.width), random.uniform(0, room.height),
                     random.uniform(-math::pi, math::pi)};
    if (room.clearance({pose.x, pose.y}) >= clearance_m) return pose;
  }
}

/// Robot that wanders: ahead by `step_m` with a slight turn, or a turn on the spot where the way is not free; and its
/// odometry, with a wrong scale, a drift of the heading and noise.
struct Wanderer {
  const Room& room;
  Pose2 X_MB, X_OB;
  double step_m = 0.1;
  double scale = 1.03, drift_radpm = 0.03, noise = 0.05;

  void go(Stream& random) {
    Pose2 motion{step_m, 0, random.uniform(-0.1, 0.1)};
    const Pose2 next = compose(X_MB, {3 * step_m + 0.2, 0, 0});
    if (room.clearance({next.x, next.y}) < 0.3) motion = {0, 0, 0.25};
    X_MB = compose(X_MB, motion);
    X_OB = compose(X_OB, {motion.x * (scale + noise * random.normal()), 0,
                          motion.theta * (1 + noise * random.normal()) + drift_radpm * motion.x});
  }
};

inline double distance(const Pose2& a, const Pose2& b) { return math::hypot(a.x - b.x, a.y - b.y); }
inline double turn(const Pose2& a, const Pose2& b) { return std::abs(math::wrap_angle(a.theta - b.theta)); }

}  // namespace sandlot::navigation::test
