/// Control programs: how they are made, described and described again.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "control/claims.h"
#include "control/kinds_with.h"
#include "controllers/controllers.h"
#include "programs/programs.h"
#include "sim/load/device_settings.h"
#include "sim/load/plugin.h"
#include "sim/world/beings.h"
#include "sim/world/programs.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

using Entry = Description::Entry;

/// Name of a topic relative to its device's path: "right/image".
std::string_view own_part_of(const SimulationParts::Device& device, const TopicBase& topic) {
  return std::string_view(topic.name()).substr(device.path.size() + 2);
}

bool same_entries(const Entry& a, const Entry& b) {
  return a.device == b.device && a.level == b.level && a.type == b.type && a.program == b.program;
}

bool all_same(const std::vector<Entry>& a, const std::vector<Entry>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Entry& x, const Entry& y) { return same_entries(x, y) && x.X_BS == y.X_BS; });
}

/// Index of the same entry in another description.
std::optional<std::uint32_t> index_in(const std::vector<Entry>& entries, const Entry& wanted) {
  for (const Entry& entry : entries)
    if (same_entries(entry, wanted)) return entry.index;
  return std::nullopt;
}

constexpr Field rate_field{"rate", "Hz", "Control steps per second.", 1e-3, 1e6};

}  // namespace

Status Programs::gather_kinds(std::vector<model::PluginDecl>& plugins, const SimulationOptions& options,
                              Diagnostics& diagnostics) {
  std::map<std::string, std::string, std::less<>> owners;
  const auto add = [&](const ControllerKind* kind, const std::string& owner, const Place& place) -> Status {
    const auto [known, fresh] = owners.emplace(kind->name, owner);
    if (!fresh)
      return Error{owner + " brings a controller '" + kind->name + "', and so does " + known->second,
                   "give it another name", place, "/plugins"};
    kinds_.push_back(kind);
    return {};
  };
  for (const ProgramKind* kind : program_kinds()) owners.emplace(kind->name, "Sandlot");
  for (const ControllerKind* kind : sandlot::controller_kinds()) SL_TRY(add(kind, "Sandlot", {}));
  for (const ControllerKind* kind : options.extra_controllers) SL_TRY(add(kind, "this program", {}));
  for (model::PluginDecl& decl : plugins) {
    SL_ASSIGN(const Plugin* const plugin, load_plugin(decl, options.paths, diagnostics));
    decl = {plugin->file, plugin->name, plugin->hash, decl.place};
    for (const ControllerKind* kind : plugin->controllers)
      SL_TRY(add(kind, "plugin '" + plugin->file + "'", decl.place));
  }
  return {};
}

bool Programs::is_outside(std::string_view kind) {
  const auto kinds = program_kinds();
  return std::any_of(kinds.begin(), kinds.end(), [&](const ProgramKind* each) {
    return kind == each->name && each->create()->outside() != nullptr;
  });
}

Programs::Team* Programs::find_team(std::string_view name) {
  for (Team& team : teams_)
    if (team.decl.name == name) return &team;
  return nullptr;
}

Programs::Driven Programs::driven_by(Entities entities, const Team& team, const Entity* leaving) {
  Driven out{team.decl.name, {}, true};
  for (auto& entity : entities)
    if (entity.get() != leaving && entity->instance.is_robot && entity->instance.team == team.decl.name)
      out.robots.push_back(entity.get());
  return out;
}

Status Programs::add(Entity& entity, std::shared_ptr<const model::ControllerDecl> declared, Time now,
                     Diagnostics& diagnostics) {
  const Driven driven = driven_by(entity);
  SL_ASSIGN(auto program, make(driven, entity.programs, declared, now, diagnostics));
  if (entity.find_device(program->path) || entity.find_program(program->path))
    return Error{"'" + program->path + "' names two things", "give the controller another name",
                 declared->place};
  entity.programs.push_back(std::move(program));
  changed_ = true;
  follow(*entity.programs.back(), driven, entity.programs);
  return {};
}

