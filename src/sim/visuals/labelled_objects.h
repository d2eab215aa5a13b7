#pragma once
/// Labelled objects: the world's instances as detectors (devices/labelled_object.h) and cameras (optics/picture.h) name them.
#include <memory>
#include <span>
#include <vector>

#include "devices/labelled_object.h"
#include "sim/world/parts.h"

namespace sandlot {

/// In creation order, without those that have no bounds.
std::vector<LabelledObject> labelled_objects_of(std::span<const Owned<SimulationParts::Entity>> entities,
                                                const Engine& engine);

/// As images name it.
inline std::uint32_t picture_instance(const SimulationParts::Entity& entity) {
  return static_cast<std::uint32_t>(entity.serial) + 1;
}

}  // namespace sandlot
