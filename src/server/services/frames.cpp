#include "server/services/frames.h"

#include "base/text.h"

namespace sandlot::server {
namespace {

/// A frame that is fixed to a body.
MovingFrame fixed_to(const BodyState& body, const Pose& X_WF) {
  return {X_WF, {body.V_WB.linear + cross(body.V_WB.angular, X_WF.p - body.X_WB.p), body.V_WB.angular}};
}

}  // namespace

Velocity velocity_of(const Simulation& simulation, const Simulation::Entity& entity) {
  const BodyId base = simulation.engine().bodies(entity.id).front();
  return fixed_to(simulation.engine().states()[base.index], simulation.engine().pose(entity.id)).V_WF;
}

std::optional<MovingFrame> find_frame(const Simulation& simulation, std::string_view name) {
  if (name.empty() || name == "world") return MovingFrame();
  const Simulation::Entity* const entity = simulation.find_entity(first_part(name));
  if (!entity) return std::nullopt;
  const auto bodies = simulation.engine().bodies(entity->id);
  const auto states = simulation.engine().states();
  const auto link = [&](std::uint32_t i) -> const BodyState& { return states[bodies[i].index]; };
  if (name == entity->instance.name) return fixed_to(link(0), simulation.engine().pose(entity->id));
  const std::string_view part = name.substr(entity->instance.name.size() + 1);
  if (const auto index = entity->instance.model->find_link(part))
    return fixed_to(link(*index), link(*index).X_WB);
  for (const auto& device : entity->devices) {
    const BodyState& body = link(device->decl.link);
    const Pose X_WS = body.X_WB * device->decl.X_LS;
    if (device->path == name) return fixed_to(body, X_WS);
    for (const auto& [frame, X_SF] : device->frames())
      if (frame == name) return fixed_to(body, X_WS * X_SF);
  }
  return std::nullopt;
}

}  // namespace sandlot::server
