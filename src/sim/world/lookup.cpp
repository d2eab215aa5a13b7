#include "sim/world/lookup.h"

#include "base/text.h"

namespace sandlot {
namespace {

constexpr std::size_t most_letters = 200;  ///< of a name in an error

}  // namespace

Error no_entity(std::string_view name) {
  return {"there is nothing named '" + std::string(name.substr(0, most_letters)) + "'"};
}

Error no_device(std::string_view path) {
  return {"there is no device '" + std::string(path.substr(0, most_letters)) + "'"};
}

Error no_device_or_program(std::string_view path) {
  return {"there is no device or program '" + std::string(path.substr(0, most_letters)) + "'"};
}

std::vector<std::string> entity_names(const Simulation& simulation) {
  std::vector<std::string> names;
  for (const auto& each : simulation.entities()) names.push_back(each->instance.name);
  return names;
}

Result<const Simulation::Entity*> entity_named(const Simulation& simulation, std::string_view name) {
  if (const Simulation::Entity* const entity = simulation.find_entity(name)) return entity;
  Error error = no_entity(name);
  error.fix = suggestion(name, entity_names(simulation));
  return error;
}

Result<const Simulation::Device*> device_named(const Simulation& simulation, std::string_view path) {
  SL_ASSIGN(const Simulation::Entity* const entity, entity_named(simulation, first_part(path)));
  std::vector<std::string> known;
  for (const auto& device : entity->devices) {
    if (device->path == path) return device.get();
    known.push_back(device->path);
  }
  Error error = no_device(path);
  error.fix = suggestion(path, known);
  return error;
}

}  // namespace sandlot
