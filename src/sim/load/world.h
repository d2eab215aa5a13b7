#pragma once
/// The world of a Setup: that of a file, or the default one with ground and sun.
#include "formats/content.h"
#include "model/model.h"

namespace sandlot {

/// Moves a world or model of a file into `setup`: its environment and instances, their devices translated.
Status take_world(formats::WorldContent content, const SearchPath& path, model::Setup& setup,
                  Diagnostics& diagnostics);

/// The ground of a scenario without a world, or of a model by itself.
model::Instance bare_ground();

/// The light of a scenario without a world, or of a model by itself: that of Gazebo's empty world.
model::Light sun();

}  // namespace sandlot
