#pragma once
/// Files of triangle meshes: COLLADA (.dae), STL (ascii and binary), OBJ (with MTL), glTF 2 (.gltf, .glb), MilkShape (.ms3d),
/// PLY (ascii and binary).
///
/// Result   [m], triangles counter-clockwise seen from outside as the file says it, nodes' transforms applied, `scale`
///          last (a mirroring scale turns the triangles over). Triangles without area are dropped. Vertices at equal
///          places are one, except where their texture coordinates differ.
/// Units    COLLADA's <unit> is applied, and MilkShape's, STL's, OBJ's and PLY's numbers are metres: as in Gazebo.
/// Up       see UpAxis.
/// Names    a part is called as the node that carries it (without a name: as the geometry or mesh), in OBJ by `o` or
///          `g`, in ASCII STL by `solid`, in MS3D as the group: what <submesh> may ask for.
/// Look     one colour and one colour texture per part. A texture is looked for where the file says, beside the mesh by
///          its bare name, and in ../materials/textures. One that is not there keeps the path where it would be; a warning
///          tells, with the line in files that have lines.
/// Polygons any simple ones; a polygon that crosses itself, or has more than 1000 corners, becomes a fan.
/// Limits   no normals, bones, animation, morph targets, lights, cameras; no Draco compression, no textures inside the
///          file; lines and points are skipped. MTL files and buffers come from the mesh's own folder or below it.
/// Errors   a missing, truncated or broken file, NaN, no triangle, too many: the mesh file, its line where it has lines.
///          Memory is bounded by a small multiple of the file's size and by max_triangles.
/// Why ours assimp 5.2.5 crashes or hangs on COLLADA, GLB and MS3D files after a few random changes, has no lines in its
///          messages and takes what it does not understand for something else.
/// Source   COLLADA 1.4.1 (Khronos), glTF 2.0 (Khronos), Wavefront OBJ/MTL, 3D Systems STL, MilkShape 1.8.5 file format,
///          PLY (G. Turk, 1994).
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "geometry/mesh.h"

namespace sandlot::assets {
namespace mesh {
class Builder;
}

/// Which way is up in the file, as far as the format says it. Other formats are never turned.
enum class UpAxis {
  usual,  ///< glTF is turned from y up to z up, as its standard says and RViz does; COLLADA's <up_axis> is left
          ///< alone, as Gazebo and RViz do: files that run there are drawn to fit (a warning tells)
  as_written,  ///< nothing is turned: what Gazebo does with every format
  declared,    ///< both are turned; a COLLADA file without <up_axis> is y up
};

struct MeshOptions {
  Vec3 scale{1, 1, 1};
  std::string submesh;  ///< only parts of that name; "" for all
  bool centre = false;  ///< move the middle of the submesh's bounding box to the origin
  UpAxis up = UpAxis::usual;
  bool textures = true;  ///< a texture that is not there is a warning; who needs only the shape does not care
  std::size_t max_bytes = std::size_t{256} << 20;
  std::size_t max_triangles = 2'000'000;
};

/// A format of mesh files.
struct MeshFormat {
  const char* name;  ///< "collada"
  const char* help;
  std::span<const std::string_view> extensions;  ///< with the dot, in small letters
  Status (*read)(std::string_view bytes, mesh::Builder& out, Diagnostics& diagnostics);
};
/// All that read_mesh() knows.
std::span<const MeshFormat> mesh_formats();

/// Reads a mesh, or hands out the one that an earlier call made with the same options from the same file, as long as
/// somebody holds it and the file has not changed. Threads may call it at the same time.
Result<std::shared_ptr<const TriangleMesh>> read_mesh(const std::string& path, const MeshOptions& options,
                                                      Diagnostics& diagnostics);

/// The same from memory; `path` gives the format by its extension, and the folder of further files.
Result<TriangleMesh> parse_mesh(std::string_view bytes, const std::string& path, const MeshOptions& options,
                                Diagnostics& diagnostics);

/// SDF's <mesh optimization="...">: how a mesh is simplified for collisions.
enum class Simplification : std::uint8_t {
  none,
  convex_hull,
  convex_decomposition,  ///< the hull of each connected part; parts without volume are left out
};

/// The meshes that stand for a mesh in collisions. Hulls of a mesh are shared with earlier calls as long as they are in use.
/// Errors   no part has a volume
Result<std::vector<std::shared_ptr<const TriangleMesh>>> collision_meshes(
    std::shared_ptr<const TriangleMesh> mesh, Simplification how);

}  // namespace sandlot::assets
