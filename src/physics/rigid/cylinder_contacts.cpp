#include "physics/rigid/cylinder_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/barrel.h"

namespace sandlot::rigid {
namespace {

/// A cylinder, a capsule or a barrel in the world.
struct Round {
  Vec3 p, a;    ///< centre, unit axis
  double r, h;  ///< radius, half of the length
  bool capsule;
  const Barrel* barrel = nullptr;

  double support(Vec3 n) const {
    if (barrel) return reach_m(*barrel, std::clamp(dot(n, a), -1.0, 1.0));
    const double c = std::abs(dot(n, a));
    return h * c + (capsule ? r : r * std::sqrt(std::max(0.0, 1 - c * c)));
  }
};

Round round_of(const Shape& shape, const Pose& X) {
  const Vec3 axis = rotate(X.q, {0, 0, 1});
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return {X.p, axis, c->radius_m, 0.5 * c->length_m, false};
  if (const auto* b = std::get_if<Barrel>(&shape))
    return {X.p, axis, b->radius_m, 0.5 * b->length_m, false, b};
  const auto& c = std::get<Capsule>(shape);
  return {X.p, axis, c.radius_m, 0.5 * c.length_m, true};
}

/// Any unit vector across a unit vector.
Vec3 across(Vec3 n) {
  const Vec3 axis = std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalised(axis - dot(axis, n) * n);
}

struct Overlap {
  const Round &A, &B;
  Vec3 apart;
  Vec3 n;  ///< best direction so far
  double depth = 1e300;

  double at(Vec3 d) const { return A.support(d) + B.support(d) - dot(d, apart); }

  /// Takes a unit direction if it is better by more than rounding: exact candidates come first and stay.
  void offer(Vec3 d) {
    const double f = at(d);
    if (f < depth - 1e-13 * (A.r + B.r)) depth = f, n = d;
  }
  /// The one of both signs that separates.
  void offer_axis(Vec3 d) { offer(dot(d, apart) < 0 ? -d : d); }
  /// The same for a vector that may be too short to have a direction.
  void offer_along(Vec3 d) {
    const double length = norm(d);
    if (length > 1e-9 * (A.r + B.r)) offer(d / length);
  }

  /// Directions across `axis`: one circle, searched from its best of 16 points.
  void search_circle(Vec3 axis) {
    const Vec3 u = across(axis), v = cross(axis, u);
    constexpr double step_c = 0.92387953251128674, step_s = 0.38268343236508977;  // pi / 8
    double c = 1, s = 0, best = 1e300;
    Vec3 start;
    for (int i = 0; i < 16; ++i) {
      const Vec3 d = c * u + s * v;
      if (const double f = at(d); f < best) best = f, start = d;
      const double c_next = c * step_c - s * step_s;
      s = s * step_c + c * step_s;
      c = c_next;
    }
    for (double step = 0.2; step > 1e-9;) {
      const Vec3 side = cross(axis, start);
      const Vec3 left = normalised(start + step * side), right = normalised(start - step * side);
      const double f = at(left), g = at(right);
      if (f < best && f <= g) best = f, start = left;
      else if (g < best) best = g, start = right;
      else step *= 0.5;
    }
    offer(start);
  }

  /// All directions round one: where rims meet the minimum is smooth.
  void search_around(Vec3 start) {
    double best = at(start);
    for (double step = 0.2; step > 1e-9;) {
      const Vec3 u = across(start), v = cross(start, u);
      Vec3 better = start;
      for (const Vec3 side : {u, v, -u, -v, u + v, u - v, v - u, -u - v}) {
        const Vec3 d = normalised(start + step * side);
        if (const double f = at(d); f < best) best = f, better = d;
      }
      if (better == start) step *= 0.5;
      start = better;
    }
    offer(start);
  }
};

/// The part of a body that faces direction n.
struct Face {
  enum Kind { point, line, disc } kind;
  Vec3 p;       ///< the point; the middle of the line; the centre of the disc
  Vec3 a;       ///< along the line; across the disc
  double size;  ///< half length; radius
};

Face face(const Round& x, Vec3 n) {
  // Within 0.02 rad faces count as flat: their points get their own depths, and those that are apart are
  // dropped.
  constexpr double flat = 0.02;
  const double c = dot(n, x.a), s = std::sqrt(std::max(0.0, 1 - c * c));
  const Vec3 end = x.p + (c < 0 ? -x.h : x.h) * x.a;
  if (!x.capsule && s < flat) return {Face::disc, end, x.a, x.barrel ? end_radius_m(*x.barrel) : x.r};
  if (x.barrel) {
    const Vec3 p = farthest(*x.barrel, {s, 0, c});
    return {Face::point, x.p + p.x / s * (n - c * x.a) + p.z * x.a, {}, 0};
  }
  const Vec3 out = x.capsule ? x.r * n : x.r / s * (n - c * x.a);
  if (std::abs(c) < flat) return {Face::line, x.p + out, x.a, x.h};
  return {Face::point, end + out, {}, 0};
}

/// Collects points on both faces.
struct Manifold {
  Vec3 n;
  Face A, B;
  double depth;
  struct Point {
    Vec3 at;
    double depth;
  };
  std::array<Point, 4> points{};
  std::size_t count = 0;

