#pragma once
/// Where the readers of worlds and robots get meshes and heightmaps from: formats/mesh and formats/image, joined here.
#include "formats/assets.h"

namespace sandlot {

/// @param skip_missing  a mesh whose textures are missing comes without them, with a warning
formats::AssetReader asset_reader(bool skip_missing);

}  // namespace sandlot
