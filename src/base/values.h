#pragma once
/// Any number in a struct with a field list, by its path: `noise.white`, `ranges[3]`, `pose.position.x`.
///
/// A path is parsed once; following it costs a comparison per field on the way and allocates nothing. Numbers, bools (0 or
/// 1), enumerations (their value) and times (in seconds) are values; text is not. Elements of lists go by index, also
/// those of fixed vectors, whose parts have names too (`.x`).
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "base/result.h"
#include "base/time.h"

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

/// What is at the end of a path.
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

template <class T>
concept PlainValue = Number<T> || std::is_enum_v<T> || std::is_same_v<T, Time>;
template <class T>
concept ListOfValues = (is_vector<T>::value || is_array<T>::value) &&
                       PlainValue<typename std::conditional_t<is_vector<T>::value || is_array<T>::value, T,
                                                              std::vector<int>>::value_type>;

template <PlainValue T>
double plain_value(const T& x) {
  if constexpr (std::is_same_v<T, Time>) return x.s();
  else if constexpr (std::is_enum_v<T>) return static_cast<double>(static_cast<std::underlying_type_t<T>>(x));
  else return static_cast<double>(x);
}
template <class T>
std::string value_unit(const std::string& field_unit) {
  return std::is_same_v<T, Time> ? "s" : field_unit;
}

/// Follows `path` from x.
/// @param unit  that of the field that holds x
template <class T>
void find_value(const T& x, const std::string& unit, std::span<const ValueStep> path, ValueFound& out) {
  using Is = ValueFound::Is;
  out.is = Is::unknown;
  if constexpr (PlainValue<T>) {
    if (path.empty()) out = {Is::value, plain_value(x), value_unit<T>(unit)};
  } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, Node>) {
    if (path.empty()) out.is = Is::text;
  } else if constexpr (is_optional<T>::value) {
    if (x) return find_value(*x, unit, path, out);
    find_value(typename T::value_type{}, unit, path, out);
    if (out.is == Is::value) out.is = Is::absent;
  } else {
    if (path.empty()) {
      out.is = Is::compound;
      return;
    }
    const ValueStep& step = path.front();
    const auto rest = path.subspan(1);
    if (step.key.empty()) {
      if constexpr (FixedVector<T>) {
        if (step.index < T::extent) find_value(x[step.index], unit, rest, out);
      } else if constexpr (is_array<T>::value) {
        if (step.index < x.size()) find_value(x[step.index], unit, rest, out);
      } else if constexpr (is_vector<T>::value) {
        using Element = typename T::value_type;
        if (step.index < x.size()) {
          if constexpr (std::is_same_v<T, std::vector<bool>>)
            find_value(static_cast<bool>(x[step.index]), unit, rest, out);
          else find_value(x[step.index], unit, rest, out);
        } else {
          find_value(Element{}, unit, rest, out);
          if (out.is == Is::value) out.is = Is::absent;
        }
      }
      return;
    }
    if constexpr (Componented<T>) {
      const auto names = components(x);
      for (std::size_t i = 0; i < names.size(); ++i)
        if (rest.empty() && step.key == names[i].name) {
          out = {Is::value, component(x, i), *names[i].unit ? std::string(names[i].unit) : unit};
          return;
        }
    }
    if constexpr (Fielded<T>)
      T::fields(x, [&](const Field& f, const auto& member) {
        if (step.key == f.key) find_value(member, unit_within(f.unit, unit), rest, out);
      });
  }
}

/// Calls `visit` for every value in x. A list of numbers is one entry, a list of structs goes element by element.
template <class T>
void list_values(const T& x, const std::string& unit, const char* help, const std::string& path,
                 const ValueVisit& visit) {
  using Is = ValueFound::Is;
  constexpr std::size_t most_elements = 16;
  const auto part = [&](const char* key) { return path.empty() ? std::string(key) : path + "." + key; };
  if constexpr (PlainValue<T>) {
    visit({path, value_unit<T>(unit), help, Is::value, plain_value(x)});
  } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, Node>) {
    return;
  } else if constexpr (is_optional<T>::value) {
    if (x) return list_values(*x, unit, help, path, visit);
    list_values(typename T::value_type{}, unit, help, path, [&](ValueEntry entry) {
      entry.is = Is::absent;
      visit(std::move(entry));
    });
  } else if constexpr (Componented<T>) {
    const auto names = components(x);
    for (std::size_t i = 0; i < names.size(); ++i)
      visit({part(names[i].name), *names[i].unit ? std::string(names[i].unit) : unit, help, Is::value,
             component(x, i)});
  } else if constexpr (ListOfValues<T>) {
    const bool empty = x.size() == 0;
    const double first = empty ? 0 : plain_value(static_cast<typename T::value_type>(*x.begin()));
    visit({path, value_unit<typename T::value_type>(unit), help, empty ? Is::absent : Is::value, first,
           x.size(), true});
  } else if constexpr (is_vector<T>::value || is_array<T>::value) {
    for (std::size_t i = 0; i < x.size() && i < most_elements; ++i)
      list_values(x[i], unit, help, path + "[" + std::to_string(i) + "]", visit);
  } else if constexpr (FixedVector<T>) {
    for (std::size_t i = 0; i < T::extent; ++i)
      list_values(x[i], unit, help, path + "[" + std::to_string(i) + "]", visit);
  } else if constexpr (Fielded<T>) {
    T::fields(x, [&](const Field& f, const auto& member) {
      list_values(member, unit_within(f.unit, unit), f.help, part(f.key), visit);
    });
  }
}

/// The shape in which TopicBase, PoolBase and Controller answer.
template <class T>
ValueFound value_at(const T& x, std::span<const ValueStep> path) {
  ValueFound found;
  find_value(x, "", path, found);
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
