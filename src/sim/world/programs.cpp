/// Control programs: how they are made, stepped and heard.
#include "sim/world/programs.h"

#include <algorithm>
#include <array>
#include <map>

#include "base/text.h"
#include "control/kinds_with.h"
#include "controllers/controllers.h"
#include "physics/parallel.h"
#include "sim/load/device_settings.h"
#include "sim/load/plugin.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// Name of a topic relative to its device's path: "right/image".
std::string_view part_of(const SimulationParts::Device& device, const TopicBase& topic) {
  return std::string_view(topic.name()).substr(device.path.size() + 2);
}

/// Few enough to stay on the stack, enough for a kind to run warm.
constexpr std::size_t most_in_batch = 16;

/// Programs lie all over the memory. This fetches what a batch of them needs at once, as far as pointers lead, so that in a
/// large swarm the machine waits once per batch and not once per pointer.
void prefetch(std::span<SimulationParts::ProgramEntry* const> programs) {
  for (const SimulationParts::ProgramEntry* const entry : programs) {
    __builtin_prefetch(&entry->key);
    __builtin_prefetch(&entry->topics);
    __builtin_prefetch(&entry->steps);
  }
  for (const SimulationParts::ProgramEntry* const entry : programs) {
    __builtin_prefetch(entry->controller);
    __builtin_prefetch(entry->topics.data());
    __builtin_prefetch(entry->seen.data());
    __builtin_prefetch(entry->command.orders().data(), 1);
  }
  for (const SimulationParts::ProgramEntry* const entry : programs)
    for (const TopicBase* const topic : entry->topics) {
      __builtin_prefetch(topic);
      __builtin_prefetch(reinterpret_cast<const std::byte*>(topic) + 128);
    }
}

}  // namespace

// --------------------------------------------------------------------------------------- how programs come to be

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

Status Programs::add(Entity& entity, std::shared_ptr<const model::ControllerDecl> declared) {
  SL_ASSIGN(auto program, make(entity, declared));
  if (entity.find_device(program->path) || entity.find_program(program->path))
    return Error{"'" + program->path + "' names two things", "give the controller another name",
                 declared->place};
  entity.programs.push_back(std::move(program));
  changed_ = true;
  follow_levels(entity);
  return {};
}

Result<std::unique_ptr<Programs::ProgramEntry>> Programs::make(
    const Entity& entity, std::shared_ptr<const model::ControllerDecl> declared) {
  const model::ControllerDecl& decl = *declared;
  const auto at = [&](Error error) {
    if (!error.place.file) error.place = decl.place;
    return error;
  };
  const ControllerKind* kind = nullptr;
  std::vector<std::string> names;
  for (const ControllerKind* each : kinds_) {
    names.emplace_back(each->name);
    if (decl.kind == each->name) kind = each;
  }
  if (!kind) return at({"no controller '" + decl.kind + "'", suggestion(decl.kind, names)});
  auto program = std::make_unique<ProgramEntry>(std::move(declared));
  program->path = entity.instance.name + "/" + sanitised(decl.name);
  program->key = entity_key(program->path);

  std::unique_ptr<Controller> controller;
  Status status;
  const auto thrown = caught([&] {
    controller = kind->create();
    program->description = describe(entity);
    if (program->description->robot == entity.instance.name) {
      status = controller->init(*program->description, decl.config);
    } else {
      Description own = *program->description;
      own.robot = entity.instance.name;
      status = controller->init(own, decl.config);
    }
  });
  if (thrown)
    return at({"controller '" + program->path + "' (" + decl.kind + ") threw while it began: " + *thrown});
  if (!status) return at(std::move(status.error()));
  program->kind = kind;
  program->controller = controller.get();
  program->program = std::make_unique<ControllerProgram>(std::move(controller));
  program->topics.resize(program->description->readings.size());
  program->seen.resize(program->description->readings.size(), 0);
  program->routes.resize(program->description->actuators.size());
  return program;
}

