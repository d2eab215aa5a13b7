#pragma once
/// Triangle meshes: what files of meshes, polylines and tessellated primitives become.
///
/// A mesh is shared by all shapes made from one file at one scale and never changes, so that engines and the
/// ray scene may build their trees once per mesh.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/fields.h"
#include "geometry/color.h"
#include "geometry/shape.h"
#include "geometry/vec3.h"

namespace sandlot {

/// A run of triangles of one look.
struct MeshPart {
  std::string name;  ///< of the sub-mesh; "" when the file has none
  std::uint32_t first_triangle = 0, triangles = 0;
  Color color;          ///< the file's own
  std::string texture;  ///< file of the colour texture; "" for none

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the sub-mesh; empty when the file has none."}, s.name);
    visit(Field{"first_triangle", "", "Index of the first triangle."}, s.first_triangle);
    visit(Field{"triangles", "", "Number of triangles."}, s.triangles);
    visit(Field{"color", "1", "Colour in the file."}, s.color);
    visit(Field{"texture", "", "File of the colour texture; empty for none."}, s.texture);
  }
};

struct TriangleMesh {
  std::vector<Vec3> vertices;                           ///< [m] in the shape's frame, scale applied
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<std::array<float, 2>> texture_uv;         ///< one per vertex, or none at all; v runs upwards
  std::vector<MeshPart> parts;                          ///< cover all triangles in order; none: one look
  /// Source file, for messages and for writing it again; "" for made ones.
  std::string source;           ///< file
  Vec3 source_scale{1, 1, 1};   ///< applied to the file's own vertices
  std::string source_part;      ///< the only part of the file that was taken; "" for all
  bool source_centred = false;  ///< that part's middle was moved to the origin
  bool is_hull = false;         ///< the convex hull of it, or of a part that hangs together

  static void fields(auto& s, auto&& visit) {
    visit(Field{"vertices", "m", "Vertices in the shape's frame."}, s.vertices);
    visit(Field{"triangles", "", "Indices of the corners."}, s.triangles);
    visit(Field{"texture_uv", "1", "Texture coordinates of the vertices."}, s.texture_uv);
    visit(Field{"parts", "", "Parts with a colour of their own."}, s.parts);
    visit(Field{"source", "", "File that the mesh is from; empty for one that was made."}, s.source);
    visit(Field{"source_scale", "1", "Scale applied to the vertices of the file."}, s.source_scale);
    visit(Field{"source_part", "", "Only part of the file that was taken; empty for all."}, s.source_part);
    visit(Field{"source_centred", "", "Whether that part's middle was moved to the origin."},
          s.source_centred);
    visit(Field{"is_hull", "", "Whether the mesh is the convex hull of what the file holds."}, s.is_hull);
  }
};

/// Mass properties of a homogeneous solid bounded by the mesh, from integrals over its triangles.
/// Source   D. Eberly, Polyhedral mass properties (2002).
struct MassProperties {
  double volume_m3 = 0;    ///< signed: negative when the triangles face inwards
  Vec3 centre_m;           ///< of mass
  Vec3 moments, products;  ///< ixx iyy izz, ixy ixz iyz about the centre, per kg of mass [m^2]
};
MassProperties mass_properties(const TriangleMesh& mesh);
/// The same of any bounded shape; zeros for planes and height fields.
MassProperties mass_properties(const Shape& shape);

/// Every edge is shared by exactly two triangles that run along it in opposite directions. Vertices at equal
/// places count as one.
bool is_closed(const TriangleMesh& mesh);

/// Smallest convex mesh around the points; empty (no triangles) when they lie in a plane.
/// Deterministic; O(n log n) on average.
TriangleMesh convex_hull(const std::vector<Vec3>& points);

/// The pieces of a mesh that hang together by shared vertices (vertices at equal places count as one), each
/// as a mesh of its own, the one of largest surface first.
std::vector<TriangleMesh> connected_parts(const TriangleMesh& mesh);

/// A bounded shape as triangles: exact for boxes, inscribed for round ones. @pre not a Plane
/// @param segments  corners of a full circle
TriangleMesh tessellate(const Shape& shape, int segments = 32);

/// A solid from a polygon in xy, extruded from z = 0 to `height_m`; as SDF's <polyline> defines it. Further
/// loops are holes. Empty when loops touch or cross, have no area or more than 4096 corners, when a hole lies
/// outside, and when the height is not positive.
TriangleMesh extrude(const std::vector<std::vector<std::array<double, 2>>>& loops_m, double height_m);

}  // namespace sandlot
