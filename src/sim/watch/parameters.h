#pragma once
/// Parameters of a running simulation: tunable fields of its devices, programs, media and rules by address,
/// "rover/laser.noise.white".
///
/// Address   TARGET.PATH: a device, a program or an element of the world ("rules/goals"), and the field as a path of values (docs/values.md), elements as "[3]" or ".3".
///           A ParameterRequest names the same field with slashes: "noise/0/white".
/// Others    "sim.errors" and "ROBOT.errors", the factors on errors, and "DEVICE.failure", the ordered failure, can be read
///           in the same way.
/// Threads   the simulation's.
/// Cost      describing a kind costs more than reading its values: a Parameters describes each once, and is made for one job.
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/describe.h"
#include "base/values.h"
#include "sim/world/simulation.h"

namespace sandlot {

/// "noise/0/white" as a path of values: "noise[0].white".
std::string value_path(std::string_view field);
/// "noise[0].white" as ParameterRequest names the field: "noise/0/white".
std::string field_path(std::string_view path);

struct Parameter {
  std::string target, field;  ///< as ParameterRequest has them: "rover/laser", "noise/white"
  std::string unit = {};
  bool in_list =
      false;  ///< within an element of a list, such as a stage of noise: it comes and goes with the element
  std::string address() const { return target + "." + value_path(field); }
};

/// The parts of an address; nothing where one is missing.
std::optional<Parameter> parse_parameter(std::string_view address);

/// Nothing: there is no such value. A choice is its name.
using ParameterValue = std::variant<std::monostate, bool, double, std::string, std::vector<double>>;

class Parameters {
 public:
  explicit Parameters(const Simulation& simulation) : simulation_(simulation) {}
  /// What can be set now of a device, program, medium or rule.
  std::vector<Parameter> list(std::string_view target);
  /// @param parameter  or one of the others above
  ParameterValue value(const Parameter& parameter);
  /// Judges a value as far as that is possible without the device: by type, unit and range. Parameters that are not
  /// described pass.
  Status check(const Parameter& parameter, const Node& value);

 private:
  using ValueReader = std::function<ValueFound(std::span<const ValueStep>)>;
  struct Part {  ///< a device, program, medium or rule
    const std::vector<FieldInfo>* fields = nullptr;
    ValueReader read;
    std::function<void(const ValueVisit&)> list;
  };
  std::optional<Part> find(std::string_view target);
  const std::vector<FieldInfo>& describe(const void* kind, std::vector<FieldInfo> (*describe)());
  const std::vector<FieldInfo>& describe(const Simulation::Device& device);

  const Simulation& simulation_;
  std::map<const void*, std::vector<FieldInfo>> described_;  ///< by kind
  std::map<const void*, std::vector<FieldInfo>> with_keys_;  ///< likewise, of devices with common keys
};

}  // namespace sandlot
