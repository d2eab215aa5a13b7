#pragma once
/// Clutter of convex polygons for tests, with an independent reference: exact rays, exact contacts of a disc, and
/// the shortest way of a disc by a visibility graph of the inflated polygons.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/math.h"
#include "base/random.h"
#include "messages/sensor_ranges.h"
#include "navigation/maps/grid.h"

namespace sandlot::navigation::test {

using Polygon = std::vector<Vec2>;  // convex, counter-clockwise

inline double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
inline double length(Vec2 a) { return std::sqrt(dot(a, a)); }

/// Distance of a point from a polygon; 0 inside.
inline double distance(const Polygon& polygon, Vec2 p) {
  bool inside = true;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], d = polygon[(i + 1) % polygon.size()] - a, r = p - a;
    inside = inside && cross(d, r) >= 0;
    const double t = std::clamp(dot(r, d) / dot(d, d), 0.0, 1.0);
    best = std::min(best, length(r - t * d));
  }
  return inside ? 0 : best;
}

/// Regular polygon of n corners. @param circumradius  of its corners
inline Polygon regular(Vec2 centre, double circumradius, int n, double turn) {
  Polygon out;
  for (int i = 0; i < n; ++i) {
    const auto [s, c] = math::sincos(turn + math::tau * i / n);
    out.push_back(centre + circumradius * Vec2{c, s});
  }
  return out;
}

/// Distance along a ray to a polygon's boundary; infinite if it misses.
inline double ray(const Polygon& polygon, Vec2 from, Vec2 direction) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], d = polygon[(i + 1) % polygon.size()] - a;
    const double den = cross(direction, d);
    if (std::abs(den) < 1e-12) continue;
    const double t = cross(a - from, d) / den, u = cross(a - from, direction) / den;
    if (t > 0 && u >= 0 && u <= 1) best = std::min(best, t);
  }
  return best;
}

/// The polygon grown by a radius, its round corners by chords outside the circle: never too small.
inline Polygon inflated(const Polygon& polygon, double radius) {
  constexpr int parts = 4;
  Polygon out;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 before = polygon[i] - polygon[(i + n - 1) % n], after = polygon[(i + 1) % n] - polygon[i];
    const double from = math::atan2(-before.x, before.y),
                 turn = math::wrap_angle(math::atan2(-after.x, after.y) - from);
    const double outer = radius / math::cos(turn / parts / 2);
    for (int k = 0; k < parts; ++k) {
      const auto [s, c] = math::sincos(from + turn * (k + 0.5) / parts);
      out.push_back(polygon[i] + outer * Vec2{c, s});
    }
  }
  return out;
}

/// Whether the open segment passes through the inside of a convex polygon (Cyrus-Beck).
inline bool crosses(const Polygon& polygon, Vec2 a, Vec2 b) {
  double begin = 0, end = 1;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 p = polygon[i], d = polygon[(i + 1) % polygon.size()] - p;
    const double here = cross(d, a - p) / length(d) - 1e-9, change = cross(d, b - a) / length(d);
    if (std::abs(change) < 1e-12) {
      if (here <= 0) return false;
      continue;
    }
    const double t = -here / change;
    if (change > 0) begin = std::max(begin, t);
    else end = std::min(end, t);
  }
  return end - begin > 1e-9;
}

