#include "optics/triangles.h"

#include <algorithm>
#include <limits>
#include <span>
#include <type_traits>

#include "base/check.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot::optics {
namespace {

using lanes::F;
using lanes::I;

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

TriangleTree::TriangleTree(RTCDevice device, const Shape& shape) : shape_(shape) {
  scene_ = rtcNewScene(device);
  SL_CHECK_MSG(scene_, "Embree makes no scene");
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  // High quality takes three times as long to build and answers a few per cent faster.
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);
  if (const auto* field = std::get_if<Heightfield>(&shape)) {
    constexpr int most = 32767;  // samples of a grid of Embree's
    if (std::max(field->grid->columns, field->grid->rows) <= most) add_grid(device, *field->grid);
    else add_triangles(device, tessellate(shape));
  } else {
    add_triangles(device, *std::get<Mesh>(shape).mesh);
  }
}

TriangleTree::~TriangleTree() { rtcReleaseScene(scene_); }

void TriangleTree::attach(RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
}

void TriangleTree::add_triangles(RTCDevice device, const TriangleMesh& mesh) {
  Range range[3];
  for (const Vec3& v : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) range[k].add(v[k]);
  if (mesh.vertices.empty() || mesh.triangles.empty()) return;
  centre_ = {range[0].middle(), range[1].middle(), range[2].middle()};
  half_size_ = {range[0].half(), range[1].half(), range[2].half()};
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
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
  attach(geometry);
}

/// Embree splits the squares of a grid from the second corner to the fourth, HeightGrid from the first to the third: a
/// grid whose columns run backwards has the same diagonals.
void TriangleTree::add_grid(RTCDevice device, const HeightGrid& grid) {
  Range z;
  for (const float h : grid.height_m) z.add(static_cast<double>(h));
  centre_ = {0, 0, z.middle()};
  half_size_ = {0.5 * grid.size_x_m, 0.5 * grid.size_y_m, z.half()};
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_GRID);
  const auto columns = static_cast<unsigned>(grid.columns), rows = static_cast<unsigned>(grid.rows);
  auto* corner = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                             RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                             std::size_t{columns} * rows));
  auto* const whole = static_cast<RTCGrid*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
  SL_CHECK_MSG(corner && whole, "Embree has no memory for a height field");
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

template <class Rays>
void fill(RTCRay8& ray, const Rays& rays, F near, F far) {
  const auto each = [](auto origin) {
    if constexpr (std::is_same_v<decltype(origin), float>) return lanes::all(origin);
    else return origin;
  };
  lanes::store(ray.org_x, each(rays.ox));
  lanes::store(ray.org_y, each(rays.oy));
  lanes::store(ray.org_z, each(rays.oz));
  lanes::store(ray.dir_x, rays.dx);
  lanes::store(ray.dir_y, rays.dy);
  lanes::store(ray.dir_z, rays.dz);
  lanes::store(ray.tnear, near);
  lanes::store(ray.tfar, far);
  lanes::store(ray.time, lanes::all(0.0f));
  lanes::store(ray.mask, lanes::all(-1));
  lanes::store(ray.flags, lanes::all(0));
}

template <class Rays>
void trace(RTCScene scene, RTCRayHit8& packet, const Rays& rays, F near, F far, const int* valid) {
  fill(packet.ray, rays, near, far);
  lanes::store(packet.hit.geomID, lanes::all(nothing));
  lanes::store(packet.hit.instID[0], lanes::all(nothing));
  embree::QueryContext context;
  embree::init_context(context);
  embree::intersect8(valid, scene, context, packet);
}

}  // namespace

F TriangleTree::distance_to(const LocalRays8& rays, F near, F far, const int* valid) const {
  alignas(64) RTCRayHit8 packet;
  trace(scene_, packet, rays, near, far, valid);
  return lanes::choose(lanes::load<I>(packet.hit.geomID) == nothing,
                       lanes::all(std::numeric_limits<float>::infinity()), lanes::load<F>(packet.ray.tfar));
}

TriangleTree::Hits TriangleTree::nearest(const LocalSpread8& rays, F near, F far, const int* valid) const {
  alignas(64) RTCRayHit8 packet;
  trace(scene_, packet, rays, near, far, valid);
  return {lanes::choose(lanes::load<I>(packet.hit.geomID) == nothing,
                        lanes::all(std::numeric_limits<float>::infinity()), lanes::load<F>(packet.ray.tfar)),
          lanes::load<I>(packet.hit.primID), lanes::load<F>(packet.hit.u), lanes::load<F>(packet.hit.v)};
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
