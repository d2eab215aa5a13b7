#include "geometry/mesh.h"

#include <algorithm>
#include <map>
#include <type_traits>

#include "base/math.h"
#include "geometry/height_grid.h"

namespace sandlot {
namespace {

/// Turns a profile of (radius, z) points, from the bottom to the top of the z axis, about that axis. Points on the axis
/// become one vertex.
TriangleMesh revolve(const std::vector<std::array<double, 2>>& profile, int segments) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(segments);
  std::vector<std::uint32_t> first;
  for (const auto& [radius, z] : profile) {
    first.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    if (radius <= 0) {
      mesh.vertices.push_back({0, 0, z});
      continue;
    }
    for (std::uint32_t i = 0; i < n; ++i) {
      const math::SinCos a = math::sincos(math::tau * i / n);
      mesh.vertices.push_back({radius * a.cos, radius * a.sin, z});
    }
  }
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
    const bool point_below = profile[ring][0] <= 0, point_above = profile[ring + 1][0] <= 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t next = (i + 1) % n;
      const std::uint32_t a = first[ring] + (point_below ? 0 : i), b = first[ring] + (point_below ? 0 : next);
      const std::uint32_t c = first[ring + 1] + (point_above ? 0 : i),
                          d = first[ring + 1] + (point_above ? 0 : next);
      if (!point_below) mesh.triangles.push_back({a, b, d});
      if (!point_above) mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

struct Tessellate {
  int segments;

  TriangleMesh operator()(const Box& box) const {
    TriangleMesh mesh;
    const Vec3 h = 0.5 * box.size_m;
    for (const double z : {-h.z, h.z})
      for (const double y : {-h.y, h.y})
        for (const double x : {-h.x, h.x}) mesh.vertices.push_back({x, y, z});
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
  }
  TriangleMesh operator()(const Sphere& s) const {
    return (*this)(Ellipsoid{{s.radius_m, s.radius_m, s.radius_m}});
  }
  TriangleMesh operator()(const Cylinder& c) const {
    const double r = c.radius_m, h = 0.5 * c.length_m;
    return revolve({{0, -h}, {r, -h}, {r, h}, {0, h}}, segments);
  }
  TriangleMesh operator()(const Cone& c) const {
    const double h = 0.5 * c.length_m;
    return revolve({{0, -h}, {c.radius_m, -h}, {0, h}}, segments);
  }
  TriangleMesh operator()(const Capsule& c) const {
    std::vector<std::array<double, 2>> profile;
    const int rings = std::max(2, segments / 4);
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i <= rings; ++i) {
        const double up = side < 0 ? -0.5 * math::pi + 0.5 * math::pi * i / rings
                                   : 0.5 * math::pi * i / rings;
        const math::SinCos a = math::sincos(up);
        const bool pole = (side < 0 && i == 0) || (side > 0 && i == rings);
        profile.push_back({pole ? 0 : c.radius_m * a.cos, side * 0.5 * c.length_m + c.radius_m * a.sin});
      }
    return revolve(profile, segments);
  }
  TriangleMesh operator()(const Ellipsoid& e) const {
    std::vector<std::array<double, 2>> profile;
    const int rings = std::max(4, segments / 2);
    for (int i = 0; i <= rings; ++i) {
      const math::SinCos a = math::sincos(math::pi * i / rings - 0.5 * math::pi);
      profile.push_back({i == 0 || i == rings ? 0 : a.cos, a.sin});
    }
    TriangleMesh mesh = revolve(profile, segments);
    for (Vec3& v : mesh.vertices) v = {v.x * e.radii_m.x, v.y * e.radii_m.y, v.z * e.radii_m.z};
    return mesh;
  }
  TriangleMesh operator()(const Mesh& m) const { return *m.mesh; }
  TriangleMesh operator()(const Heightfield& field) const {
    const HeightGrid& g = *field.grid;
    TriangleMesh mesh;
    for (int row = 0; row < g.rows; ++row)
      for (int column = 0; column < g.columns; ++column)
        mesh.vertices.push_back({column * g.cell_x_m() - 0.5 * g.size_x_m,
                                 row * g.cell_y_m() - 0.5 * g.size_y_m,
                                 static_cast<double>(g.at(column, row))});
    const auto width = static_cast<std::uint32_t>(g.columns);
    for (std::uint32_t row = 0; row + 1 < static_cast<std::uint32_t>(g.rows); ++row)
      for (std::uint32_t column = 0; column + 1 < width; ++column) {
        const std::uint32_t a = row * width + column;
        mesh.triangles.push_back({a, a + 1, a + width + 1});
        mesh.triangles.push_back({a, a + width + 1, a + width});
      }
    return mesh;
  }
  TriangleMesh operator()(const Plane&) const { return {}; }
};

}  // namespace

