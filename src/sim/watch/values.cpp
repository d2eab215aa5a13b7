#include "sim/watch/values.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "base/text.h"
#include "markers/footprint.h"
#include "sim/watch/monitor.h"

namespace sandlot {
namespace {

using Is = ValueFound::Is;

ValueFound number(double value, const char* unit) { return {Is::value, value, unit}; }

/// "rover/laser" and "ranges[3]" of "rover/laser.ranges[3]".
std::pair<std::string_view, std::string_view> cut(std::string_view address) {
  const std::size_t dot = address.find('.');
  if (dot == std::string_view::npos) return {address, {}};
  return {address.substr(0, dot), address.substr(dot + 1)};
}

const char* joint_unit(model::JointType type, std::string_view what) {
  const bool slides = type == model::JointType::prismatic;
  if (what == "position") return slides ? "m" : "rad";
  if (what == "velocity") return slides ? "m/s" : "rad/s";
  return slides ? "N" : "Nm";
}

bool has_joints(const Simulation& simulation) { return simulation.engine().capabilities().joints; }

}  // namespace

bool NamedValue::take(What what, std::size_t skip, const ValueFound& found) {
  if (found.is != Is::value && found.is != Is::absent) return false;
  what_ = what;
  skip_ = skip;
  unit_ = found.unit;
  return true;
}

bool NamedValue::resolve() {
  what_ = What::nothing;
  revision_ = simulation_->revision();
  const auto [thing, rest] = cut(address_);
  if (rest.empty()) {
    const auto named = simulation_->monitor().find_value(address_);
    if (!named) return address_ == "criterion" && resolve_criterion("");
    index_ = *named;
    return take(What::named, 0, number(0, ""));
  }
  auto path = parse_value_path(rest);
  if (!path) return false;
  path_ = std::move(*path);
  const std::string& first = path_.front().key;
  if (thing == "sim") {
    if (path_.size() != 1) return false;
    if (first == "time") return take(What::time, 1, number(0, "s"));
    if (first == "tick") return take(What::tick, 1, number(0, "1"));
    if (first == "errors") return take(What::all_errors, 1, number(0, "1"));
    return first == "revision" && take(What::revision, 1, number(0, "1"));
  }
  if (thing == "values") {
    const auto named = simulation_->monitor().find_value(first);
    if (!named || path_.size() != 1) return false;
    index_ = *named;
    return take(What::named, 1, number(0, ""));
  }
  if (const WorldElements::Part* const part = simulation_->elements().find_part(thing))
    return resolve_element(*part->element);
  if (const TopicBase* const topic = simulation_->elements().find_own_topic(thing))
    return resolve_topic(*topic);
  const Simulation::Entity* const entity = simulation_->find_entity(first_part(thing));
  if (!entity) {
    if (rest == "criterion" && resolve_criterion(thing)) return true;
    const auto* const of_team = simulation_->programs_of(first_part(thing));
    return of_team && resolve_programs(*of_team, thing);
  }
  entity_ = entity;
  if (entity->instance.name == thing) return resolve_thing(*entity);
  for (const auto& device : entity->devices) {
    if (device->path == thing) return resolve_device(*device);
    for (const auto* slots : {&device->topics, &device->commands})
      for (const Simulation::Slot& slot : *slots) {
        if (std::string_view(slot.topic->name()).substr(1) != thing) continue;
        return resolve_topic(*slot.topic);
      }
  }
  return resolve_programs(entity->programs, thing);
}

bool NamedValue::resolve_criterion(std::string_view team) {
  team_ = team;
  return simulation_->monitor().find_criterion(team) && take(What::criterion, 0, number(0, ""));
}

bool NamedValue::resolve_topic(const TopicBase& topic) {
  topic_ = &topic;
  if (take(What::topic, 0, topic.value(path_))) return true;
  if (path_.size() != 1) return false;
  const std::string& first = path_.front().key;
  if (first == "count") return take(What::topic_count, 1, number(0, "1"));
  if (first == "waiting" && topic.queue_limit() > 0) return take(What::topic_waiting, 1, number(0, "1"));
  return first == "stamp" && take(What::topic_stamp, 1, number(0, "s"));
}

bool NamedValue::resolve_programs(const Simulation::ProgramEntries& programs, std::string_view thing) {
  for (const auto& program : programs) {
    if (program->path == thing) return resolve_program(*program);
    if (!program->outputs) continue;
    for (const Outputs::Output& output : program->outputs->all())
      if (std::string_view(output.topic->name()).substr(1) == thing) return resolve_topic(*output.topic);
    for (const Outputs::Input& input : program->outputs->inputs())
      if (std::string_view(input.topic->name()).substr(1) == thing) return resolve_topic(*input.topic);
  }
  return false;
}

bool NamedValue::resolve_thing(const Simulation::Entity& entity) {
  const auto pose_or_twist = [&](std::size_t at, What pose, What twist) {
    if (path_.size() <= at) return false;
    const auto rest = std::span(path_).subspan(at + 1);
    if (path_[at].key == "pose") return take(pose, at + 1, value_at(Pose(), rest));
    return path_[at].key == "twist" && take(twist, at + 1, value_at(Velocity(), rest));
  };
  const Engine& engine = simulation_->engine();
  const model::Model& model = *entity.instance.model;
  const std::string& first = path_.front().key;
  if (first == "errors" && path_.size() == 1) return take(What::errors, 1, number(0, "1"));
  const auto& properties = entity.instance.properties;
  for (std::size_t i = 0; i < properties.size() && path_.size() == 1; ++i) {
    if (properties[i].name != first) continue;
    index_ = static_cast<std::uint32_t>(i);
    return take(What::property, 1, number(0, properties[i].unit.c_str()));
  }
  if ((first == "in" || first == "overlaps") && path_.size() == 2) {
    marker_ = simulation_->elements().find_marker(path_[1].key);
    return marker_ && take(first == "in" ? What::inside : What::overlap, 2, number(0, "1"));
  }
  if (first == "links" && path_.size() > 2) {
    for (std::size_t i = 0; i < model.links.size(); ++i) {
      if (sanitised(model.links[i].name) != path_[1].key) continue;
      index_ = engine.bodies(entity.id)[i].index;
      return pose_or_twist(2, What::body_pose, What::body_twist);
    }
    return false;
  }
  if (first == "joints" && path_.size() == 3 && has_joints(*simulation_)) {
    const std::string& what = path_[2].key;
    if (what != "position" && what != "velocity" && what != "effort") return false;
    for (std::size_t i = 0; i < model.joints.size(); ++i) {
      if (sanitised(model.joints[i].name) != path_[1].key) continue;
      index_ = engine.joints(entity.id)[i].index;
      return take(What::joint, 2, number(0, joint_unit(model.joints[i].type, what)));
    }
    return false;
  }
  index_ = engine.bodies(entity.id).front().index;
  return pose_or_twist(0, What::model_pose, What::body_twist);
}

bool NamedValue::resolve_device(const Simulation::Device& device) {
  device_ = &device;
  topic_ = device.topics.empty() ? nullptr : device.topics.front().topic.get();
  const std::string& first = path_.front().key;
  const auto rest = std::span<const ValueStep>(path_).subspan(1);
  // What is spelt out goes first: a field called `state` is found behind `reading.`.
  if (!rest.empty()) {
    if (first == "reading" && topic_ && take(What::topic, 1, topic_->value(rest))) return true;
    if (first == "parameter" &&
        take(What::parameter, 1, simulation_->value(device, ValuePart::parameter, rest)))
      return true;
    if (first == "state" && take(What::state, 1, simulation_->value(device, ValuePart::state, rest)))
      return true;
  }
  if (topic_ && take(What::topic, 0, topic_->value(path_))) return true;
  if (take(What::parameter, 0, simulation_->value(device, ValuePart::parameter, path_))) return true;
  if (take(What::state, 0, simulation_->value(device, ValuePart::state, path_))) return true;
  if (path_.size() != 1) return false;
  if (first == "sample") return take(What::sample, 1, number(0, "1"));
  if (!topic_) return false;
  if (first == "count") return take(What::topic_count, 1, number(0, "1"));
  return first == "stamp" && take(What::topic_stamp, 1, number(0, "s"));
}

bool NamedValue::resolve_program(const Simulation::ProgramEntry& entry) {
  program_ = &entry;
  const Program& program = *entry.program;
  const auto rest = std::span<const ValueStep>(path_).subspan(1);
  const std::string& first = path_.front().key;
  if (first == "parameter" && !rest.empty() &&
      take(What::program_parameter, 1, program.value(ValuePart::parameter, rest)))
    return true;
  if (first == "state" && !rest.empty() &&
      take(What::program_state, 1, program.value(ValuePart::state, rest)))
    return true;
  if (take(What::program_parameter, 0, program.value(ValuePart::parameter, path_))) return true;
  if (take(What::program_state, 0, program.value(ValuePart::state, path_))) return true;
  return first == "steps" && rest.empty() && take(What::steps, 1, number(0, "1"));
}

bool NamedValue::resolve_element(const Element& element) {
  element_ = &element;
  const auto rest = std::span<const ValueStep>(path_).subspan(1);
  const std::string& first = path_.front().key;
  if (first == "parameter" && !rest.empty() &&
      take(What::element_parameter, 1, element.value(ValuePart::parameter, rest)))
    return true;
  if (first == "state" && !rest.empty() &&
      take(What::element_state, 1, element.value(ValuePart::state, rest)))
    return true;
  return take(What::element_parameter, 0, element.value(ValuePart::parameter, path_)) ||
         take(What::element_state, 0, element.value(ValuePart::state, path_));
}

ValueFound NamedValue::look() const {
  const auto rest = std::span<const ValueStep>(path_).subspan(skip_);
  const Engine& engine = simulation_->engine();
  switch (what_) {
    case What::nothing: break;
    case What::time: return number(simulation_->now().s(), "");
    case What::tick: return number(static_cast<double>(simulation_->tick_index()), "");
    case What::revision: return number(static_cast<double>(simulation_->revision()), "");
    case What::all_errors: return number(simulation_->setup().errors, "");
    case What::errors: return number(entity_->instance.errors, "");
    case What::property: return number(entity_->instance.properties[index_].value, "");
    case What::named: {
      const auto value = simulation_->monitor().value(index_);
      return value ? number(*value, "") : ValueFound{Is::absent};
    }
    case What::criterion: {
      const Monitor::Criterion* const criterion = simulation_->monitor().find_criterion(team_);
      const auto value = simulation_->monitor().judge(*criterion);
      return value && *value ? number(**value, "") : ValueFound{Is::absent};
    }
    case What::model_pose: return value_at(engine.pose(entity_->id), rest);
    case What::body_pose: return value_at(engine.states()[index_].X_WB, rest);
    case What::body_twist: return value_at(engine.states()[index_].V_WB, rest);
    case What::inside: return number(marker_->contains(engine.pose(entity_->id).p), "");
    case What::overlap: return number(overlaps(*marker_, engine, *entity_->instance.model, entity_->id), "");
    case What::joint: {
      const JointState& joint = engine.joint_states()[index_];
      const char what = rest.front().key.front();
      return number(what == 'p' ? joint.position : what == 'v' ? joint.velocity : joint.effort, "");
    }
    case What::topic: return topic_->count > 0 ? topic_->value(rest) : ValueFound{Is::absent};
    case What::topic_count: return number(static_cast<double>(topic_->count), "");
    case What::topic_stamp: return topic_->count > 0 ? number(topic_->stamp.s(), "") : ValueFound{Is::absent};
    case What::topic_waiting: return number(static_cast<double>(topic_->waiting()), "");
    case What::parameter: return simulation_->value(*device_, ValuePart::parameter, rest);
    case What::state: return simulation_->value(*device_, ValuePart::state, rest);
    case What::sample: return number(static_cast<double>(simulation_->timing(*device_).sample), "");
    case What::program_parameter: return program_->program->value(ValuePart::parameter, rest);
    case What::program_state: return program_->program->value(ValuePart::state, rest);
    case What::steps: return number(static_cast<double>(program_->steps), "");
    case What::element_parameter: return element_->value(ValuePart::parameter, rest);
    case What::element_state: return element_->value(ValuePart::state, rest);
  }
  return {Is::absent};
}

bool NamedValue::is_broken() const {
  return what_ == What::named && simulation_->monitor().is_broken(index_);
}

std::optional<double> NamedValue::read() {
  if (revision_ != simulation_->revision()) {
    std::string unit = std::move(unit_);  // it stays known when the thing goes
    resolve();
    if (what_ == What::nothing) unit_ = std::move(unit);
  }
  const ValueFound found = look();
  return found.is == Is::value ? std::optional(found.value) : std::nullopt;
}

namespace {

/// Puts `path` behind "rover/laser", with `part.` between them where the bare address means something else.
class Lister {
 public:
  explicit Lister(const ValueVisit& visit) : visit_(visit) {}
  ValueVisit under(const std::string& thing, const char* part) {
    return [this, thing, part](ValueEntry entry) {
      std::string address = thing + "." + entry.path;
      if (!seen_.insert(address).second) address = thing + "." + part + "." + entry.path;
      entry.path = std::move(address);
      visit_(entry);
    };
  }
  void one(const std::string& address, const char* unit, const char* help, double value) {
    visit_({address, unit, help, Is::value, value});
  }
  bool fresh(const std::string& address) { return seen_.insert(address).second; }

