#include "physics/rigid/barrel_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/barrel.h"
#include "geometry/height_grid.h"

namespace sandlot::rigid {
namespace {

/// A flat end within this angle [rad] of a surface lies on it.
constexpr double flat = 0.02;

/// The point of a-b that lies deepest in (or nearest to) the barrel, all in its frame. Distance from a convex
/// body falls and then rises along a line, so halving by the golden section finds it.
struct Deepest {
  Vec3 point;
  BarrelSurface surface;
};
Deepest deepest(const Barrel& barrel, Vec3 a, Vec3 b) {
  constexpr double golden = 0.6180339887498949;
  const auto at = [&](double t) { return nearest(barrel, a + t * (b - a)).distance_m; };
  double low = 0, high = 1, left = 1 - golden, right = golden;
  double f = at(left), g = at(right);
  for (int i = 0; i < 44; ++i) {
    if (f < g) {
      high = right, right = left, g = f;
      left = high - golden * (high - low), f = at(left);
    } else {
      low = left, left = right, f = g;
      right = low + golden * (high - low), g = at(right);
    }
  }
  const Vec3 p = a + 0.5 * (low + high) * (b - a);
  Deepest best{p, nearest(barrel, p)};
  for (const Vec3 end : {a, b})  // a search never quite reaches its ends
    if (const BarrelSurface s = nearest(barrel, end); s.distance_m <= best.surface.distance_m)
      best = {end, s};
  return best;
}

/// Cuts a segment to the ball of this radius about the origin; false: it misses it.
bool cut(Vec3& a, Vec3& b, double radius) {
  const Vec3 along = b - a;
  const double length2 = dot(along, along);
  if (!(length2 > 0)) return dot(a, a) <= radius * radius;
  const double middle = -dot(a, along) / length2;
  const Vec3 foot = a + middle * along;
  const double half2 = (radius * radius - dot(foot, foot)) / length2;
  if (!(half2 >= 0)) return false;
  const double half = std::sqrt(half2), from = std::max(0.0, middle - half),
               to = std::min(1.0, middle + half);
  if (from > to) return false;
  const Vec3 start = a;
  a = start + from * along, b = start + to * along;
  return true;
}

struct Collector {
  const Barrel& barrel;
  const Pose& X_WB;
  std::span<dContactGeom> out;
  std::size_t count = 0;
  double reach = 0;  ///< radius about the origin that contains the barrel

  /// @param push  unit, into the barrel, in its frame
  void add(Vec3 point, Vec3 push, double depth) {
    if (count == out.size()) return;
    const Vec3 p = X_WB * point, n = rotate(X_WB.q, push);
    dContactGeom& g = out[count++];
    g = {};
    g.pos[0] = p.x, g.pos[1] = p.y, g.pos[2] = p.z;
    g.normal[0] = n.x, g.normal[1] = n.y, g.normal[2] = n.z;
    g.depth = depth;
    g.side1 = g.side2 = -1;
  }

  /// Points that may lie on a face with this normal: the farthest one, or four round a flat end.
  std::array<Vec3, 4> feet(Vec3 n, std::size_t& number) const {
    const double end = end_radius_m(barrel), z = n.z < 0 ? 0.5 * barrel.length_m : -0.5 * barrel.length_m;
    number = 1;
    if (n.x * n.x + n.y * n.y > flat * flat || !(end > 0)) return {farthest(barrel, -n)};
    number = 4;
    const Vec3 u = normalised(Vec3{-n.x, -n.y, 0}, {1, 0, 0}), v{-u.y, u.x, 0};
    return {end * u + Vec3{0, 0, z}, end * v + Vec3{0, 0, z}, -end * u + Vec3{0, 0, z},
            -end * v + Vec3{0, 0, z}};
  }

  void plane(Vec3 n, double offset) {
    std::size_t number = 0;
    const auto points = feet(n, number);
    for (std::size_t i = 0; i < number; ++i)
      if (const double depth = offset - dot(n, points[i]); depth >= 0)
        add(points[i] + 0.5 * depth * n, n, depth);
  }

  /// A ball swept from a to b.
  void capsule(Vec3 a, Vec3 b, double radius) {
    const Deepest d = a == b ? Deepest{a, nearest(barrel, a)} : deepest(barrel, a, b);
    const double depth = radius - d.surface.distance_m;
    if (depth < 0) return;
    add(d.point - (radius - 0.5 * depth) * d.surface.normal, -d.surface.normal, depth);
  }