MassProperties mass_properties(const TriangleMesh& mesh) {
  // Sums over tetrahedra from the origin to each triangle; the origin is a vertex of the mesh, so that a body far from
  // its frame loses no digits.
  MassProperties out;
  if (mesh.vertices.empty()) return out;
  const Vec3 origin = mesh.vertices.front();
  double volume = 0;
  Vec3 first, squares, mixed;  // integrals of x, of x^2, of xy xz yz
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin,
               c = mesh.vertices[t[2]] - origin;
    const double six = dot(a, cross(b, c));
    const Vec3 sum = a + b + c;
    volume += six / 6;
    first += six / 24 * sum;
    const auto product = [&](double ai, double bi, double ci, double si, double aj, double bj, double cj,
                             double sj) { return six / 120 * (ai * aj + bi * bj + ci * cj + si * sj); };
    squares += {product(a.x, b.x, c.x, sum.x, a.x, b.x, c.x, sum.x),
                product(a.y, b.y, c.y, sum.y, a.y, b.y, c.y, sum.y),
                product(a.z, b.z, c.z, sum.z, a.z, b.z, c.z, sum.z)};
    mixed += {product(a.x, b.x, c.x, sum.x, a.y, b.y, c.y, sum.y),
              product(a.x, b.x, c.x, sum.x, a.z, b.z, c.z, sum.z),
              product(a.y, b.y, c.y, sum.y, a.z, b.z, c.z, sum.z)};
  }
  out.volume_m3 = volume;
  if (volume == 0) return out;
  const Vec3 m = first / volume, s = squares / volume - Vec3{m.x * m.x, m.y * m.y, m.z * m.z};
  const Vec3 p = mixed / volume - Vec3{m.x * m.y, m.x * m.z, m.y * m.z};
  out.centre_m = origin + m;
  out.moments = {s.y + s.z, s.x + s.z, s.x + s.y};
  out.products = -p;
  return out;
}

MassProperties mass_properties(const Shape& shape) {
  if (const auto* m = std::get_if<Mesh>(&shape)) return mass_properties(*m->mesh);
  MassProperties out;
  out.volume_m3 = volume_m3(shape);
  out.moments = inertia_kg_m2(shape, 1);
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    out.centre_m.z = -0.25 * cone->length_m;
    const double d2 = out.centre_m.z * out.centre_m.z;
    out.moments -= {d2, d2, 0};
  }
  return out;
}

bool is_closed(const TriangleMesh& mesh) {
  // Files repeat a vertex for each of its normals: equal places count as one.
  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> place;
  for (const Vec3& v : mesh.vertices)
    place.push_back(
        places.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(places.size())).first->second);
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) edges.push_back({place[t[i]], place[t[(i + 1) % 3]]});
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    return e[0] != e[1] && std::binary_search(edges.begin(), edges.end(), std::array{e[1], e[0]});
  });
}

TriangleMesh tessellate(const Shape& shape, int segments) {
  return std::visit(Tessellate{std::max(segments, 8)}, shape);
}

}  // namespace sandlot
