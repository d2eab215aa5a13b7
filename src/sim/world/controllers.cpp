#include "sim/world/controllers.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "files/yaml.h"
#include "formats/ros2_control/ros2_control.h"
#include "model/model_bytes.h"
#include "sim/load/device_settings.h"
#include "sim/world/controller_manager.h"
#include "sim/world/lookup.h"

namespace sandlot {
namespace {

using Entity = Simulation::Entity;
using Device = Simulation::Device;
using State = ControllerView::State;

constexpr const char* active_key = "active";

/// The key `active` of a device; nothing: it has none.
std::optional<bool> activity(const Simulation& simulation, const Device& device) {
  const ValueStep path[] = {{active_key}};
  const ValueFound found = simulation.value(device, ValuePart::parameter, path);
  if (found.is != ValueFound::Is::value) return std::nullopt;
  return found.value != 0;
}

/// Whether a device is a joint controller.
bool is_controller(const Simulation& simulation, const Device& device) {
  return drives(simulation.kind(device)) && activity(simulation, device);
}

std::string path_of(const Entity& robot, const std::string& name) {
  return robot.instance.name + "/" + sanitised(name);
}

const Device* device_of(const Entity& robot, const std::string& name) {
  const std::string path = path_of(robot, name);
  for (const auto& device : robot.devices)
    if (device->path == path) return device.get();
  return nullptr;
}

std::vector<std::string> joint_claims(const Simulation& simulation, const Entity& robot,
                                      const Device& device) {
  const model::Model& model = *robot.instance.model;
  std::vector<std::string> out;
  for (const std::uint32_t joint : driven_joints(device.decl, simulation.kind(device), model))
    out.push_back("joint " + model.joints[joint].name);
  return out;
}

/// Devices that a program may order, by their names in its description.
std::vector<std::string> claims_of(const Simulation::ProgramEntry& program) {
  std::set<std::string> names;
  for (const Description::Entry& entry : program.description->actuators)
    if (!program.kind || std::binary_search(program.claims.begin(), program.claims.end(), entry.index))
      names.insert(entry.device);
  return {names.begin(), names.end()};
}

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "'" : ", '") + name + "'";
  return out;
}

Error no_controller(const Entity& robot, std::string_view name, const std::vector<ControllerView>& all) {
  std::vector<std::string> known;
  for (const ControllerView& each : all) known.push_back(each.name);
  return {"robot '" + robot.instance.name + "' has no controller '" + std::string(name.substr(0, 100)) + "'",
          known.empty() ? "load one first" : suggestion(name, known)};
}

}  // namespace

const char* name_of(State state) {
  static constexpr const char* names[] = {"unconfigured", "inactive", "active"};
  return names[static_cast<std::size_t>(state)];
}

std::vector<ControllerView> controllers_of(const Simulation& simulation, const Entity& robot) {
  std::vector<ControllerView> out;
  for (const auto& program : robot.programs)
    out.push_back({sanitised(program->decl.name),
                   program->decl.kind,
                   program->inactive ? State::inactive : State::active,
                   true,
                   {},
                   claims_of(*program)});
  std::set<const Device*> grouped;
  std::vector<ControllerView> unconfigured;
  for (const Simulation::LoadedController& each : robot.loaded) {
    ControllerView view{each.decl.name, each.decl.kind, State::unconfigured, each.devices.empty()};
    if (!each.configured) {
      unconfigured.push_back(std::move(view));
      continue;
    }
    for (const model::DeviceDecl& decl : each.devices) {
      const Device* const device = device_of(robot, decl.name);
      if (!device) continue;  // unloaded as a device
      grouped.insert(device);
      view.devices.push_back(sanitised(decl.name));
      const bool active = activity(simulation, *device).value_or(true);
      view.state = active || view.state == State::active ? State::active : State::inactive;
      for (std::string& claim : joint_claims(simulation, robot, *device))
        view.claims.push_back(std::move(claim));
    }
    if (view.devices.empty()) view.state = State::inactive;
    out.push_back(std::move(view));
  }
  for (const auto& device : robot.devices)
    if (!grouped.contains(device.get()) && is_controller(simulation, *device))
      out.push_back({sanitised(device->decl.name),
                     device->decl.kind,
                     *activity(simulation, *device) ? State::active : State::inactive,
                     false,
                     {sanitised(device->decl.name)},
                     joint_claims(simulation, robot, *device)});
  std::move(unconfigured.begin(), unconfigured.end(), std::back_inserter(out));
  return out;
}

// ------------------------------------------------------------------------------------------------------ the manager

std::span<const DeviceService> controller_services() { return Simulation::ControllerManager::services(); }

