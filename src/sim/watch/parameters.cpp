#include "sim/watch/parameters.h"

#include <algorithm>

#include "base/read.h"
#include "base/text.h"
#include "programs/programs.h"
#include "sim/world/faults.h"

namespace sandlot {
namespace {

bool is_index(std::string_view part) {
  return !part.empty() && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
}

ParameterValue typed(const FieldInfo* field, double value) {
  if (field && field->type == "bool") return value != 0;
  if (field && field->type == "choice" && value >= 0 && value < static_cast<double>(field->choices.size()))
    return field->choices[static_cast<std::size_t>(value)];
  return value;
}

/// The failure that was ordered of a device.
std::string failure_of(const Simulation::Device& device) {
  const auto kind = device.faults ? device.faults->order.kind : FailureOrder::Kind::planned;
  for (const auto& [name, each] : enum_names(kind))
    if (each == kind) return name;
  return "";
}

}  // namespace

std::string value_path(std::string_view field) {
  std::string out;
  for (const std::string_view part : split(field, '/')) {
    if (!out.empty() && is_index(part)) out.append("[").append(part).append("]");
    else out.append(out.empty() ? "" : ".").append(part);
  }
  return out;
}

std::string field_path(std::string_view path) {
  std::string out;
  for (const char c : path) {
    if (c == '.' || c == '[') out += '/';
    else if (c != ']') out += c;
  }
  return out;
}

std::optional<Parameter> parse_parameter(std::string_view address) {
  const std::size_t dot = address.find('.');
  if (dot == std::string_view::npos || dot + 1 == address.size()) return std::nullopt;
  return Parameter{std::string(address.substr(0, dot)), field_path(address.substr(dot + 1))};
}

const std::vector<FieldInfo>& Parameters::describe(const void* kind, std::vector<FieldInfo> (*describe)()) {
  const auto [found, fresh] = described_.try_emplace(kind);
  if (fresh && describe) found->second = describe();
  return found->second;
}

/// Fields of the kind, and the common keys of devices that have some.
const std::vector<FieldInfo>& Parameters::describe(const Simulation::Device& device) {
  const Kind& kind = simulation_.kind(device);
  if (!device.keys) return describe(&kind, kind.describe);
  const auto [found, fresh] = with_keys_.try_emplace(&kind);
  if (fresh) {
    found->second = describe(&kind, kind.describe);
    for (FieldInfo& field : device_key_fields(kind)) found->second.push_back(std::move(field));
  }
  return found->second;
}

std::optional<Parameters::Part> Parameters::find(std::string_view target) {
  if (const WorldElements::Part* const found = simulation_.elements().find_part(target)) {
    const Element& element = *found->element;
    return Part{&describe(found->kind, found->describe),
                [&](std::span<const ValueStep> path) { return element.value(ValuePart::parameter, path); },
                [&](const ValueVisit& visit) { element.list_values(ValuePart::parameter, visit); }};
  }
  static const std::vector<Owned<Simulation::Device>> no_devices;
  static const Simulation::ProgramEntries no_programs;
  const Simulation::Entity* const entity = simulation_.find_entity(first_part(target));
  for (const auto& each : entity ? entity->devices : no_devices) {
    if (each->path != target) continue;
    const Simulation::Device& device = *each;
    return Part{
        &describe(device),
        [&](std::span<const ValueStep> path) {
          return simulation_.value(device, ValuePart::parameter, path);
        },
        [&](const ValueVisit& visit) { simulation_.list_values(device, ValuePart::parameter, visit); }};
  }
  const Simulation::ProgramEntries* const programs = simulation_.programs_of(first_part(target));
  for (const auto& each : programs ? *programs : no_programs) {
    if (each->path != target) continue;
    const ControllerKind* kind = nullptr;
    for (const ControllerKind* known : simulation_.controller_kinds())
      if (each->decl.kind == known->name) kind = known;
    const ProgramKind* other = nullptr;
    for (const ProgramKind* known : program_kinds())
      if (each->decl.kind == known->name) other = known;
    const auto& program = *each->program;
    return Part{kind ? &describe(kind, kind->describe) : &describe(other, other ? other->describe : nullptr),
                [&](std::span<const ValueStep> path) { return program.value(ValuePart::parameter, path); },
                [&](const ValueVisit& visit) { program.list_values(ValuePart::parameter, visit); }};
  }
  return std::nullopt;
}

std::vector<Parameter> Parameters::list(std::string_view target) {
  std::vector<Parameter> out;
  const std::optional<Part> part = find(target);
  if (!part) return out;
  std::map<std::string, std::string, std::less<>> present;  // paths that have a value now, with their units
  part->list([&](const ValueEntry& entry) {
    if (entry.is != ValueFound::Is::absent || entry.list) present.emplace(entry.path, entry.unit);
  });
  std::vector<std::string> lists;
  for (const FieldInfo& field : *part->fields) {
    if (field.type == "list of maps") {
      lists.push_back(value_path(field.path) + "[");
      continue;
    }
    if (!field.tunable || field.path.find("[]") != std::string::npos) continue;
    const bool plain = field.type == "number" || field.type == "integer" || field.type == "bool" ||
                       field.type == "choice";
    if (plain && !present.contains(value_path(field.path))) continue;  // in a part that is not set
    out.push_back({std::string(target), field.path, field.unit});
  }
  for (const auto& [path, unit] : present) {
    bool in_list = part->fields->empty();  // of a kind without a description any value may be tunable
    for (const std::string& list : lists) in_list = in_list || starts_with(path, list);
    if (in_list) out.push_back({std::string(target), field_path(path), unit, true});
  }
  return out;
}

ParameterValue Parameters::value(const Parameter& parameter) {
  const auto& [target, field, unit, in_list] = parameter;
  if (target == "sim" && field == "errors") return simulation_.setup().errors;
  if (const Simulation::Entity* const entity = simulation_.find_entity(first_part(target))) {
    if (target == entity->instance.name && field == "errors") return entity->instance.errors;
    if (field == failure_field) {
      for (const auto& device : entity->devices)
        if (device->path == target) return failure_of(*device);
      return {};
    }
  }
  const std::optional<Part> part = find(target);
  auto steps = parse_value_path(value_path(field));
  if (!part || !steps) return {};
  const FieldInfo* known = nullptr;
  for (const FieldInfo& each : *part->fields)
    if (each.path == field) known = &each;
  const ValueFound found = part->read(*steps);
  if (found.is == ValueFound::Is::value) return typed(known, found.value);
  if (found.is != ValueFound::Is::compound) return {};
  // A list of numbers, as long as its elements go on.
  constexpr std::size_t most_elements = 1000;
  std::vector<double> values;
  steps->push_back({"", 0});
  for (; values.size() < most_elements; ++steps->back().index) {
    const ValueFound element = part->read(*steps);
    if (element.is != ValueFound::Is::value) break;
    values.push_back(element.value);
  }
  if (values.empty()) return {};
  return values;
}

Status Parameters::check(const Parameter& parameter, const Node& value) {
  const std::optional<Part> part = find(parameter.target);
  if (!part) return {};
  for (const FieldInfo& info : *part->fields) {
    if (info.path != parameter.field) continue;
    if (!info.tunable) return Error{"'" + parameter.address() + "' is fixed once the run has started"};
    const Field field{info.path.c_str(), info.unit.c_str(), info.help.c_str(), info.min, info.max};
    if (info.type == "number" || info.type == "integer") {
      auto number = read_number(value, field, info.min, info.max, info.type == "integer", "");
      if (!number) return std::move(number.error());
    } else if (info.type == "bool") {
      auto read = read_bool(value, "");
      if (!read) return std::move(read.error());
    } else if (info.type == "choice") {
      if (std::find(info.choices.begin(), info.choices.end(), value.text()) == info.choices.end())
        return Error{"'" + value.text().substr(0, 40) + "' is not a choice here",
                     suggestion(value.text(), info.choices)};
    }
  }
  return {};
}

}  // namespace sandlot