/// Length of the shortest way of a disc between two points; infinite if there is none.
/// Dijkstra over the corners of the inflated polygons. Its round corners are chords outside the circle, so that the
/// result is an upper bound of the optimum, within 1 % for corners of at most a right angle.
inline double shortest(const std::vector<Polygon>& obstacles, double radius, Vec2 start, Vec2 goal,
                       double half_room) {
  std::vector<Polygon> grown;
  std::vector<Vec2> node{start, goal};
  for (const Polygon& obstacle : obstacles) {
    grown.push_back(inflated(obstacle, radius));
    for (const Vec2 p : grown.back())
      if (std::abs(p.x) < half_room - radius && std::abs(p.y) < half_room - radius) node.push_back(p);
  }
  const auto free = [&](Vec2 a, Vec2 b) {
    return std::none_of(grown.begin(), grown.end(), [&](const Polygon& g) { return crosses(g, a, b); });
  };
  std::vector<double> way(node.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> done(node.size());
  way[0] = 0;
  for (;;) {
    std::size_t at = node.size();
    for (std::size_t i = 0; i < node.size(); ++i)
      if (!done[i] && std::isfinite(way[i]) && (at == node.size() || way[i] < way[at])) at = i;
    if (at == node.size()) return std::numeric_limits<double>::infinity();
    if (at == 1) return way[1];
    done[at] = true;
    for (std::size_t i = 0; i < node.size(); ++i) {
      const double cost = way[at] + length(node[i] - node[at]);
      if (!done[i] && cost < way[i] && free(node[at], node[i])) way[i] = cost;
    }
  }
}

/// Square room with polygons in it.
struct Clutter {
  double half = 5;
  std::vector<Polygon> polygons;
  Vec2 start{-4.2, -4.2}, goal{4.2, 4.2};

  static Clutter random(std::uint64_t seed, int count) {
    Clutter out;
    Stream random(seed, entity_key("clutter"), Purpose::experiment, seed);
    for (int tries = 0; tries < 1000 && static_cast<int>(out.polygons.size()) < count; ++tries) {
      const Vec2 c{random.uniform(-4.4, 4.4), random.uniform(-4.4, 4.4)};
      const double size = random.uniform(0.15, 0.6);
      const int corners = 3 + static_cast<int>(random.uniform(0, 5.999));
      const double turn = random.uniform(0, math::tau);
      if (length(c - out.start) < size + 0.8 || length(c - out.goal) < size + 0.8) continue;
      out.polygons.push_back(regular(c, size, corners, turn));
    }
    return out;
  }
  double clearance(Vec2 p) const {
    double best = std::min(half - std::abs(p.x), half - std::abs(p.y));
    for (const Polygon& polygon : polygons) best = std::min(best, distance(polygon, p));
    return best;
  }
  /// Map of the room with a cell's width around it: every cell that an obstacle touches, as a laser finds them in time.
  GridMap map(double resolution_m) const {
    const int side = 2 * static_cast<int>(half / resolution_m) + 2;
    GridMap out{{side, side, resolution_m, {-resolution_m * side / 2, -resolution_m * side / 2, 0}}, {}};
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const Vec2 p = GridFrame(out.geometry).to_map({x + 0.5, y + 0.5});
        out.occupancy.push_back(clearance(p) <= 0.7072 * resolution_m ? 100 : 0);
      }
    return out;
  }
};

struct Mover {
  Vec2 centre, velocity;
  double radius = 0.2;
  bool touches = false;  ///< the robot
};

inline msg::LaserScan scan(const Clutter& room, std::span<const Mover> movers, const Pose2& X,
                           int beams = 360) {
  msg::LaserScan out;
  out.angle_min = static_cast<float>(-math::pi);
  out.angle_increment = static_cast<float>(math::tau / beams);
  out.range_min = 0.02f;
  out.range_max = 12;
  for (int i = 0; i < beams; ++i) {
    const auto [s, c] = math::sincos(X.theta - math::pi + math::tau * i / beams);
    const Vec2 p{X.x, X.y}, d{c, s};
    double range = std::min((d.x > 0 ? room.half - p.x : room.half + p.x) / std::max(std::abs(d.x), 1e-12),
                            (d.y > 0 ? room.half - p.y : room.half + p.y) / std::max(std::abs(d.y), 1e-12));
    for (const Polygon& polygon : room.polygons) range = std::min(range, ray(polygon, p, d));
    for (const Mover& m : movers) {
      const Vec2 to = m.centre - p;
      const double along = dot(to, d), rest = m.radius * m.radius - (dot(to, to) - along * along);
      if (rest > 0 && along > 0) range = std::min(range, along - std::sqrt(rest));
    }
    out.ranges.push_back(range < 12 ? static_cast<float>(range) : std::numeric_limits<float>::infinity());
  }
  return out;
}

}  // namespace sandlot::navigation::test
