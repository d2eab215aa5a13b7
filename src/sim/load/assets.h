#pragma once
/// Where the readers of worlds and robots get meshes and heightmaps from: formats/mesh and formats/image, joined here.
#include "formats/assets.h"

namespace sandlot {

formats::AssetReader asset_reader();

}  // namespace sandlot
