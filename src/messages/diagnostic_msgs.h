#pragma once
/// diagnostic_msgs (Humble).
#include <cstddef>
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// A named text.
struct KeyValue {
  static constexpr const char* ros_type = "diagnostic_msgs/msg/KeyValue";
  std::string key;
  std::string value;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"key", "", "Name of the value."}, s.key);
    visit(Field{"value", "", "Value as text."}, s.value);
  }
};

/// How a part of a robot is.
struct DiagnosticStatus {
  static constexpr const char* ros_type = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr std::byte ok{0};
  static constexpr std::byte warn{1};
  static constexpr std::byte error{2};
  static constexpr std::byte stale{3};
  std::byte level{};
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
  static void constants(auto&& visit) {
    visit("OK", ok);
    visit("WARN", warn);
    visit("ERROR", error);
    visit("STALE", stale);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"level", "1", "Severity of the status. 0: well, 1: warning, 2: error, 3: no news."}, s.level);
    visit(Field{"name", "", "Name of the part."}, s.name);
    visit(Field{"message", "", "Description of the status."}, s.message);
    visit(Field{"hardware_id", "", "Identifier of the hardware."}, s.hardware_id);
    visit(Field{"values", "", "Additional values."}, s.values);
  }
};

/// How the parts of a robot are.
struct DiagnosticArray {
  static constexpr const char* ros_type = "diagnostic_msgs/msg/DiagnosticArray";
  Header header;
  std::vector<DiagnosticStatus> status;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"status", "", "Statuses of the parts."}, s.status);
  }
};

}  // namespace sandlot::msg