  void box(Vec3 half, const Pose& X_BO) {
    const Vec3 axes[] = {rotate(X_BO.q, {1, 0, 0}), rotate(X_BO.q, {0, 1, 0}), rotate(X_BO.q, {0, 0, 1})};
    const auto overlap = [&](Vec3 push) {
      double box_reach = 0;
      for (std::size_t k = 0; k < 3; ++k) box_reach += half[k] * std::abs(dot(axes[k], push));
      return reach_m(barrel, push.z) + box_reach + dot(push, X_BO.p);
    };
    Vec3 push, edge_point;
    double depth = 1e300;
    std::size_t face = 3;
    for (std::size_t k = 0; k < 3; ++k)
      for (const double sign : {1.0, -1.0})
        if (const double f = overlap(sign * axes[k]); f < depth) depth = f, push = sign * axes[k], face = k;
    if (depth < 0) return;
    const Vec3 c = X_BO.p;
    for (std::size_t k = 0; k < 3; ++k)
      for (unsigned side = 0; side < 4; ++side) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const Vec3 middle = c + (side & 1 ? half[i] : -half[i]) * axes[i] +
                            (side & 2 ? half[j] : -half[j]) * axes[j];
        Vec3 a = middle - half[k] * axes[k], b = middle + half[k] * axes[k];
        if (!cut(a, b, reach)) continue;
        const Deepest d = deepest(barrel, a, b);
        const Vec3 out_of = -d.surface.normal;
        // Only where the edge is what the box offers in that direction; else a face is.
        const double f = overlap(out_of);
        if (f < depth - 1e-12 * reach) depth = f, push = out_of, face = 3, edge_point = d.point;
      }
    if (depth < 0) return;
    if (face == 3) return add(edge_point + 0.5 * depth * -push, push, depth);
    std::size_t number = 0, added = 0;
    const auto points = feet(push, number);
    const double top = dot(push, c) + half[face];
    const auto on_face = [&](Vec3 p, bool& inside) {
      inside = true;
      Vec3 q = c + dot(p - c, axes[face]) * axes[face];
      for (const std::size_t k : {(face + 1) % 3, (face + 2) % 3}) {
        const double x = dot(p - c, axes[k]);
        inside = inside && std::abs(x) <= half[k];
        q += std::clamp(x, -half[k], half[k]) * axes[k];
      }
      return q;
    };
    for (std::size_t i = 0; number > 1 && i < number; ++i) {
      bool inside = false;
      const Vec3 p = on_face(points[i], inside);
      const double deep = top - dot(push, p);
      if (inside && deep >= 0) add(p + 0.5 * deep * push, push, deep), ++added;
    }
    if (added > 0) return;
    bool inside = false;
    add(on_face(farthest(barrel, -push), inside) + 0.5 * depth * push, push, depth);
  }
};

/// Triangles one by one; faces and edges apart, because faces decide which edges count.
struct Skin {
  Collector& faces;
  struct EdgePoint {
    Vec3 point, push;
    double depth;
  };
  std::array<EdgePoint, 64> edges{};
  std::size_t edge_count = 0;

