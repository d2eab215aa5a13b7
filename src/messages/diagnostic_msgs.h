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
    visit(Field{"key", "", "The name."}, s.key);
    visit(Field{"value", "", "The text."}, s.value);
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
    visit(Field{"level", "1", "0: well, 1: warning, 2: error, 3: no news."}, s.level);
    visit(Field{"name", "", "The part."}, s.name);
    visit(Field{"message", "", "In words."}, s.message);
    visit(Field{"hardware_id", "", "Its number."}, s.hardware_id);
    visit(Field{"values", "", "What else is known."}, s.values);
  }
};

/// How the parts of a robot are.
struct DiagnosticArray {
  static constexpr const char* ros_type = "diagnostic_msgs/msg/DiagnosticArray";
  Header header;
  std::vector<DiagnosticStatus> status;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"status", "", "The parts."}, s.status);
  }
};

}  // namespace sandlot::msg
