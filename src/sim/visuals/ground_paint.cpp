#include "sim/visuals/ground_paint.h"

#include "geometry/mesh.h"
#include "geometry/triangulate.h"

namespace sandlot {
namespace {

constexpr double step_m = 5e-4;

}  // namespace

std::vector<GroundPaint> ground_paint_of(std::span<const WorldElements::NamedMarker> markers) {
  std::vector<GroundPaint> all;
  for (const WorldElements::NamedMarker& each : markers) {
    if (!each.marker->visible()) continue;
    const double z_m = step_m * static_cast<double>(all.size() + 1);
    auto mesh = std::make_shared<TriangleMesh>();
    for (const std::vector<Vec3>& outline : each.marker->outlines_W()) {
      const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
      Loop2 loop;
      for (const Vec3& corner : outline) {
        loop.push_back({corner.x, corner.y});
        mesh->vertices.push_back({corner.x, corner.y, z_m});
      }
      for (const auto& [a, b, c] : triangulate({loop}))
        mesh->triangles.push_back({first + a, first + b, first + c});
    }
    if (!mesh->triangles.empty()) all.push_back({Mesh{std::move(mesh)}, each.marker->color()});
  }
  return all;
}

}  // namespace sandlot
