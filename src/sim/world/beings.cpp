#include "sim/world/beings.h"

#include <algorithm>

namespace sandlot {

std::vector<programs::Being> beings_of(std::span<const Owned<SimulationParts::Entity>> entities,
                                       const Engine* engine) {
  std::vector<const SimulationParts::Entity*> all;
  for (const auto& entity : entities)
    if (entity->instance.is_robot || !entity->instance.model->is_static) all.push_back(entity.get());
  std::stable_sort(all.begin(), all.end(), [](const auto* a, const auto* b) {
    return std::pair(!a->instance.is_robot, a->serial) < std::pair(!b->instance.is_robot, b->serial);
  });
  std::vector<programs::Being> out;
  for (const SimulationParts::Entity* const entity : all)
    out.push_back({static_cast<std::uint32_t>(out.size() + 1), entity->instance.is_robot,
                   entity->instance.name, engine ? engine->pose(entity->id) : Pose{}});
  return out;
}

void show_beings(std::span<Owned<SimulationParts::Entity>> entities, const Engine& engine) {
  std::vector<programs::Being> beings;
  for (auto& entity : entities)
    for (auto& program : entity->programs) {
      // Controllers, which may be many, wait for nothing.
      auto* const surrounded = program->wait ? dynamic_cast<programs::Surrounded*>(program->program.get())
                                             : nullptr;
      if (!surrounded || !surrounded->looks_around()) continue;
      if (beings.empty()) beings = beings_of(entities, &engine);
      surrounded->see(beings);
    }
}

std::vector<programs::DeviceFacts> facts_of(const SimulationParts::Entity& entity, const DevicePools& pools) {
  std::vector<programs::DeviceFacts> out;
  for (const auto& device : entity.devices) {
    const Kind& kind = pools.kind(*device);
    programs::DeviceFacts& facts = out.emplace_back();
    facts.name = device->decl.name;
    facts.kind = kind.name;
    for (std::uint32_t level = 0; level < kind.levels.size(); ++level)
      if ((device->levels >> level & 1) != 0) facts.levels.emplace_back(kind.levels[level].name);
    pools.list_values(*device, ValuePart::parameter, [&](const ValueEntry& entry) {
      if (entry.is == ValueFound::Is::value && !entry.list) facts.numbers[entry.path] = entry.value;
    });
  }
  return out;
}

}  // namespace sandlot