 private:
  const ValueVisit& visit_;
  std::set<std::string> seen_;
};

void list_topic(const TopicBase& topic, const ValueVisit& visit) {
  topic.list_values([&](ValueEntry entry) {
    if (topic.count == 0) entry.is = Is::absent;
    visit(std::move(entry));
  });
}

void list_thing(const Simulation& simulation, const Simulation::Entity& entity, const ValueVisit& visit) {
  const Engine& engine = simulation.engine();
  const model::Model& model = *entity.instance.model;
  const std::string& name = entity.instance.name;
  const auto bodies = engine.bodies(entity.id);
  const auto prefixed = [&](const std::string& prefix) {
    return [&visit, prefix](ValueEntry entry) {
      entry.path = prefix + "." + entry.path;
      visit(std::move(entry));
    };
  };
  list_values(engine.pose(entity.id), "", "Pose of the model frame in the world.", "",
              prefixed(name + ".pose"));
  if (!model.is_static || entity.instance.motion)
    list_values(engine.states()[bodies.front().index].V_WB, "", "", "", prefixed(name + ".twist"));
  if (!entity.devices.empty())
    visit({name + ".errors", "1", "Factor on the errors of all its devices.", Is::value,
           entity.instance.errors});
  for (const model::PropertyDecl& each : entity.instance.properties)
    visit({name + "." + each.name, each.unit, "", Is::value, each.value});
  for (const WorldElements::NamedMarker& each : simulation.elements().markers()) {
    visit({name + ".in." + each.name, "1", "Whether its origin lies in the area.", Is::value,
           each.marker->contains(engine.pose(entity.id).p) ? 1.0 : 0.0});
    visit({name + ".overlaps." + each.name, "1", "Whether a part of its collisions lies over the area.",
           Is::value, overlaps(*each.marker, engine, model, entity.id) ? 1.0 : 0.0});
  }
  if (model.links.size() > 1)
    for (std::size_t i = 0; i < model.links.size(); ++i) {
      const std::string link = name + ".links." + sanitised(model.links[i].name);
      const BodyState& state = engine.states()[bodies[i].index];
      list_values(state.X_WB, "", "Pose of the link in the world.", "", prefixed(link + ".pose"));
      list_values(state.V_WB, "", "", "", prefixed(link + ".twist"));
    }
  if (!has_joints(simulation)) return;
  const auto joints = engine.joints(entity.id);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (model.joints[i].type == model::JointType::fixed) continue;
    const JointState& state = engine.joint_states()[joints[i].index];
    const std::string joint = name + ".joints." + sanitised(model.joints[i].name);
    const auto type = model.joints[i].type;
    visit({joint + ".position", joint_unit(type, "position"), "", Is::value, state.position});
    visit({joint + ".velocity", joint_unit(type, "velocity"), "", Is::value, state.velocity});
    visit({joint + ".effort", joint_unit(type, "effort"), "What the motor put in.", Is::value, state.effort});
  }
}

/// Parameters that have a value: not the keys of all the stages that a stage of noise is none of.
ValueVisit given(ValueVisit visit) {
  return [visit = std::move(visit)](ValueEntry entry) {
    if (entry.is != Is::absent || entry.list) visit(std::move(entry));
  };
}

void list_programs(const Simulation::ProgramEntries& programs, Lister& lister) {
  for (const auto& program : programs) {
    program->program->list_values(ValuePart::parameter, given(lister.under(program->path, "parameter")));
    program->program->list_values(ValuePart::state, lister.under(program->path, "state"));
    if (lister.fresh(program->path + ".steps"))
      lister.one(program->path + ".steps", "1", "Control steps so far.", static_cast<double>(program->steps));
    if (!program->outputs) continue;
    const auto list = [&](const TopicBase& message) {
      const std::string topic = message.name().substr(1);
      list_topic(message, lister.under(topic, "reading"));
      if (lister.fresh(topic + ".count"))
        lister.one(topic + ".count", "1", "Messages so far.", static_cast<double>(message.count));
    };
    for (const Outputs::Output& output : program->outputs->all()) list(*output.topic);
    for (const Outputs::Input& input : program->outputs->inputs()) list(*input.topic);
  }
}

void list_entity(const Simulation& simulation, const Simulation::Entity& entity, const ValueVisit& visit) {
  list_thing(simulation, entity, visit);
  Lister lister(visit);
  for (const auto& device : entity.devices) {
    if (!device->topics.empty())
      list_topic(*device->topics.front().topic, lister.under(device->path, "reading"));
    simulation.list_values(*device, ValuePart::parameter, given(lister.under(device->path, "parameter")));
    simulation.list_values(*device, ValuePart::state, lister.under(device->path, "state"));
    if (lister.fresh(device->path + ".sample"))
      lister.one(device->path + ".sample", "1", "Index of the next sample.",
                 static_cast<double>(simulation.timing(*device).sample));
    for (const auto* slots : {&device->topics, &device->commands})
      for (const Simulation::Slot& slot : *slots) {
        const std::string topic = slot.topic->name().substr(1);
        if (&slot != device->topics.data()) list_topic(*slot.topic, lister.under(topic, "reading"));
        if (lister.fresh(topic + ".count"))
          lister.one(topic + ".count", "1", "Messages so far.", static_cast<double>(slot.topic->count));
        if (slot.topic->queue_limit() > 0 && lister.fresh(topic + ".waiting"))
          lister.one(topic + ".waiting", "1", "Orders that wait in the queue.",
                     static_cast<double>(slot.topic->waiting()));
      }
  }
  list_programs(entity.programs, lister);
}

void list_element(const WorldElements::Part& part, const ValueVisit& visit) {
  Lister lister(visit);
  part.element->list_values(ValuePart::parameter, given(lister.under(part.path, "parameter")));
  part.element->list_values(ValuePart::state, lister.under(part.path, "state"));
}

}  // namespace