Status Programs::add_inactive(Entities entities, Entity& entity,
                              std::shared_ptr<const model::ControllerDecl> declared, Time now) {
  Diagnostics ignored;
  SL_TRY(add(entity, std::move(declared), now, ignored));
  entity.programs.back()->inactive = true;
  // A team's programs may read its topics.
  if (Status fits = describe_team(entities, entity.instance.team); !fits) {
    entity.programs.pop_back();
    return fits;
  }
  return {};
}

Status Programs::remove(Entities entities, Entity& entity, std::size_t index) {
  const auto place = entity.programs.begin() + static_cast<std::ptrdiff_t>(index);
  Owned<ProgramEntry> taken = std::move(*place);
  entity.programs.erase(place);
  changed_ = true;
  Status described = describe_again(entities, entity);
  if (!described)
    entity.programs.insert(entity.programs.begin() + static_cast<std::ptrdiff_t>(index), std::move(taken));
  return described;
}

void Programs::set_active(ProgramEntry& program, bool active, Time now) {
  program.inactive = !active;
  program.command.clear();
  if (active && program.schedule) {
    program.schedule->start = program.schedule->due = now;
    program.schedule->step = 0;
  }
  changed_ = true;
}

Status Programs::add_teams(Entities entities, Time now, Diagnostics& diagnostics) {
  for (const model::TeamDecl& decl : setup_.teams) {
    // A forged snapshot may name it anything.
    if (decl.name.empty() || sanitised(decl.name) != decl.name)
      return Error{"'" + decl.name + "' cannot be the name of a team", "letters, digits, _ and -",
                   decl.place};
    if (find_team(decl.name))
      return Error{"two teams are called '" + decl.name + "'", "give one of them another name", decl.place};
    teams_.push_back({decl, {}});
    Team& team = teams_.back();
    const Driven driven = driven_by(entities, team, nullptr);
    for (std::size_t i = 0; i < team.decl.controllers.size(); ++i) {
      SL_ASSIGN(auto program, make(driven, team.programs, team.decl.controllers.share(i), now, diagnostics));
      for (const auto& other : team.programs)
        if (other->path == program->path)
          return Error{"'" + program->path + "' names two things", "give the controller another name",
                       program->decl.place};
      team.programs.push_back(std::move(program));
      follow(*team.programs.back(), driven, team.programs);
    }
  }
  changed_ = true;
  return {};
}

Result<Owned<Programs::ProgramEntry>> Programs::make(const Driven& driven, const ProgramEntries& before,
                                                     std::shared_ptr<const model::ControllerDecl> declared,
                                                     Time now, Diagnostics& diagnostics) {
  const model::ControllerDecl& decl = *declared;
  const auto at = [&](Error error) {
    if (!error.place.file) error.place = decl.place;
    return error;
  };
  const ControllerKind* kind = nullptr;
  const ProgramKind* other_kind = nullptr;
  std::vector<std::string> names;
  for (const ControllerKind* each : kinds_) {
    names.emplace_back(each->name);
    if (decl.kind == each->name) kind = each;
  }
  for (const ProgramKind* each : program_kinds()) {
    names.emplace_back(each->name);
    if (decl.kind == each->name) other_kind = each;
  }
  if (!kind && !other_kind) return at({"no controller '" + decl.kind + "'", suggestion(decl.kind, names)});
  Owned<ProgramEntry> program = std::make_unique<ProgramEntry>(std::move(declared));
  program->path = driven.name + "/" + sanitised(decl.name);
  program->key = entity_key(program->path);

  Node config = decl.config;
  auto rate_hz = take_rate(decl, kind ? kind->describe : other_kind->describe, config, diagnostics);
  if (!rate_hz) return at(std::move(rate_hz.error()));
  double period_s = (setup_.step * setup_.control_interval).s();
  if (*rate_hz > 0) {
    period_s = 1 / *rate_hz;
    program->schedule = std::make_unique<SimulationParts::Schedule>();
    program->schedule->rate_hz = *rate_hz;
    program->schedule->start = program->schedule->due = now;
  }

  auto outputs = std::make_unique<Outputs>(program->path);
  Status status;
  const auto thrown = caught([&] {
    if (kind) {
      auto controller = kind->create();
      program->controller = controller.get();
      program->program = std::make_unique<ControllerProgram>(std::move(controller));
    } else {
      program->program = other_kind->create();
      program->wait = std::make_unique<SimulationParts::Wait>();
      any_beyond_controllers_ = true;
      if (auto* const surrounded = dynamic_cast<programs::Surrounded*>(program->program.get());
          surrounded && !driven.team)
        surrounded->describe(
            facts_of(*driven.robots.front(), devices_),
            setup_.clock.mode == model::Clock::Mode::fixed ? setup_.step : setup_.clock.min_step);
    }
    program->description = describe(driven, before, period_s);
    const ClaimNotes notes(program->claims, program->reads);
    if (program->description->robot == driven.name) {
      status = program->program->init(*program->description, config, *outputs);
    } else {
      Description own = *program->description;
      own.robot = driven.name;
      status = program->program->init(own, config, *outputs);
    }
  });
  if (thrown)
    return at({"controller '" + program->path + "' (" + decl.kind + ") threw while it began: " + *thrown});
  if (!status) return at(std::move(status.error()));
  if (!outputs->status()) return at(outputs->status().error());
  program->kind = kind;
  program->topics.resize(program->description->readings.size());
  program->seen.resize(program->description->readings.size(), 0);
  program->routes.resize(program->description->actuators.size());
  if (!outputs->empty()) {
    program->outputs = std::move(outputs);
    program->command.bind(program->outputs.get());
  }
  if (Status free = check_inputs(*program, driven, before); !free) return at(std::move(free.error()));
  return program;
}