std::span<const DeviceService> Simulation::ControllerManager::services() {
  using M = ControllerManager;
  static constexpr DeviceService services[] = {
      device_service<M, cm::ListControllers, &M::list>("list_controllers",
                                                       "Lists the controllers of the robot."),
      device_service<M, cm::LoadController, &M::load>("load_controller", "Adds a controller to the robot."),
      device_service<M, cm::ConfigureController, &M::configure>("configure_controller",
                                                                "Reads the keys of a loaded controller."),
      device_service<M, cm::SwitchController, &M::switch_over>("switch_controller",
                                                               "Starts and stops controllers in one tick."),
      device_service<M, cm::UnloadController, &M::unload>("unload_controller",
                                                          "Takes a stopped controller from the robot."),
  };
  return services;
}

Simulation::Entity* Simulation::ControllerManager::robot_at(Simulation& sim, std::string_view path) {
  const std::string_view owner = first_part(path);
  if (owner.size() == path.size() || path.substr(owner.size() + 1) != controller_manager_name) return nullptr;
  Entity* const robot = sim.find_entity(owner);
  return robot && robot->instance.is_robot && !robot->find_device(path) ? robot : nullptr;
}

Status Simulation::ControllerManager::answer(Simulation& sim, Entity& robot, const CallRequest& request,
                                             std::vector<std::byte>& response) {
  std::vector<std::string> known;
  ControllerManager manager{sim, robot};
  for (const DeviceService& each : services()) {
    if (request.service == each.name) return each.call(&manager, request.bytes, response, sim.context());
    known.emplace_back(each.name);
  }
  return Error{"a controller manager offers no service '" + request.service.substr(0, 60) + "'",
               suggestion(request.service, known)};
}

/// Viewers, recordings and rules look names up again.
void Simulation::ControllerManager::changed() {
  sim.elements_.entities_changed();
  ++sim.revision_;
}

Result<cm::ListControllers::Response> Simulation::ControllerManager::list(const cm::ListControllers::Request&,
                                                                          const Context&) {
  cm::ListControllers::Response out;
  for (ControllerView& each : controllers_of(sim, robot)) {
    cm::ControllerState& made = out.controller.emplace_back();
    made.name = std::move(each.name);
    made.state = name_of(each.state);
    made.type = std::move(each.kind);
    made.required_command_interfaces = std::move(each.claims);
    if (each.state == State::active) made.claimed_interfaces = made.required_command_interfaces;
  }
  return out;
}

// ------------------------------------------------------------------------------------------------- load and configure

Status Simulation::ControllerManager::check_name(const std::string& name) const {
  if (name.empty() || sanitised(name) != name || name.size() > 100)
    return Error{"'" + name.substr(0, 100) + "' cannot be the name of a controller",
                 "1 to 100 letters, digits, _ and -"};
  const std::vector<ControllerView> all = controllers_of(sim, robot);
  for (const ControllerView& each : all)
    if (each.name == name)
      return Error{"robot '" + robot.instance.name + "' has a controller '" + name + "' already, which is " +
                       name_of(each.state),
                   "unload it first, or take another name"};
  if (robot.find_device(path_of(robot, name)) || name == controller_manager_name)
    return Error{"'" + path_of(robot, name) + "' would name two things", "give the controller another name"};
  if (all.size() >= most_controllers)
    return Error{"robot '" + robot.instance.name + "' has " + std::to_string(all.size()) + " controllers",
                 "unload some first"};
  return {};
}

