#include "geometry/mesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <type_traits>

#include "base/math.h"
#include "geometry/barrel.h"
#include "geometry/height_grid.h"
#include "geometry/triangulate.h"

namespace sandlot {
namespace {

/// Turns a profile of (radius, z) points, from the bottom to the top of the z axis, about that axis. Points
/// on the axis become one vertex.
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
  TriangleMesh operator()(const Barrel& b) const {
    const double h = 0.5 * b.length_m;
    std::vector<std::array<double, 2>> profile{{0, -h}};
    const int rings = std::max(4, segments / 4);
    const double steepest = math::asin(std::min(1.0, h / b.profile_m));
    for (int i = 0; i <= rings; ++i) {
      const double z = b.profile_m * math::sin(steepest * (2.0 * i / rings - 1));
      if (const double r = radius_at_m(b, z); r > 0) profile.push_back({r, z});
    }
    profile.push_back({0, h});
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

/// For each vertex the first one at its place: files repeat a vertex for each of its normals.
std::vector<std::uint32_t> places_of(const std::vector<Vec3>& vertices) {
  const auto key = [&](std::uint32_t i) {
    return std::array{vertices[i].x + 0.0, vertices[i].y + 0.0, vertices[i].z + 0.0};  // -0 becomes 0
  };
  std::vector<std::uint32_t> order(vertices.size()), place(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    place[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? place[order[i - 1]] : order[i];
  return place;
}

/// Without points that follow an equal one; the last and the first are neighbours.
Loop2 without_repeats(const Loop2& loop) {
  Loop2 out;
  for (const auto& p : loop)
    if (out.empty() || out.back() != p) out.push_back(p);
  while (out.size() > 1 && out.front() == out.back()) out.pop_back();
  return out;
}

/// Copies the triangles `chosen` (in order) and what belongs to them.
TriangleMesh picked(const TriangleMesh& mesh, const std::vector<std::uint32_t>& chosen) {
  TriangleMesh out;
  out.source = mesh.source;
  std::map<std::uint32_t, std::uint32_t> number;
  std::size_t part = 0;
  const MeshPart* open = nullptr;
  for (const std::uint32_t t : chosen) {
    while (part < mesh.parts.size() && t >= mesh.parts[part].first_triangle + mesh.parts[part].triangles)
      ++part;
    if (part < mesh.parts.size()) {
      if (open != &mesh.parts[part]) {
        open = &mesh.parts[part];
        out.parts.push_back(*open);
        out.parts.back().first_triangle = static_cast<std::uint32_t>(out.triangles.size());
        out.parts.back().triangles = 0;
      }
      ++out.parts.back().triangles;
    }
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = mesh.triangles[t][i];
      const auto [found, is_new] = number.try_emplace(v, static_cast<std::uint32_t>(out.vertices.size()));
      if (is_new) {
        out.vertices.push_back(mesh.vertices[v]);
        if (!mesh.texture_uv.empty()) out.texture_uv.push_back(mesh.texture_uv[v]);
      }
      corners[i] = found->second;
    }
    out.triangles.push_back(corners);
  }
  return out;
}

}  // namespace

MassProperties mass_properties(const TriangleMesh& mesh) {
  // Sums over tetrahedra from the origin to each triangle; the origin is a vertex of the mesh, so that a body
  // far from its frame loses no digits.
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
  const std::vector<std::uint32_t> place = places_of(mesh.vertices);
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) edges.push_back({place[t[i]], place[t[(i + 1) % 3]]});
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    return e[0] != e[1] && std::binary_search(edges.begin(), edges.end(), std::array{e[1], e[0]});
  });
}

std::vector<TriangleMesh> connected_parts(const TriangleMesh& mesh) {
  // Union of sets, the least vertex of each its name.
  std::vector<std::uint32_t> parent = places_of(mesh.vertices);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 1; i < 3; ++i) {
      const std::uint32_t a = root(t[0]), b = root(t[i]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  struct Piece {
    std::vector<std::uint32_t> triangles;
    double area = 0;
  };
  std::map<std::uint32_t, std::size_t> number;
  std::vector<Piece> pieces;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto [found, is_new] = number.try_emplace(root(a), pieces.size());
    if (is_new) pieces.emplace_back();
    Piece& piece = pieces[found->second];
    piece.triangles.push_back(t);
    piece.area += norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.area > b.area; });
  std::vector<TriangleMesh> out;
  for (const Piece& piece : pieces) out.push_back(picked(mesh, piece.triangles));
  return out;
}

TriangleMesh extrude(const std::vector<std::vector<std::array<double, 2>>>& loops_m, double height_m) {
  TriangleMesh mesh;
  std::vector<Loop2> loops;
  for (const Loop2& loop : loops_m) {
    loops.push_back(without_repeats(loop));
    for (const auto& [x, y] : loop)
      if (!std::isfinite(x) || !std::isfinite(y)) return mesh;
    // The outline counter-clockwise, holes clockwise: then all walls face away from the solid.
    if ((twice_area(loops.back()) < 0) == (loops.size() == 1))
      std::reverse(loops.back().begin(), loops.back().end());
  }
  if (loops.empty() || !(height_m > 0) || !std::isfinite(height_m) || !is_simple(loops)) return mesh;
  const auto flat = triangulate(loops);
  if (flat.empty()) return mesh;
  for (const Loop2& loop : loops)
    for (const auto& [x, y] : loop) mesh.vertices.push_back({x, y, 0});
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t i = 0; i < n; ++i)
    mesh.vertices.push_back({mesh.vertices[i].x, mesh.vertices[i].y, height_m});
  for (const auto& [a, b, c] : flat) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({a + n, b + n, c + n});
  }
  std::uint32_t first = 0;
  for (const Loop2& loop : loops) {
    const auto count = static_cast<std::uint32_t>(loop.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t a = first + i, b = first + (i + 1) % count;
      mesh.triangles.push_back({a, b, b + n});
      mesh.triangles.push_back({a, b + n, a + n});
    }
    first += count;
  }
  return mesh;
}

TriangleMesh tessellate(const Shape& shape, int segments) {
  return std::visit(Tessellate{std::max(segments, 8)}, shape);
}

}  // namespace sandlot
