#include "optics/surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/math.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot::optics {
namespace {

using lanes::abs;
using lanes::broadcast;
using lanes::F;
using lanes::F3;
using lanes::I;
using lanes::select;

constexpr float turn = 2 * std::numbers::pi_v<float>;
constexpr float tiny = 1e-20f;

void set_normal(Surface8& s, F3 n) { s.normal = s.face_normal = n; }

/// u once around z.
void around(Surface8& s, F x, F y) {
  const F square = lanes::max(x * x + y * y, broadcast(tiny));
  s.u = 0.5f + lanes::angle_of(y, x) / turn;
  s.u_gradient = {-y / (turn * square), x / (turn * square), broadcast(0.0f)};
}
void along_z(Surface8& s, F z, float length) {
  s.v = 0.5f + z / length;
  s.v_gradient = {broadcast(0.0f), broadcast(0.0f), broadcast(1 / length)};
}
/// A flat end, where `end`: the square around the disc once.
void flat_end(Surface8& s, I end, const F3& p, float radius) {
  const float per_m = 0.5f / radius;
  s.u = select(end, 0.5f + per_m * p.x, s.u);
  s.v = select(end, 0.5f + per_m * p.y, s.v);
  s.u_gradient = select(end, {broadcast(per_m), broadcast(0.0f), broadcast(0.0f)}, s.u_gradient);
  s.v_gradient = select(end, {broadcast(0.0f), broadcast(per_m), broadcast(0.0f)}, s.v_gradient);
}
F3 upright(F z) {
  return {broadcast(0.0f), broadcast(0.0f), select(z < 0, broadcast(-1.0f), broadcast(1.0f))};
}

Surface8 box(const float* half, const F3& p, bool textured) {
  Surface8 s;
  // The face is the one whose plane is nearest.
  const F dx = abs(abs(p.x) - half[0]), dy = abs(abs(p.y) - half[1]), dz = abs(abs(p.z) - half[2]);
  const I on_x = (dx <= dy) & (dx <= dz), on_y = ~on_x & (dy <= dz);
  const auto sign = [](F a) { return select(a < 0, broadcast(-1.0f), broadcast(1.0f)); };
  const F zero = broadcast(0.0f);
  set_normal(s, select(on_x, {sign(p.x), zero, zero},
                       select(on_y, {zero, sign(p.y), zero}, F3{zero, zero, sign(p.z)})));
  if (!textured) return s;
  const float px = 0.5f / half[0], py = 0.5f / half[1], pz = 0.5f / half[2];
  s.u_gradient = select(on_x, {zero, py * sign(p.x), zero},
                        select(on_y, {-px * sign(p.y), zero, zero}, F3{broadcast(px), zero, zero}));
  s.v_gradient = select(on_x | on_y, {zero, zero, broadcast(pz)}, F3{zero, py * sign(p.z), zero});
  s.u = 0.5f + dot(s.u_gradient, p);
  s.v = 0.5f + dot(s.v_gradient, p);
  return s;
}

Surface8 oval_surface(const float* r, const F3& p, bool textured) {
  Surface8 s;
  const F3 q{p.x / r[0], p.y / r[1], p.z / r[2]};  // on the unit sphere
  set_normal(s, normalised(F3{q.x / r[0], q.y / r[1], q.z / r[2]}));
  if (!textured) return s;
  around(s, q.x, q.y);
  const F across = lanes::sqrt(lanes::max(q.x * q.x + q.y * q.y, broadcast(tiny)));
  s.v = 0.5f + lanes::angle_of(q.z, across) / (turn / 2);
  const float scale = 1 / (turn / 2);
  s.v_gradient = {-q.z * q.x / across * scale, -q.z * q.y / across * scale, across * scale};
  // From the unit sphere to the ellipsoid.
  const auto stretch = [&](F3& g) { g = {g.x / r[0], g.y / r[1], g.z / r[2]}; };
  stretch(s.u_gradient);
  stretch(s.v_gradient);
  return s;
}

}  // namespace

