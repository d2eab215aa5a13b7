#include "optics/triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "base/check.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "optics/lanes_math.h"

namespace sandlot::optics {
namespace {

using lanes::F;
using lanes::F3;
using lanes::I;

constexpr float largest = std::numeric_limits<float>::max();
constexpr int nothing = static_cast<int>(RTC_INVALID_GEOMETRY_ID);

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double middle() const { return 0.5 * (low + high); }
  double half() const { return 0.5 * (high - low); }
};

}  // namespace

const void* triangles_of(const Shape& shape) {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return mesh->mesh.get();
  if (const auto* field = std::get_if<Heightfield>(&shape)) return field->grid.get();
  return nullptr;
}

TriangleTree::TriangleTree(const Shape& shape) : shape_(shape) {
  scene_ = rtcNewScene(embree::device());
  SL_CHECK_MSG(scene_, "Embree makes no scene");
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  // High quality takes three times as long to build and answers a few per cent faster.
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);
  if (const auto* field = std::get_if<Heightfield>(&shape)) {
    constexpr int most = 32767;  // samples of a grid of Embree's
    if (std::max(field->grid->columns, field->grid->rows) <= most) add_grid(*field->grid);
    else add_triangles(tessellate(shape));
  } else {
    add_triangles(*std::get<Mesh>(shape).mesh);
  }
}

TriangleTree::~TriangleTree() { rtcReleaseScene(scene_); }

void TriangleTree::attach(RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
}

void TriangleTree::add_triangles(const TriangleMesh& mesh) {
  Range range[3];
  for (const Vec3& v : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) range[k].add(v[k]);
  if (mesh.vertices.empty() || mesh.triangles.empty()) return;
  centre_ = {range[0].middle(), range[1].middle(), range[2].middle()};
  half_size_ = {range[0].half(), range[1].half(), range[2].half()};
  const RTCGeometry geometry = rtcNewGeometry(embree::device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* const corners = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  auto* const indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  SL_CHECK_MSG(corners && indices, "Embree has no memory for a mesh");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      corners[3 * i + k] = static_cast<float>(mesh.vertices[i][k] - centre_[k]);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) indices[3 * i + k] = mesh.triangles[i][k];
  corners_ = corners;
  indices_ = indices;
  attach(geometry);
}

/// Embree splits the squares of a grid from the second corner to the fourth, HeightGrid from the first to the
/// third: a grid whose columns run backwards has the same diagonals.
void TriangleTree::add_grid(const HeightGrid& grid) {
  Range z;
  for (const float h : grid.height_m) z.add(static_cast<double>(h));
  centre_ = {0, 0, z.middle()};
  half_size_ = {0.5 * grid.size_x_m, 0.5 * grid.size_y_m, z.half()};
  const RTCGeometry geometry = rtcNewGeometry(embree::device(), RTC_GEOMETRY_TYPE_GRID);
  const auto columns = static_cast<unsigned>(grid.columns), rows = static_cast<unsigned>(grid.rows);
  auto* corner = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                             RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                             std::size_t{columns} * rows));
  auto* const whole = static_cast<RTCGrid*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
  SL_CHECK_MSG(corner && whole, "Embree has no memory for a height field");
  corners_ = corner;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = grid.columns; column-- > 0; corner += 3) {
      corner[0] = static_cast<float>(column * grid.cell_x_m() - half_size_.x);
      corner[1] = static_cast<float>(row * grid.cell_y_m() - half_size_.y);
      corner[2] = static_cast<float>(static_cast<double>(grid.at(column, row)) - centre_.z);
    }
  *whole = {0, columns, static_cast<unsigned short>(columns), static_cast<unsigned short>(rows)};
  attach(geometry);
}

