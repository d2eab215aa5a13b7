#include "server/clients/parameters.h"

#include <cmath>
#include <map>

#include "base/text.h"
#include "sim/world/faults.h"

namespace sandlot::server {
namespace {

using foxglove::Parameter;

/// "noise/0/white" as a path of values: "noise[0].white".
std::string value_path(std::string_view field) {
  std::string out;
  for (const std::string_view part : split(field, '/')) {
    double index = 0;
    if (!out.empty() && parse_number(part, index) && index >= 0 && index < 1e6 &&
        index == std::floor(index)) {
      out.append("[").append(part).append("]");
      continue;
    }
    if (!out.empty()) out += '.';
    out += part;
  }
  return out;
}

/// "noise[0].white" as a path of fields: "noise/0/white".
std::string field_path(std::string_view path) {
  std::string out;
  for (const char c : path) {
    if (c == '.' || c == '[') out += '/';
    else if (c != ']') out += c;
  }
  return out;
}

/// Reads one value of a device or program.
using Look = std::function<ValueFound(std::span<const ValueStep>)>;

void set_value(Parameter& out, const FieldInfo* field, double value) {
  if (field && field->type == "bool") {
    out.value = value != 0;
  } else if (field && field->type == "choice" && value >= 0 &&
             value < static_cast<double>(field->choices.size())) {
    out.value = field->choices[static_cast<std::size_t>(value)];
  } else {
    out.value = value;
    out.type = "float64";
  }
}

bool read(const Look& look, const FieldInfo* field, const std::string& path, Parameter& out) {
  auto steps = parse_value_path(path);
  if (!steps) return false;
  const ValueFound found = look(*steps);
  if (found.is == ValueFound::Is::value) {
    set_value(out, field, found.value);
    return true;
  }
  if (found.is != ValueFound::Is::compound) return false;
  // A list of numbers, as long as its elements go on.
  std::vector<double> values;
  constexpr std::size_t most_elements = 1000;
  steps->push_back({"", 0});
  for (; values.size() < most_elements; ++steps->back().index) {
    const ValueFound element = look(*steps);
    if (element.is != ValueFound::Is::value) break;
    values.push_back(element.value);
  }
  if (values.empty()) return false;
  out.value = std::move(values);
  out.type = "float64_array";
  return true;
}

/// Describing a kind costs more than reading its values.
class Fields {
 public:
  explicit Fields(const Simulation& simulation) : simulation_(simulation) {}
  const std::vector<FieldInfo>& of(const Simulation::Device& device) {
    const Kind& kind = simulation_.kind(device);
    return of(&kind, kind.describe);
  }
  const std::vector<FieldInfo>& of(const Simulation::ProgramEntry& program) {
    for (const ControllerKind* kind : simulation_.controller_kinds())
      if (program.decl.kind == kind->name) return of(kind, kind->describe);
    return of(nullptr, nullptr);
  }

