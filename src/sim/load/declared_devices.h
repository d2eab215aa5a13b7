#pragma once
/// Devices of an instance as files declare them: names of SDF translated into kinds, changes of a scenario laid on top.
#include "base/node.h"
#include "files/resources.h"
#include "model/model.h"

namespace sandlot {

/// Replaces the devices that an SDF file declared by those of Sandlot's kinds; one that no kind answers to is dropped with a
/// warning. Plugins of ros2_control become the devices of their parameter files.
Status translate_devices(model::Instance& instance, const SearchPath& path, Diagnostics& diagnostics);

/// Lays the map `devices:` of a scenario upon the devices of the model: known names change keys, new names need a kind.
Status merge_devices(model::Instance& instance, const Node& devices);

}  // namespace sandlot
