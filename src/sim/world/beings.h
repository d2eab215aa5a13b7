#pragma once
/// The world for programs that need more of it than messages (programs/surroundings.h).
#include <span>
#include <vector>

#include "physics/engine.h"
#include "programs/surroundings.h"
#include "sim/world/device_pools.h"
#include "sim/world/parts.h"

namespace sandlot {

/// Robots, then objects that are not static, in the order of their creation.
/// @param engine  null: without poses
std::vector<programs::Being> beings_of(std::span<const Owned<SimulationParts::Entity>> entities,
                                       const Engine* engine = nullptr);
/// Shows the world to those programs that look at it before each step.
void show_beings(std::span<Owned<SimulationParts::Entity>> entities, const Engine& engine);
std::vector<programs::DeviceFacts> facts_of(const SimulationParts::Entity& entity, const DevicePools& pools);

}  // namespace sandlot
