#pragma once
/// Answers of programs outside this process, as JSON: lines of a pipe, messages of a remote client.
///
///   {"orders": {"drive": {"linear": {"x": 0.3}}}, "samples": ["eye"], "wait": 2.5}
///
/// orders   messages for devices, by the device's name, `device/level` or, of a device that takes several types,
///          `device/Type`. Fields that are left out keep their defaults. Where the order of messages matters, or a device
///          takes several, as a radio does, a list of pairs: [["radio", {...}], ["radio", {...}]]; the type may follow as a third,
///          of a device that takes several.
/// samples  devices that shall take a sample although none is due.
/// wait     the next observation: at this time [s], or with the next message of the reading of this name; left out or null:
///          at the next control step.
/// Errors   no JSON, another key, a name or a field that is not there (with the nearest), a value of another type. Nothing of
///          the answer has been ordered then.
/// Limits   objects and lists are nested 32 deep at most; 1000 orders.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "control/program.h"

namespace sandlot::programs {

/// Reaction of a robot to an answer that does not come in time.
enum class OnMiss : std::uint8_t { hold, stop, end };
inline std::span<const EnumName<OnMiss>> enum_names(OnMiss) {
  static constexpr EnumName<OnMiss> names[] = {
      {"hold", OnMiss::hold}, {"stop", OnMiss::stop}, {"end", OnMiss::end}};
  return names;
}

/// A reading or an actuator, by the names that JSON has for it.
struct Named {
  std::string name;  ///< "drive", or "drive/TwistStamped" where another type has that name
  std::uint32_t index = 0;
  std::string type;
  bool any_level = true;  ///< follows the active level
};
/// Names for the entries of a description.
std::vector<Named> names_of(const std::vector<Description::Entry>& entries);

/// Puts orders and requests of an answer into `cmd`.
/// @param forms  per actuator an object of its message type
Result<Program::Resumed> read_answer(std::string_view line, std::span<const Named> readings,
                                     std::span<const Named> actuators,
                                     std::span<const TopicBase* const> forms, Command& cmd);

/// Orders all drives among the actuators to stand still.
void stop_drives(std::span<const Named> actuators, Command& cmd);

}  // namespace sandlot::programs
