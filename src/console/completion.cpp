/// Completion of the last word of a line.
#include <algorithm>
#include <utility>

#include "base/text.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "devices/kind.h"
#include "sim/watch/parameters.h"
#include "sim/watch/values.h"
#include "sim/world/controllers.h"
#include "sim/world/faults.h"

namespace sandlot {
namespace {

using console::Argument;
using console::BuiltinCommand;
using Entity = Simulation::Entity;

constexpr std::size_t most_candidates = 100;

class Candidates {
 public:
  explicit Candidates(std::string prefix) : prefix_(std::move(prefix)) {}
  const std::string& prefix() const { return prefix_; }
  void add(std::string word) {
    if (starts_with(word, prefix_)) words_.push_back(std::move(word));
  }
  /// Sorted; where they are too many, cut after the next / or . so that they become fewer.
  std::vector<std::string> take() && {
    tidy();
    if (words_.size() > most_candidates) {
      for (std::string& word : words_)
        if (const std::size_t cut = word.find_first_of("/.[", prefix_.size()); cut != std::string::npos)
          word.resize(cut + 1);
      tidy();
    }
    if (words_.size() > most_candidates) words_.resize(most_candidates);
    return std::move(words_);
  }

 private:
  void tidy() {
    std::sort(words_.begin(), words_.end());
    words_.erase(std::unique(words_.begin(), words_.end()), words_.end());
  }
  std::string prefix_;
  std::vector<std::string> words_;
};

std::string_view robot_of(std::string_view address) { return address.substr(0, address.find_first_of("/.")); }

/// Addresses below things: names of things first, then all of the one thing that is left.
template <class Tail, class List>
void complete_addresses(const Simulation& simulation, Candidates& out, const Tail& tail, const List& list) {
  const std::string_view robot = robot_of(out.prefix());
  if (robot.size() < out.prefix().size()) {
    if (const Entity* const entity = simulation.find_entity(robot)) list(*entity);
    return;
  }
  const Entity* only = nullptr;
  std::size_t count = 0;
  for (const auto& entity : simulation.entities()) {
    const std::string after = tail(*entity);
    if (after.empty() || !starts_with(entity->instance.name, robot)) continue;
    only = ++count == 1 ? entity.get() : nullptr;
    out.add(entity->instance.name + after);
  }
  if (only) list(*only);
}

std::vector<std::string> device_paths(const Entity& entity, bool programs) {
  std::vector<std::string> out;
  for (const auto& device : entity.devices) out.push_back(device->path);
  if (programs)
    for (const auto& program : entity.programs) out.push_back(program->path);
  return out;
}

std::string slash_if_devices(const Entity& entity) {
  return entity.devices.empty() && entity.programs.empty() ? "" : "/";
}

/// Topics that clients publish for the programs of a robot or team.
template <class F>
void each_input(const Simulation::ProgramEntries& programs, F take) {
  for (const auto& program : programs)
    if (program->outputs)
      for (const Outputs::Input& input : std::as_const(*program->outputs).inputs()) take(*input.topic);
}

void complete_values(const Simulation& simulation, Candidates& out) {
  if (robot_of(out.prefix()).size() == out.prefix().size()) {
    out.add("sim.");
  } else if (starts_with(out.prefix(), "sim.")) {
    for (const char* each : {"sim.time", "sim.tick", "sim.revision"}) out.add(each);
    return;
  }
  complete_addresses(
      simulation, out, [](const Entity&) { return std::string("."); },
      [&](const Entity& entity) {
        list_values(simulation, entity.instance.name, [&](const ValueEntry& entry) { out.add(entry.path); });
      });
}

void complete_argument(const Simulation& simulation, const Console::Options& options, Argument argument,
                       const std::vector<std::string>& before, Candidates& out) {
  const auto device_named = [&](const std::string& path) -> const Simulation::Device* {
    if (const Entity* const entity = simulation.find_entity(robot_of(path)))
      for (const auto& device : entity->devices)
        if (device->path == path) return device.get();
    return nullptr;
  };
  switch (argument) {
    case Argument::none: break;
    case Argument::command:
      for (std::string& name : console::command_names(options)) out.add(std::move(name));
      break;
    case Argument::list:
      for (const char* each : {"entities", "robots", "agents", "models", "topics", "parameters"})
        out.add(each);
      for (const auto& entity : simulation.entities()) out.add(entity->instance.name);
      for (const WorldElements::Part& part : simulation.elements().parts()) out.add(part.path);
      for (const Simulation::Team& team : simulation.teams())
        for (const auto& program : team.programs) out.add(program->path);
      if (out.prefix().find('/') != std::string::npos)
        if (const Entity* const entity = simulation.find_entity(robot_of(out.prefix())))
          for (std::string& path : device_paths(*entity, true)) out.add(std::move(path));
      break;
    case Argument::thing:
      for (const auto& entity : simulation.entities()) out.add(entity->instance.name);
      break;
    case Argument::device:
    case Argument::target:
      complete_addresses(simulation, out, slash_if_devices, [&](const Entity& entity) {
        for (const auto& device : entity.devices)
          if (argument == Argument::device || !device->commands.empty()) out.add(device->path);
        if (argument == Argument::target)
          each_input(entity.programs, [&](const TopicBase& topic) { out.add(topic.name().substr(1)); });
      });
      if (argument == Argument::target)
        for (const Simulation::Team& team : simulation.teams())
          each_input(team.programs, [&](const TopicBase& topic) { out.add(topic.name().substr(1)); });
      break;
    case Argument::level:
      if (const Simulation::Device* const device = before.empty() ? nullptr : device_named(before.front()))
        if (const auto kind = find_device_kind(device->decl.kind))
          for (const LevelInfo& level : (*kind)->levels) out.add(level.name);
      break;
    case Argument::service:
      if (const Simulation::Device* const device = before.empty() ? nullptr : device_named(before.front()))
        for (const DeviceService& service : simulation.kind(*device).services) out.add(service.name);
      break;
    case Argument::agent:
      for (const auto& entity : simulation.entities())
        for (const auto& program : entity->programs) out.add(program->path);
      break;
    case Argument::controller_act:
      for (const char* each : {"load", "configure", "start", "stop", "unload"}) out.add(each);
      for (const auto& entity : simulation.entities())
        if (entity->instance.is_robot) out.add(entity->instance.name);
      break;
    case Argument::controller:
      for (const auto& entity : simulation.entities())
        if (entity->instance.is_robot && starts_with(entity->instance.name + "/", robot_of(out.prefix())))
          for (const ControllerView& each : controllers_of(simulation, *entity))
            out.add(entity->instance.name + "/" + each.name);
      break;
    case Argument::link:
      if (const Entity* const entity = before.empty() ? nullptr : simulation.find_entity(before.front()))
        for (const model::Link& link : entity->instance.model->links) out.add(link.name);
      break;
    case Argument::parameter:
      complete_addresses(simulation, out, slash_if_devices, [&](const Entity& entity) {
        Parameters parameters(simulation);
        for (const std::string& path : device_paths(entity, true))
          for (const Parameter& parameter : parameters.list(path)) out.add(parameter.address());
        for (const auto& device : entity.devices) out.add(device->path + "." + failure_field);
      });
      break;
    case Argument::value: complete_values(simulation, out); break;
    case Argument::type:
      if (const Simulation::Device* const device = before.empty() ? nullptr : device_named(before.front()))
        for (const Simulation::Slot& slot : device->commands) out.add(slot.topic->type());
      if (const auto* const programs = before.empty() ? nullptr
                                                      : simulation.programs_of(robot_of(before.front())))
        each_input(*programs, [&](const TopicBase& topic) {
          if (topic.name().substr(1) == before.front()) out.add(topic.type());
        });
      break;
    case Argument::model:
      for (const char* each : {"box", "sphere", "cylinder", "copy"}) out.add(each);
      for (const console::ModelFile& file : console::model_files(options)) out.add(file.name);
      for (const auto& entity : simulation.entities())
        if (!entity->instance.model->is_static) out.add(entity->instance.name);
      break;
    case Argument::off: out.add("off"); break;
    case Argument::speed: out.add("max"); break;
  }
}

}  // namespace

std::vector<std::string> Console::complete(std::string_view line) const {
  if (line.size() > console::most_letters) return {};
  std::vector<console::Word> words = console::plain_words_of(line);
  const bool fresh = words.empty() || words.back().end < line.size();
  std::string prefix = fresh ? "" : words.back().text;
  if (!fresh) words.pop_back();
  if (prefix.size() > console::most_pattern) return {};
  Candidates out(std::move(prefix));
  const Simulation& simulation = std::as_const(session_).simulation();
  if (words.empty()) {
    complete_argument(simulation, options_, Argument::command, {}, out);
    return std::move(out).take();
  }
  const BuiltinCommand* const command = console::find_command(words.front().text);
  if (!command) return {};
  std::vector<std::string> before;
  for (std::size_t i = 1; i < words.size(); ++i) before.push_back(words[i].text);
  const std::size_t place = std::min(before.size(), command->arguments.size() - 1);
  complete_argument(simulation, options_, command->arguments[place], before, out);
  return std::move(out).take();
}

}  // namespace sandlot
