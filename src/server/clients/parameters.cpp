#include "server/clients/parameters.h"

#include "base/text.h"
#include "sim/watch/parameters.h"

namespace sandlot::server {
namespace {

foxglove::Parameter to_foxglove(std::string name, ParameterValue value) {
  foxglove::Parameter out;
  out.name = std::move(name);
  // JSON writes a whole number like an integer: the type shows that it is not one.
  if (std::holds_alternative<double>(value)) out.type = "float64";
  if (std::holds_alternative<std::vector<double>>(value)) out.type = "float64_array";
  std::visit([&](auto& x) { out.value = std::move(x); }, value);
  return out;
}

}  // namespace

bool list_parameters(const Simulation& simulation, std::vector<foxglove::Parameter>& out) {
  Parameters parameters(simulation);
  bool all = true;
  const auto add = [&](const Parameter& parameter) {
    ParameterValue value = parameters.value(parameter);
    if (std::holds_alternative<std::monostate>(value)) return;
    if (out.size() >= most_parameters) all = false;
    else out.push_back(to_foxglove(parameter.address(), std::move(value)));
  };
  add({"sim", "errors"});
  for (const auto& entity : simulation.entities())
    if (!entity->devices.empty() && out.size() < most_parameters) add({entity->instance.name, "errors"});
  const auto add_part = [&](const std::string& path) {
    if (!all) return;
    for (const Parameter& parameter : parameters.list(path))
      if (!parameter.in_list) add(parameter);
  };
  for (const WorldElements::Part& part : simulation.elements().parts()) add_part(part.path);
  for (const auto& entity : simulation.entities()) {
    for (const auto& device : entity->devices) add_part(device->path);
    for (const auto& program : entity->programs) add_part(program->path);
  }
  for (const auto& team : simulation.teams())
    for (const auto& program : team.programs) add_part(program->path);
  return all;
}

std::vector<foxglove::Parameter> read_parameters(const Simulation& simulation,
                                                 std::span<const std::string> names) {
  Parameters parameters(simulation);
  std::vector<foxglove::Parameter> out;
  out.reserve(names.size());
  for (const std::string& name : names) {
    const auto parameter = parse_parameter(name);
    out.push_back(to_foxglove(name, parameter ? parameters.value(*parameter) : ParameterValue()));
  }
  return out;
}

foxglove::Parameter read_parameter(const Simulation& simulation, const std::string& name) {
  return read_parameters(simulation, std::span(&name, 1)).front();
}

Result<ParameterRequest> parameter_request(const foxglove::Parameter& parameter) {
  const std::string quoted = "'" + parameter.name.substr(0, 200) + "'";
  auto address = parse_parameter(parameter.name);
  if (!address) return Error{"no parameter " + quoted, "they are called as in rover/laser.noise.white"};
  ParameterRequest out{std::move(address->target), std::move(address->field), {}};
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
    return Error{quoted + " cannot be deleted", "give it a value"};
  }
  return out;
}

}  // namespace sandlot::server
