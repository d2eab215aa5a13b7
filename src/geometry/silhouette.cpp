#include "geometry/silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"
#include "geometry/barrel.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

constexpr double upright = 1e-9;  ///< [rad] a tilt that does not count
constexpr int facets = 32;

Vec2 flattened(Vec3 v) { return {v.x, v.y}; }

/// The rim of a disc of radius r about `centre` with unit normal `axis`, seen from above: a circle, a line or
/// an ellipse, which its 32 tangents enclose.
void add_rim(Vec3 centre, Vec3 axis, double r, std::vector<SilhouetteDisc>& hull) {
  const double tilt = std::sqrt(axis.x * axis.x + axis.y * axis.y);
  if (tilt < upright) return hull.push_back({flattened(centre), r});
  const Vec2 low{axis.x / tilt, axis.y / tilt};  // the way it leans; across it the ellipse is r wide
  const double narrow = std::abs(axis.z) * r;
  if (narrow < upright * r) {
    hull.push_back({flattened(centre) + r * Vec2{-low.y, low.x}, 0});
    hull.push_back({flattened(centre) - r * Vec2{-low.y, low.x}, 0});
    return;
  }
  const double outside = 1 / math::cos(math::pi / facets);
  for (int i = 0; i < facets; ++i) {
    const auto [s, c] = math::sincos(math::tau * i / facets);
    hull.push_back({flattened(centre) + outside * (r * s * Vec2{-low.y, low.x} + narrow * c * low), 0});
  }
}

/// Upper part and height of R diag(r^2) R^T, which describes the ellipse of an ellipsoid's shadow.
struct Shadow {
  double xx, xy, yy, zz;
};
Shadow shadow_of(const Ellipsoid& egg, Quat q) {
  const Vec3 x = egg.radii_m.x * rotate(q, {1, 0, 0}), y = egg.radii_m.y * rotate(q, {0, 1, 0}),
             z = egg.radii_m.z * rotate(q, {0, 0, 1});
  return {x.x * x.x + y.x * y.x + z.x * z.x, x.x * x.y + y.x * y.y + z.x * z.y,
          x.y * x.y + y.y * y.y + z.y * z.y, x.z * x.z + y.z * y.z + z.z * z.z};
}

std::array<Vec3, 8> corners_of(const Box& box, const Pose& X_WC) {
  std::array<Vec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners[i] = X_WC *
                 (0.5 * Vec3{i & 1 ? box.size_m.x : -box.size_m.x, i & 2 ? box.size_m.y : -box.size_m.y,
                             i & 4 ? box.size_m.z : -box.size_m.z});
  return corners;
}

}  // namespace

std::vector<Vec2> convex_hull_2d(std::vector<Vec2> points) {
  if (points.empty()) return {};
  std::sort(points.begin(), points.end(),
            [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  double size = 0;
  for (const Vec2 p : points)
    size = std::max({size, std::abs(p.x - points[0].x), std::abs(p.y - points[0].y)});
  std::vector<Vec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const Vec2 p : points) {
      while (hull.size() >= start + 2) {
        const Vec2 a = hull[hull.size() - 2], b = hull.back();
        const double area = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        if (area > 1e-12 * size * size) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();  // the first of the other side
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

Heights heights_of(const Shape& shape, const Pose& X_WC) {
  const Vec3 axis = rotate(X_WC.q, {0, 0, 1});
  double half = -1;
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vec3 x = rotate(X_WC.q, {1, 0, 0}), y = rotate(X_WC.q, {0, 1, 0});
    half = 0.5 *
           (std::abs(x.z) * box->size_m.x + std::abs(y.z) * box->size_m.y + std::abs(axis.z) * box->size_m.z);
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    half = sphere->radius_m;
  } else if (const auto* can = std::get_if<Cylinder>(&shape)) {
    half = std::sqrt(axis.x * axis.x + axis.y * axis.y) * can->radius_m +
           0.5 * std::abs(axis.z) * can->length_m;
  } else if (const auto* pill = std::get_if<Capsule>(&shape)) {
    half = pill->radius_m + 0.5 * std::abs(axis.z) * pill->length_m;
  } else if (const auto* barrel = std::get_if<Barrel>(&shape)) {
    half = reach_m(*barrel, axis.z);
  } else if (const auto* egg = std::get_if<Ellipsoid>(&shape)) {
    half = std::sqrt(shadow_of(*egg, X_WC.q).zz);
  } else if (const auto* cone = std::get_if<Cone>(&shape)) {
    const double rim = std::sqrt(axis.x * axis.x + axis.y * axis.y) * cone->radius_m;
    const double apex = 0.5 * cone->length_m * axis.z;
    return {X_WC.p.z + std::min(apex, -apex - rim), X_WC.p.z + std::max(apex, -apex + rim)};
  } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    Heights heights;
    for (const Vec3& v : mesh->mesh->vertices) {
      const double z = (X_WC * v).z;
      heights.add({z, z});
    }
    return heights;
  } else {
    return {};
  }
  return {X_WC.p.z - half, X_WC.p.z + half};
}

void add_silhouette(const Shape& shape, const Pose& X_WC, std::vector<SilhouetteDisc>& hull) {
  const Vec3 axis = rotate(X_WC.q, {0, 0, 1});
  if (const auto* box = std::get_if<Box>(&shape)) {
    for (const Vec3 corner : corners_of(*box, X_WC)) hull.push_back({flattened(corner), 0});
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    hull.push_back({flattened(X_WC.p), sphere->radius_m});
  } else if (const auto* can = std::get_if<Cylinder>(&shape)) {
    for (const double end : {-0.5, 0.5})
      add_rim(X_WC.p + end * can->length_m * axis, axis, can->radius_m, hull);
  } else if (const auto* pill = std::get_if<Capsule>(&shape)) {
    for (const double end : {-0.5, 0.5})
      hull.push_back({flattened(X_WC.p + end * pill->length_m * axis), pill->radius_m});
  } else if (const auto* barrel = std::get_if<Barrel>(&shape)) {
    // The arc as five rings: from above it lies inside the true outline by less than 1 % of the sagitta.
    for (const double part : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const double z = part * 0.5 * barrel->length_m;
      if (const double r = radius_at_m(*barrel, z); r > 0) add_rim(X_WC.p + z * axis, axis, r, hull);
    }
  } else if (const auto* cone = std::get_if<Cone>(&shape)) {
    add_rim(X_WC.p - 0.5 * cone->length_m * axis, axis, cone->radius_m, hull);
    hull.push_back({flattened(X_WC.p + 0.5 * cone->length_m * axis), 0});
  } else if (const auto* egg = std::get_if<Ellipsoid>(&shape)) {
    const Shadow s = shadow_of(*egg, X_WC.q);
    const double tolerance = upright * (s.xx + s.yy);
    if (std::abs(s.xx - s.yy) < tolerance && std::abs(s.xy) < tolerance)
      return hull.push_back({flattened(X_WC.p), std::sqrt(s.xx)});
    // The ellipse is the unit circle times the Cholesky factor; so are its tangents.
    const double a = std::sqrt(s.xx), b = s.xy / a, c = std::sqrt(std::max(s.yy - b * b, 0.0));
    const double outside = 1 / math::cos(math::pi / facets);
    for (int i = 0; i < facets; ++i) {
      const auto [sine, cosine] = math::sincos(math::tau * i / facets);
      hull.push_back({flattened(X_WC.p) + outside * Vec2{a * cosine, b * cosine + c * sine}, 0});
    }
  } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    for (const Vec3& v : mesh->mesh->vertices) hull.push_back({flattened(X_WC * v), 0});
  }
}

}  // namespace sandlot
