/// long file: the commands share how they match addresses. Commands about values, parameters and devices.
#include "sim/watch/values.h"

#include <algorithm>
#include <set>

#include "base/json_writer.h"
#include "base/text.h"
#include "base/units.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "devices/kind.h"
#include "files/yaml.h"
#include "messages/command.h"
#include "messages/registry.h"
#include "noise/chain.h"
#include "sim/watch/monitor.h"
#include "sim/watch/parameters.h"
#include "sim/world/faults.h"
#include "sim/world/lookup.h"

namespace sandlot::console {
namespace {

using Is = ValueFound::Is;

std::string_view thing_of(std::string_view address) { return address.substr(0, address.find('.')); }
std::string_view robot_of(std::string_view address) { return address.substr(0, address.find_first_of("/.")); }

/// A list of objects as JSON.
class JsonRows {
 public:
  JsonRows() { json_.begin_list(); }
  /// @param members  writes those of one object
  template <class F>
  void add(F members) {
    json_.object([&] { members(json_); });
  }
  std::string take() && {
    json_.end_list();
    return std::move(text_);
  }

 private:
  std::string text_;
  JsonWriter json_{text_};
};

void write_number(JsonWriter& json, std::string_view key, std::optional<double> value) {
  if (value) json.key(key).real(*value);
  else json.key(key).null();
}

void add_row(JsonRows& rows, const ValueEntry& entry) {
  rows.add([&](JsonWriter& json) {
    json.key("address").text(entry.path);
    json.key("unit").text(entry.unit);
    json.key("help").text(entry.help);
    write_number(json, "value", entry.is == Is::value ? std::optional(entry.value) : std::nullopt);
    json.key("count").integer(entry.list ? entry.count : 0);
  });
}

std::string line_of(const Simulation& simulation, const ValueEntry& entry) {
  if (entry.list) {
    constexpr std::size_t most = 12;
    std::string text = entry.path + " = [";
    for (std::size_t i = 0; i < entry.count && i < most; ++i) {
      auto element = NamedValue::find_or_wait(simulation, entry.path + "[" + std::to_string(i) + "]");
      const auto value = element.read();
      text += (i ? ", " : "") + (value ? readable(*value) : "-");
    }
    text += entry.count > most ? ", ...]" : "]";
    if (!entry.unit.empty() && entry.unit != "1") text += " " + entry.unit;
    return text + (entry.count > most ? " (" + std::to_string(entry.count) + " values)" : "");
  }
  if (entry.is != Is::value) return entry.path + " has no value";
  return entry.path + " = " + with_unit(entry.value, entry.unit);
}

/// All values whose address fits, or that belong to a thing or device that fits.
Status gather(CommandCall& call, std::string_view pattern, std::vector<ValueEntry>& out) {
  if (pattern.size() > most_pattern)
    return Error{"an address has " + std::to_string(most_pattern) + " letters at most"};
  const Simulation& simulation = call.simulation();
  const bool whole_things = pattern.find('.') == std::string_view::npos;
  const bool plain = !is_pattern(pattern, true);
  const Pattern ready(pattern, true);
  bool too_many = false;
  const auto take = [&](const ValueEntry& entry) {
    const std::string_view thing = thing_of(entry.path);
    const bool fitting = plain ? thing == pattern ||
                                     (thing.size() > pattern.size() && starts_with(thing, pattern) &&
                                      thing[pattern.size()] == '/' &&
                                      pattern.find('/') != std::string_view::npos)
                               : ready.fits(whole_things ? thing : std::string_view(entry.path));
    if (!fitting) return;
    if (out.size() == most_matches) too_many = true;
    else out.push_back(entry);
  };
  if (robot_of(pattern) == "sim" || robot_of(pattern) == "values") {
    list_values(simulation, "", [&](const ValueEntry& entry) {
      const std::string_view thing = thing_of(entry.path);
      if (thing == "sim" || thing == "values") take(entry);
    });
  }
  const std::string_view robot = robot_of(pattern);
  const bool deep = robot.find("**") != std::string_view::npos;
  const auto look = [&](std::string_view name) {
    if (!too_many && (plain ? name == robot : deep || fits(robot, name))) list_values(simulation, name, take);
  };
  std::set<std::string_view> lists;  // "media", "rules"
  for (const WorldElements::Part& part : simulation.elements().parts()) lists.insert(first_part(part.path));
  for (const std::string_view list : lists) look(list);
  for (const auto& entity : simulation.entities()) look(entity->instance.name);
  for (const Simulation::Team& team : simulation.teams()) look(team.decl.name);
  if (too_many)
    return Error{"'" + std::string(pattern) + "' meets more than " + std::to_string(most_matches) + " values",
                 "narrow it down"};
  return {};
}

bool is_of_type(const TopicBase& slot, std::string_view type) {
  const std::string_view full = slot.type();
  return long_name(type) == full || full.substr(full.rfind('/') + 1) == type;
}

struct SlotFound {
  const TopicBase* slot = nullptr;
  std::string target;
};

/// The slot that a target and a type name; active ones go first.
Result<SlotFound> find_slot(CommandCall& call, std::string_view target, std::string_view type) {
  target = without_slash(target);
  if (target.size() > 8 && target.substr(target.size() - 8) == "/command") target.remove_suffix(8);
  const Simulation::Entity* const entity = call.simulation().find_entity(robot_of(target));
  std::vector<std::string> takes, known;
  SlotFound found;
  bool there = false, active = false;
  if (entity)
    for (const auto& device : entity->devices) {
      if (!device->commands.empty()) known.push_back(device->path);
      const bool whole = device->path == target;
      if (!whole && !starts_with(target, device->path + "/")) continue;
      const auto kind = find_device_kind(device->decl.kind);
      for (const Simulation::Slot& slot : device->commands) {
        const bool always = !kind || slot.level >= (*kind)->levels.size();
        const std::string level = always ? "" : (*kind)->levels[slot.level].name;
        if (!whole && target.substr(device->path.size() + 1) != level) continue;
        there = true;
        takes.emplace_back(slot.topic->type());
        if (!is_of_type(*slot.topic, type)) continue;
        const bool awake = always || (device->levels >> slot.level & 1);
        if (!found.slot || (awake && !active))
          found = {slot.topic.get(), std::string(target)}, active = awake;
      }
    }
  if (const auto* const programs = call.simulation().programs_of(robot_of(target)); programs && !there)
    for (const auto& program : *programs) {
      if (!program->outputs) continue;
      for (const Outputs::Input& input : std::as_const(*program->outputs).inputs()) {
        known.push_back(input.topic->name().substr(1));
        if (known.back() != target) continue;
        there = true;
        takes.emplace_back(input.topic->type());
        if (!found.slot && is_of_type(*input.topic, type)) found = {input.topic.get(), known.back()};
      }
    }
  if (found.slot) return found;
  if (there) {
    std::sort(takes.begin(), takes.end());
    takes.erase(std::unique(takes.begin(), takes.end()), takes.end());  // several levels take one type
    return Error{"'" + std::string(target) + "' takes no " + std::string(type.substr(0, 60)),
                 suggestion(type, takes)};
  }
  // "goal_pose", or that of another robot, is meant for one whose programs read such a topic.
  const auto last_part = [](std::string_view name) { return name.substr(name.rfind('/') + 1); };
  std::string namesake;
  if (known.empty())
    for (const auto& each : call.simulation().entities())
      if (const auto* const programs = call.simulation().programs_of(each->instance.name))
        for (const auto& program : *programs)
          if (program->outputs && namesake.empty())
            for (const Outputs::Input& input : std::as_const(*program->outputs).inputs())
              if (last_part(input.topic->name()) == last_part(target))
                namesake = input.topic->name().substr(1);
  call.unknown_thing = true;
  return Error{"there is no device or topic '" + std::string(target.substr(0, 100)) + "' that takes commands",
               namesake.empty() ? suggestion(target, known) : "did you mean '" + namesake + "'?"};
}

}  // namespace

CommandResult cmd_show(CommandCall& call) {
  std::vector<std::string> lines;
  JsonRows rows;
  const Simulation& simulation = call.simulation();
  std::size_t met = 0;
  for (const std::string& word : call.words) {
    const std::string_view address = without_slash(word);
    if (auto value = NamedValue::find(simulation, address)) {
      const auto number = value->read();
      ValueEntry entry{value->address(), value->unit(), "", number ? Is::value : Is::absent,
                       number.value_or(0)};
      lines.push_back(line_of(simulation, entry));
      add_row(rows, entry);
      continue;
    }
    std::vector<ValueEntry> entries;
    SL_TRY(gather(call, address, entries));
    // "rover/laser.ranges" is a list; it goes as a whole.
    if (entries.empty() && !is_pattern(address, true)) {
      list_values(simulation, robot_of(address), [&](ValueEntry entry) {
        if (entry.list && entry.path == address) entries.push_back(std::move(entry));
      });
      if (entries.empty() && address.find_first_of(" +*(<>=") == std::string_view::npos) {
        // The part of a struct: rover.pose
        list_values(simulation, robot_of(address), [&](ValueEntry entry) {
          if (entries.size() < most_matches && starts_with(entry.path, std::string(address) + "."))
            entries.push_back(std::move(entry));
        });
      }
    }
    if (entries.empty()) {
      SL_ASSIGN(ValueExpression expression, ValueExpression::compile(simulation, word));
      const auto number = expression.evaluate();
      ValueEntry entry{expression.text(), expression.unit(), "", number ? Is::value : Is::absent,
                       number ? number->value : 0};
      lines.push_back(line_of(simulation, entry));
      add_row(rows, entry);
      continue;
    }
    // Of all words together: a line has room for two thousand '*'.
    met += entries.size();
    if (met > most_matches)
      return Error{"the line meets more than " + std::to_string(most_matches) + " values", "narrow it down"};
    for (const ValueEntry& entry : entries) {
      if (!call.json) lines.push_back(line_of(simulation, entry));
      else add_row(rows, entry);
    }
  }
  if (call.json) return std::optional(std::move(rows).take());
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return std::optional(std::move(text));
}

namespace {

/// `errors`, `sim.errors`: of all devices; `rover.errors`, `*.errors`: of all devices of robots.
CommandResult set_errors(CommandCall& call, std::string_view thing, const Node& value,
                         std::string_view written) {
  auto factor = read_number(value, errors_field, errors_field.min, errors_field.max, false, "");
  if (!factor) return std::move(factor.error());
  std::vector<PendingRequest> requests;
  std::vector<std::string> names;
  const auto ask = [&](const std::string& target) {
    requests.push_back({ParameterRequest{target, errors_field.key, value},
                        target + ".errors = " + std::string(written.substr(0, 100))});
  };
  if (thing == "sim") ask("sim");
  else
    for (const auto& entity : call.simulation().entities()) {
      const std::string& name = entity->instance.name;
      names.push_back(name);
      if (is_pattern(thing) ? !entity->devices.empty() && fits(thing, name) : thing == name) ask(name);
    }
  if (requests.empty()) {
    call.unknown_thing = true;
    return Error{"there is no '" + std::string(thing.substr(0, 100)) + "'", suggestion(thing, names)};
  }
  if (requests.size() > most_matches)
    return Error{"'" + std::string(thing) + "' meets more than " + std::to_string(most_matches) + " things",
                 "narrow it down"};
  return submit(call, std::move(requests));
}

/// `rover/laser.failure`, `*/laser.failure`.
CommandResult set_failure(CommandCall& call, std::string_view thing, const Node& value,
                          std::string_view written) {
  auto order = read_failure_order(value);
  if (!order) return std::move(order.error());
  SL_ASSIGN(const std::vector<std::string> devices, match_devices(call, thing));
  std::vector<PendingRequest> requests;
  for (const std::string& device : devices)
    requests.push_back({ParameterRequest{device, failure_field, value},
                        device + ".failure = " + std::string(written.substr(0, 100))});
  return submit(call, std::move(requests));
}

/// `rover.fuel`, `*.health`: properties of the user's own. Nothing: no robot or object that fits has one of that name.
std::optional<CommandResult> set_property(CommandCall& call, std::string_view thing, std::string_view name,
                                          const Node& value, std::string_view written) {
  std::vector<PendingRequest> requests;
  for (const auto& entity : call.simulation().entities()) {
    const std::string& owner = entity->instance.name;
    if (is_pattern(thing) ? !fits(thing, owner) : thing != owner) continue;
    const model::PropertyDecl* const property = entity->instance.find_property(name);
    if (!property) continue;
    const std::string address = owner + "." + property->name;
    const Field field{"value", property->unit.c_str(), ""};
    auto number = read_number(value, field, property->min, property->max, false, "/" + address);
    if (!number) return std::move(number.error());
    requests.push_back({ParameterRequest{owner, property->name, value},
                        address + " = " + std::string(written.substr(0, 100))});
    if (requests.size() > most_matches)
      return Error{"'" + std::string(thing) + "' meets more than " + std::to_string(most_matches) + " things",
                   "narrow it down"};
  }
  if (requests.empty()) return std::nullopt;
  return submit(call, std::move(requests));
}

}  // namespace

CommandResult cmd_set(CommandCall& call) {
  const std::string_view address = without_slash(call.words.front());
  if (address.size() > most_pattern)
    return Error{"an address has " + std::to_string(most_pattern) + " letters at most"};
  std::string_view written = call.rest(1);
  if (!written.empty() && written.front() == '=') written = trim(written.substr(1));
  auto parsed = parse_yaml(written, "");
  if (!parsed)
    return Error{"'" + std::string(written.substr(0, 60)) + "' is not a value: " + parsed.error().what};
  if (parsed->is_null()) return Error{"a value is missing", "set ADDRESS VALUE"};
  Node value = std::move(*parsed);
  const std::string_view thing = thing_of(address);
  if (address == "errors" || (thing.find('/') == std::string_view::npos && address.size() > thing.size() &&
                              address.substr(thing.size() + 1) == "errors"))
    return set_errors(call, address == "errors" ? "sim" : thing, value, written);
  if (thing.find('/') != std::string_view::npos && address.size() > thing.size() &&
      address.substr(thing.size() + 1) == failure_field)
    return set_failure(call, thing, value, written);
  if (thing.size() == address.size() || thing.find('/') == std::string_view::npos) {
    if (thing.size() < address.size())
      if (auto set = set_property(call, thing, address.substr(thing.size() + 1), value, written))
        return std::move(*set);
    if (!is_pattern(thing) || thing.size() == address.size())
      return Error{"'" + std::string(address) + "' is not a parameter",
                   "write DEVICE.PARAMETER: rover/laser.noise.white"};
  }
  std::string_view path = address.substr(thing.size() + 1);
  if (starts_with(path, "parameter.")) path.remove_prefix(10);
  const bool plain = !is_pattern(thing) && !is_pattern(path, true);

  const Simulation& simulation = call.simulation();
  Parameters parameters(simulation);
  std::vector<Parameter> matching;
  std::vector<std::string> near;
  bool met_thing = false;
  const Pattern ready_thing(thing), ready_path(path, true);
  const auto look = [&](const std::string& target) {
    if (plain ? target != thing : !ready_thing.fits(target)) return;
    met_thing = true;
    for (Parameter& parameter : parameters.list(target)) {
      const std::string whole = parameter.address();
      const std::string_view own = std::string_view(whole).substr(target.size() + 1);
      if (plain ? own == path : ready_path.fits(own)) matching.push_back(std::move(parameter));
      else if (near.size() < 200) near.push_back(whole);
    }
  };
  for (const WorldElements::Part& part : simulation.elements().parts()) look(part.path);
  const std::string_view robot = robot_of(thing);
  for (const auto& entity : simulation.entities()) {
    const std::string& name = entity->instance.name;
    if (plain ? name != robot : robot.find("**") == std::string_view::npos && !fits(robot, name)) continue;
    for (const auto& device : entity->devices) look(device->path);
    for (const auto& program : entity->programs) look(program->path);
    if (matching.size() > most_matches)
      return Error{
          "'" + std::string(address) + "' meets more than " + std::to_string(most_matches) + " parameters",
          "narrow it down"};
  }
  for (const Simulation::Team& team : simulation.teams())
    if (plain ? team.decl.name == robot : fits(robot, team.decl.name))
      for (const auto& program : team.programs) look(program->path);
  if (matching.empty()) {
    if (!met_thing) {
      call.unknown_thing = true;
      if (plain && !simulation.find_entity(robot) && (robot == "media" || robot == "rules")) {
        std::vector<std::string> parts;
        for (const WorldElements::Part& part : simulation.elements().parts()) parts.push_back(part.path);
        return Error{
            "there is no '" + std::string(thing.substr(0, 100)) + "'",
            parts.empty() ? "the scenario declares neither media nor rules" : suggestion(thing, parts)};
      }
      if (plain) return match_devices(call, thing) ? no_device(thing) : match_devices(call, thing).error();
      return Error{"no device fits '" + std::string(thing) + "'"};
    }
    if (plain) { SL_TRY(parameters.check({std::string(thing), field_path(path)}, value)); }
    return Error{
        "no parameter '" + std::string(path.substr(0, 100)) + "' of '" + std::string(thing) + "' can be set",
        suggestion(address, near)};
  }
  std::vector<PendingRequest> requests;
  for (Parameter& parameter : matching) {
    if (Status fine = parameters.check(parameter, value); !fine) {
      fine.error().place = {};
      fine.error().path = parameter.address();
      return std::move(fine.error());
    }
    std::string text = parameter.address() + " = ";
    const auto number = value.is_scalar()
                            ? parse_quantity(value.text(), parameter.unit.empty() ? "1" : parameter.unit)
                            : Result<double>(Error{});
    text += number ? with_unit(*number, parameter.unit) : std::string(written.substr(0, 100));
    requests.push_back(
        {ParameterRequest{std::move(parameter.target), std::move(parameter.field), value}, std::move(text)});
  }
  return submit(call, std::move(requests));
}

CommandResult cmd_level(CommandCall& call) {
  SL_ASSIGN(const std::vector<std::string> devices, match_devices(call, without_slash(call.words.front())));
  const std::vector<std::string> levels(call.words.begin() + 1, call.words.end());
  std::vector<PendingRequest> requests;
  for (const std::string& path : devices) {
    const Simulation::Entity* const entity = call.simulation().find_entity(robot_of(path));
    for (const auto& device : entity->devices) {
      const auto kind = find_device_kind(device->decl.kind);
      if (device->path != path || !kind) continue;
      std::vector<std::string> known;
      for (const LevelInfo& level : (*kind)->levels) known.emplace_back(level.name);
      for (const std::string& level : levels)
        if (std::find(known.begin(), known.end(), level) == known.end())
          return Error{"device '" + path + "' has no level '" + level.substr(0, 60) + "'",
                       suggestion(level, known)};
    }
    std::string text = path + " at level";
    for (const std::string& level : levels) text += " " + level;
    requests.push_back({LevelRequest{path, levels}, std::move(text)});
  }
  return submit(call, std::move(requests));
}

CommandResult cmd_command(CommandCall& call) {
  SL_ASSIGN(const SlotFound found, find_slot(call, call.words[0], call.words[1]));
  SL_ASSIGN(std::vector<std::byte> bytes, command_from_json(*found.slot, call.rest(2)));
  CommandRequest request{found.target, found.slot->type(), std::move(bytes)};
  return submit(call, {{std::move(request), found.target + " got a " + found.slot->type()}});
}

CommandResult cmd_sample(CommandCall& call) {
  SL_ASSIGN(const std::vector<std::string> devices, match_devices(call, without_slash(call.words.front())));
  std::vector<PendingRequest> requests;
  for (const std::string& path : devices) requests.push_back({SampleRequest{path}, path + " measures"});
  return submit(call, std::move(requests));
}

CommandResult cmd_call(CommandCall& call) {
  const std::string path(without_slash(call.words.front()));
  const auto device = device_named(call.simulation(), path);
  if (!device) {
    call.unknown_thing = true;
    return device.error();
  }
  SL_ASSIGN(const DeviceService* const service,
            service_of(call.simulation().kind(**device), path, call.words[1]));
  const std::string_view text = call.words.size() > 2 ? call.rest(2) : std::string_view("{}");
  SL_ASSIGN(const AnyMessage request, message_from_json(service->request(), text));
  CallRequest made{path, service->name, {}};
  request.to_cdr(made.bytes);
  return submit(call, {{std::move(made), path + " " + service->name, &service->response()}});
}

CommandResult cmd_values(CommandCall& call) {
  const Monitor& monitor = call.simulation().monitor();
  if (monitor.value_names().empty() && !call.json)
    return std::optional<std::string>("the scenario names none");
  JsonRows rows;
  std::string text;
  for (std::uint32_t i = 0; i < monitor.value_names().size(); ++i) {
    const auto value = monitor.value(i);
    const std::string& name = monitor.value_names()[i];
    rows.add([&](JsonWriter& json) {
      json.key("name").text(name);
      write_number(json, "value", value);
    });
    text += (text.empty() ? "" : "\n") + name + (value ? " = " + readable(*value) : " has no value");
  }
  return std::optional(call.json ? std::move(rows).take() : text);
}

CommandResult cmd_events(CommandCall& call) {
  const Monitor& monitor = call.simulation().monitor();
  if (monitor.events().empty() && !call.json) return std::optional<std::string>("the scenario has none");
  JsonRows rows;
  std::string text;
  for (const Monitor::Event& event : monitor.events()) {
    rows.add([&](JsonWriter& json) {
      json.key("name").text(event.decl.name);
      json.key("when").text(event.decl.when);
      json.key("count").integer(event.count);
      write_number(json, "last_s", event.count > 0 ? std::optional(event.last.s()) : std::nullopt);
    });
    text += (text.empty() ? "" : "\n") + event.decl.name + " (" + event.decl.when + ") ";
    text += event.count == 0 ? std::string("has not happened")
                             : "happened " + std::to_string(event.count) + " x, last at " +
                                   readable(event.last.s()) + " s";
  }
  return std::optional(call.json ? std::move(rows).take() : text);
}

namespace {

std::string kind_of(const Simulation::Entity& entity) {
  return entity.instance.is_robot ? "robot" : entity.instance.model->is_static ? "static" : "object";
}

CommandResult list_entities(CommandCall& call, std::span<const Simulation::Entity* const> things) {
  JsonRows rows;
  std::string text;
  for (const Simulation::Entity* thing : things) {
    const Pose X = call.simulation().engine().pose(thing->id);
    const model::Instance& instance = thing->instance;
    rows.add([&](JsonWriter& json) {
      json.key("name").text(instance.name);
      json.key("kind").text(kind_of(*thing));
      json.key("model").text(instance.model->name);
      json.key("team").text(instance.team);
      json.key("pose").list([&] {
        for (const double x : {X.p.x, X.p.y, X.p.z, X.q.w, X.q.x, X.q.y, X.q.z}) json.real(x);
      });
    });
    if (!call.json)
      text += (text.empty() ? "" : "\n") + instance.name + "  " + kind_of(*thing) + "  " +
              instance.model->name + "  at " + readable(X.p.x) + " " + readable(X.p.y) + " " +
              readable(X.p.z) + " m";
  }
  return std::optional(call.json ? std::move(rows).take() : text);
}

CommandResult list_topics(CommandCall& call) {
  JsonRows rows;
  std::string text;
  for (const TopicBase* topic : call.simulation().topics()) {
    rows.add([&](JsonWriter& json) {
      json.key("name").text(topic->name());
      json.key("type").text(topic->type());
      json.key("count").integer(topic->count);
    });
    text += (text.empty() ? "" : "\n") + topic->name() + "  " + topic->type() + "  " +
            std::to_string(topic->count);
  }
  return std::optional(call.json ? std::move(rows).take() : text);
}

CommandResult list_parameters(CommandCall& call) {
  JsonRows rows;
  std::string text;
  std::size_t count = 0;
  const Simulation& simulation = call.simulation();
  Parameters parameters(simulation);
  const auto add = [&](const std::string& target) {
    for (const Parameter& parameter : parameters.list(target)) {
      if (++count > most_matches) return;
      auto found = NamedValue::find(simulation,
                                    target + ".parameter." + parameter.address().substr(target.size() + 1));
      const std::optional<double> value = found ? found->read() : std::nullopt;
      rows.add([&](JsonWriter& json) {
        json.key("address").text(parameter.address());
        json.key("unit").text(parameter.unit);
        write_number(json, "value", value);
      });
      text += (text.empty() ? "" : "\n") + parameter.address();
      if (value) text += " = " + with_unit(*value, parameter.unit);
    }
  };
  for (const WorldElements::Part& part : simulation.elements().parts()) add(part.path);
  for (const auto& entity : simulation.entities()) {
    for (const auto& device : entity->devices) add(device->path);
    for (const auto& program : entity->programs) add(program->path);
  }
  for (const Simulation::Team& team : simulation.teams())
    for (const auto& program : team.programs) add(program->path);
  return std::optional(call.json ? std::move(rows).take() : text);
}

CommandResult list_models(CommandCall& call) {
  JsonRows rows;
  std::string text;
  const auto add = [&](const std::string& name, const std::string& help) {
    rows.add([&](JsonWriter& json) {
      json.key("name").text(name);
      json.key("help").text(help);
    });
    text += (text.empty() ? "" : "\n") + name + (help.empty() ? "" : "  " + help);
  };
  add("box", "size=X,Y,Z color=... mass=...");
  add("sphere", "size=DIAMETER color=... mass=...");
  add("cylinder", "size=DIAMETER,HEIGHT color=... mass=...");
  for (const ModelFile& file : model_files(call.options)) add(file.name, file.help);
  return std::optional(call.json ? std::move(rows).take() : text);
}

/// What belongs to no robot: media, rules, programs of teams.
struct WorldPart {
  std::string path, kind;
};
std::vector<WorldPart> world_parts(const Simulation& simulation) {
  std::vector<WorldPart> out;
  for (const WorldElements::Part& part : simulation.elements().parts()) out.push_back({part.path, part.kind});
  for (const Simulation::Team& team : simulation.teams())
    for (const auto& program : team.programs) out.push_back({program->path, program->decl.kind});
  return out;
}

CommandResult list_one(CommandCall& call, std::string_view address) {
  std::vector<ValueEntry> entries;
  SL_TRY(gather(call, address, entries));
  if (call.json) {
    JsonRows rows;
    for (const ValueEntry& entry : entries) add_row(rows, entry);
    return std::optional(std::move(rows).take());
  }
  std::string text;
  const auto add = [&](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
  if (const Simulation::Entity* const entity = call.simulation().find_entity(robot_of(address))) {
    for (const auto& device : entity->devices) {
      if (address != entity->instance.name && address != device->path) continue;
      std::string line = device->path + "  " + device->decl.kind;
      if (const auto kind = find_device_kind(device->decl.kind))
        for (std::size_t i = 0; i < (*kind)->levels.size(); ++i)
          line += std::string(i ? ", " : "  ") + (*kind)->levels[i].name +
                  (device->levels >> i & 1 ? "*" : "");
      add(line);
    }
    for (const auto& program : entity->programs)
      if (address == entity->instance.name || address == program->path)
        add(program->path + "  " + program->decl.kind);
  } else {
    for (const WorldPart& part : world_parts(call.simulation()))
      if (address == part.path) add(part.path + "  " + part.kind);
  }
  for (const ValueEntry& entry : entries) add(line_of(call.simulation(), entry));
  return std::optional(std::move(text));
}

}  // namespace

CommandResult cmd_list(CommandCall& call) {
  const std::string what = call.words.empty() ? "entities" : std::string(without_slash(call.words.front()));
  if (call.words.size() > 1) return Error{"'list' lists one thing at a time"};
  const Simulation& simulation = call.simulation();
  // A thing of that name goes before the word.
  const Simulation::Entity* const entity = simulation.find_entity(robot_of(what));
  if (entity) {
    bool known = what == entity->instance.name;
    std::vector<std::string> paths;
    for (const auto& device : entity->devices) paths.push_back(device->path);
    for (const auto& program : entity->programs) paths.push_back(program->path);
    known = known || std::find(paths.begin(), paths.end(), what) != paths.end();
    if (known) return list_one(call, what);
    if (what.find('/') != std::string::npos && !is_pattern(what))
      return Error{"'" + entity->instance.name + "' has no device '" + what.substr(0, 100) + "'",
                   suggestion(what, paths)};
  }
  for (const WorldPart& part : world_parts(simulation))
    if (what == part.path) return list_one(call, what);
  if (what == "entities") {
    std::vector<const Simulation::Entity*> all;
    for (const auto& each : simulation.entities()) all.push_back(each.get());
    return list_entities(call, all);
  }
  if (what == "robots") {
    std::vector<const Simulation::Entity*> robots;
    for (const auto& each : simulation.entities())
      if (each->instance.is_robot) robots.push_back(each.get());
    return list_entities(call, robots);
  }
  if (what == "agents") return list_agents(call);
  if (what == "topics") return list_topics(call);
  if (what == "parameters") return list_parameters(call);
  if (what == "models") return list_models(call);
  if (is_pattern(what)) {
    SL_ASSIGN(const std::vector<const Simulation::Entity*> things, match_things(call, what));
    return list_entities(call, things);
  }
  std::vector<std::string> known{"entities", "robots", "agents", "models", "topics", "parameters"};
  for (const auto& each : simulation.entities()) known.push_back(each->instance.name);
  for (const WorldPart& part : world_parts(simulation)) known.push_back(part.path);
  return Error{"there is no '" + what.substr(0, 100) + "' to list", suggestion(what, known)};
}

}  // namespace sandlot::console