  /// Height of the face above `x`, along n.
  double height(const Face& f, Vec3 x) const {
    if (f.kind == Face::disc) return dot(f.p - x, f.a) / dot(n, f.a);
    if (f.kind == Face::line) {
      const Vec3 along = f.a - dot(f.a, n) * n;
      const double t = dot(x - f.p, along) / dot(along, along);
      return dot(f.p + t * f.a - x, n);
    }
    return dot(f.p - x, n);
  }
  void add(Vec3 x) {
    const double over = height(A, x), under = height(B, x);
    if (over - under < 0 || count == points.size()) return;
    points[count++] = {x + 0.5 * (over + under) * n, over - under};
  }

  void disc_disc() {
    const Vec3 between = B.p - A.p;
    const Vec3 level = between - dot(between, n) * n;
    const double d = norm(level);
    const Vec3 u = d > 1e-9 * (A.size + B.size) ? level / d : across(n);
    const Vec3 v = cross(n, u);
    const Face& small = A.size < B.size ? A : B;
    if (d + small.size <= std::max(A.size, B.size)) {
      for (const Vec3 side : {u, v, -u, -v}) add(small.p + small.size * side);
      return;
    }
    // A lens: its two corners, and the middles of its two arcs.
    const double x = (d * d + A.size * A.size - B.size * B.size) / (2 * d);
    const double y = std::sqrt(std::max(0.0, A.size * A.size - x * x));
    add(A.p + x * u + y * v);
    add(A.p + x * u - y * v);
    add(A.p + A.size * u);
    add(B.p - B.size * u);
  }
  void disc_line(const Face& disc, const Face& line) {
    const Vec3 to = disc.p - line.p;
    const double t = dot(to, line.a);
    const Vec3 level = to - t * line.a;
    const Vec3 off = level - dot(level, n) * n;
    const double half = std::sqrt(std::max(0.0, disc.size * disc.size - dot(off, off)));
    add(line.p + std::clamp(t - half, -line.size, line.size) * line.a);
    add(line.p + std::clamp(t + half, -line.size, line.size) * line.a);
  }
  void line_line() {
    const double c = dot(A.a, B.a), t = dot(B.p - A.p, A.a);
    if (std::abs(c) > 0.9998) {  // parallel to 0.02 rad: the stretch they share
      const double low = std::max(-A.size, t - B.size), high = std::min(A.size, t + B.size);
      add(A.p + low * A.a);
      if (high > low) add(A.p + high * A.a);
      return;
    }
    // Their crossing, seen along n.
    const double s = dot(B.p - A.p, B.a);
    add(A.p + std::clamp((t - c * s) / (1 - c * c), -A.size, A.size) * A.a);
  }
  void build() {
    if (A.kind == Face::disc && B.kind == Face::disc) disc_disc();
    else if (A.kind == Face::disc && B.kind == Face::line) disc_line(A, B);
    else if (A.kind == Face::line && B.kind == Face::disc) disc_line(B, A);
    else if (A.kind == Face::line && B.kind == Face::line) line_line();
    if (count > 0) return;
    const Vec3 at = A.kind == Face::point ? A.p - 0.5 * depth * n : B.p + 0.5 * depth * n;
    points[count++] = {at, depth};
  }
};

}  // namespace

bool is_round_pair(const Shape& a, const Shape& b) {
  const bool cylinder_a = std::holds_alternative<Cylinder>(a),
             cylinder_b = std::holds_alternative<Cylinder>(b);
  const bool barrel_a = std::holds_alternative<Barrel>(a), barrel_b = std::holds_alternative<Barrel>(b);
  if ((barrel_a && (barrel_b || cylinder_b)) || (barrel_b && cylinder_a)) return true;
  return (cylinder_a && (cylinder_b || std::holds_alternative<Capsule>(b))) ||
         (cylinder_b && std::holds_alternative<Capsule>(a));
}

int collide_round(const Shape& shape_a, const Pose& X_WA, const Shape& shape_b, const Pose& X_WB, int most,
                  dContactGeom* out, int skip) {
  const Round A = round_of(shape_a, X_WA), B = round_of(shape_b, X_WB);
  Overlap overlap{A, B, B.p - A.p, {}};
  const Vec3 d = overlap.apart;
  overlap.offer_along(d - dot(d, A.a) * A.a);
  overlap.offer_along(d - dot(d, B.a) * B.a);
  overlap.offer_axis(A.a);
  overlap.offer_axis(B.a);
  if (const Vec3 both = cross(A.a, B.a); dot(both, both) > 1e-8) overlap.offer_axis(normalised(both));
  overlap.offer_along(d);
  if (overlap.depth < 0) return 0;
  overlap.search_circle(A.a);
  overlap.search_circle(B.a);
  if (overlap.depth < 0) return 0;
  // Not from the best so far: that lies on a kink, and there the search would stay.
  overlap.search_around(normalised(d, overlap.n));
  if (overlap.depth < 0) return 0;

  const Vec3 n = overlap.n;
  Manifold manifold{n, face(A, n), face(B, -n), overlap.depth};
  manifold.build();
  const int count = std::min(most, static_cast<int>(manifold.count));
  for (int i = 0; i < count; ++i) {
    auto* const g = reinterpret_cast<dContactGeom*>(reinterpret_cast<char*>(out) +
                                                    static_cast<std::ptrdiff_t>(i) * skip);
    const Manifold::Point& point = manifold.points[static_cast<std::size_t>(i)];
    g->pos[0] = point.at.x, g->pos[1] = point.at.y, g->pos[2] = point.at.z, g->pos[3] = 0;
    g->normal[0] = -n.x, g->normal[1] = -n.y, g->normal[2] = -n.z, g->normal[3] = 0;
    g->depth = point.depth;
    g->side1 = g->side2 = -1;
  }
  return count;
}

}  // namespace sandlot::rigid