namespace {

template <class Origin>
F each(Origin x) {
  if constexpr (std::is_same_v<Origin, float>) return lanes::broadcast(x);
  else return x;
}

template <class Rays>
void fill(RTCRay8& ray, const Rays& rays, F near, F far) {
  lanes::store(ray.org_x, each(rays.ox));
  lanes::store(ray.org_y, each(rays.oy));
  lanes::store(ray.org_z, each(rays.oz));
  lanes::store(ray.dir_x, rays.dx);
  lanes::store(ray.dir_y, rays.dy);
  lanes::store(ray.dir_z, rays.dz);
  lanes::store(ray.tnear, near);
  lanes::store(ray.tfar, far);
  lanes::store(ray.time, lanes::broadcast(0.0f));
  lanes::store(ray.mask, lanes::broadcast(-1));
  lanes::store(ray.flags, lanes::broadcast(0));
}

template <class Rays>
void trace(RTCScene scene, RTCRayHit8& packet, const Rays& rays, F near, F far, const int* valid) {
  fill(packet.ray, rays, near, far);
  lanes::store(packet.hit.geomID, lanes::broadcast(nothing));
  lanes::store(packet.hit.instID[0], lanes::broadcast(nothing));
  embree::QueryContext context;
  embree::init_context(context);
  embree::intersect8(valid, scene, context, packet);
}

/// To the plane through three points; may be infinite or no number.
double distance_along(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 normal = cross(b - a, c - a);
  return dot(a - origin, normal) / dot(direction, normal);
}

}  // namespace

/// By the plane of the triangle that was hit; weights by the volumes that the ray spans with its edges.
template <class Rays>
void TriangleTree::place_on_mesh(const Rays& rays, Hits& hits) const {
  const I found = hits.t < std::numeric_limits<float>::infinity();
  if (!lanes::any(found)) return;
  alignas(32) float corner[9][lanes::width] = {};
  for (int i = 0; i < lanes::width; ++i) {
    if (!found[i]) continue;
    const unsigned* const of = indices_ + 3 * static_cast<std::size_t>(hits.triangle[i]);
    for (std::size_t k = 0; k < 9; ++k) corner[k][i] = corners_[std::size_t{3} * of[k / 3] + k % 3];
  }
  const F3 origin{each(rays.ox), each(rays.oy), each(rays.oz)}, direction{rays.dx, rays.dy, rays.dz};
  const auto from_origin = [&](int k) {
    return F3{lanes::load<F>(corner[3 * k]), lanes::load<F>(corner[3 * k + 1]),
              lanes::load<F>(corner[3 * k + 2])} -
           origin;
  };
  const F3 a = from_origin(0), b = from_origin(1), c = from_origin(2);
  const F3 opposite_b = c - a, opposite_c = a - b, opposite_a = b - c;
  const F w_b = dot(cross(opposite_b, c + a), direction), w_c = dot(cross(opposite_c, a + b), direction),
          w_a = dot(cross(opposite_a, b + c), direction), all = w_a + w_b + w_c;
  const F3 normal = cross(opposite_b, opposite_c);
  const F across = dot(normal, direction), t = dot(normal, a) / across;
  // Triangles too thin for this (t may not be a number) stay as they are.
  hits.t = lanes::select(found & (across != 0) & (lanes::abs(t) < largest), t, hits.t);
  const auto weight = [&](F w) { return lanes::min(lanes::max(w / all, F{}), lanes::broadcast(1.0f)); };
  hits.b1 = lanes::select(found & (all != 0), weight(w_b), hits.b1);
  hits.b2 = lanes::select(found & (all != 0), weight(w_c), hits.b2);
}

