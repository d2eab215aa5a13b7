#pragma once
/// Lookups by name for people: the error says what is missing and suggests the nearest known name.
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "sim/world/simulation.h"

namespace sandlot {

Result<const Simulation::Entity*> entity_named(const Simulation& simulation, std::string_view name);
/// By path, "rover/laser".
Result<const Simulation::Device*> device_named(const Simulation& simulation, std::string_view path);

/// In creation order.
std::vector<std::string> entity_names(const Simulation& simulation);

/// The errors alone, without a suggestion; a long name is cut.
Error no_entity(std::string_view name);
Error no_device(std::string_view path);
Error no_device_or_program(std::string_view path);

}  // namespace sandlot