/// An input is called like a device of the robot would be, "/rover/goal_pose": no device and no program may have its name, and
/// all that read it take one type.
Status Programs::check_inputs(const ProgramEntry& program, const Driven& driven,
                              const ProgramEntries& before) {
  const auto inputs_of = [](const ProgramEntry& each) {
    return each.outputs ? std::as_const(*each.outputs).inputs() : std::span<const Outputs::Input>();
  };
  const auto path_of = [](const Outputs::Input& input) {
    return std::string_view(input.topic->name()).substr(1);
  };
  const auto named_twice = [](const ProgramEntry& reader, const Outputs::Input& input) {
    return Error{"'" + reader.path + "' reads the topic '" + input.topic->name() +
                     "', which is also the name of a device or program",
                 "give that another name"};
  };
  for (const Outputs::Input& input : inputs_of(program))
    if (path_of(input) == program.path ||
        (!driven.team && driven.robots.front()->find_device(path_of(input))))
      return named_twice(program, input);
  for (const auto& other : before) {
    for (const Outputs::Input& theirs : inputs_of(*other))
      if (path_of(theirs) == program.path) return named_twice(*other, theirs);
    for (const Outputs::Input& input : inputs_of(program)) {
      if (path_of(input) == other->path) return named_twice(program, input);
      for (const Outputs::Input& theirs : inputs_of(*other))
        if (theirs.topic->name() == input.topic->name() && &theirs.topic->info() != &input.topic->info())
          return Error{"'" + program.path + "' reads the topic '" + input.topic->name() + "' as " +
                           input.topic->type() + ", '" + other->path + "' as " + theirs.topic->type(),
                       "a topic has one type: one of the two programs needs another name for it"};
    }
  }
  return {};
}

