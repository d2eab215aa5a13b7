#pragma once
/// Steering in exact operations: +, -, *, / and the square root alone, which IEEE 754 rounds the same in every language and on
/// every machine. The law therefore orders the same bits as part of Sandlot, as a plugin, and in a client written in C++ or
/// Python (docs/clients.md).
///
/// Frame    all points and headings in the frame of the world, seen from above. Headings are unit vectors, not angles.
/// Angles   by angle_of() alone, within 1e-15 rad of the true one.
/// Limits   compilers must not fuse products with sums (-ffp-contract=off). A way goes around one disc at a time.
/// Cost     three square roots and two divisions per angle, no allocation.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace sandlot::controllers::clearing::exact {

inline constexpr double pi = 3.14159265358979323846;

struct Vec {
  double x = 0, y = 0;
  friend constexpr Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec operator*(double s, Vec a) { return {s * a.x, s * a.y}; }
};

constexpr double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }
constexpr double cross(Vec a, Vec b) { return a.x * b.y - a.y * b.x; }
inline double norm(Vec a) { return std::sqrt(dot(a, a)); }
/// a / |a|; along x when a has no length.
inline Vec unit(Vec a) {
  const double length = norm(a);
  return length > 0 ? Vec{a.x / length, a.y / length} : Vec{1, 0};
}

/// The angle of a vector in [-pi, pi], 0 when it has no length.
///
/// The arc tangent of t in [0, 1] by halving twice, atan(t) = 2 atan(t / (1 + sqrt(1 + t t))), which leaves t below 0.2, and its
/// power series up to t^19: the first term left out is below 1e-16.
inline double angle_of(Vec v) {
  const double x = std::abs(v.x), y = std::abs(v.y);
  const double larger = std::max(x, y), smaller = std::min(x, y);
  if (!(larger > 0)) return 0;
  double t = smaller / larger;
  t = t / (1 + std::sqrt(1 + t * t));
  t = t / (1 + std::sqrt(1 + t * t));
  const double t2 = t * t;
  double sum = 0;
  for (int k = 19; k > 1; k -= 2) sum = t2 * (1.0 / k - sum);
  double angle = 4 * (t - t * sum);
  if (y > x) angle = pi / 2 - angle;
  if (v.x < 0) angle = pi - angle;
  return v.y < 0 ? -angle : angle;
}
/// The angle by which `from` has to be turned to point along `to`, in [-pi, pi].
inline double turn_between(Vec from, Vec to) { return angle_of({dot(from, to), cross(from, to)}); }
/// The difference of two angles of angle_of(), by the short way.
inline double angle_between(double from_rad, double to_rad) {
  const double turn = to_rad - from_rad;
  return turn > pi ? turn - 2 * pi : turn < -pi ? turn + 2 * pi : turn;
}

/// Number in [0, 1), 53 bits, for one of several uses of a step's random number: splitmix64.
inline double draw(std::uint64_t random, std::uint64_t use) {
  std::uint64_t z = random + use * 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  z = z ^ (z >> 31);
  return static_cast<double>(z >> 11) * 0x1p-53;
}

/// Place of a robot.
struct Place {
  Vec at, heading{1, 0};  ///< heading: unit vector
};
/// @param x,y,z,w  quaternion of the orientation
inline Place place(double at_x, double at_y, double x, double y, double z, double w) {
  return {{at_x, at_y}, unit({1 - 2 * (y * y + z * z), 2 * (x * y + w * z)})};
}
/// A point in the frame of a robot: x ahead, y to the left.
inline Vec seen_from(const Place& robot, Vec point) {
  const Vec off = point - robot.at;
  return {dot(robot.heading, off), cross(robot.heading, off)};
}

/// Largest rates of a robot.
struct Limits {
  double speed_mps = 0.3;
  double turn_speed_radps = 2;
};
/// What a drive is ordered to do.
struct Motion {
  double forward_mps = 0, turn_radps = 0;
};
/// An area to keep out of.
struct Disc {
  Vec centre;
  double radius_m = 0;
};

/// Turns to a direction, a unit vector, on the spot: with 3/s of the error.
inline Motion turn_to(const Place& robot, Vec direction, const Limits& limits) {
  const double turn = 3 * turn_between(robot.heading, direction);
  return {0, std::max(-limits.turn_speed_radps, std::min(turn, limits.turn_speed_radps))};
}
/// Drives along a direction: the slower the larger the error is; beyond 90 degrees it stands.
inline Motion drive_along(const Place& robot, Vec direction, const Limits& limits) {
  Motion motion = turn_to(robot, direction, limits);
  motion.forward_mps = limits.speed_mps * std::max(0.0, dot(robot.heading, direction));
  return motion;
}
/// Drives to a point: turns to it on the spot until it is within 60 degrees, then along it, slower in the last 10 cm.
inline Motion drive_to(const Place& robot, Vec point, const Limits& limits) {
  const Vec way = point - robot.at;
  const double distance = norm(way);
  if (distance < 1e-6) return {};
  const Vec direction = unit(way);
  if (dot(robot.heading, direction) < 0.5) return turn_to(robot, direction, limits);
  const double slower = std::max(0.2, std::min(distance / 0.1, 1.0));
  return drive_along(robot, direction, {slower * limits.speed_mps, limits.turn_speed_radps});
}

/// Where to head for to come from `from` to `to` without entering the discs: `to` itself, or a point beside the nearest disc in the
/// way, on the shorter side. Discs around `to` are left out; from within a disc the way leads along its edge.
inline Vec way_around(Vec from, Vec to, const std::vector<Disc>& discs) {
  Vec aim = to;
  const Disc* passed = nullptr;
  for (int k = 0; k < 4; ++k) {
    const double length = norm(aim - from);
    if (length < 1e-6) return aim;
    const Vec along = unit(aim - from);
    const Disc* nearest = nullptr;
    double nearest_m = 0, nearest_radius_m = 0;
    for (const Disc& disc : discs) {
      if (&disc == passed || norm(disc.centre - to) < disc.radius_m) continue;
      const Vec off = disc.centre - from;
      const double radius = std::min(disc.radius_m, 0.95 * norm(off));
      const double ahead = dot(off, along);
      if (ahead <= 0 || ahead - radius > length || std::abs(cross(along, off)) >= radius) continue;
      if (nearest && ahead >= nearest_m) continue;
      nearest = &disc, nearest_m = ahead, nearest_radius_m = radius;
    }
    if (!nearest) return aim;
    // The tangent on the side where `to` lies: to the left of the centre when it lies to the left of the line there.
    const Vec off = nearest->centre - from;
    const double apart = norm(off);
    const double sine = (cross(off, to - from) >= 0 ? 1.0 : -1.0) * nearest_radius_m / apart;
    const double cosine = std::sqrt(1 - sine * sine);
    const double tangent = std::max(
        std::sqrt(std::max(0.0, apart * apart - nearest_radius_m * nearest_radius_m)), 0.1);
    const Vec straight = unit(off);
    const Vec turned{cosine * straight.x - sine * straight.y, sine * straight.x + cosine * straight.y};
    aim = from + tangent * turned;
    passed = nearest;
  }
  return aim;
}

}  // namespace sandlot::controllers::clearing::exact