/// What a request declares, with all that can be checked of it without making it.
Result<Simulation::LoadedController> Simulation::ControllerManager::declared(
    const cm::LoadController::Request& asked) const {
  const std::string file = asked.file.empty() ? "parameters" : asked.file;
  SL_ASSIGN(Node root, parse_yaml(asked.parameters, file));
  if (root.is_null()) root = Node::map(root.place());
  if (!root.is_map()) return root.error("parameters are a map of keys", "write KEY: VALUE");
  // A file says of which kind it is; keys alone do not.
  std::optional<formats::DeclaredController> declared;
  if (asked.kind.empty() || root.find("controller_manager") || root.find(asked.name)) {
    SL_ASSIGN(declared, formats::find_controller(root, asked.name));
  }
  LoadedController out;
  out.decl.name = asked.name;
  out.decl.kind = asked.kind;
  out.decl.config = declared ? declared->parameters : root;
  out.decl.place = declared ? declared->place : root.place();
  Place kind_place = out.decl.place;
  if (declared && out.decl.kind.empty() && declared->type.is_scalar()) {
    out.decl.kind = declared->type.text();
    kind_place = declared->type.place();
  }
  // What is beside the parameters in ros_control of ROS 1.
  if (declared) out.decl.config.erase("type");
  if (out.decl.kind.empty())
    return Error{"the kind of controller '" + asked.name + "' is missing", "name one, such as sine",
                 kind_place};
  std::vector<std::string> names;
  for (const formats::ControllerType& type : formats::controller_types()) {
    names.emplace_back(type.type);
    if (out.decl.kind != type.type) continue;
    const auto kind = sim.devices_.find_kind(type.kind);
    SL_CHECK(kind != nullptr);
    const std::vector<FieldInfo> fields = kind->describe();
    if (std::none_of(fields.begin(), fields.end(), [](const auto& f) { return f.path == active_key; }))
      return Error{"a " + out.decl.kind + " becomes a device of kind " + type.kind +
                       ", which can be neither started nor stopped",
                   "declare it with the robot: joint_controllers: FILE", kind_place};
    formats::DeclaredController whole{asked.name, Node::scalar(type.type, kind_place), out.decl.config,
                                      declared ? declared->gains : Node(), out.decl.place};
    Diagnostics ignored;
    SL_ASSIGN(out.devices, formats::joint_devices(whole, ignored));
    for (model::DeviceDecl& device : out.devices)
      device.config.set(active_key, Node::scalar("false", out.decl.place));
    return out;
  }
  bool known = false;
  const auto look = [&](const char* name) {
    names.emplace_back(name);
    known = known || out.decl.kind == name;
  };
  for (const ControllerKind* const each : sim.programs_.kinds()) look(each->name);
  for (const ProgramKind* const each : sim.program_kinds()) look(each->name);
  if (!known)
    return Error{"there is no kind of controller '" + out.decl.kind.substr(0, 100) + "'",
                 suggestion(out.decl.kind, names), kind_place};
  // A request may come from anywhere: it starts no process.
  if (Programs::is_outside(out.decl.kind))
    return Error{"a program of kind '" + out.decl.kind + "' begins with the run: it cannot be loaded",
                 "declare it with the robot", kind_place};
  return out;
}

Result<cm::LoadController::Response> Simulation::ControllerManager::load(
    const cm::LoadController::Request& asked, const Context&) {
  SL_TRY(check_name(asked.name));
  SL_ASSIGN(LoadedController loaded, declared(asked));
  for (const model::DeviceDecl& device : loaded.devices)
    if (device_of(robot, device.name))
      return Error{"robot '" + robot.instance.name + "' has a device '" + device.name + "' already",
                   "give the controller another name", device.place};
  robot.loaded.push_back(std::move(loaded));
  changed();
  return cm::LoadController::Response{};
}

/// Makes the devices of a joint controller, switched off.
Status Simulation::ControllerManager::add_devices(LoadedController& loaded) {
  std::vector<std::byte> none;
  std::vector<std::string> made;
  for (const model::DeviceDecl& device : loaded.devices) {
    Request request = LoadDeviceRequest{robot.instance.name, device};
    if (Status added = sim.process(request, {}, none); !added) {
      if (!added.error().place.file) added.error().place = device.place;
      SL_CHECK(take_devices(made));  // what came in this tick is needed by nobody
      return added;
    }
    made.push_back(device.name);
  }
  return {};
}

/// Takes devices of joint controllers that are off. On an error all of them are there, as they were declared.
Status Simulation::ControllerManager::take_devices(const std::vector<std::string>& names) {
  std::vector<std::byte> none;
  std::vector<model::DeviceDecl> taken;
  for (auto name = names.rbegin(); name != names.rend(); ++name) {
    const Device* const device = device_of(robot, *name);
    if (!device) continue;
    model::DeviceDecl decl = device->decl;
    Request request = UnloadDeviceRequest{device->path};
    if (Status gone = sim.process(request, {}, none); !gone) {
      for (auto back = taken.rbegin(); back != taken.rend(); ++back) {
        back->config.set(active_key, Node::scalar("false", back->place));
        Request again = LoadDeviceRequest{robot.instance.name, *back};
        SL_CHECK(sim.process(again, {}, none));
      }
      return gone;
    }
    taken.push_back(std::move(decl));
  }
  return {};
}