/// Description of a robot for its programs: the same object as for the robot before it, if they have the same devices.
std::shared_ptr<const Description> Programs::describe(const Entity& entity) {
  Description description;
  description.robot = entity.instance.name;
  set_kinds_with(kinds_with);
  description.control_period_s = (setup_.step * setup_.control_interval).s();
  const model::Model& model = *entity.instance.model;
  for (const auto& device : entity.devices) {
    const Pose X_BS = inverse(model.links.front().X_ML) * model.links[device->decl.link].X_ML *
                      device->decl.X_LS;
    // One entry per type that follows the device's active level, then one per level.
    const auto describe = [&](const std::vector<SimulationParts::Slot>& slots,
                              std::vector<Description::Entry>& entries) {
      std::vector<std::string> types;
      for (const SimulationParts::Slot& slot : slots) {
        if (std::find(types.begin(), types.end(), slot.topic->type()) != types.end()) continue;
        types.emplace_back(slot.topic->type());
        entries.push_back(
            {device->decl.name, "", slot.topic->type(), static_cast<std::uint32_t>(entries.size()), X_BS});
      }
      for (const SimulationParts::Slot& slot : slots) {
        const auto& levels = devices_.kind(*device).levels;
        const std::string level = slot.level < levels.size() ? levels[slot.level].name : "";
        if (!level.empty())
          entries.push_back({device->decl.name, level, slot.topic->type(),
                             static_cast<std::uint32_t>(entries.size()), X_BS});
        // Of several of one type at one level, such as the pictures of a pair of eyes, each has its own name, too.
        const auto alike = std::count_if(slots.begin(), slots.end(), [&](const SimulationParts::Slot& other) {
          return other.level == slot.level && std::string_view(other.topic->type()) == slot.topic->type();
        });
        if (alike > 1)
          entries.push_back({device->decl.name, std::string(part_of(*device, *slot.topic)),
                             slot.topic->type(), static_cast<std::uint32_t>(entries.size()), X_BS});
      }
    };
    describe(device->topics, description.readings);
    describe(device->commands, description.actuators);
  }
  const auto same = [](const Description::Entry& a, const Description::Entry& b) {
    return a.device == b.device && a.level == b.level && a.type == b.type && a.X_BS == b.X_BS;
  };
  const auto all_same = [&](const std::vector<Description::Entry>& a,
                            const std::vector<Description::Entry>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
  };
  if (!described_ || !all_same(described_->readings, description.readings) ||
      !all_same(described_->actuators, description.actuators))
    described_ = std::make_shared<const Description>(std::move(description));
  return described_;
}

void Programs::follow_levels(Entity& entity) {
  for (const auto& program : entity.programs) {
    for (const Description::Entry& entry : program->description->readings) {
      const TopicBase* first = nullptr;
      const TopicBase* chosen = nullptr;
      for (const auto& device : entity.devices) {
        if (device->decl.name != entry.device) continue;
        const auto& levels = devices_.kind(*device).levels;
        for (const SimulationParts::Slot& slot : device->topics) {
          if (entry.type != slot.topic->type()) continue;
          const bool always = slot.level >= levels.size();
          const bool named = entry.level == part_of(*device, *slot.topic);
          if (!entry.level.empty() && !named && (always || entry.level != levels[slot.level].name)) continue;
          if (!first) first = slot.topic.get();
          if (!chosen && (always || (device->levels >> slot.level & 1))) chosen = slot.topic.get();
        }
      }
      program->topics[entry.index] = chosen ? chosen : first;
    }
    for (const Description::Entry& entry : program->description->actuators) {
      SimulationParts::Route& route = program->routes[entry.index];
      route = {};
      for (const auto& device : entity.devices)
        if (device->decl.name == entry.device)
          route = {device.get(), devices_.command_slot(*device, entry.type, entry.level)};
    }
  }
}

Status Programs::describe_again(Entity& entity) {
  std::vector<std::unique_ptr<ProgramEntry>> fresh;
  std::uint64_t refused = 0;
  for (const auto& old : entity.programs) {
    SL_ASSIGN(auto program, make(entity, old->shared_decl));
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
  changed_ = true;
  commands_.count_refused(refused);
  follow_levels(entity);
  return {};
}

// --------------------------------------------------------------------------------------------- phases of a tick

/// Lists the programs again when some came, went or ended.
void Programs::gather(Entities entities) {
  if (!changed_) return;
  changed_ = false;
  all_.clear();
  owners_.clear();
  running_.clear();
  for (const auto& entity : entities)
    for (const auto& program : entity->programs) {
      all_.push_back(program.get());
      owners_.push_back(entity.get());
      if (!program->ended) running_.push_back(program.get());
    }
  // Kind by kind, in the order in which the kinds first appear.
  std::map<const ControllerKind*, std::size_t> place;
  for (const ProgramEntry* const entry : running_) place.emplace(entry->kind, place.size());
  std::stable_sort(running_.begin(), running_.end(), [&](const ProgramEntry* a, const ProgramEntry* b) {
    return place.at(a->kind) < place.at(b->kind);
  });
}

void Programs::step_batch(std::span<ProgramEntry* const> batch, Time now) const {
  std::array<std::optional<Observation>, most_in_batch> seen;
  std::array<ControllerTurn, most_in_batch> turns;
  const ControllerKind& kind = *batch.front()->kind;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    ProgramEntry& entry = *batch[i];
    entry.command.clear();
    seen[i].emplace(now, entry.topics, entry.seen,
                    Stream(setup_.seed, entry.key, Purpose::controller, entry.steps));
    turns[i] = {entry.controller, &*seen[i], &entry.command};
  }
  if (kind.step_all) kind.step_all({turns.data(), batch.size()});
  for (std::size_t i = 0; i < batch.size(); ++i) {
    ProgramEntry& entry = *batch[i];
    if (kind.step_all) {
      entry.failure = std::move(turns[i].failure);
    } else {
      Program::Resumed resumed = entry.program->resume(now, *seen[i], entry.command);
      entry.failure = std::move(resumed.failure);
      entry.ended = resumed.waiting_for == Program::Waiting::nothing;
    }
    ++entry.steps;
    for (std::size_t t = 0; t < entry.topics.size(); ++t) entry.seen[t] = entry.topics[t]->count;
  }
}

