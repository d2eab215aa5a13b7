/// Any bytes: the first picks the format, the rest is the file. parse_mesh answers with triangles of finite vertices that
/// exist, or with one error.
#include <array>
#include <cmath>
#include <string>

#include "assets/mesh/mesh.h"
#include "base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  if (size == 0) return 0;
  static constexpr std::array formats{"stl", "obj", "dae", "gltf", "glb", "ms3d", "ply"};
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::string path = std::string("/nowhere/fuzz.") + formats[data[0] % formats.size()];
  Diagnostics diagnostics;
  const auto mesh = assets::parse_mesh(bytes, path,
                                       {.scale = {1, -2, 1},
                                        .centre = (data[0] & 0x40) != 0,
                                        .textures = (data[0] & 0x80) != 0,
                                        .max_triangles = 20'000},
                                       diagnostics);
  if (!mesh) {
    SL_CHECK(!mesh.error().what.empty() && mesh.error().place.file);
    return 0;
  }
  SL_CHECK(!mesh->triangles.empty() && mesh->triangles.size() <= 20'000);
  SL_CHECK(mesh->texture_uv.empty() || mesh->texture_uv.size() == mesh->vertices.size());
  for (const Vec3& v : mesh->vertices) SL_CHECK(is_finite(v));
  for (const auto& t : mesh->triangles)
    for (const std::uint32_t v : t) SL_CHECK(v < mesh->vertices.size());
  std::uint32_t covered = 0;
  for (const MeshPart& part : mesh->parts) {
    SL_CHECK(part.first_triangle == covered);
    covered += part.triangles;
  }
  SL_CHECK(covered == mesh->triangles.size());
  // What the engines ask of a mesh next.
  is_closed(*mesh);
  SL_CHECK(std::isfinite(mass_properties(*mesh).volume_m3));
  const TriangleMesh hull = convex_hull(mesh->vertices);
  SL_CHECK(hull.triangles.empty() || is_closed(hull));
  return 0;
}