 private:
  const std::vector<FieldInfo>& of(const void* kind, std::vector<FieldInfo> (*describe)()) {
    const auto [found, fresh] = known_.try_emplace(kind);
    if (fresh && describe) found->second = describe();
    return found->second;
  }
  const Simulation& simulation_;
  std::map<const void*, std::vector<FieldInfo>> known_;
};

Look look_at(const Simulation& simulation, const Simulation::Device& device) {
  return [&](std::span<const ValueStep> path) {
    return simulation.pool(device).value(device.index, ValuePart::parameter, path);
  };
}
Look look_at(const Simulation&, const Simulation::ProgramEntry& program) {
  return [&](std::span<const ValueStep> path) { return program.program->value(ValuePart::parameter, path); };
}

/// Calls f(path, look, fields) for the devices and programs of an entity.
template <class F>
void for_each_part(const Simulation& simulation, const Simulation::Entity& entity, Fields& fields, F&& f) {
  for (const auto& device : entity.devices) f(device->path, look_at(simulation, *device), fields.of(*device));
  for (const auto& program : entity.programs)
    f(program->path, look_at(simulation, *program), fields.of(*program));
}

/// What was ordered to go wrong with a device.
Parameter failure(const Simulation::Device& device) {
  Parameter out;
  out.name = device.path + "." + failure_field;
  const auto kind = device.faults ? device.faults->order.kind : FailureOrder::Kind::planned;
  for (const auto& [name, each] : enum_names(kind))
    if (each == kind) out.value = std::string(name);
  return out;
}

/// The factor on the errors of the whole world or of one robot.
Parameter factor(const std::string& target, double value) {
  Parameter out;
  out.name = target + ".errors";
  set_value(out, nullptr, value);
  return out;
}

}  // namespace

std::string parameter_name(std::string_view target, std::string_view field) {
  return std::string(target) + "." + value_path(field);
}

bool list_parameters(const Simulation& simulation, std::vector<Parameter>& out) {
  bool all = true;
  Fields known(simulation);
  out.push_back(factor("sim", simulation.setup().errors));
  for (const auto& entity : simulation.entities())
    if (!entity->devices.empty() && out.size() < most_parameters)
      out.push_back(factor(entity->instance.name, entity->instance.errors));
  for (const auto& entity : simulation.entities())
    for_each_part(simulation, *entity, known,
                  [&](const std::string& path, const Look& look, const std::vector<FieldInfo>& fields) {
                    for (const FieldInfo& field : fields) {
                      if (!field.tunable || field.path.find("[]") != std::string::npos) continue;
                      if (out.size() >= most_parameters) {
                        all = false;
                        return;
                      }
                      Parameter made;
                      if (!read(look, &field, value_path(field.path), made)) continue;
                      made.name = parameter_name(path, field.path);
                      out.push_back(std::move(made));
                    }
                  });
  return all;
}

Parameter read_parameter(const Simulation& simulation, const std::string& name) {
  return read_parameters(simulation, std::span(&name, 1)).front();
}

std::vector<Parameter> read_parameters(const Simulation& simulation, std::span<const std::string> names) {
  std::vector<Parameter> all;
  all.reserve(names.size());
  Fields known_fields(simulation);
  for (const std::string& name : names) {
    Parameter& out = all.emplace_back();
    out.name = name;
    const std::size_t dot = name.find('.');
    if (dot == std::string::npos) continue;
    const std::string_view target = std::string_view(name).substr(0, dot);
    const std::string rest = name.substr(dot + 1);
    const Simulation::Entity* const entity = simulation.find_entity(target.substr(0, target.find('/')));
    if (target == "sim" && rest == "errors") out = factor("sim", simulation.setup().errors);
    if (!entity) continue;
    if (target == entity->instance.name && rest == "errors")
      out = factor(entity->instance.name, entity->instance.errors);
    for (const auto& device : entity->devices)
      if (device->path == target && rest == failure_field) out = failure(*device);
    for_each_part(simulation, *entity, known_fields,
                  [&](const std::string& path, const Look& look, const std::vector<FieldInfo>& fields) {
                    if (path != target || rest == failure_field) return;
                    const FieldInfo* known = nullptr;
                    for (const FieldInfo& field : fields)
                      if (field.path == field_path(rest)) known = &field;
                    if (!read(look, known, rest, out)) out.value = std::monostate();
                  });
  }
  return all;
}

Result<ParameterRequest> parameter_request(const Parameter& parameter) {
  const std::size_t dot = parameter.name.find('.');
  const std::string shown = "'" + parameter.name.substr(0, 200) + "'";
  if (dot == std::string::npos || dot + 1 == parameter.name.size())
    return Error{"no parameter " + shown, "they are called as in rover/laser.noise.white"};
  ParameterRequest out;
  out.target = parameter.name.substr(0, dot);
  out.field = field_path(std::string_view(parameter.name).substr(dot + 1));
  if (const auto* number = std::get_if<double>(&parameter.value)) {
    out.value = Node::scalar(number_text(*number));
  } else if (const auto* flag = std::get_if<bool>(&parameter.value)) {
    out.value = Node::scalar(*flag ? "true" : "false");
  } else if (const auto* text = std::get_if<std::string>(&parameter.value)) {
    out.value = Node::scalar(*text);
  } else if (const auto* numbers = std::get_if<std::vector<double>>(&parameter.value)) {
    out.value = Node::sequence();
    for (const double each : *numbers) out.value.push(Node::scalar(number_text(each)));
  } else if (const auto* texts = std::get_if<std::vector<std::string>>(&parameter.value)) {
    out.value = Node::sequence();
    for (const std::string& each : *texts) out.value.push(Node::scalar(each));
  } else {
    return Error{shown + " cannot be deleted", "give it a value"};
  }
  return out;
}

}  // namespace sandlot::server