std::optional<Error> no_such_marker(const Simulation& simulation, std::string_view path) {
  const std::size_t dot = path.find('.');
  const std::string_view what = path.substr(0, dot);
  if ((what != "in" && what != "overlaps") || dot == std::string_view::npos) return std::nullopt;
  const std::string_view name = path.substr(dot + 1);
  std::vector<std::string> names;
  for (const WorldElements::NamedMarker& each : simulation.elements().markers()) names.push_back(each.name);
  if (std::find(names.begin(), names.end(), name) != names.end()) return std::nullopt;
  return Error{"there is no marker '" + std::string(name.substr(0, 100)) + "'",
               names.empty() ? "declare it: markers: [{kind: disc, name: ...}]" : suggestion(name, names)};
}

namespace {

/// The error for a value or criterion of the scenario that is not there yet where it is used.
std::optional<Error> not_yet(const Simulation& simulation, std::string_view thing, std::string_view rest) {
  const model::Setup& setup = simulation.setup();
  const std::string_view name = thing == "values" ? rest : thing;
  if (simulation.monitor().find_value(name)) return std::nullopt;
  for (const model::ValueDecl& value : setup.values)
    if (value.name == name)
      return Error{"the value '" + value.name + "' is declared later, or uses itself",
                   "a value may use those above it"};
  const bool of_run = thing == "criterion" && rest.empty() && setup.criterion;
  const bool of_team = rest == "criterion" &&
                       std::any_of(setup.teams.begin(), setup.teams.end(), [&](const model::TeamDecl& team) {
                         return team.name == thing && team.criterion;
                       });
  if (of_run || of_team)
    return Error{"values and criteria cannot use a criterion",
                 "name what is needed twice under 'values', and use that"};
  return std::nullopt;
}

}  // namespace

