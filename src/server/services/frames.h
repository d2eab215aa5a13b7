#pragma once
/// Frames that requests name: "world" or none, an entity, `ENTITY/LINK`, `ENTITY/DEVICE` and further frames of a device, as /tf
/// has them.
#include <optional>
#include <string_view>

#include "sim/world/simulation.h"

namespace sandlot::server {

/// A frame F in the world, and how it moves there.
struct MovingFrame {
  Pose X_WF;
  Velocity V_WF;  ///< of its origin
};
std::optional<MovingFrame> find_frame(const Simulation& simulation, std::string_view name);

/// Of the model's origin.
Velocity velocity_of(const Simulation& simulation, const Simulation::Entity& entity);

}  // namespace sandlot::server
