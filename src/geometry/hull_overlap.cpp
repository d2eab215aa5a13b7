#include "geometry/hull_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "geometry/barrel.h"
#include "geometry/bounds.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

Vec3 farthest_of(std::span<const Vec3> points, Vec3 d) {
  Vec3 best = points.front();
  for (const Vec3& each : points)
    if (dot(each, d) > dot(best, d)) best = each;
  return best;
}

/// The point of a shape that lies farthest along a direction, in its own frame.
struct Farthest {
  Vec3 d;
  Vec3 disc(double radius_m, double z_m) const {
    const double across = std::sqrt(d.x * d.x + d.y * d.y);
    const double f = across > 0 ? radius_m / across : 0;
    return {f * d.x, f * d.y, z_m};
  }
  Vec3 unit() const { return normalised(d, {0, 0, 1}); }
  Vec3 operator()(const Box& b) const {
    return {std::copysign(0.5 * b.size_m.x, d.x), std::copysign(0.5 * b.size_m.y, d.y),
            std::copysign(0.5 * b.size_m.z, d.z)};
  }
  Vec3 operator()(const Sphere& s) const { return s.radius_m * unit(); }
  Vec3 operator()(const Cylinder& c) const { return disc(c.radius_m, std::copysign(0.5 * c.length_m, d.z)); }
  Vec3 operator()(const Capsule& c) const {
    return Vec3{0, 0, std::copysign(0.5 * c.length_m, d.z)} + c.radius_m * unit();
  }
  Vec3 operator()(const Cone& c) const {
    const Vec3 top{0, 0, 0.5 * c.length_m}, rim = disc(c.radius_m, -0.5 * c.length_m);
    return dot(top, d) >= dot(rim, d) ? top : rim;
  }
  Vec3 operator()(const Ellipsoid& e) const {
    const Vec3 r = e.radii_m, scaled = normalised(Vec3{r.x * d.x, r.y * d.y, r.z * d.z}, {0, 0, 1});
    return {r.x * scaled.x, r.y * scaled.y, r.z * scaled.z};
  }
  Vec3 operator()(const Barrel& b) const { return farthest(b, unit()); }
  Vec3 operator()(const Mesh& m) const { return farthest_of(m.mesh->vertices, d); }
  Vec3 operator()(const Heightfield& h) const {
    const Bounds box = bounds_of(Shape(h));
    return {d.x > 0 ? box.high.x : box.low.x, d.y > 0 ? box.high.y : box.low.y,
            d.z > 0 ? box.high.z : box.low.z};
  }
  Vec3 operator()(const Plane&) const { SL_CHECK_MSG(false, "a plane has no farthest point"); }
};

/// Up to four points of the difference of two solids.
struct Simplex {
  std::array<Vec3, 4> p;
  std::size_t size = 0;

  /// Keeps the points whose hull has the point nearest to the origin, which it returns.
  Vec3 reduce() {
    Simplex best;
    Vec3 nearest;
    double least = 1e300;
    for (unsigned mask = 1; mask < 1u << size; ++mask) {
      Simplex part;
      for (std::size_t i = 0; i < size; ++i)
        if (mask >> i & 1) part.p[part.size++] = p[i];
      Vec3 at;
      if (!part.nearest_inside(at) || dot(at, at) >= least) continue;
      least = dot(at, at);
      nearest = at;
      best = part;
    }
    *this = best;
    return nearest;
  }

 private:
  /// The point nearest to the origin in the plane of all its points, if their hull contains it.
  bool nearest_inside(Vec3& out) const {
    const Vec3 a = p[0];
    if (size == 1) return out = a, true;
    if (size == 2) {
      const Vec3 u = p[1] - a;
      const double uu = dot(u, u), s = -dot(a, u) / uu;
      out = a + s * u;
      return uu > 0 && s >= 0 && s <= 1;
    }
    const Vec3 u = p[1] - a, v = p[2] - a;
    if (size == 3) {
      const Vec3 n = cross(u, v);
      const double nn = dot(n, n);
      if (!(nn > 0)) return false;
      const double s = dot(cross(-a, v), n) / nn, t = dot(cross(u, -a), n) / nn;
      out = a + s * u + t * v;
      return s >= 0 && t >= 0 && s + t <= 1;
    }
    const Vec3 w = p[3] - a;
    const double volume = dot(u, cross(v, w));
    if (volume == 0) return false;
    const double r = dot(-a, cross(v, w)) / volume, s = dot(u, cross(-a, w)) / volume,
                 t = dot(u, cross(v, -a)) / volume;
    out = {};
    return r >= 0 && s >= 0 && t >= 0 && r + s + t <= 1;
  }
};

}  // namespace

bool meets(const Shape& shape, const Pose& X_AG, std::span<const Vec3> hull_A) {
  SL_CHECK(!hull_A.empty());
  if (const auto* const plane = std::get_if<Plane>(&shape)) {
    const Vec3 n = rotate(X_AG.q, normalised(plane->normal, {0, 0, 1}));
    return dot(farthest_of(hull_A, -n) - X_AG.p, n) <= 0;
  }
  if (const auto* const mesh = std::get_if<Mesh>(&shape))
    if (mesh->mesh->vertices.empty()) return false;
  double size = 0;
  const auto farthest_apart = [&](Vec3 d) {
    const Vec3 on_shape = X_AG * std::visit(Farthest{rotate_inverse(X_AG.q, d)}, shape);
    const Vec3 apart = on_shape - farthest_of(hull_A, -d);
    size = std::max(size, norm(apart));
    return apart;
  };
  constexpr double tolerance = 1e-9;
  constexpr int most_iterations = 200;
  Vec3 nearest = farthest_apart(hull_A.front() - X_AG.p);
  Simplex simplex;
  simplex.p[simplex.size++] = nearest;
  for (int i = 0; i < most_iterations; ++i) {
    const double distance = norm(nearest);
    if (distance <= tolerance * size) return true;
    const Vec3 next = farthest_apart(-nearest);
    // Nothing lies nearer to the origin, beyond the plane through `next`.
    const double gap = dot(nearest, next) / distance;
    if (gap > tolerance * size) return false;
    if (distance - gap <= tolerance * size || simplex.size == 4) return true;
    simplex.p[simplex.size++] = next;
    nearest = simplex.reduce();
  }
  return true;
}

}  // namespace sandlot
