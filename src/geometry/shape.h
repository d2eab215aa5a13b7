#pragma once
/// Shapes in their own frame G: the closed list that physics, rays and drawings agree on.
#include <memory>
#include <variant>

#include "geometry/vec3.h"

namespace sandlot {

struct Box {
  Vec3 size_m;  ///< full edge lengths, centred on G
};
struct Sphere {
  double radius_m;
};
/// Axis along z of G, centred; `length_m` from cap to cap.
struct Cylinder {
  double radius_m;
  double length_m;
};
/// Axis along z of G, centred; `length_m` is the cylindrical part without the half spheres.
struct Capsule {
  double radius_m;
  double length_m;
};
/// Half space below the plane through G's origin. Infinite: SDF's <size> is for drawing only.
struct Plane {
  Vec3 normal;  ///< unit, in G
};

/// Axis along z of G, apex up; G's origin is half way between base and apex, as SDF has it.
struct Cone {
  double radius_m;
  double length_m;
};
struct Ellipsoid {
  Vec3 radii_m;
};

/// Turned from an arc: r(z) = radius - profile + sqrt(profile^2 - z^2) for |z| <= length / 2, with flat ends.
/// Axis along z of G, centred. The roller of an omni wheel; with a profile smaller than the radius, a tyre.
/// geometry/barrel.h.
struct Barrel {
  double radius_m;   ///< at the thick middle
  double profile_m;  ///< radius of the arc, >= length / 2
  double length_m;
};

struct TriangleMesh;  // geometry/mesh.h
struct HeightGrid;    // geometry/height_grid.h

/// A surface of triangles; a solid to physics where it is closed.
struct Mesh {
  std::shared_ptr<const TriangleMesh> mesh;  ///< never null
};
/// Solid ground below a grid of heights. Only what stands still may have one.
struct Heightfield {
  std::shared_ptr<const HeightGrid> grid;  ///< never null
};

using Shape = std::variant<Box, Sphere, Cylinder, Capsule, Plane, Cone, Ellipsoid, Mesh, Heightfield, Barrel>;

/// "box", "cylinder" ...: as SDF spells it ("heightmap" for a Heightfield).
const char* shape_name(const Shape& shape);

/// Radius about G's origin that contains the shape; infinity for planes.
double bounding_radius_m(const Shape& shape);
double volume_m3(const Shape& shape);
/// Diagonal of the inertia tensor about G's origin of a homogeneous solid of `mass_kg`, in G [kg m^2].
/// Planes and height fields have none (zeros). Of a mesh or cone, whose centre of mass is elsewhere,
/// mass_properties() (mesh.h) says all.
Vec3 inertia_kg_m2(const Shape& shape, double mass_kg);

}  // namespace sandlot
