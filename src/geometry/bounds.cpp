#include "geometry/bounds.h"

#include <algorithm>
#include <cmath>

#include "geometry/barrel.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

/// Half extents along A's axes, for shapes that are symmetrical about G's origin.
struct HalfExtent {
  Vec3 x, y, z;  ///< axes of G in A

  /// Bounds of a part of a cylinder: rings of radius r at both ends of a stick of half length h along z.
  Vec3 rings(double r, double h) const {
    const auto one = [&](double a) { return std::abs(a) * h + r * std::sqrt(std::max(0.0, 1 - a * a)); };
    return {one(z.x), one(z.y), one(z.z)};
  }
  Vec3 of_box(Vec3 h) const {
    const auto one = [&](std::size_t i) {
      return std::abs(x[i]) * h.x + std::abs(y[i]) * h.y + std::abs(z[i]) * h.z;
    };
    return {one(0), one(1), one(2)};
  }
  Vec3 of_ellipsoid(Vec3 r) const {
    const auto one = [&](std::size_t i) { return norm(Vec3{x[i] * r.x, y[i] * r.y, z[i] * r.z}); };
    return {one(0), one(1), one(2)};
  }
};

}  // namespace

void Bounds::include(Vec3 p) {
  low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

void Bounds::include(const Bounds& other) {
  if (other.empty()) return;
  include(other.low);
  include(other.high);
}

double Bounds::distance_m(Vec3 p) const {
  const auto outside = [&](std::size_t i) { return std::max({low[i] - p[i], 0.0, p[i] - high[i]}); };
  return norm(Vec3{outside(0), outside(1), outside(2)});
}

Bounds bounds_of(const Shape& shape, const Pose& X_AG) {
  const HalfExtent axes{rotate(X_AG.q, {1, 0, 0}), rotate(X_AG.q, {0, 1, 0}), rotate(X_AG.q, {0, 0, 1})};
  Bounds out;
  const auto around = [&](Vec3 half) {
    out.include(X_AG.p - half);
    out.include(X_AG.p + half);
  };
  if (const auto* box = std::get_if<Box>(&shape)) {
    around(axes.of_box(0.5 * box->size_m));
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    around({sphere->radius_m, sphere->radius_m, sphere->radius_m});
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    around(axes.rings(cylinder->radius_m, 0.5 * cylinder->length_m));
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const double r = capsule->radius_m;
    around(axes.rings(0, 0.5 * capsule->length_m) + Vec3{r, r, r});
  } else if (const auto* cone = std::get_if<Cone>(&shape)) {
    const Vec3 up = 0.5 * cone->length_m * axes.z, base = axes.rings(cone->radius_m, 0);
    out.include(X_AG.p + up);
    out.include(X_AG.p - up - base);
    out.include(X_AG.p - up + base);
  } else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) {
    around(axes.of_ellipsoid(ellipsoid->radii_m));
  } else if (const auto* barrel = std::get_if<Barrel>(&shape)) {
    around({reach_m(*barrel, axes.z.x), reach_m(*barrel, axes.z.y), reach_m(*barrel, axes.z.z)});
  } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    for (const Vec3& v : mesh->mesh->vertices) out.include(X_AG * v);
  } else if (const auto* field = std::get_if<Heightfield>(&shape)) {
    const HeightGrid& grid = *field->grid;
    if (grid.height_m.empty()) return out;
    const auto [low, high] = std::minmax_element(grid.height_m.begin(), grid.height_m.end());
    for (const double x : {-0.5 * grid.size_x_m, 0.5 * grid.size_x_m})
      for (const double y : {-0.5 * grid.size_y_m, 0.5 * grid.size_y_m})
        for (const float z : {*low, *high}) out.include(X_AG * Vec3{x, y, static_cast<double>(z)});
  }
  return out;
}

}  // namespace sandlot
