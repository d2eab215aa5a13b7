#include <algorithm>

#include "wire/append.h"
#include "wire/scene.h"

namespace sandlot::wire {

void write_batteries(const Simulation& simulation, std::vector<std::byte>& out) {
  const auto has_battery = [](const auto& entity) { return static_cast<bool>(entity->energy); };
  const auto entities = simulation.entities();
  out.clear();
  append(out, simulation.tick_index());
  append(out, simulation.now().ns);
  append(out, static_cast<std::uint32_t>(std::count_if(entities.begin(), entities.end(), has_battery)));
  for (const auto& entity : entities) {
    if (!has_battery(entity)) continue;
    append(out, static_cast<std::uint32_t>(entity->serial));
    append_float(out, entity->energy->empty ? 0 : entity->energy->fraction);
  }
}

}  // namespace sandlot::wire
