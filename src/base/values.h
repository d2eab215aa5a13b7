#pragma once
/// Any number in a struct with a field list, by its path: `noise.white`, `ranges[3]`, `pose.position.x`.
///
/// A path is parsed once; following it costs a comparison per field on the way and allocates nothing.
/// Numbers, bools (0 or 1), enumerations (their value) and times (in seconds) are values; text is not.
/// Elements of lists go by index, also those of fixed vectors, whose parts have names too (`.x`).
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "base/struct_info.h"

namespace sandlot {

/// `.key`, or `[index]` when the key is empty.
struct ValueStep {
  std::string key;
  std::size_t index = 0;
};
using ValuePath = std::vector<ValueStep>;

/// "pose.position.x" or "ranges[3]". At most 16 steps.
Result<ValuePath> parse_value_path(std::string_view text);
std::string to_string(std::span<const ValueStep> path);

/// Value, struct or list at the end of a path.
struct ValueFound {
  enum class Is : std::uint8_t {
    unknown,  ///< nothing has this path
    value,
    absent,    ///< a value that is not there at present: beyond the end of a list, an option that is not set
    text,      ///< a string or a free map
    compound,  ///< the path ends early: a struct or a list
  } is = Is::unknown;
  double value = 0;
  std::string unit = {};  ///< the field's; "s" for times
};

/// One value, or a list of numbers as a whole.
struct ValueEntry {
  std::string path;
  std::string unit = {};
  const char* help = "";
  ValueFound::Is is = ValueFound::Is::value;
  double value = 0;       ///< of a list: its first element
  std::size_t count = 0;  ///< of a list: how many there are; its elements are path[0], path[1] ...
  bool list = false;
};
using ValueVisit = std::function<void(ValueEntry entry)>;

/// Follows `path` from x.
/// @param unit  that of the field that holds x
void find_value(const TypeInfo& type, const void* x, std::string_view unit, std::span<const ValueStep> path,
                ValueFound& out);

/// Calls `visit` for every value in x. A list of numbers is one entry, a list of structs goes element by
/// element.
void list_values(const TypeInfo& type, const void* x, const std::string& unit, const char* help,
                 const std::string& path, const ValueVisit& visit);
template <class T>
void list_values(const T& x, const std::string& unit, const char* help, const std::string& path,
                 const ValueVisit& visit) {
  list_values(type_info<T>, &x, unit, help, path, visit);
}

/// The shape in which TopicBase, PoolBase and Controller answer.
template <class T>
ValueFound value_at(const T& x, std::span<const ValueStep> path) {
  ValueFound found;
  find_value(type_info<T>, &x, "", path, found);
  return found;
}

/// Which of the two structs of a device or controller.
enum class ValuePart : std::uint8_t { parameter, state };
template <class Spec, class State>
ValueFound value_at(ValuePart part, const Spec& spec, const State& state, std::span<const ValueStep> path) {
  return part == ValuePart::state ? value_at(state, path) : value_at(spec, path);
}
template <class Spec, class State>
void list_values(ValuePart part, const Spec& spec, const State& state, const ValueVisit& visit) {
  if (part == ValuePart::state) list_values(state, "", "", "", visit);
  else list_values(spec, "", "", "", visit);
}

}  // namespace sandlot