Result<cm::ConfigureController::Response> Simulation::ControllerManager::configure(
    const cm::ConfigureController::Request& asked, const Context&) {
  const std::vector<ControllerView> all = controllers_of(sim, robot);
  const auto view = std::find_if(all.begin(), all.end(), [&](const auto& v) { return v.name == asked.name; });
  if (view == all.end()) return no_controller(robot, asked.name, all);
  if (view->state != State::unconfigured)
    return Error{"controller '" + asked.name + "' is " + name_of(view->state) + ", which it can be but once",
                 "configure those that are unconfigured; unload it and load it again to read other keys"};
  const auto loaded = std::find_if(robot.loaded.begin(), robot.loaded.end(),
                                   [&](const auto& each) { return each.decl.name == asked.name; });
  if (!loaded->devices.empty()) {
    SL_TRY(add_devices(*loaded));
    loaded->configured = true;
    changed();
    return cm::ConfigureController::Response{};
  }
  auto& declared = robot.instance.controllers;
  declared.push_back(loaded->decl);
  Status added = sim.programs_.add_inactive(sim.entities_, robot, declared.share(declared.size() - 1),
                                            sim.now_);
  if (!added) {
    declared.erase(declared.size() - 1);
    return std::move(added.error());
  }
  robot.loaded.erase(loaded);
  changed();
  return cm::ConfigureController::Response{};
}

// ------------------------------------------------------------------------------------------------------------ switch