/// Takes the program's own rate out of its keys. @return 0: the run's control steps
Result<double> Programs::take_rate(const model::ControllerDecl& decl, std::vector<FieldInfo> (*fields)(),
                                   Node& config, Diagnostics& diagnostics) const {
  double rate_hz = decl.rate_hz;
  Place place = decl.rate_place.file ? decl.rate_place : decl.place;
  // A key of this name that the kind has itself stays the kind's.
  const auto is_own_key = [&] {
    const std::vector<FieldInfo> all = fields();
    return std::any_of(all.begin(), all.end(),
                       [](const FieldInfo& field) { return field.path == rate_field.key; });
  };
  if (const Node* const given = std::as_const(config).find(rate_field.key); given && !is_own_key()) {
    const Place at = given->place().file ? given->place() : place;
    SL_ASSIGN(rate_hz, read_number(*given, rate_field, rate_field.min, rate_field.max, false, "/rate"));
    place = at;
    config.erase(rate_field.key);
  }
  if (rate_hz != 0 && !(rate_hz >= rate_field.min && rate_hz <= rate_field.max))
    return Error{"rate must be in [0.001, 1e6] Hz, is " + number_text(rate_hz), "", place, "/rate"};
  if (rate_hz == 0 || setup_.clock.mode != model::Clock::Mode::fixed) return rate_hz;
  const double tick_hz = 1e9 / static_cast<double>(setup_.step.ns);
  if (rate_hz > tick_hz * (1 + 1e-9))
    return Error{
        "rate " + number_text(rate_hz) + " Hz is above the tick rate of " + number_text(tick_hz) + " Hz",
        "lower the rate or make time.step smaller", place, "/rate"};
  const double ticks = tick_hz / rate_hz;
  if (std::abs(ticks - std::round(ticks)) > 1e-6 * ticks)
    diagnostics.warn({"rate " + number_text(rate_hz) + " Hz of controller '" + decl.name +
                          "' does not divide the tick rate of " + number_text(tick_hz) + " Hz",
                      "its steps fall on the next tick, so their spacing varies by one tick", place,
                      "/rate"});
  return rate_hz;
}

/// Adds the devices of a robot, and the topics of its programs, to a description.
/// @param prefix  of their names: "", or "red1/" for a team
void Programs::describe_robot(const Entity& entity, const ProgramEntries& programs, const std::string& prefix,
                              Description& out) const {
  const model::Model& model = *entity.instance.model;
  for (const auto& device : entity.devices) {
    const Pose X_BS = inverse(model.links.front().X_ML) * model.links[device->decl.link].X_ML *
                      device->decl.X_LS;
    const std::string name = prefix + device->decl.name;
    // One entry per type that follows the device's active level, then one per level.
    const auto describe = [&](const std::vector<SimulationParts::Slot>& slots, std::vector<Entry>& entries) {
      const auto add = [&](std::string level, const TopicBase& topic) {
        entries.push_back(
            {name, std::move(level), topic.type(), static_cast<std::uint32_t>(entries.size()), X_BS});
      };
      std::vector<std::string> types;
      for (const SimulationParts::Slot& slot : slots) {
        if (std::find(types.begin(), types.end(), slot.topic->type()) != types.end()) continue;
        types.emplace_back(slot.topic->type());
        add("", *slot.topic);
      }
      for (const SimulationParts::Slot& slot : slots) {
        const auto& levels = devices_.kind(*device).levels;
        const std::string level = slot.level < levels.size() ? levels[slot.level].name : "";
        if (!level.empty()) add(level, *slot.topic);
        // Of several of one type at one level, such as the pictures of a pair of eyes, each has its own name, too.
        const auto alike = std::count_if(slots.begin(), slots.end(), [&](const SimulationParts::Slot& other) {
          return other.level == slot.level && std::string_view(other.topic->type()) == slot.topic->type();
        });
        if (alike > 1) add(std::string(own_part_of(*device, *slot.topic)), *slot.topic);
      }
    };
    describe(device->topics, out.readings);
    describe(device->commands, out.actuators);
  }
  // "estimator/estimate" of "/rover/estimator/estimate"
  for (const auto& program : programs) {
    if (!program->outputs) continue;
    for (const Outputs::Output& output : program->outputs->all()) {
      const std::string& topic = output.topic->name();
      const std::size_t begin = topic.find('/', 1) + 1;
      out.readings.push_back({prefix + topic.substr(begin),
                              "",
                              output.topic->type(),
                              static_cast<std::uint32_t>(out.readings.size()),
                              {},
                              true});
    }
  }
}

namespace {

/// Puts the entries of late topics behind the others, whose numbers, which are State, then do not depend on them.
void put_late_last(Description& description) {
  for (auto list : {&Description::readings, &Description::actuators}) {
    std::vector<Entry>& entries = description.*list;
    std::stable_partition(entries.begin(), entries.end(), [](const Entry& each) { return !is_late(each); });
    std::vector<std::uint32_t> place(entries.size());
    for (std::uint32_t i = 0; i < entries.size(); ++i) place[std::exchange(entries[i].index, i)] = i;
    for (Description& member : description.members)
      for (Entry& entry : member.*list) entry.index = place[entry.index];
  }
}

}  // namespace

