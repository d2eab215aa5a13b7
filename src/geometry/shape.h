#pragma once
/// Primitive solids in their own frame G: the closed list that physics, rays and drawings agree on.
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

using Shape = std::variant<Box, Sphere, Cylinder, Capsule, Plane>;

/// Radius about G's origin that contains the shape; infinity for planes.
double bounding_radius_m(const Shape& shape);
double volume_m3(const Shape& shape);
/// Diagonal of the inertia tensor about G's origin of a homogeneous solid of `mass_kg`, in G [kg m^2].
/// Planes have none (zeros).
Vec3 inertia_kg_m2(const Shape& shape, double mass_kg);

}  // namespace sandlot