Error no_such_value(const Simulation& simulation, std::string_view address) {
  const std::string shown(address.substr(0, 100));
  const auto [thing, rest] = cut(address);
  const Simulation::Entity* const entity = simulation.find_entity(first_part(thing));
  std::vector<std::string> things{"sim"};
  if (simulation.monitor().find_criterion("")) things.emplace_back("criterion");
  if (!simulation.monitor().value_names().empty()) things.emplace_back("values");
  for (const std::string& name : simulation.monitor().value_names()) things.push_back(name);
  const WorldElements::Part* const part = simulation.elements().find_part(thing);
  for (const WorldElements::Part& each : simulation.elements().parts()) things.push_back(each.path);
  bool known = thing == "sim" || thing == "values" || part || (entity && entity->instance.name == thing);
  if (entity) {
    things.push_back(entity->instance.name);
    for (const auto& device : entity->devices) {
      things.push_back(device->path);
      for (const auto* slots : {&device->topics, &device->commands})
        for (const Simulation::Slot& slot : *slots) things.push_back(slot.topic->name().substr(1));
    }
  } else {
    for (const auto& each : simulation.entities()) things.push_back(each->instance.name);
  }
  const Simulation::ProgramEntries* const programs = simulation.programs_of(first_part(thing));
  if (programs) {
    for (const auto& program : *programs) {
      things.push_back(program->path);
      if (program->outputs)
        for (const Outputs::Output& output : program->outputs->all())
          things.push_back(output.topic->name().substr(1));
    }
    for (const std::string& each : things) known = known || each == thing;
  }
  if (auto error = not_yet(simulation, thing, rest)) return std::move(*error);
  if (!known) return {"there is no '" + std::string(thing.substr(0, 100)) + "'", suggestion(thing, things)};
  if (entity && entity->instance.name == thing)
    if (auto error = no_such_marker(simulation, rest)) return std::move(*error);
  std::vector<std::string> addresses;
  if (thing == "sim") addresses = {"sim.time", "sim.tick", "sim.revision", "sim.errors"};
  if (thing == "values")
    for (const std::string& name : simulation.monitor().value_names()) addresses.push_back("values." + name);
  const ValueVisit take = [&, wanted = std::string_view(thing)](const ValueEntry& entry) {
    if (cut(entry.path).first == wanted) addresses.push_back(entry.path + (entry.list ? "[0]" : ""));
  };
  Lister lister(take);
  if (part) list_element(*part, take);
  else if (entity) list_entity(simulation, *entity, take);
  else if (programs) list_programs(*programs, lister);
  if (rest.empty()) {
    std::string example;
    if (!addresses.empty()) example = "name one of its values, such as " + addresses.front();
    return {"'" + shown + "' is not a number", example};
  }
  // The parts of a group: everything that begins with it.
  std::vector<std::string> parts;
  for (const std::string& each : addresses)
    if (starts_with(each, std::string(address) + ".") || starts_with(each, std::string(address) + "["))
      parts.push_back(each);
  if (!parts.empty()) return {"'" + shown + "' is not a number but a group of them", suggestion("", parts)};
  return {"'" + std::string(thing) + "' has no value '" + std::string(rest.substr(0, 100)) + "'",
          suggestion(address, addresses)};
}

