#pragma once
/// rcl_interfaces (Humble): log messages and parameters.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// A line of the log (/rosout).
struct Log {
  static constexpr const char* ros_type = "rcl_interfaces/msg/Log";
  static constexpr std::byte debug{10};
  static constexpr std::byte info{20};
  static constexpr std::byte warn{30};
  static constexpr std::byte error{40};
  static constexpr std::byte fatal{50};
  Time stamp;
  std::uint8_t level = 0;
  std::string name;
  std::string msg;
  std::string file;
  std::string function;
  std::uint32_t line = 0;
  static void constants(auto&& visit) {
    visit("DEBUG", debug);
    visit("INFO", info);
    visit("WARN", warn);
    visit("ERROR", error);
    visit("FATAL", fatal);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Time of the message."}, s.stamp);
    visit(Field{"level", "1", "Severity. 10: debug, 20: info, 30: warning, 40: error, 50: fatal."}, s.level);
    visit(Field{"name", "", "Name of the source."}, s.name);
    visit(Field{"msg", "", "Text of the message."}, s.msg);
    visit(Field{"file", "", "Name of the source file."}, s.file);
    visit(Field{"function", "", "Name of the function in the source file."}, s.function);
    visit(Field{"line", "1", "Line in the source file."}, s.line);
  }
};

/// Constants for ParameterValue.type.
struct ParameterType {
  static constexpr const char* ros_type = "rcl_interfaces/msg/ParameterType";
  static void constants(auto&& visit) {
    visit("PARAMETER_NOT_SET", std::uint8_t{0});
    visit("PARAMETER_BOOL", std::uint8_t{1});
    visit("PARAMETER_INTEGER", std::uint8_t{2});
    visit("PARAMETER_DOUBLE", std::uint8_t{3});
    visit("PARAMETER_STRING", std::uint8_t{4});
    visit("PARAMETER_BYTE_ARRAY", std::uint8_t{5});
    visit("PARAMETER_BOOL_ARRAY", std::uint8_t{6});
    visit("PARAMETER_INTEGER_ARRAY", std::uint8_t{7});
    visit("PARAMETER_DOUBLE_ARRAY", std::uint8_t{8});
    visit("PARAMETER_STRING_ARRAY", std::uint8_t{9});
  }
  static void fields(auto&, auto&&) {}
};

/// The value that `type` names.
struct ParameterValue {
  static constexpr const char* ros_type = "rcl_interfaces/msg/ParameterValue";
  std::uint8_t type = 0;
  bool bool_value = false;
  std::int64_t integer_value = 0;
  double double_value = 0;
  std::string string_value;
  std::vector<std::byte> byte_array_value;
  std::vector<Boolean> bool_array_value;
  std::vector<std::int64_t> integer_array_value;
  std::vector<double> double_array_value;
  std::vector<std::string> string_array_value;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"type", "1", "Type of the value, a constant of ParameterType."}, s.type);
    visit(Field{"bool_value", "", "Value of type 1."}, s.bool_value);
    visit(Field{"integer_value", "", "Value of type 2."}, s.integer_value);
    visit(Field{"double_value", "", "Value of type 3."}, s.double_value);
    visit(Field{"string_value", "", "Value of type 4."}, s.string_value);
    visit(Field{"byte_array_value", "", "Value of type 5."}, s.byte_array_value);
    visit(Field{"bool_array_value", "", "Value of type 6."}, s.bool_array_value);
    visit(Field{"integer_array_value", "", "Value of type 7."}, s.integer_array_value);
    visit(Field{"double_array_value", "", "Value of type 8."}, s.double_array_value);
    visit(Field{"string_array_value", "", "Value of type 9."}, s.string_array_value);
  }
};

/// A named value.
struct Parameter {
  static constexpr const char* ros_type = "rcl_interfaces/msg/Parameter";
  std::string name;
  ParameterValue value;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the parameter."}, s.name);
    visit(Field{"value", "", "Value of the parameter."}, s.value);
  }
};

/// Parameters of a node have changed.
struct ParameterEvent {
  static constexpr const char* ros_type = "rcl_interfaces/msg/ParameterEvent";
  Time stamp;
  std::string node;
  std::vector<Parameter> new_parameters;
  std::vector<Parameter> changed_parameters;
  std::vector<Parameter> deleted_parameters;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Time of the message."}, s.stamp);
    visit(Field{"node", "", "Name of the node."}, s.node);
    visit(Field{"new_parameters", "", "Parameters that are new."}, s.new_parameters);
    visit(Field{"changed_parameters", "", "Parameters that have changed."}, s.changed_parameters);
    visit(Field{"deleted_parameters", "", "Parameters that were deleted."}, s.deleted_parameters);
  }
};

/// Whether parameters could be set.
struct SetParametersResult {
  static constexpr const char* ros_type = "rcl_interfaces/msg/SetParametersResult";
  bool successful = false;
  std::string reason;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"successful", "", "Whether the parameters were set."}, s.successful);
    visit(Field{"reason", "", "Reason of a failure."}, s.reason);
  }
};

/// Names of parameters.
struct ListParametersResult {
  static constexpr const char* ros_type = "rcl_interfaces/msg/ListParametersResult";
  std::vector<std::string> names;
  std::vector<std::string> prefixes;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"names", "", "Names of the parameters."}, s.names);
    visit(Field{"prefixes", "", "Groups that the parameters are in."}, s.prefixes);
  }
};

}  // namespace sandlot::msg
