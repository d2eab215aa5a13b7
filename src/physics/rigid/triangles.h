#pragma once
/// Shapes that ODE knows as triangles: meshes, terrain, and tessellated cones and ellipsoids.
///
/// Mesh       ODE's trimesh on the mesh's own arrays; one tree for all shapes of a mesh.
/// Terrain    ODE's height field; the same diagonals as HeightGrid. Static only.
/// Cone       trimesh of 64 segments: the surface lies up to 0.12 % of the radius inside; exact against
///            planes.
/// Ellipsoid  trimesh of 48 segments: up to 0.22 % of the radius inside; exact against planes.
/// Contacts   ODE's points, of which duplicates are dropped and, where there are more than `max_contacts`,
///            the deepest is kept and then those farthest from the ones kept (in place and normal), in ODE's
///            order.
/// Limits     triangles are a skin: what sinks deeper than its own half, or is thinner than its path in a
///            sub-step, comes out on either side. Triangles against triangles: see mesh_contacts.h. ODE
///            searches trees in single precision: keep a mesh and its place within some kilometres.
/// Cost       building: 1 us per triangle, once per mesh and engine.
#include <ode/ode.h>

#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/mesh.h"
#include "model/model.h"
#include "physics/rigid/mesh_contacts.h"
#include "physics/rigid/triangle_tree.h"

namespace sandlot::rigid {

/// What ODE holds of one mesh or grid.
class Triangles {
 public:
  /// @pre is_of_triangles(shape)
  explicit Triangles(const Shape& shape);
  ~Triangles();
  Triangles(const Triangles&) = delete;
  Triangles& operator=(const Triangles&) = delete;

  /// A new shape in no space.
  dGeomID make_geom() const;
  /// Frame of ODE's shape in C: ODE's terrain has y up.
  Quat q_CO() const { return q_CO_; }
  /// For all but terrain.
  std::span<const Sample> samples() const { return samples_; }
  /// For all but terrain; made on first use.
  const TriangleTree& tree() const;

 private:
  std::shared_ptr<const TriangleMesh> mesh_;
  std::vector<Sample> samples_;
  std::vector<float> heights_;  ///< in ODE's order
  dTriMeshDataID triangles_ = nullptr;
  dHeightfieldDataID heightfield_ = nullptr;
  Quat q_CO_;
  mutable std::unique_ptr<const TriangleTree> tree_;
};

/// The triangles of one engine's shapes, kept while any shape uses them.
class TriangleStore {
 public:
  /// Null for shapes that ODE has itself. @pre `collision` outlives what is returned
  std::shared_ptr<const Triangles> of(const model::Collision& collision);

 private:
  /// By the address of the mesh, grid or collision; looked up only, so its order does not matter.
  std::unordered_map<const void*, std::weak_ptr<const Triangles>> known_;
};

/// Whether ODE knows this shape as triangles.
bool is_of_triangles(const Shape& shape);

/// Drops duplicates and keeps at most `most` points, in order, at the front. Returns how many.
/// @param size_m  of the smaller of the two shapes
int reduce_contacts(std::span<dContactGeom> points, int most, double size_m);

/// Exact contacts of an ellipsoid or a cone with a plane, the normal pointing into the shape.
bool meets_planes_exactly(const Shape& shape);
int collide_with_plane(const Shape& shape, const Pose& X_WC, Vec3 normal_W, double offset_m,
                       std::span<dContactGeom> out);

}  // namespace sandlot::rigid
