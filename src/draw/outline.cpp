#include "draw/outline.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "base/math.h"
#include "geometry/mesh.h"

namespace sandlot::draw {
namespace {

constexpr int corners_per_turn = 32;
constexpr double upright = 1 - 1e-9;  // |cosine| of the lean below which a circle is drawn as one

Vec3 flat(Vec3 p) { return {p.x, p.y, 0}; }

/// Twice the signed area of a triangle: positive when a, b, c turn left.
double turn(Vec3 a, Vec3 b, Vec3 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Convex hull, counter-clockwise (A. M. Andrew's monotone chain, 1979). Points on an edge are left out.
std::vector<Vec3> hull(std::vector<Vec3> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec3& a, const Vec3& b) { return std::tuple(a.x, a.y) < std::tuple(b.x, b.y); });
  constexpr double eps = 1e-12;
  std::vector<Vec3> chain;
  const auto half = [&](auto begin, auto end) {
    const std::size_t first = chain.size();
    for (auto p = begin; p != end; ++p) {
      while (chain.size() >= first + 2 && turn(chain[chain.size() - 2], chain.back(), *p) <= eps)
        chain.pop_back();
      chain.push_back(*p);
    }
    chain.pop_back();
  };
  half(points.begin(), points.end());
  half(points.rbegin(), points.rend());
  return chain;
}

Outline circle(Vec3 centre, double radius_m, double half_height_m) {
  return {{}, flat(centre), radius_m, centre.z - half_height_m, centre.z + half_height_m};
}

Outline polygon(std::vector<Vec3> points, Vec3 centre, double half_height_m) {
  Outline outline{hull(std::move(points)), flat(centre), 0, centre.z - half_height_m,
                  centre.z + half_height_m};
  for (const Vec3& corner : outline.corners)
    outline.radius_m = std::max(outline.radius_m, norm(corner - outline.centre_m));
  return outline;
}

/// The rim of a disc with its centre at `centre` that u and v span.
void add_rim(std::vector<Vec3>& points, Vec3 centre, Vec3 u, Vec3 v) {
  for (int i = 0; i < corners_per_turn; ++i) {
    const math::SinCos a = math::sincos(math::tau * i / corners_per_turn);
    points.push_back(flat(centre + a.cos * u + a.sin * v));
  }
}

Outline outline(const Box& box, const Pose& X_WC) {
  const Vec3 half = 0.5 * box.size_m;
  std::vector<Vec3> points;
  double half_height = 0;
  for (const double x : {-half.x, half.x})
    for (const double y : {-half.y, half.y})
      for (const double z : {-half.z, half.z}) {
        const Vec3 corner = X_WC * Vec3{x, y, z};
        half_height = std::max(half_height, std::abs(corner.z - X_WC.p.z));
        points.push_back(flat(corner));
      }
  return polygon(std::move(points), X_WC.p, half_height);
}

Outline outline(const Sphere& sphere, const Pose& X_WC) {
  return circle(X_WC.p, sphere.radius_m, sphere.radius_m);
}

Outline outline(const Cylinder& cylinder, const Pose& X_WC) {
  const double r = cylinder.radius_m;
  const Vec3 axis = rotate(X_WC.q, {0, 0, 1});
  const double lean = std::sqrt(std::max(0.0, 1 - axis.z * axis.z));
  const double half_height = 0.5 * cylinder.length_m * std::abs(axis.z) + r * lean;
  if (std::abs(axis.z) > upright) return circle(X_WC.p, r, half_height);
  std::vector<Vec3> points;
  for (const double end : {-0.5, 0.5})
    add_rim(points, X_WC.p + end * cylinder.length_m * axis, r * rotate(X_WC.q, {1, 0, 0}),
            r * rotate(X_WC.q, {0, 1, 0}));
  return polygon(std::move(points), X_WC.p, half_height);
}

Outline outline(const Capsule& capsule, const Pose& X_WC) {
  const double r = capsule.radius_m;
  const Vec3 axis = rotate(X_WC.q, {0, 0, 1});
  const double half_height = 0.5 * capsule.length_m * std::abs(axis.z) + r;
  if (std::abs(axis.z) > upright) return circle(X_WC.p, r, half_height);
  std::vector<Vec3> points;
  for (const double end : {-0.5, 0.5})
    add_rim(points, X_WC.p + end * capsule.length_m * axis, {r, 0, 0}, {0, r, 0});
  return polygon(std::move(points), X_WC.p, half_height);
}

/// Everything else: the hull of its corners.
Outline outline_of_corners(const Shape& shape, const Pose& X_WC) {
  std::vector<Vec3> points;
  double half_height = 0;
  for (const Vec3& v : tessellate(shape).vertices) {
    const Vec3 corner = X_WC * v;
    half_height = std::max(half_height, std::abs(corner.z - X_WC.p.z));
    points.push_back(flat(corner));
  }
  return polygon(std::move(points), X_WC.p, half_height);
}
Outline outline(const Cone& s, const Pose& X) { return outline_of_corners(s, X); }
Outline outline(const Ellipsoid& s, const Pose& X) { return outline_of_corners(s, X); }
Outline outline(const Barrel& s, const Pose& X) { return outline_of_corners(s, X); }
Outline outline(const Mesh& s, const Pose& X) { return outline_of_corners(s, X); }
Outline outline(const Heightfield& s, const Pose& X) { return outline_of_corners(s, X); }

/// Squared distance of p from the segment a-b, in the plane.
double squared_distance(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 ab = flat(b - a), ap = flat(p - a);
  const double length2 = dot(ab, ab);
  const double t = length2 > 0 ? std::clamp(dot(ap, ab) / length2, 0.0, 1.0) : 0.0;
  const Vec3 off = ap - t * ab;
  return dot(off, off);
}

}  // namespace

std::optional<Outline> outline_from_above(const Shape& shape, const Pose& X_WC) {
  return std::visit(
      [&](const auto& s) -> std::optional<Outline> {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(s)>, Plane>) return std::nullopt;
        else return outline(s, X_WC);
      },
      shape);
}

std::vector<Vec3> simplified(const std::vector<Vec3>& path, double tolerance_m) {
  if (path.size() < 3) return path;
  std::vector<bool> keep(path.size(), false);
  keep.front() = keep.back() = true;
  std::vector<std::array<std::size_t, 2>> open{{0, path.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double farthest = tolerance_m * tolerance_m;
    std::size_t split = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d2 = squared_distance(path[i], path[first], path[last]);
      if (d2 > farthest) farthest = d2, split = i;
    }
    if (split == first) continue;
    keep[split] = true;
    open.push_back({first, split});
    open.push_back({split, last});
  }
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < path.size(); ++i)
    if (keep[i]) kept.push_back(path[i]);
  return kept;
}

}  // namespace sandlot::draw