/// Description of what a program drives: the same object as for the robot before it, if they have the same devices.
/// @param before  the programs that precede it
std::shared_ptr<const Description> Programs::describe(const Driven& driven, const ProgramEntries& before,
                                                      double period_s) {
  Description description;
  description.robot = driven.name;
  description.control_period_s = period_s;
  set_kinds_with(kinds_with);
  if (!driven.team) {
    describe_robot(*driven.robots.front(), before, "", description);
    put_late_last(description);
    if (!described_ || described_->control_period_s != period_s ||
        !all_same(described_->readings, description.readings) ||
        !all_same(described_->actuators, description.actuators))
      described_ = std::make_shared<const Description>(std::move(description));
    return described_;
  }
  for (const Entity* const robot : driven.robots) {
    const std::string& name = robot->instance.name;
    const std::size_t readings = description.readings.size(), actuators = description.actuators.size();
    describe_robot(*robot, robot->programs, name + "/", description);
    Description& member = description.members.emplace_back();
    member.robot = name;
    member.control_period_s = period_s;
    const auto take = [&](const std::vector<Entry>& all, std::size_t from, std::vector<Entry>& to) {
      to.assign(all.begin() + static_cast<std::ptrdiff_t>(from), all.end());
      for (Entry& entry : to) entry.device.erase(0, name.size() + 1);
    };
    take(description.readings, readings, member.readings);
    take(description.actuators, actuators, member.actuators);
  }
  for (const auto& program : before)
    if (program->outputs)
      for (const Outputs::Output& output : program->outputs->all())
        description.readings.push_back({output.topic->name().substr(driven.name.size() + 2),
                                        "",
                                        output.topic->type(),
                                        static_cast<std::uint32_t>(description.readings.size()),
                                        {},
                                        true});
  put_late_last(description);
  return std::make_shared<const Description>(std::move(description));
}

/// Points readings and orders of a program at the active levels of the devices.
/// @param programs  of the same robot or team
void Programs::follow(ProgramEntry& program, const Driven& driven, const ProgramEntries& programs) const {
  /// The robot that an entry speaks of, and the name without the robot's.
  const auto locate = [&](const Entry& entry) -> std::pair<Entity*, std::string_view> {
    if (!driven.team) return {driven.robots.front(), entry.device};
    const std::string_view robot = first_part(entry.device);
    for (Entity* const each : driven.robots)
      if (each->instance.name == robot)
        return {each, std::string_view(entry.device).substr(robot.size() + 1)};
    return {nullptr, entry.device};
  };
  const auto topic_of = [](const ProgramEntries& all, const std::string& name) -> const TopicBase* {
    for (const auto& each : all)
      if (each->outputs)
        for (const Outputs::Output& output : each->outputs->all())
          if (output.topic->name() == name) return output.topic.get();
    return nullptr;
  };
  for (const Entry& entry : program.description->readings) {
    const auto [entity, name] = locate(entry);
    const TopicBase* first = nullptr;
    const TopicBase* chosen = nullptr;
    if (entry.program) {
      if (entity) first = topic_of(entity->programs, "/" + entity->instance.name + "/" + std::string(name));
      if (!first) first = topic_of(programs, "/" + driven.name + "/" + entry.device);
    } else if (entity) {
      for (auto& device : entity->devices) {
        if (device->decl.name != name) continue;
        const auto& levels = devices_.kind(*device).levels;
        for (const SimulationParts::Slot& slot : device->topics) {
          if (entry.type != slot.topic->type()) continue;
          const bool always = slot.level >= levels.size();
          const bool named = entry.level == own_part_of(*device, *slot.topic);
          if (!entry.level.empty() && !named && (always || entry.level != levels[slot.level].name)) continue;
          if (!first) first = slot.topic.get();
          if (!chosen && (always || (device->levels >> slot.level & 1))) chosen = slot.topic.get();
        }
      }
    }
    program.topics[entry.index] = chosen ? chosen : first;
  }
  for (const Entry& entry : program.description->actuators) {
    SimulationParts::Route& route = program.routes[entry.index];
    route = {};
    const auto [entity, name] = locate(entry);
    if (!entity) continue;
    for (auto& device : entity->devices)
      if (device->decl.name == name)
        route = {device.get(), devices_.command_slot(*device, entry.type, entry.level)};
  }
}

