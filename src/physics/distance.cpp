#include "physics/distance.h"

#include <algorithm>

#include "base/math.h"
#include "geometry/barrel.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

double from_segment(Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length2 = dot(along, along);
  const double s = length2 > 0 ? std::clamp(-dot(a, along) / length2, 0.0, 1.0) : 0;
  return norm(a + s * along);
}

/// Distance of the origin from a triangle.
double from_triangle(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  // Right over the triangle its plane is the nearest, else one of the edges.
  const bool over = dot(cross(b - a, n), a) >= 0 && dot(cross(c - b, n), b) >= 0 &&
                    dot(cross(a - c, n), c) >= 0;
  if (over && dot(n, n) > 0) return std::abs(dot(n, a)) / norm(n);
  return std::min({from_segment(a, b), from_segment(b, c), from_segment(c, a)});
}

/// Signed solid angle under which the origin sees a triangle. A. van Oosterom, J. Strackee (1983).
double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return 2 *
         math::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

struct Distance {
  Vec3 p;
  double limit;
  double operator()(const Box& b) const {
    const auto outside = [](double x, double size) { return std::max(std::abs(x) - 0.5 * size, 0.0); };
    return norm(Vec3{outside(p.x, b.size_m.x), outside(p.y, b.size_m.y), outside(p.z, b.size_m.z)});
  }
  double operator()(const Sphere& s) const { return std::max(norm(p) - s.radius_m, 0.0); }
  double operator()(const Cylinder& c) const {
    const double side = std::max(std::sqrt(p.x * p.x + p.y * p.y) - c.radius_m, 0.0);
    const double cap = std::max(std::abs(p.z) - 0.5 * c.length_m, 0.0);
    return std::sqrt(side * side + cap * cap);
  }
  double operator()(const Capsule& c) const {
    const double along = std::clamp(p.z, -0.5 * c.length_m, 0.5 * c.length_m);
    return std::max(norm(p - Vec3{0, 0, along}) - c.radius_m, 0.0);
  }
  double operator()(const Barrel& b) const { return std::max(nearest(b, p).distance_m, 0.0); }
  double operator()(const Plane& plane) const {
    return std::max(dot(p, normalised(plane.normal, {0, 0, 1})), 0.0);
  }
  double operator()(const Cone& c) const {
    // In the half plane through the axis: distance from a triangle with corners (0, h), (r, -h), (0, -h).
    const double rho = std::sqrt(p.x * p.x + p.y * p.y), h = 0.5 * c.length_m;
    const double slant = std::sqrt(c.radius_m * c.radius_m + c.length_m * c.length_m);
    const double nr = c.length_m / slant, nz = c.radius_m / slant;  // normal of the mantle
    const double beyond = nr * rho + nz * (p.z - h);
    if (p.z < -h) return norm(Vec3{std::max(rho - c.radius_m, 0.0), 0, -h - p.z});
    if (beyond <= 0) return 0;
    const double down = std::clamp(nz * rho - nr * (p.z - h), 0.0, slant);  // along the mantle, from the apex
    return norm(Vec3{rho - nz * down, 0, p.z - (h - nr * down)});
  }
  double operator()(const Ellipsoid& e) const {
    const Vec3 r = e.radii_m, q{std::abs(p.x), std::abs(p.y), std::abs(p.z)};
    const auto scaled2 = [&](Vec3 v) {
      return v.x * v.x / (r.x * r.x) + v.y * v.y / (r.y * r.y) + v.z * v.z / (r.z * r.z);
    };
    if (scaled2(q) <= 1) return 0;
    // The nearest point is r_i^2 q_i / (r_i^2 + t) with the one t >= 0 that puts it on the surface.
    const auto foot = [&](double t) {
      return Vec3{r.x * r.x * q.x / (r.x * r.x + t), r.y * r.y * q.y / (r.y * r.y + t),
                  r.z * r.z * q.z / (r.z * r.z + t)};
    };
    double low = 0, high = norm(q) * std::max({r.x, r.y, r.z});
    for (int i = 0; i < 200 && low < high; ++i) {
      const double middle = 0.5 * (low + high);
      if (middle == low || middle == high) break;
      (scaled2(foot(middle)) > 1 ? low : high) = middle;
    }
    return norm(q - foot(high));
  }
  double operator()(const Mesh& m) const {
    const TriangleMesh& mesh = *m.mesh;
    double best = limit, turns = 0;
    bool within = true;  // the bounds
    for (std::size_t k = 0; k < 3; ++k) {
      bool below = false, above = false;
      for (const Vec3& v : mesh.vertices) below = below || v[k] <= p[k], above = above || v[k] >= p[k];
      within = within && below && above;
    }
    bool found = false;
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]] - p, b = mesh.vertices[t[1]] - p, c = mesh.vertices[t[2]] - p;
      bool far = false;
      for (std::size_t k = 0; k < 3; ++k)
        far = far || std::min({a[k], b[k], c[k]}) > best || std::max({a[k], b[k], c[k]}) < -best;
      if (!far) {
        const double d = from_triangle(a, b, c);
        if (d <= best) best = d, found = true;
      }
      if (within) turns += solid_angle(a, b, c);
    }
    if (std::abs(turns) > 2 * math::pi) return 0;
    return found ? best : std::numeric_limits<double>::infinity();
  }
  double operator()(const Heightfield& field) const {
    const HeightGrid& g = *field.grid;
    const double x = std::clamp(p.x, -0.5 * g.size_x_m, 0.5 * g.size_x_m),
                 y = std::clamp(p.y, -0.5 * g.size_y_m, 0.5 * g.size_y_m);
    const double above = std::max(p.z - height_at(g, x, y), 0.0);
    double best = norm(Vec3{p.x - x, p.y - y, above});
    if (above == 0) return best;
    // Only cells nearer than the point right below can hold a nearer one.
    const double reach = std::min(best, limit);
    const auto cell = [](double at, double size, double width, int cells) {
      return std::clamp(
          static_cast<int>(std::floor(std::clamp((at + 0.5 * size) / width, -1.0, cells + 1.0))), 0,
          cells - 1);
    };
    const int i0 = cell(p.x - reach, g.size_x_m, g.cell_x_m(), g.columns - 1),
              i1 = cell(p.x + reach, g.size_x_m, g.cell_x_m(), g.columns - 1);
    const int j0 = cell(p.y - reach, g.size_y_m, g.cell_y_m(), g.rows - 1),
              j1 = cell(p.y + reach, g.size_y_m, g.cell_y_m(), g.rows - 1);
    const auto corner = [&](int i, int j) {
      return Vec3{i * g.cell_x_m() - 0.5 * g.size_x_m, j * g.cell_y_m() - 0.5 * g.size_y_m,
                  static_cast<double>(g.at(i, j))} -
             p;
    };
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        const Vec3 a = corner(i, j), c = corner(i + 1, j + 1);
        best = std::min({best, from_triangle(a, corner(i + 1, j), c), from_triangle(a, c, corner(i, j + 1))});
      }
    return best;
  }
};

}  // namespace

double distance_m(const Shape& shape, Vec3 point_G, double limit_m) {
  return std::visit(Distance{point_G, limit_m}, shape);
}

}  // namespace sandlot