Surface8 surface_of(const Solid& solid, const F3& p, bool textured) {
  const float* size = solid.size;
  const float radius = size[0], half = size[1];
  Surface8 s;
  switch (solid.type) {
    case Solid::Type::box: return box(size, p, textured);
    case Solid::Type::sphere: {
      const float r[] = {radius, radius, radius};
      return oval_surface(r, p, textured);
    }
    case Solid::Type::ellipsoid: return oval_surface(size, p, textured);
    case Solid::Type::cylinder:
    case Solid::Type::cone:
    case Solid::Type::barrel: {
      const F out = lanes::sqrt(p.x * p.x + p.y * p.y), safe = lanes::max(out, broadcast(tiny));
      F wide = broadcast(radius),
        slope = broadcast(0.0f);  // of the side at this height; d z / d r of its normal
      if (solid.type == Solid::Type::cone) {
        wide = radius * (half - p.z) / (2 * half);
        slope = broadcast(radius / (2 * half));
      }
      if (solid.type == Solid::Type::barrel) {
        const float flat = radius / size[2];  // x x + y y + (flat z)^2 = r^2
        wide = lanes::sqrt(lanes::max(radius * radius - flat * flat * p.z * p.z, broadcast(tiny)));
        slope = flat * flat * p.z / wide;
      }
      const I end = (solid.type == Solid::Type::cone ? half + p.z : abs(half - abs(p.z))) < abs(wide - out);
      set_normal(s, select(end, upright(p.z), normalised(F3{p.x / safe, p.y / safe, slope})));
      if (!textured) return s;
      around(s, p.x, p.y);
      along_z(s, p.z, 2 * half);
      flat_end(s, end, p, radius);
      return s;
    }
    case Solid::Type::capsule: {
      const F beyond = p.z - lanes::clamp(p.z, -half, half);
      set_normal(s, normalised(F3{p.x, p.y, beyond}));
      if (!textured) return s;
      around(s, p.x, p.y);
      along_z(s, p.z, 2 * (half + radius));
      return s;
    }
    case Solid::Type::triangles: break;
  }
  SL_CHECK_MSG(false, "a skin knows what triangles are like");
  return box(size, p, textured);
}

// ---- meshes

namespace {

constexpr double crease_cos = 0.766;  // of 40 degrees

/// Vertices at equal places as one index each.
std::vector<std::uint32_t> merged(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size()), same(mesh.vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto& v = mesh.vertices;
  const auto key = [&](std::uint32_t i) { return std::array{v[i].x, v[i].y, v[i].z}; };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i)
    same[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? same[order[i - 1]] : order[i];
  return same;
}

/// Each corner's normal: that of all faces around the place that are within the crease of this one, weighted
/// by their angle there.
std::vector<float> smooth_normals(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  const std::vector<std::uint32_t> place = merged(mesh);
  std::vector<Vec3> face(count);
  std::vector<double> angle(3 * count);
  std::vector<std::uint32_t> first(mesh.vertices.size() + 1, 0), corners(3 * count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& c = mesh.triangles[t];
    const Vec3 p[] = {mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]};
    face[t] = normalised(cross(p[1] - p[0], p[2] - p[0]), Vec3{0, 0, 1});
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
      angle[3 * t + k] = math::atan2(norm(cross(a, b)), dot(a, b));
      ++first[place[c[k]] + 1];
    }
  }
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t i = 0; i < corners.size(); ++i) corners[next[place[mesh.triangles[i / 3][i % 3]]]++] = i;
  std::vector<float> normals;
  normals.reserve(9 * count);
  // Around a place where thousands of faces meet, all pairs would be too many: a fan's tip stays flat.
  constexpr std::uint32_t most = 64;
  for (std::size_t i = 0; i < 3 * count; ++i) {
    const std::uint32_t at = place[mesh.triangles[i / 3][i % 3]];
    Vec3 sum;
    if (first[at + 1] - first[at] <= most)
      for (std::uint32_t k = first[at]; k < first[at + 1]; ++k)
        if (const Vec3 other = face[corners[k] / 3]; dot(other, face[i / 3]) >= crease_cos)
          sum += angle[corners[k]] * other;
    sum = normalised(sum, face[i / 3]);
    for (std::size_t k = 0; k < 3; ++k) normals.push_back(static_cast<float>(sum[k]));
  }
  return normals;
}

}  // namespace