namespace {

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

/// That all names are there, each once, in the state that they are to leave.
Status Simulation::ControllerManager::check_switch(const std::vector<ControllerView>& all,
                                                   const std::vector<std::string>& start,
                                                   const std::vector<std::string>& stop) const {
  if (start.empty() && stop.empty())
    return Error{"no controller is named", "name those to start and those to stop"};
  const auto check = [&](const std::vector<std::string>& names, bool starts) -> Status {
    for (const std::string& name : names) {
      const auto view = std::find_if(all.begin(), all.end(), [&](const auto& v) { return v.name == name; });
      if (view == all.end()) return no_controller(robot, name, all);
      if (std::count(start.begin(), start.end(), name) + std::count(stop.begin(), stop.end(), name) > 1)
        return Error{"controller '" + name + "' is named twice", "start it or stop it, once"};
      if (starts && view->state == State::unconfigured)
        return Error{"controller '" + name + "' is unconfigured", "configure it before it is started"};
      if (starts && view->state == State::active)
        return Error{"controller '" + name + "' is active already", "leave it out of those to start"};
      if (!starts && view->state != State::active)
        return Error{"controller '" + name + "' is not active, but " + name_of(view->state),
                     "leave it out of those to stop"};
      const ProgramEntry* const program = view->program ? robot.find_program(path_of(robot, name)) : nullptr;
      if (starts && program && program->ended)
        return Error{"program '" + name + "' has ended", "unload it and load it again"};
      if (starts && !view->program && view->devices.empty())
        return Error{"the devices of controller '" + name + "' are gone", "unload it and load it again"};
    }
    return {};
  };
  SL_TRY(check(start, true));
  return check(stop, false);
}

/// That of those that will be active no two command the same, unless they did so before.
Status Simulation::ControllerManager::check_claims(const std::vector<ControllerView>& all,
                                                   const std::vector<std::string>& start,
                                                   const std::vector<std::string>& stop) const {
  struct Holder {
    std::string what, name;
    bool fresh;
    const char* fix;
  };
  std::vector<Holder> holders;
  for (const ControllerView& each : all) {
    const bool fresh = has(start, each.name);
    if (!fresh && (each.state != State::active || has(stop, each.name))) continue;
    for (const std::string& claim : each.claims)
      holders.push_back(
          {claim, "controller '" + each.name + "'", fresh, "stop one of them in the same switch"});
  }
  for (const auto& device : robot.devices)
    if (drives(sim.kind(*device)) && !activity(sim, *device))
      for (std::string& claim : joint_claims(sim, robot, *device))
        holders.push_back({std::move(claim), "device '" + device->decl.name + "'", false,
                           "the device is always active: unload it, or leave the controller stopped"});
  if (const Team* const team = sim.programs_.find_team(robot.instance.team))
    for (const auto& program : team->programs)
      for (const std::string& claim : claims_of(*program))
        if (first_part(claim) == robot.instance.name)
          holders.push_back({claim.substr(robot.instance.name.size() + 1), "program '" + program->path + "'",
                             false, "programs of teams cannot be stopped: leave the controller stopped"});
  for (std::size_t i = 0; i < holders.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Holder &a = holders[k], &b = holders[i];
      if (a.what != b.what || a.name == b.name || !(a.fresh || b.fresh)) continue;
      return Error{a.name + " and " + b.name + " both command " +
                       (starts_with(a.what, "joint ") ? "joint '" + a.what.substr(6) + "'"
                                                      : "'" + path_of(robot, a.what) + "'"),
                   b.fix};
    }
  return {};
}

void Simulation::ControllerManager::set_active(const ControllerView& view, bool active) {
  if (view.program) {
    ProgramEntry* const program = robot.find_program(path_of(robot, view.name));
    SL_CHECK(program != nullptr);
    return sim.programs_.set_active(*program, active, sim.now_);
  }
  for (const std::string& name : view.devices) {
    Device* const device = robot.find_device(path_of(robot, name));
    SL_CHECK(device != nullptr);
    SL_CHECK(sim.devices_.set_parameter(*device, active_key, Node::scalar(active ? "true" : "false")));
  }
}

Result<cm::SwitchController::Response> Simulation::ControllerManager::switch_over(
    const cm::SwitchController::Request& asked, const Context&) {
  // 0 is what is sent by those who say nothing.
  if (asked.strictness != 0 && asked.strictness != cm::SwitchController::Request::strict)
    return Error{"strictness " + std::to_string(asked.strictness) + " is not known", "STRICT (2) is"};
  const std::vector<std::string>&start = asked.activate_controllers, &stop = asked.deactivate_controllers;
  const std::vector<ControllerView> all = controllers_of(sim, robot);
  SL_TRY(check_switch(all, start, stop));
  SL_TRY(check_claims(all, start, stop));
  for (const bool starts : {false, true})
    for (const ControllerView& each : all)
      if (has(starts ? start : stop, each.name)) set_active(each, starts);
  changed();
  cm::SwitchController::Response out;
  if (!stop.empty()) out.message = "stopped " + joined(stop);
  if (!start.empty()) out.message += (stop.empty() ? "started " : "; started ") + joined(start);
  return out;
}

Result<cm::UnloadController::Response> Simulation::ControllerManager::unload(
    const cm::UnloadController::Request& asked, const Context&) {
  const std::vector<ControllerView> all = controllers_of(sim, robot);
  const auto view = std::find_if(all.begin(), all.end(), [&](const auto& v) { return v.name == asked.name; });
  if (view == all.end()) return no_controller(robot, asked.name, all);
  if (view->state == State::active)
    return Error{"controller '" + asked.name + "' is active", "stop it before it is unloaded"};
  if (view->program && view->state == State::inactive) {
    const auto program = std::find_if(robot.programs.begin(), robot.programs.end(), [&](const auto& each) {
      return each->path == path_of(robot, asked.name);
    });
    const auto index = static_cast<std::size_t>(program - robot.programs.begin());
    SL_TRY(sim.programs_.remove(sim.entities_, robot, index));
    robot.instance.controllers.erase(index);
  } else {
    SL_TRY(take_devices(view->devices));
    std::erase_if(robot.loaded, [&](const auto& each) { return each.decl.name == asked.name; });
  }
  changed();
  return cm::UnloadController::Response{};
}

// ------------------------------------------------------------------------------------------------------------- State

void Simulation::ControllerManager::save_loaded(const Simulation& sim, ByteWriter& w) {
  for (const auto& entity : sim.entities_) {
    if (entity->loaded.empty()) continue;
    write(w, entity->instance.name);
    write(w, static_cast<std::uint32_t>(entity->loaded.size()));
    for (const LoadedController& each : entity->loaded) {
      write(w, each.decl.name), write(w, each.decl.kind);
      write_node(w, each.decl.config);
      write(w, each.configured);
      write(w, static_cast<std::uint32_t>(each.devices.size()));
      for (const model::DeviceDecl& device : each.devices) write_device(w, device);
    }
  }
}

bool Simulation::ControllerManager::load_loaded(Simulation& sim, ByteReader& r) {
  while (r.ok() && r.remaining() > 0) {
    std::string name;
    std::uint32_t count = 0;
    read(r, name), read(r, count);
    Entity* const entity = r.ok() ? sim.find_entity(name) : nullptr;
    if (!entity || !entity->instance.is_robot || !entity->loaded.empty() || count > most_controllers)
      return false;
    for (std::uint32_t i = 0; i < count; ++i) {
      LoadedController& each = entity->loaded.emplace_back();
      std::uint32_t devices = 0;
      read(r, each.decl.name), read(r, each.decl.kind);
      if (!read_node(r, each.decl.config)) return false;
      read(r, each.configured), read(r, devices);
      for (std::uint32_t k = 0; k < devices && r.ok(); ++k)
        if (!read_device(r, each.devices.emplace_back())) return false;
      if (!r.ok() || sanitised(each.decl.name) != each.decl.name || each.decl.name.empty()) return false;
      if (each.configured && each.devices.empty()) return false;
    }
  }
  return r.ok();
}

}  // namespace sandlot
