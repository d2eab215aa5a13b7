#include "physics/rigid/mesh_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "geometry/height_grid.h"
#include "physics/rigid/ode_vector.h"

namespace sandlot::rigid {
namespace {

using Cell = std::array<int, 3>;

struct Point {
  Vec3 at, normal;  ///< normals of the faces around, added up
};

}  // namespace

std::vector<Sample> sample(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], v[k]), high[k] = std::max(high[k], v[k]);
  const Vec3 centre = 0.5 * (low + high);
  const double size = norm(high - low);
  if (!(size > 0)) return {};
  const double spacing = size / 8, depth = size / 10, cell = size / 16;
  // Some files have their triangles inside out.
  const double outwards = mass_properties(mesh).volume_m3 < 0 ? -1 : 1;

  // Vertices at one place count as one: files repeat them for each normal.
  std::map<std::array<double, 3>, Point> points;
  const auto add = [&](Vec3 at, Vec3 normal) {
    Point& p = points[{at.x, at.y, at.z}];
    p.at = at;
    p.normal += normal;
  };
  // One point per cell is kept in the end: of a very fine mesh a part of the triangles is enough.
  const std::size_t stride = 1 + mesh.triangles.size() / 200'000;
  for (std::size_t at_triangle = 0; at_triangle < mesh.triangles.size(); at_triangle += stride) {
    const auto& t = mesh.triangles[at_triangle];
    const Vec3 corner[] = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const Vec3 across = cross(corner[1] - corner[0], corner[2] - corner[0]);
    if (!(norm(across) > 0)) continue;
    const Vec3 n = outwards * normalised(across);
    for (std::size_t i = 0; i < 3; ++i) {
      add(corner[i], n);
      // From the smaller end, so that both triangles at an edge make the same points.
      Vec3 a = corner[i], b = corner[(i + 1) % 3];
      if (std::array{b.x, b.y, b.z} < std::array{a.x, a.y, a.z}) std::swap(a, b);
      const int parts = static_cast<int>(std::min(std::ceil(norm(b - a) / spacing), 16.0));
      for (int k = 1; k < parts; ++k) add(a + static_cast<double>(k) / parts * (b - a), n);
    }
  }
  // One per cell: the outermost, which is met first.
  std::map<Cell, const Point*> outermost;
  const auto distance2 = [&](const Point& p) { return dot(p.at - centre, p.at - centre); };
  for (const auto& [place, p] : points) {
    Cell key;
    for (std::size_t k = 0; k < 3; ++k) key[k] = static_cast<int>(std::floor((p.at[k] - low[k]) / cell));
    const Point*& best = outermost[key];
    if (!best || distance2(p) > distance2(*best)) best = &p;
  }
  std::vector<Sample> samples;
  for (const auto& [key, p] : outermost) {
    const Vec3 out = normalised(p->normal, normalised(p->at - centre));
    samples.push_back({p->at, p->at - depth * out});
  }
  return samples;
}

namespace {

void write_contact(dContactGeom& g, Vec3 at, Vec3 normal, double depth) {
  g = {};
  for (std::size_t k = 0; k < 3; ++k) g.pos[k] = at[k], g.normal[k] = normal[k];
  g.depth = depth;
  g.side1 = g.side2 = -1;
}

}  // namespace

int collide_samples(std::span<const Sample> samples, const Pose& X_WA, dGeomID ray, dGeomID triangles_B,
                    std::span<dContactGeom> out) {
  dReal box[6];
  dGeomGetAABB(triangles_B, box);
  std::size_t count = 0;
  for (const Sample& s : samples) {
    if (count == out.size()) break;
    const Vec3 point = X_WA * s.point;
    // A point outside of B's bounds cannot be behind its surface by less than its ray's length.
    const Vec3 from = X_WA * s.below, along = point - from;
    bool apart = false;
    for (std::size_t k = 0; k < 3; ++k)
      apart = apart || std::max(point[k], from[k]) < box[2 * k] ||
              std::min(point[k], from[k]) > box[2 * k + 1];
    if (apart) continue;
    const double length = norm(along);
    dGeomRaySet(ray, from.x, from.y, from.z, along.x, along.y, along.z);
    dGeomRaySetLength(ray, length);
    dContactGeom hit;
    if (dCollide(ray, triangles_B, 1, &hit, sizeof hit) == 0) continue;
    Vec3 n = vec(hit.normal);
    if (dot(n, along) > 0) n = -n;
    const double depth = dot(n, vec(hit.pos) - point);
    if (depth < 0) continue;
    write_contact(out[count++], point, n, depth);
  }
  return static_cast<int>(count);
}

int collide_samples(std::span<const Sample> samples, const Pose& X_WA, const HeightGrid& grid,
                    const Pose& X_WG, std::span<dContactGeom> out) {
  const Pose X_GA = inverse(X_WG) * X_WA;
  std::size_t count = 0;
  for (const Sample& s : samples) {
    if (count == out.size()) break;
    const Vec3 p = X_GA * s.point;
    if (std::abs(p.x) > 0.5 * grid.size_x_m || std::abs(p.y) > 0.5 * grid.size_y_m) continue;
    const double under = height_at(grid, p.x, p.y) - p.z;
    if (under < 0) continue;
    const Vec3 n = normal_at(grid, p.x, p.y);
    write_contact(out[count++], X_WG * p, rotate(X_WG.q, n), under * n.z);
  }
  return static_cast<int>(count);
}

}  // namespace sandlot::rigid