Skin::Skin(const Shape& shape, bool smooth) : shape_(shape), smooth_(smooth) {
  const auto* solid = std::get_if<Mesh>(&shape_);
  if (!solid) return;
  mesh_ = solid->mesh.get();
  if (smooth) normals_ = smooth_normals(*mesh_);
  if (mesh_->parts.size() < 2) return;
  parts_.assign(mesh_->triangles.size(), 0);
  for (std::uint32_t k = 0; k < mesh_->parts.size(); ++k) {
    const MeshPart& part = mesh_->parts[k];
    for (std::size_t i = 0; i < part.triangles && part.first_triangle + i < parts_.size(); ++i)
      parts_[part.first_triangle + i] = k;
  }
}

bool Skin::has_texture_coordinates() const { return !mesh_ || !mesh_->texture_uv.empty(); }

Surface8 Skin::surface(I valid, I triangle, F b1, F b2, const F3& p, bool textured) const {
  Surface8 out;
  const F zero = broadcast(0.0f);
  out.normal = out.face_normal = out.u_gradient = out.v_gradient = F3{zero, zero, zero};
  out.u = out.v = zero;
  const auto put = [](F3& to, int i, Vec3 a) {
    to.x[i] = static_cast<float>(a.x);
    to.y[i] = static_cast<float>(a.y);
    to.z[i] = static_cast<float>(a.z);
  };
  for (int i = 0; i < lanes::width; ++i) {
    if (!valid[i]) continue;
    if (!mesh_) {
      const HeightGrid& grid = *std::get<Heightfield>(shape_).grid;
      const auto x = static_cast<double>(p.x[i]), y = static_cast<double>(p.y[i]);
      // The slope over two cells about the point: it changes steadily from cell to cell.
      const double dx = grid.cell_x_m(), dy = grid.cell_y_m();
      const double along_x = (height_at(grid, x + dx, y) - height_at(grid, x - dx, y)) / (2 * dx);
      const double along_y = (height_at(grid, x, y + dy) - height_at(grid, x, y - dy)) / (2 * dy);
      put(out.face_normal, i, normal_at(grid, x, y));
      put(out.normal, i, smooth_ ? normalised(Vec3{-along_x, -along_y, 1}) : normal_at(grid, x, y));
      if (!textured) continue;
      out.u[i] = static_cast<float>(x / grid.size_x_m + 0.5);
      out.v[i] = static_cast<float>(y / grid.size_y_m + 0.5);
      put(out.u_gradient, i, {1 / grid.size_x_m, 0, 0});
      put(out.v_gradient, i, {0, 1 / grid.size_y_m, 0});
      continue;
    }
    const auto t = static_cast<std::size_t>(triangle[i]);
    const auto& c = mesh_->triangles[t];
    const Vec3 origin = mesh_->vertices[c[0]], e1 = mesh_->vertices[c[1]] - origin,
               e2 = mesh_->vertices[c[2]] - origin, across = cross(e1, e2);
    const Vec3 n = normalised(across, Vec3{0, 0, 1});
    put(out.face_normal, i, n);
    const auto w1 = static_cast<double>(b1[i]), w2 = static_cast<double>(b2[i]);
    if (normals_.empty()) {
      put(out.normal, i, n);
    } else {
      const float* k = &normals_[9 * t];
      const auto corner = [&](std::size_t j) {
        return Vec3{static_cast<double>(k[3 * j]), static_cast<double>(k[3 * j + 1]),
                    static_cast<double>(k[3 * j + 2])};
      };
      put(out.normal, i, normalised((1 - w1 - w2) * corner(0) + w1 * corner(1) + w2 * corner(2), n));
    }
    if (!textured) continue;
    const auto uv = [&](std::size_t j, std::size_t k) {
      return static_cast<double>(mesh_->texture_uv[c[j]][k]);
    };
    // Gradients of functions that are linear over the triangle.
    const double square = std::max(dot(across, across), 1e-300);
    const Vec3 g1 = cross(e2, across) / square, g2 = cross(across, e1) / square;
    F* const value[] = {&out.u, &out.v};
    F3* const gradient[] = {&out.u_gradient, &out.v_gradient};
    for (std::size_t k = 0; k < 2; ++k) {
      const double d1 = uv(1, k) - uv(0, k), d2 = uv(2, k) - uv(0, k);
      (*value[k])[i] = static_cast<float>(uv(0, k) + w1 * d1 + w2 * d2);
      put(*gradient[k], i, d1 * g1 + d2 * g2);
    }
  }
  return out;
}

}  // namespace sandlot::optics