Result<NamedValue> NamedValue::find(const Simulation& simulation, std::string_view address) {
  address = without_slash(trim(address));
  NamedValue value(simulation, std::string(address));
  if (!value.resolve()) return no_such_value(simulation, address);
  return value;
}

NamedValue NamedValue::find_or_wait(const Simulation& simulation, std::string_view address) {
  NamedValue value(simulation, std::string(without_slash(trim(address))));
  value.resolve();
  return value;
}

void list_values(const Simulation& simulation, std::string_view entity, const ValueVisit& visit) {
  if (entity.empty()) {
    visit({"sim.time", "s", "Simulated time.", Is::value, simulation.now().s()});
    visit({"sim.tick", "1", "Ticks so far.", Is::value, static_cast<double>(simulation.tick_index())});
    visit({"sim.revision", "1", "Counts spawns, deletions and level changes.", Is::value,
           static_cast<double>(simulation.revision())});
    visit({"sim.errors", "1", "Factor on the errors of all devices.", Is::value, simulation.setup().errors});
    const Monitor& watch = simulation.monitor();
    for (std::uint32_t i = 0; i < watch.value_names().size(); ++i) {
      const auto value = watch.value(i);
      visit({"values." + watch.value_names()[i], "", "Named by the scenario.", value ? Is::value : Is::absent,
             value.value_or(0)});
    }
  }
  for (const Monitor::Criterion& criterion : simulation.monitor().criteria()) {
    if (!entity.empty() && entity != criterion.team) continue;
    const auto value = simulation.monitor().judge(criterion);
    const bool is = value && value->has_value();
    visit({criterion.team.empty() ? "criterion" : criterion.team + ".criterion", "",
           criterion.team.empty() ? "What the run is judged by." : "What the team is judged by.",
           is ? Is::value : Is::absent, is ? **value : 0});
  }
  for (const WorldElements::Part& part : simulation.elements().parts())
    if (entity.empty() || entity == first_part(part.path)) list_element(part, visit);
  for (const auto& each : simulation.entities()) {
    const bool is_static = each->instance.model->is_static && !each->instance.motion && each->devices.empty();
    if (entity.empty() ? !is_static : each->instance.name == entity) list_entity(simulation, *each, visit);
  }
  Lister lister(visit);
  for (const Simulation::Team& team : simulation.teams())
    if (entity.empty() || team.decl.name == entity) list_programs(team.programs, lister);
}

}  // namespace sandlot
