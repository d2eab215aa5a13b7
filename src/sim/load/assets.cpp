#include "sim/load/assets.h"

#include "assets/image/image.h"
#include "assets/mesh/mesh.h"
#include "geometry/height_grid.h"

namespace sandlot {
namespace {

using formats::MeshUse;

const char* word_for(MeshUse::Optimization optimization) {
  switch (optimization) {
    case MeshUse::Optimization::convex_hull: return "convex_hull";
    case MeshUse::Optimization::convex_decomposition: return "convex_decomposition";
    default: return "";
  }
}

Result<std::vector<Shape>> load_mesh(const MeshUse& use, Diagnostics& diagnostics) {
  const bool collision = use.purpose == MeshUse::Purpose::collision;
  assets::MeshOptions options;
  options.scale = use.scale;
  options.submesh = use.submesh;
  options.centre = use.centre_submesh;
  options.textures = !collision;  // nobody sees a collision
  SL_ASSIGN(auto mesh, assets::read_mesh(use.file, options, diagnostics));
  if (!collision) return std::vector<Shape>{Mesh{std::move(mesh)}};
  SL_ASSIGN(auto parts, assets::collision_meshes(std::move(mesh), word_for(use.optimization)));
  std::vector<Shape> out;
  for (auto& part : parts) out.emplace_back(Mesh{std::move(part)});
  return out;
}

Result<Shape> load_heightmap(const formats::HeightmapUse& use, Diagnostics& diagnostics) {
  SL_ASSIGN(HeightGrid grid, assets::read_heightmap(use.file, use.size_m, {}, diagnostics));
  return Shape{Heightfield{std::make_shared<const HeightGrid>(std::move(grid))}};
}

}  // namespace

formats::AssetReader asset_reader() { return {load_mesh, load_heightmap}; }

}  // namespace sandlot
