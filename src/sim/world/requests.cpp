/// Requests: what each does to the world. They act at the beginning of a tick, in the order that Commands::take() gives.
///
/// A request that fails has changed nothing. Those that add or remove bodies count the revision, so that viewers, recordings
/// and the scenes follow.
#include <algorithm>

#include "base/text.h"
#include "noise/chain.h"
#include "sim/world/controller_manager.h"
#include "sim/world/faults.h"
#include "sim/world/lookup.h"
#include "sim/world/simulation.h"

namespace sandlot {

/// Of velocities that are set, [m/s] and [rad/s].
constexpr double most_speed = 1e4;

/// Carries out requests: one operator per alternative of Request. A new request is a struct in request.h and an operator here.
struct Simulation::Processor {
  Simulation& sim;
  const Source& source;
  std::vector<std::byte>& response;

  Status operator()(const CommandRequest& command);
  Status operator()(const ParameterRequest& request);
  Status operator()(const LevelRequest& request);
  Status operator()(SpawnRequest& request);
  Status operator()(const DeleteRequest& request);
  Status operator()(const PoseRequest& request);
  Status operator()(const SampleRequest& request);
  Status operator()(const LoadDeviceRequest& request);
  Status operator()(const UnloadDeviceRequest& request);
  Status operator()(const PullRequest& request);
  Status operator()(const AnswerRequest& request);
  Status operator()(const CallRequest& request);
  Status operator()(const VelocityRequest& request);
  Status operator()(const InfoRequest& request);