/// For a whole grid Embree reports only where in it the hit is, so the triangle is looked for there: first of
/// all that the point may lie in, by more than the rounding of floats.
template <class Rays>
void TriangleTree::place_on_grid(const Rays& rays, Hits& hits) const {
  const HeightGrid& grid = *std::get<Heightfield>(shape_).grid;
  const double dx = grid.cell_x_m(), dy = grid.cell_y_m();
  const double slack = 1e-6 + 1e-7 * std::max(grid.columns, grid.rows);  // in cells
  const auto corner = [&](int column, int row) {
    const float* const at = corners_ + std::size_t{3} * (static_cast<std::size_t>(row) *
                                                             static_cast<std::size_t>(grid.columns) +
                                                         static_cast<std::size_t>(grid.columns - 1 - column));
    return Vec3{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
  };
  const F3 origin{each(rays.ox), each(rays.oy), each(rays.oz)}, direction{rays.dx, rays.dy, rays.dz};
  for (int i = 0; i < lanes::width; ++i) {
    if (!(hits.t[i] < std::numeric_limits<float>::infinity())) continue;
    const auto ray = [i](const F3& v) {
      return Vec3{static_cast<double>(v.x[i]), static_cast<double>(v.y[i]), static_cast<double>(v.z[i])};
    };
    const Vec3 o = ray(origin), d = ray(direction);
    const auto about = static_cast<double>(hits.t[i]);
    const Vec3 p = o + about * d;
    const double column = (p.x + half_size_.x) / dx, row = (p.y + half_size_.y) / dy;
    const auto cell = [slack](double at, double side, int cells) {
      return std::clamp(static_cast<int>(std::floor(at + side * slack)), 0, cells - 2);
    };
    const double tolerance = 1e-3 * (dx + dy + std::abs(about));
    double nearest = std::numeric_limits<double>::infinity();
    const auto take = [&](double t, int of_column, int of_row, bool upper) {
      if (!(std::abs(t - about) < tolerance) || t >= nearest) return;
      const Vec3 q = o + t * d;
      const double u = (q.x + half_size_.x) / dx - of_column, v = (q.y + half_size_.y) / dy - of_row;
      const double low = upper ? u : v, high = upper ? v : u, edge = 0.25 * slack;
      if (low >= -edge && low <= high + edge && high <= 1 + edge) nearest = t;
    };
    const int last_column = cell(column, 1, grid.columns), last_row = cell(row, 1, grid.rows);
    for (int m = cell(row, -1, grid.rows); m <= last_row; ++m)
      for (int k = cell(column, -1, grid.columns); k <= last_column; ++k) {
        const Vec3 a = corner(k, m), c = corner(k + 1, m + 1);
        take(distance_along(o, d, a, corner(k + 1, m), c), k, m, false);
        take(distance_along(o, d, a, c, corner(k, m + 1)), k, m, true);
      }
    if (nearest < std::numeric_limits<double>::infinity()) hits.t[i] = static_cast<float>(nearest);
  }
}

template <class Rays>
TriangleTree::Hits TriangleTree::hit(const Rays& rays, F near, F far, const int* valid) const {
  alignas(64) RTCRayHit8 packet;
  trace(scene_, packet, rays, near, far, valid);
  Hits hits{lanes::select(lanes::load<I>(packet.hit.geomID) == nothing,
                          lanes::broadcast(std::numeric_limits<float>::infinity()),
                          lanes::load<F>(packet.ray.tfar)),
            lanes::load<I>(packet.hit.primID), lanes::load<F>(packet.hit.u), lanes::load<F>(packet.hit.v)};
  if (indices_) place_on_mesh(rays, hits);
  else place_on_grid(rays, hits);
  return hits;
}

F TriangleTree::distance_to(const LocalRays8& rays, F near, F far, const int* valid) const {
  return hit(rays, near, far, valid).t;
}

TriangleTree::Hits TriangleTree::nearest(const LocalSpread8& rays, F near, F far, const int* valid) const {
  return hit(rays, near, far, valid);
}

I TriangleTree::between(const LocalSpread8& rays, F near, F far, const int* valid) const {
  alignas(32) RTCRay8 packet;
  fill(packet, rays, near, far);
  embree::QueryContext context;
  embree::init_context(context);
  embree::occluded8(valid, scene_, context, packet);
  return lanes::load<F>(packet.tfar) < 0;
}

}  // namespace sandlot::optics
