#include "physics/rigid/triangles.h"
#include "physics/rigid/ode_vector.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "geometry/height_grid.h"
#include "physics/rigid/ode_vector.h"

namespace sandlot::rigid {
namespace {

static_assert(sizeof(dTriIndex) == sizeof(std::uint32_t) && sizeof(Vec3) == 3 * sizeof(double));

constexpr int cone_segments = 64, ellipsoid_segments = 48;

}  // namespace

bool is_of_triangles(const Shape& shape) {
  return std::holds_alternative<Mesh>(shape) || std::holds_alternative<Heightfield>(shape) ||
         std::holds_alternative<Cone>(shape) || std::holds_alternative<Ellipsoid>(shape);
}

Triangles::Triangles(const Shape& shape) {
  if (const auto* field = std::get_if<Heightfield>(&shape)) {
    // A quarter turn about x takes ODE's (x, y up, z) to (x, -z, y up): its rows run along -y, ours along +y.
    // That also turns ODE's diagonals into those of HeightGrid.
    const HeightGrid& g = *field->grid;
    const double r = std::sqrt(0.5);
    q_CO_ = {r, r, 0, 0};
    for (int row = g.rows; row-- > 0;)
      for (int column = 0; column < g.columns; ++column) heights_.push_back(g.at(column, row));
    heightfield_ = dGeomHeightfieldDataCreate();
    const auto [low, high] = std::minmax_element(heights_.begin(), heights_.end());
    // Its bounding box reaches a metre below the lowest point, so that what has sunk in is still pushed out.
    dGeomHeightfieldDataBuildSingle(heightfield_, heights_.data(), 0, g.size_x_m, g.size_y_m, g.columns,
                                    g.rows, 1, 0, 1, 0);
    dGeomHeightfieldDataSetBounds(heightfield_, static_cast<double>(*low), static_cast<double>(*high));
    return;
  }
  if (const auto* m = std::get_if<Mesh>(&shape)) {
    mesh_ = m->mesh;
  } else {
    const int segments = std::holds_alternative<Cone>(shape) ? cone_segments : ellipsoid_segments;
    mesh_ = std::make_shared<const TriangleMesh>(tessellate(shape, segments));
  }
  samples_ = sample(*mesh_);
  triangles_ = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(triangles_, mesh_->vertices.data(), sizeof(Vec3),
                              static_cast<int>(mesh_->vertices.size()), mesh_->triangles.data(),
                              static_cast<int>(3 * mesh_->triangles.size()), 3 * sizeof(std::uint32_t));
}

Triangles::~Triangles() {
  if (triangles_) dGeomTriMeshDataDestroy(triangles_);
  if (heightfield_) dGeomHeightfieldDataDestroy(heightfield_);
}

const TriangleTree& Triangles::tree() const {
  SL_CHECK(mesh_);
  if (!tree_) tree_ = std::make_unique<const TriangleTree>(*mesh_);
  return *tree_;
}

dGeomID Triangles::make_geom() const {
  if (heightfield_) return dCreateHeightfield(nullptr, heightfield_, 1);
  return dCreateTriMesh(nullptr, triangles_, nullptr, nullptr, nullptr);
}

std::shared_ptr<const Triangles> TriangleStore::of(const model::Collision& collision) {
  if (!is_of_triangles(collision.shape)) return nullptr;
  const void* key = &collision;
  if (const auto* mesh = std::get_if<Mesh>(&collision.shape)) key = mesh->mesh.get();
  if (const auto* field = std::get_if<Heightfield>(&collision.shape)) key = field->grid.get();
  std::weak_ptr<const Triangles>& entry = known_[key];
  std::shared_ptr<const Triangles> triangles = entry.lock();
  if (!triangles) {
    std::erase_if(known_, [](const auto& e) { return e.second.expired(); });
    triangles = std::make_shared<const Triangles>(collision.shape);
    known_[key] = triangles;
  }
  return triangles;
}

int reduce_contacts(std::span<dContactGeom> points, int most, double size_m) {
  // Distance between points as contacts: two at one place that push in different ways are two.
  const auto apart2 = [&](const dContactGeom& a, const dContactGeom& b) {
    const Vec3 p = vec(a.pos) - vec(b.pos), n = size_m * (vec(a.normal) - vec(b.normal));
    return dot(p, p) + dot(n, n);
  };
  const double same = 1e-3 * size_m, same2 = same * same;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t twin = 0;
    while (twin < count && apart2(points[twin], points[i]) > same2) ++twin;
    if (twin == count) points[count++] = points[i];
    else if (points[i].depth > points[twin].depth) points[twin] = points[i];
  }
  points = points.first(count);
  if (count <= static_cast<std::size_t>(most)) return static_cast<int>(count);

  // The deepest, then always the one farthest from those kept. `side1` marks who stays; nobody else reads it.
  std::array<double, 512> nearest2;
  SL_CHECK(count <= nearest2.size());
  std::fill_n(nearest2.begin(), count, 1e300);
  for (dContactGeom& p : points) p.side1 = 0;
  std::size_t next = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (points[i].depth > points[next].depth) next = i;
  for (int kept = 0; kept < most; ++kept) {
    points[next].side1 = 1;
    const dContactGeom chosen = points[next];
    for (std::size_t i = 0; i < count; ++i) nearest2[i] = std::min(nearest2[i], apart2(points[i], chosen));
    next = 0;
    for (std::size_t i = 1; i < count; ++i)
      if (nearest2[i] > nearest2[next]) next = i;
  }
  std::size_t kept = 0;
  for (const dContactGeom& p : points)
    if (p.side1 == 1) points[kept++] = p;
  return static_cast<int>(kept);
}

bool meets_planes_exactly(const Shape& shape) {
  return std::holds_alternative<Cone>(shape) || std::holds_alternative<Ellipsoid>(shape);
}

int collide_with_plane(const Shape& shape, const Pose& X, Vec3 n, double offset_m,
                       std::span<dContactGeom> out) {
  std::size_t count = 0;
  const auto add = [&](Vec3 point_C) {
    const Vec3 p = X * point_C;
    const double depth = offset_m - dot(n, p);
    if (depth < 0 || count == out.size()) return;
    dContactGeom& g = out[count++];
    g = {};
    g.pos[0] = p.x, g.pos[1] = p.y, g.pos[2] = p.z;
    g.normal[0] = n.x, g.normal[1] = n.y, g.normal[2] = n.z;
    g.depth = depth;
    g.side1 = g.side2 = -1;
  };
  const Vec3 down = -rotate_inverse(X.q, n);
  if (const auto* e = std::get_if<Ellipsoid>(&shape)) {
    const Vec3 r = e->radii_m, scaled{r.x * down.x, r.y * down.y, r.z * down.z};
    const double support = norm(scaled);
    add({r.x * scaled.x / support, r.y * scaled.y / support, r.z * scaled.z / support});
    return static_cast<int>(count);
  }
  const Cone& cone = std::get<Cone>(shape);
  const double h = 0.5 * cone.length_m, r = cone.radius_m;
  const Vec3 lowest = normalised(Vec3{down.x, down.y, 0}, {1, 0, 0});
  const Vec3 across{-lowest.y, lowest.x, 0};
  add({0, 0, h});
  for (const Vec3 side : {lowest, across, -lowest, -across}) add(r * side - Vec3{0, 0, h});
  return static_cast<int>(count);
}

}  // namespace sandlot::rigid