void Programs::follow_levels(Entities entities, Entity& entity) {
  const Driven driven = driven_by(entity);
  for (auto& program : entity.programs) follow(*program, driven, entity.programs);
  Team* const team = find_team(entity.instance.team);
  if (!team || team->programs.empty()) return;
  const Driven all = driven_by(entities, *team, nullptr);
  for (auto& program : team->programs) follow(*program, all, team->programs);
}

// ------------------------------------------------------------------------------------------------ describing again

/// Makes programs anew from the same declarations, with the State of the old ones, which stay as they are.
Result<Programs::Remade> Programs::remake(const Driven& driven, const ProgramEntries& old_programs) {
  Remade out;
  Diagnostics given_before;
  for (const auto& old : old_programs) {
    SL_ASSIGN(auto program, make(driven, out.programs, old->shared_decl, {}, given_before));
    program->steps = old->steps;
    program->ended = old->ended;
    program->inactive = old->inactive;
    if (program->schedule) *program->schedule = *old->schedule;
    if (program->wait) {
      *program->wait = *old->wait;
      if (old->wait->waiting_for == Program::Waiting::message) {
        const auto index = index_in(program->description->readings,
                                    old->description->readings[old->wait->reading]);
        if (index) program->wait->reading = *index;
        else *program->wait = {};
      }
    }
    ByteWriter w;
    old->program->save(w);
    ByteReader r(w.bytes());
    program->program->load(r);
    const Description& before = *old->description;
    for (const Entry& entry : program->description->readings)
      if (const auto index = index_in(before.readings, entry)) program->seen[entry.index] = old->seen[*index];
    // Orders of the previous tick are still to be carried out.
    for (const Command::Order& order : old->command.orders()) {
      const auto index = order.is_sample()
                             ? index_in(program->description->readings, before.readings[order.reading()])
                             : index_in(program->description->actuators, before.actuators[order.slot]);
      if (!index) ++out.refused;
      else if (order.is_sample()) program->command.request_sample_of(*index);
      else program->command.set_bytes(*index, old->command.bytes(order));
    }
    out.programs.push_back(std::move(program));
  }
  return out;
}

/// Puts programs in the place of old ones. Topics stay the same objects, with their messages.
void Programs::commit(ProgramEntries& old, Remade remade) {
  for (std::size_t i = 0; i < old.size(); ++i) {
    if (remade.programs[i]->outputs && old[i]->outputs) remade.programs[i]->outputs->adopt(*old[i]->outputs);
    if (Outside* const outside = remade.programs[i]->program->outside())
      outside->adopt(*old[i]->program->outside());
  }
  old = std::move(remade.programs);
  commands_.count_refused(remade.refused);
  changed_ = true;
}

Status Programs::describe_again(Entities entities, Entity& entity) {
  SL_ASSIGN(Remade own, remake(driven_by(entity), entity.programs));
  Team* const team = find_team(entity.instance.team);
  if (team && entity.instance.is_robot) {
    // The team's programs read topics of the robot's.
    std::swap(entity.programs, own.programs);
    auto of_team = remake(driven_by(entities, *team, nullptr), team->programs);
    std::swap(entity.programs, own.programs);
    if (!of_team) return std::move(of_team.error());
    commit(team->programs, std::move(*of_team));
  }
  commit(entity.programs, std::move(own));
  follow_levels(entities, entity);
  return {};
}

Status Programs::describe_team(Entities entities, std::string_view name, const Entity* leaving) {
  Team* const team = find_team(name);
  if (!team || team->programs.empty()) return {};
  const Driven driven = driven_by(entities, *team, leaving);
  SL_ASSIGN(Remade remade, remake(driven, team->programs));
  commit(team->programs, std::move(remade));
  for (auto& program : team->programs) follow(*program, driven, team->programs);
  return {};
}

}  // namespace sandlot
