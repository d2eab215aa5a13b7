/// Devices that come and go while the run goes on.
///
/// The instance's own list of devices follows, so that a snapshot taken later builds the same robot. Programs hold
/// indices into the description of their robot; they are made anew with the new description and given their state
/// back, the same way as after a restore. A program that would not start with the new list (its laser is gone, or
/// "the only laser" is one of two now) refuses the request.
#include <algorithm>

#include "sim/world/simulation.h"

namespace sandlot {

Status Simulation::mount_device(const LoadDeviceRequest& request) {
  Entity* const entity = find_entity(request.robot);
  if (!entity) return Error{"there is nothing named '" + request.robot + "'"};
  if (request.device.name.empty()) return Error{"the device has no name"};
  if (request.device.link >= entity->instance.model->links.size())
    return Error{"model '" + entity->instance.model->name + "' has no link " +
                 std::to_string(request.device.link)};
  Diagnostics ignored;
  SL_TRY(add_device(*entity, request.device, ignored));
  if (Status described = describe_anew(*entity); !described) {
    remove_from_pool(*entity->devices.back());
    entity->devices.pop_back();
    return described;
  }
  entity->instance.devices.push_back(request.device);
  // The engine has to know too: a snapshot makes a robot of it.
  if (!entity->instance.is_robot) engine_->become_robot(entity->id);
  entity->instance.is_robot = true;
  ++revision_;
  rebuild_sight(ignored);
  return {};
}

Status Simulation::unmount_device(const UnloadDeviceRequest& request) {
  Device* const device = find_device(request.device);
  if (!device) return Error{"there is no device '" + request.device + "'"};
  Entity& entity = *find_entity(std::string_view(request.device).substr(0, request.device.find('/')));
  const auto place = std::find_if(entity.devices.begin(), entity.devices.end(),
                                  [&](const auto& each) { return each.get() == device; });
  const std::ptrdiff_t index = place - entity.devices.begin();
  std::unique_ptr<Device> taken = std::move(*place);
  entity.devices.erase(place);
  if (Status described = describe_anew(entity); !described) {
    entity.devices.insert(entity.devices.begin() + index, std::move(taken));
    return described;
  }
  actuation_.clear();
  pools_[taken->kind].pool->release(taken->index, context());
  engine_->set_targets(actuation_.joints);
  engine_->set_drive_targets(actuation_.drives);
  engine_->set_wheels(actuation_.wheels);
  engine_->set_grips(actuation_.grips);
  actuation_.clear();
  remove_from_pool(*taken);
  entity.instance.devices.erase(static_cast<std::size_t>(index));
  ++revision_;
  return {};
}

/// Gives the programs of a robot the description of its devices as they are now. On an error nothing has changed.
Status Simulation::describe_anew(Entity& entity) {
  std::vector<std::unique_ptr<ProgramEntry>> fresh;
  std::uint64_t refused = 0;
  for (const auto& old : entity.programs) {
    SL_ASSIGN(auto program, make_program(entity, old->shared_decl));
    program->steps = old->steps;
    program->ended = old->ended;
    ByteWriter w;
    old->program->save(w);
    ByteReader r(w.bytes());
    program->program->load(r);
    const auto same = [](const Description::Entry& a, const Description::Entry& b) {
      return a.device == b.device && a.level == b.level && a.type == b.type;
    };
    for (const Description::Entry& entry : program->description->readings)
      for (const Description::Entry& before : old->description->readings)
        if (same(entry, before)) program->seen[entry.index] = old->seen[before.index];
    // Orders of the previous tick are still to be carried out.
    for (const Command::Order& order : old->command.orders()) {
      const auto& actuators = program->description->actuators;
      const auto now = std::find_if(actuators.begin(), actuators.end(), [&](const Description::Entry& entry) {
        return same(entry, old->description->actuators[order.slot]);
      });
      if (now == actuators.end()) ++refused;
      else program->command.set_bytes(now->index, old->command.bytes(order));
    }
    fresh.push_back(std::move(program));
  }
  entity.programs = std::move(fresh);
  programs_changed_ = true;
  refused_commands_ += refused;
  point_programs_at_active_levels(entity);
  return {};
}

}  // namespace sandlot