  void triangle(Vec3 a, Vec3 b, Vec3 c) {
    const Barrel& barrel = faces.barrel;
    const double r = barrel.radius_m, h = 0.5 * barrel.length_m;
    for (std::size_t k = 0; k < 3; ++k) {
      const double most = k == 2 ? h : r;
      if (std::min({a[k], b[k], c[k]}) > most || std::max({a[k], b[k], c[k]}) < -most) return;
    }
    const Vec3 middle = 1.0 / 3 * (a + b + c);
    const double extent = std::sqrt(
        std::max({dot(a - middle, a - middle), dot(b - middle, b - middle), dot(c - middle, c - middle)}));
    if (nearest(barrel, middle).distance_m > extent) return;
    const Vec3 n = normalised(cross(b - a, c - a), {});
    const double offset = dot(n, a);
    if (offset > 0 || n == Vec3{} || offset < -reach_m(barrel, n.z)) return;
    const auto over = [&](Vec3 p) {
      // A trifle beyond its edges, so that no point falls between two triangles.
      const auto beside = [&](Vec3 from, Vec3 to) {
        const Vec3 along = to - from;
        return dot(cross(along, n), p - from) > 1e-9 * faces.reach * norm(along);
      };
      return !beside(a, b) && !beside(b, c) && !beside(c, a);
    };
    std::size_t number = 0, added = 0;
    const auto points = faces.feet(n, number);
    for (std::size_t i = 0; i < number; ++i)
      if (const double depth = offset - dot(n, points[i]); depth >= 0 && over(points[i]))
        faces.add(points[i] + 0.5 * depth * n, n, depth), ++added;
    if (added > 0) return;
    for (auto [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      if (!cut(from, to, faces.reach)) continue;
      const Deepest d = deepest(barrel, from, to);
      const double depth = -d.surface.distance_m;
      if (depth < 0 || edge_count == edges.size() || dot(d.surface.normal, n) > 0) continue;
      edges[edge_count++] = {d.point + 0.5 * depth * d.surface.normal, -d.surface.normal, depth};
    }
  }

  void finish() {
    const std::size_t of_faces = faces.count;
    for (std::size_t i = 0; i < edge_count; ++i) {
      bool seam = false;
      const Vec3 push_W = rotate(faces.X_WB.q, edges[i].push);
      for (std::size_t f = 0; f < of_faces; ++f) {
        const dReal* n = faces.out[f].normal;
        seam = seam || dot(Vec3{n[0], n[1], n[2]}, push_W) > 0.9;
      }
      // Neighbours share edges, and a smooth body meets a nearly straight chain of them once: at the deepest.
      for (std::size_t k = 0; k < edge_count; ++k)
        seam = seam || (k != i && dot(edges[k].push, edges[i].push) > 0.9 &&
                        (edges[k].depth > edges[i].depth || (edges[k].depth == edges[i].depth && k < i)));
      if (!seam) faces.add(edges[i].point, edges[i].push, edges[i].depth);
    }
  }
};

void collide_grid(Skin& skin, const HeightGrid& g, const Pose& X_BO, const Pose& X_OB) {
  const Vec3 axis = rotate(X_OB.q, {0, 0, 1});
  const double dx = reach_m(skin.faces.barrel, axis.x), dy = reach_m(skin.faces.barrel, axis.y);
  const auto cell = [](double at, double size, double width, int cells) {
    return static_cast<int>(
        std::clamp(std::floor((at + 0.5 * size) / width), -1.0, static_cast<double>(cells)));
  };
  const int i0 = std::max(0, cell(X_OB.p.x - dx, g.size_x_m, g.cell_x_m(), g.columns - 1)),
            i1 = std::min(g.columns - 2, cell(X_OB.p.x + dx, g.size_x_m, g.cell_x_m(), g.columns - 1));
  const int j0 = std::max(0, cell(X_OB.p.y - dy, g.size_y_m, g.cell_y_m(), g.rows - 1)),
            j1 = std::min(g.rows - 2, cell(X_OB.p.y + dy, g.size_y_m, g.cell_y_m(), g.rows - 1));
  const auto corner = [&](int i, int j) {
    return X_BO * Vec3{i * g.cell_x_m() - 0.5 * g.size_x_m, j * g.cell_y_m() - 0.5 * g.size_y_m,
                       static_cast<double>(g.at(i, j))};
  };
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const Vec3 a = corner(i, j), c = corner(i + 1, j + 1);
      skin.triangle(a, corner(i + 1, j), c);
      skin.triangle(a, c, corner(i, j + 1));
    }
}

}  // namespace

int collide_barrel(const Barrel& barrel, const Pose& X_WB, const Shape& other, const Pose& X_WO,
                   const Triangles* triangles, std::span<dContactGeom> out) {
  Collector found{barrel, X_WB, out};
  found.reach = bounding_radius_m(barrel);
  const Pose X_BW = inverse(X_WB), X_BO = X_BW * X_WO;
  if (const auto* plane = std::get_if<Plane>(&other)) {
    const Vec3 n = normalised(rotate(X_BO.q, plane->normal));
    found.plane(n, dot(n, X_BO.p));
  } else if (const auto* ball = std::get_if<Sphere>(&other)) {
    found.capsule(X_BO.p, X_BO.p, ball->radius_m);
  } else if (const auto* pill = std::get_if<Capsule>(&other)) {
    const Vec3 half = rotate(X_BO.q, {0, 0, 0.5 * pill->length_m});
    found.capsule(X_BO.p - half, X_BO.p + half, pill->radius_m);
  } else if (const auto* box = std::get_if<Box>(&other)) {
    found.box(0.5 * box->size_m, X_BO);
  } else if (triangles) {
    Skin skin{found};
    const Pose X_OB = inverse(X_BO);
    if (const auto* field = std::get_if<Heightfield>(&other)) {
      collide_grid(skin, *field->grid, X_BO, X_OB);
    } else {
      const Vec3 axis = rotate(X_OB.q, {0, 0, 1});
      const Vec3 half{reach_m(barrel, axis.x), reach_m(barrel, axis.y), reach_m(barrel, axis.z)};
      const TriangleTree& tree = triangles->tree();
      tree.visit(X_OB.p - half, X_OB.p + half,
                 [&](Vec3 a, Vec3 b, Vec3 c) { skin.triangle(X_BO * a, X_BO * b, X_BO * c); });
    }
    skin.finish();
  }
  return static_cast<int>(found.count);
}

}  // namespace sandlot::rigid
