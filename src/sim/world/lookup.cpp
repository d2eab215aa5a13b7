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

Result<const Simulation::Entity*> entity_named(const Simulation& simulation, std::string_view name) {
  if (const Simulation::Entity* const entity = simulation.find_entity(name)) return entity;
  std::vector<std::string> known;
  for (const auto& each : simulation.entities()) known.push_back(each->instance.name);
  Error error = no_entity(name);
  error.fix = suggestion(name, known);
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