 private:
  Result<Entity*> entity_named(const std::string& name);
  Result<Device*> device_named(const std::string& path);
  Status deliver(Device& device, std::string_view level, const CommandRequest& command);
  Status deliver(TopicBase& of_rule, const CommandRequest& command) const;
  Status deliver_to_programs(const CommandRequest& command) const;
  Status set_errors(Entity* entity, std::string_view field, const Node& value);
  static Status set_property(model::PropertyDecl& property, const Node& value);
};

Status Simulation::process(Request& request, const Source& source, std::vector<std::byte>& response) {
  return std::visit(Processor{*this, source, response}, request);
}

Result<Simulation::Entity*> Simulation::Processor::entity_named(const std::string& name) {
  if (Entity* const entity = sim.find_entity(name)) return entity;
  return no_entity(name);
}

Result<Simulation::Device*> Simulation::Processor::device_named(const std::string& path) {
  if (Device* const device = sim.find_device(path)) return device;
  return no_device(path);
}

// ------------------------------------------------------------------------------------------- commands and settings

Status Simulation::Processor::operator()(const CommandRequest& command) {
  const std::string_view target = command.target;
  // The target is a device, or one of its levels.
  Device* device = sim.find_device(target);
  std::string_view level;
  if (!device) {
    if (const std::size_t slash = target.rfind('/'); slash != std::string_view::npos) {
      device = sim.find_device(target.substr(0, slash));
      level = target.substr(slash + 1);
    }
  }
  TopicBase* const of_rule = device ? nullptr : sim.elements_.command_slot(target, command.type);
  Status status = device    ? deliver(*device, level, command)
                  : of_rule ? deliver(*of_rule, command)
                            : deliver_to_programs(command);
  if (!status) sim.commands_.count_refused();
  return status;
}

Status Simulation::Processor::deliver(Device& device, std::string_view level, const CommandRequest& command) {
  Slot* const slot = sim.devices_.command_slot(device, command.type, level);
  if (!slot) return Error{"'" + command.target + "' takes no " + command.type + " at its active level"};
  const bool by_program = source.kind == Source::Kind::program;
  if (by_program && sim.commands_.is_overridden(device))
    return Error{"'" + command.target + "' is driven from outside"};
  SL_TRY(sim.devices_.deliver(device, *slot, command.bytes, sim.now_));
  if (!source.is_inside()) sim.commands_.override_manually(device, sim.now_);
  return {};
}

/// Orders to a rule are for those who run the world, and for other rules: neither for programs nor for who drives a robot.
Status Simulation::Processor::deliver(TopicBase& of_rule, const CommandRequest& command) const {
  if (source.kind != Source::Kind::admin && source.kind != Source::Kind::rule)
    return Error{"'" + command.target + "' takes orders from administrators alone"};
  SL_TRY(of_rule.assign(command.bytes));
  of_rule.stamp = sim.now_;
  ++of_rule.count;
  return {};
}

/// What clients publish for programs: those of a robot or of a team.
Status Simulation::Processor::deliver_to_programs(const CommandRequest& command) const {
  const std::string_view owner = first_part(command.target);
  if (Entity* const entity = sim.find_entity(owner))
    return Programs::deliver(entity->programs, command, sim.now_);
  if (Team* const team = sim.programs_.find_team(owner))
    return Programs::deliver(team->programs, command, sim.now_);
  return no_device(command.target);
}

/// The target is a device, a program, a medium or rule, "sim" or an entity, looked for in this order.
Status Simulation::Processor::operator()(const ParameterRequest& request) {
  if (Device* const device = sim.find_device(request.target)) {
    if (request.field != failure_field)
      return sim.devices_.set_parameter(*device, request.field, request.value);
    SL_ASSIGN(const FailureOrder order, read_failure_order(request.value));
    return sim.devices_.order_failure(*device, order);
  }
  if (ProgramEntry* const program = sim.find_program(request.target))
    return program->program->set_parameter(request.field, request.value);
  if (const WorldElements::Part* const part = sim.elements_.find_part(request.target))
    return part->element->set_parameter(request.field, request.value);
  if (request.target == "sim") return set_errors(nullptr, request.field, request.value);
  if (Entity* const entity = sim.find_entity(request.target)) {
    for (model::PropertyDecl& each : entity->instance.properties)
      if (each.name == request.field) return set_property(each, request.value);
    return set_errors(entity, request.field, request.value);
  }
  return no_device_or_program(request.target);
}

/// Sets a property of the user's own, within its range.
Status Simulation::Processor::set_property(model::PropertyDecl& property, const Node& value) {
  const Field field{"value", property.unit.c_str(), ""};
  SL_ASSIGN(property.value,
            read_number(value, field, property.min, property.max, false, "/" + property.name));
  return {};
}

/// Sets the factor on the errors of all devices of an entity, or of the world (null).
Status Simulation::Processor::set_errors(Entity* entity, std::string_view field, const Node& value) {
  if (field != errors_field.key)
    return Error{"'" + std::string(field.substr(0, 60)) + "' is not a parameter of the whole", "errors is",
                 value.place()};
  SL_ASSIGN(const double factor,
            read_number(value, errors_field, errors_field.min, errors_field.max, false, "/errors"));
  (entity ? entity->instance.errors : sim.setup_.errors) = factor;
  for (auto& each : sim.entities_)
    for (auto& device : each->devices)
      sim.devices_.scale_errors(*device, sim.setup_.errors * each->instance.errors);
  return {};
}

Status Simulation::Processor::operator()(const LevelRequest& request) {
  SL_ASSIGN(Device* const device, device_named(request.device));
  SL_TRY(sim.devices_.set_levels(*device, request.levels, sim.context()));
  ++sim.revision_;
  sim.programs_.follow_levels(sim.entities_, sim.entity_of(*device));
  return {};
}

Status Simulation::Processor::operator()(const SampleRequest& request) {
  SL_ASSIGN(Device* const device, device_named(request.device));
  return sim.devices_.request_sample(*device, sim.now_ + sim.step_);
}

/// A device that is dead or stuck answers nothing. A robot's controller manager is called as if it were one of its devices.
Status Simulation::Processor::operator()(const CallRequest& request) {
  if (Entity* const robot = ControllerManager::robot_at(sim, request.device))
    return ControllerManager::answer(sim, *robot, request, response);
  SL_ASSIGN(Device* const device, device_named(request.device));
  return sim.devices_.call(*device, request.service, request.bytes, response, sim.context());
}

// -------------------------------------------------------------------------------------------------------- entities

Status Simulation::Processor::operator()(SpawnRequest& request) {
  Diagnostics ignored;
  // A request may come from anywhere: it starts no process.
  for (const model::ControllerDecl& decl : std::as_const(request.instance.controllers))
    if (Programs::is_outside(decl.kind))
      return Error{"a program of kind '" + decl.kind + "' begins with the run: it cannot be spawned"};
  SL_TRY(sim.add_entity(request.instance, ignored));
  sim.world_changed();
  return {};
}

Status Simulation::Processor::operator()(const DeleteRequest& request) {
  SL_ASSIGN(const Entity* const entity, entity_named(request.name));
  SL_TRY(sim.programs_.describe_team(sim.entities_, entity->instance.team, entity));
  const auto place = std::find_if(sim.entities_.begin(), sim.entities_.end(),
                                  [&](const auto& each) { return each.get() == entity; });
  sim.remove_entity(static_cast<std::size_t>(place - sim.entities_.begin()));
  sim.world_changed();
  return {};
}

Status Simulation::Processor::operator()(const PoseRequest& request) {
  SL_ASSIGN(const Entity* const entity, entity_named(request.name));
  if (!is_finite(request.X_WM) || norm(request.X_WM.q) < 1e-6) return Error{"the pose is not finite"};
  // A person sees what he does; a rule does not.
  if (source.kind == Source::Kind::rule)
    if (const std::string in_it = sim.solid_at(*entity, request.X_WM); !in_it.empty())
      return Error{"'" + request.name + "' cannot be put where '" + in_it + "' stands",
                   "choose a place that is free"};
  sim.engine_->set_pose(entity->id, {request.X_WM.p, normalised(request.X_WM.q)});
  if (entity->instance.model->is_static) ++sim.revision_;  // viewers and /tf_static get it once per revision
  return {};
}

Status Simulation::Processor::operator()(const VelocityRequest& request) {
  SL_ASSIGN(const Entity* const entity, entity_named(request.name));
  const auto fits = [](Vec3 v) { return is_finite(v) && norm(v) <= most_speed; };
  if (!fits(request.V_WM.linear) || !fits(request.V_WM.angular)) return Error{"the velocity is out of range"};
  if (entity->instance.model->is_static) return Error{"'" + request.name + "' never moves"};
  if (entity->instance.motion) return Error{"'" + request.name + "' moves along a path of its own"};
  // The canonical link's origin need not be the model's.
  const Vec3 origin = sim.engine_->pose(entity->id).p;
  const BodyState& base = sim.engine_->states()[sim.engine_->bodies(entity->id).front().index];
  sim.engine_->set_velocity(
      entity->id,
      {request.V_WM.linear + cross(request.V_WM.angular, base.X_WB.p - origin), request.V_WM.angular});
  return {};
}

/// No part of the State: nothing in the run reads it.
Status Simulation::Processor::operator()(const InfoRequest& request) {
  SL_ASSIGN(Entity* const entity, entity_named(request.name));
  constexpr std::size_t most_tags = 100, most_letters = 1000;
  bool fits = request.info.tags.size() <= most_tags && request.info.description.size() <= most_letters;
  for (const std::string& tag : request.info.tags) fits = fits && tag.size() <= most_letters;
  if (!fits) return Error{"the description is too long", "1000 letters, and 100 tags of that length"};
  entity->instance.info = request.info;
  return {};
}

/// The name of something that never moves in which the middle of an entity would lie; "": nothing.
std::string Simulation::solid_at(const Entity& entity, const Pose& X_WM) const {
  constexpr double radius_m = 1e-3;
  const model::Link& link = entity.instance.model->links.front();
  const OverlapQuery middle{X_WM * (link.X_ML * link.inertial.X_LCo.p), radius_m};
  std::vector<std::uint32_t> found, ends;
  engine_->overlaps({&middle, 1}, found, ends);
  for (const std::uint32_t index : found) {
    const std::string_view name = engine_->name(engine_->body_at(index)).instance;
    const Entity* const other = find_entity(name);
    if (other && other != &entity && other->instance.model->is_static) return std::string(name);
  }
  return {};
}

Status Simulation::Processor::operator()(const PullRequest& request) {
  SL_ASSIGN(const Entity* const entity, entity_named(request.name));
  return sim.pulls_.start(*entity, request, sim.now_);
}

Status Simulation::Processor::operator()(const AnswerRequest& request) {
  ProgramEntry* const program = sim.find_program(request.program);
  if (!program || !program->program->outside())
    return Error{"there is no program '" + request.program.substr(0, 200) + "' that takes answers"};
  if (program->ended) return Error{"program '" + program->path + "' has ended"};
  if (!sim.options_.run_programs) return {};  // its orders are in the log, too
  if (auto failed = sim.programs_.answer(*program, request.answer, sim.now_)) {
    sim.fail(*failed);
    return std::move(*failed);
  }
  return {};
}

// --------------------------------------------------------------------------------------------------------- devices

namespace {

/// The engines build bodies once: what is part of a link's mass can neither come nor go.
Status adds_no_mass(const SimulationParts::Device& device) {
  if (!device.keys || device.keys->spec.mass_kg == 0) return {};
  return Error{"'" + device.path + "' has a mass, and the mass of a robot is fixed once it is in the world",
               "declare the device with the robot and keep it, or leave mass out"};
}

/// Devices are connected to the battery of their robot when they are built.
Status is_no_battery(const Kind* kind, const std::string& device) {
  if (!kind || !kind->stores_energy) return {};
  return Error{"'" + device + "' is a battery, which neither comes nor goes while the run goes on",
               "declare it with the robot and keep it"};
}

}  // namespace

/// The instance's own list of devices is extended as well, so that a snapshot taken later builds the same robot. A program
/// that would not start with the new list ("the only laser" is one of two now) refuses the request.
Status Simulation::Processor::operator()(const LoadDeviceRequest& request) {
  SL_ASSIGN(Entity* const entity, entity_named(request.robot));
  if (request.device.name.empty()) return Error{"the device has no name"};
  if (request.device.link >= entity->instance.model->links.size())
    return Error{"model '" + entity->instance.model->name + "' has no link " +
                 std::to_string(request.device.link)};
  SL_TRY(is_no_battery(sim.devices_.find_kind(request.device.kind), request.device.name));
  Diagnostics ignored;
  SL_TRY(sim.devices_.add(*entity, request.device, *sim.engine_, sim.now_, ignored));
  Status fits = adds_no_mass(*entity->devices.back());
  if (fits) fits = sim.devices_.connect_orders(*entity, *entity->devices.back(), sim.commands_);
  if (fits) fits = sim.programs_.describe_again(sim.entities_, *entity);
  if (!fits) {
    sim.devices_.remove(*entity->devices.back());
    entity->devices.pop_back();
    return fits;
  }
  entity->instance.devices.push_back(request.device);
  // The engine has to know too: a snapshot makes a robot of it.
  if (!entity->instance.is_robot) sim.engine_->become_robot(entity->id);
  entity->instance.is_robot = true;
  sim.elements_.entities_changed();
  ++sim.revision_;
  sim.scenes_.rebuild_render_scene(sim.entities_, sim.devices_.need_render_scene(), ignored);
  return {};
}

/// Refused while a program of the robot needs the device.
Status Simulation::Processor::operator()(const UnloadDeviceRequest& request) {
  SL_ASSIGN(Device* const device, device_named(request.device));
  SL_TRY(adds_no_mass(*device));
  SL_TRY(is_no_battery(&sim.devices_.kind(*device), device->path));
  Entity& entity = sim.entity_of(*device);
  for (const auto& other : entity.devices)
    for (const auto& order : other->orders())
      if (order->device() == device->path)
        return Error{"'" + other->path + "' gives orders to '" + device->path + "'",
                     "unload '" + other->path + "' first"};
  const auto place = std::find_if(entity.devices.begin(), entity.devices.end(),
                                  [&](const auto& each) { return each.get() == device; });
  const std::ptrdiff_t index = place - entity.devices.begin();
  Owned<Device> taken = std::move(*place);
  entity.devices.erase(place);
  if (Status described = sim.programs_.describe_again(sim.entities_, entity); !described) {
    entity.devices.insert(entity.devices.begin() + index, std::move(taken));
    return described;
  }
  sim.actuation_.clear();
  sim.devices_.release(*taken, sim.context());
  sim.hand_over(sim.actuation_);
  sim.actuation_.clear();
  sim.devices_.remove(*taken);
  sim.elements_.entities_changed();
  entity.instance.devices.erase(static_cast<std::size_t>(index));
  ++sim.revision_;
  Diagnostics ignored;
  if (taken->light())
    sim.scenes_.rebuild_render_scene(sim.entities_, sim.devices_.need_render_scene(), ignored);
  return {};
}

}  // namespace sandlot
