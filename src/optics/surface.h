#pragma once
/// Surface at the point where a ray meets it: normals, and texture coordinates with their gradients.
///
/// Texture   box: every face once, upright. Sphere, ellipsoid: u once around z from -x through -y to +x, v
///           from pole to pole. Cylinder, capsule, cone, barrel: u around, v along z; their ends as seen
///           along z. Plane: u and v along its axes, one tile per `tile_m`. Roughly as OGRE's meshes of these
///           primitives, which Gazebo shows.
#include <memory>
#include <vector>

#include "geometry/shape.h"
#include "optics/lanes_math.h"
#include "optics/solid.h"

namespace sandlot::optics {

/// In the shape's frame.
struct Surface8 {
  lanes::F3 normal;       ///< unit, outwards; of smoothed meshes interpolated
  lanes::F3 face_normal;  ///< unit, of the surface itself
  lanes::F u, v;
  lanes::F3 u_gradient, v_gradient;  ///< [1/m], along the surface
};

/// @param p          points of the solid's surface, in its frame @pre not triangles
/// @param textured   false: u, v and gradients stay undefined
Surface8 surface_of(const Solid& solid, const lanes::F3& p, bool textured);

/// A mesh or height field as it is shown: smooth normals, texture coordinates, parts.
///
/// Cost   40 bytes and 0.5 us per triangle, once; terrain: nothing.
class Skin {
 public:
  /// @pre shape is a Mesh or a Heightfield
  Skin(const Shape& shape, bool smooth);

  /// @param p  relative to the middle of the bounds, as TriangleTree has it
  /// @param valid  lanes to fill; the others are zero
  Surface8 surface(lanes::I valid, lanes::I triangle, lanes::F b1, lanes::F b2, const lanes::F3& p,
                   bool textured) const;
  /// Index into TriangleMesh::parts; 0 where there are none.
  std::uint32_t part(std::uint32_t triangle) const { return parts_.empty() ? 0 : parts_[triangle]; }
  const TriangleMesh* mesh() const { return mesh_; }
  bool has_texture_coordinates() const;

 private:
  Shape shape_;  ///< keeps the mesh alive
  bool smooth_;
  const TriangleMesh* mesh_ = nullptr;
  std::vector<float> normals_;        ///< nine per triangle; none: flat
  std::vector<std::uint32_t> parts_;  ///< of each triangle
};

}  // namespace sandlot::optics
