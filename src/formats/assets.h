#pragma once
/// Meshes and heightmaps as the readers of worlds and robots ask for them. The readers of those files are siblings that
/// do not know each other; who brings them together (sim/load) fills this in.
///
/// Files are found (files/resources.h) before they are asked for. Errors carry the place of the file that has the
/// fault, or none: the asker then adds its own.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/shape.h"

namespace sandlot::formats {

/// One use of a mesh file.
struct MeshUse {
  enum class Purpose : std::uint8_t { collision, visual };
  enum class Optimization : std::uint8_t { none, convex_hull, convex_decomposition };
  std::string file;
  Vec3 scale{1, 1, 1};
  std::string submesh;          ///< only this part of the file; "" for all
  bool centre_submesh = false;  ///< move that part's middle to the origin
  Purpose purpose = Purpose::visual;
  Optimization optimization = Optimization::none;
};

struct HeightmapUse {
  std::string file;
  Vec3 size_m{1, 1, 1};  ///< extent in x and y, height of the brightest pixel
};

struct AssetReader {
  /// At least one shape: one, or the pieces of a decomposition. All have the frame of the file.
  std::function<Result<std::vector<Shape>>(const MeshUse&, Diagnostics&)> mesh;
  /// A Heightfield centred on its frame; to put it elsewhere is left to the asker.
  std::function<Result<Shape>(const HeightmapUse&, Diagnostics&)> heightmap;
};

}  // namespace sandlot::formats