std::optional<Error> Programs::step(Entities entities, Time now) {
  gather(entities);
  parallel_for(running_.size(), 64, [&](std::size_t begin, std::size_t end) {
    while (begin < end) {
      std::span<ProgramEntry* const> batch(&running_[begin], std::min(most_in_batch, end - begin));
      prefetch(batch);
      std::size_t count = 1;
      while (count < batch.size() && batch[count]->kind == batch.front()->kind) ++count;
      step_batch(batch.first(count), now);
      begin += count;
    }
  });
  std::optional<Error> failed;
  for (const ProgramEntry* entry : running_) {
    changed_ = changed_ || entry->ended;
    if (!entry->failure || failed) continue;
    failed = Error{"controller '" + entry->path + "' (" + entry->decl.kind + ") threw at " +
                       number_text(now.s()) + " s: " + *entry->failure,
                   "", entry->decl.place};
  }
  return failed;
}

void Programs::deliver_orders(Entities entities, Time now, bool logged) {
  gather(entities);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    ProgramEntry& program = *all_[i];
    // Programs lie all over the memory; see prefetch().
    if (i + 16 < all_.size()) {
      __builtin_prefetch(&all_[i + 16]->routes);
      __builtin_prefetch(&all_[i + 16]->command);
      const ProgramEntry& next = *all_[i + 8];
      __builtin_prefetch(next.routes.data());
      __builtin_prefetch(next.command.orders().data());
    }
    for (const Command::Order& order : program.command.orders()) {
      const SimulationParts::Route& route = program.routes[order.slot];
      const bool possible = route.slot && !commands_.is_overridden(*route.device);
      const std::span<const std::byte> bytes = program.command.bytes(order);
      // Orders for a level that was switched off meanwhile, or for a device under manual override, are refused and counted.
      const bool refused = !possible || !devices_.deliver(*route.device, *route.slot, bytes, now, false);
      if (refused) commands_.count_refused();
      if (!logged) continue;
      const Entity& entity = *owners_[i];
      const Description::Entry& entry = program.description->actuators[order.slot];
      LogEntry& log = commands_.log_entry(LogEntry::command, {Source::Kind::program, entity.serial},
                                          program.steps);
      log.target.append(entity.instance.name).append("/").append(sanitised(entry.device));
      if (!entry.level.empty()) log.target.append("/").append(entry.level);
      log.type = entry.type;
      log.bytes.assign(bytes.begin(), bytes.end());
      log.refused = refused;
    }
    program.command.clear();
  }
}

// --------------------------------------------------------------------------------------------------------- State

void Programs::save(const ProgramEntry& program, ByteWriter& w) {
  write(w, program.steps);
  write(w, program.ended);
  write(w, program.seen);
  write(w, static_cast<std::uint32_t>(program.command.orders().size()));
  for (const Command::Order& order : program.command.orders()) {
    const auto bytes = program.command.bytes(order);
    write(w, order.slot);
    write(w, static_cast<std::uint32_t>(bytes.size()));
    w.raw(bytes.data(), bytes.size());
  }
  program.program->save(w);
}

bool Programs::load(ProgramEntry& program, ByteReader& r) {
  const std::size_t readings = program.seen.size();
  read(r, program.steps);
  read(r, program.ended);
  read(r, program.seen);
  std::uint32_t orders = 0;
  read(r, orders);
  program.command.clear();
  for (std::uint32_t i = 0; i < orders && r.ok(); ++i) {
    std::uint32_t slot = 0, size = 0;
    read(r, slot);
    read(r, size);
    const auto bytes = r.take(size);
    if (slot >= program.description->actuators.size()) return false;
    program.command.set_bytes(slot, bytes);
  }
  program.program->load(r);
  return r.ok() && program.seen.size() == readings;
}

}  // namespace sandlot
