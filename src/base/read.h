#pragma once
/// Reads a struct with a field list from a Node: types, units, ranges, unknown and missing keys, each with
/// `file:line:column`, the key path and what would be right.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "base/text.h"
#include "base/units.h"

namespace sandlot {

/// A number with unit and range; shared by all numeric fields so that the template stays small.
/// @param min, max  what the number must lie within: the field's range, cut to what the type can hold
Result<double> read_number(const Node& node, const Field& field, double min, double max, bool integer,
                           const std::string& path);
Result<bool> read_bool(const Node& node, const std::string& path);
/// The error for a key that no field has.
Error unknown_key(const Node::Entry& entry, const std::vector<std::string>& known, const std::string& path);
/// The error for a node of the wrong type.
Error wrong_type(const Node& node, const char* expected, const std::string& path);

/// The field's range cut to the numbers that T and a double both hold exactly.
template <Number T>
std::pair<double, double> number_range(const Field& field) {
  if constexpr (std::is_integral_v<T>) {
    constexpr double exact = 9007199254740992.0;  // 2^53
    const auto low = static_cast<double>(std::numeric_limits<T>::lowest());
    const auto high = static_cast<double>(std::numeric_limits<T>::max());
    return {std::max({field.min, low, -exact}), std::min({field.max, high, exact})};
  } else {
    const auto high = static_cast<double>(std::numeric_limits<T>::max());
    return {std::max(field.min, -high), std::min(field.max, high)};
  }
}

template <class T>
Status read_value(const Node& node, const Field& field, T& out, const std::string& path);

/// A rule between the fields of a spec, if it has one.
template <class Spec>
Status check_rules(const Node& node, const Spec& spec, const std::string& path) {
  if constexpr (requires { spec.check(node, path); }) return spec.check(node, path);
  else return (void)node, (void)spec, (void)path, Status();
}

/// Reads the fields of `spec` that `node` (a map, or null for "all defaults") gives; the others keep their
/// value. The first fault is returned and `spec` is then half-read: callers throw it away.
/// @param unit  of the field that `spec` is the value of
template <Fielded Spec>
Status read_fields(const Node& node, Spec& spec, const std::string& path = "", std::string_view unit = "") {
  std::vector<std::string> known;
  Status status;
  if constexpr (requires { Spec::list_key; }) {
    if (node.is_sequence()) {
      Spec::fields(spec, [&](const Field& f, auto& member) {
        if (std::string_view(f.key) != Spec::list_key) return;
        const std::string own_unit = unit_within(f.unit, unit);
        Field here = f;
        here.unit = own_unit.c_str();
        status = read_value(node, here, member, path);
      });
      if (!status) return status;
      return check_rules(node, spec, path);
    }
  }
  if (!node.is_map() && !node.is_null()) return wrong_type(node, "a map of keys", path);
  Spec::fields(spec, [&](const Field& inner, auto& member) {
    known.emplace_back(inner.key);
    if (!status) return;
    const std::string own_unit = unit_within(inner.unit, unit);
    Field f = inner;
    f.unit = own_unit.c_str();
    if (const Node* value = node.find(f.key)) status = read_value(*value, f, member, path + "/" + f.key);
    else if (f.flags & Field::required)
      status = node.error(std::string("key '") + f.key + "' is missing", f.help, path);
  });
  // An unknown key is reported before a bad value: a slip in the name is the likelier cause of both.
  for (const Node::Entry& entry : node.entries()) {
    bool found = false;
    for (const std::string& key : known) found = found || key == entry.key;
    if (found) continue;
    Error error = unknown_key(entry, known, path);
    if constexpr (requires { Spec::list_key; })
      error.fix += std::string("; ") + Spec::list_key + " are written as a list: [{name: {...}}, ...]";
    return error;
  }
  if (!status) return status;
  return check_rules(node, spec, path);
}

template <class T>
Status read_value(const Node& node, const Field& field, T& out, const std::string& path) {
  if constexpr (std::is_same_v<T, bool>) {
    SL_ASSIGN(out, read_bool(node, path));
  } else if constexpr (Number<T>) {
    const auto [min, max] = number_range<T>(field);
    SL_ASSIGN(const double number, read_number(node, field, min, max, std::is_integral_v<T>, path));
    out = static_cast<T>(number);
  } else if constexpr (NamedEnum<T>) {
    if (!node.is_scalar()) return wrong_type(node, "a name", path);
    std::vector<std::string> names;
    for (const auto& entry : enum_names(T{})) {
      names.emplace_back(entry.name);
      if (node.text() == entry.name) return out = entry.value, Status();
    }
    return node.error("'" + node.text().substr(0, 40) + "' is no choice here", suggestion(node.text(), names),
                      path);
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (!node.is_scalar()) return wrong_type(node, "text", path);
    if (node.text().size() > field.max_count)
      return node.error("text has " + std::to_string(node.text().size()) + " characters",
                        "at most " + std::to_string(field.max_count) + " are allowed", path);
    out = node.text();
  } else if constexpr (std::is_same_v<T, Node>) {
    out = node;
  } else if constexpr (FixedVector<T> || is_array<T>::value) {
    constexpr std::size_t extent = [] {
      if constexpr (FixedVector<T>) return static_cast<std::size_t>(T::extent);
      else return std::tuple_size_v<T>;
    }();
    if (!node.is_sequence() || node.items().size() != extent)
      return wrong_type(node, ("a list of " + std::to_string(extent) + " values").c_str(), path);
    for (std::size_t i = 0; i < extent; ++i)
      SL_TRY(read_value(node.items()[i], field, out[i], path + "/" + std::to_string(i)));
  } else if constexpr (is_vector<T>::value) {
    if constexpr (std::is_same_v<typename T::value_type, std::string>) {
      if (node.is_scalar()) {  // one text stands for a list of one
        out.resize(1);
        Field of_element = field;
        of_element.max_count = Field{}.max_count;
        return read_value(node, of_element, out.front(), path);
      }
    }
    if (!node.is_sequence()) return wrong_type(node, "a list", path);
    if (node.items().size() > field.max_count)
      return node.error("list has " + std::to_string(node.items().size()) + " elements",
                        "at most " + std::to_string(field.max_count) + " are allowed", path);
    if (node.items().size() < field.min_count)
      return node.error(node.items().empty() ? "the list is empty" : "the list is too short",
                        "at least " + std::to_string(field.min_count) +
                            (field.min_count == 1 ? " element is needed" : " elements are needed"),
                        path);
    out.clear();
    Field of_element = field;  // whose own length is not that of the list
    of_element.max_count = Field{}.max_count;
    of_element.min_count = 0;
    for (std::size_t i = 0; i < node.items().size(); ++i) {
      typename T::value_type element{};
      SL_TRY(read_value(node.items()[i], of_element, element, path + "/" + std::to_string(i)));
      out.push_back(std::move(element));
    }
  } else if constexpr (is_optional<T>::value) {
    typename T::value_type value{};
    if (out) value = *out;
    SL_TRY(read_value(node, field, value, path));
    out = std::move(value);
  } else {
    static_assert(Fielded<T>, "a field must be a number, text, enumeration, list or a struct with fields");
    SL_TRY(read_fields(node, out, path, field.unit));
  }
  return {};
}

/// Defaults overlaid with `node`, every value in range.
template <Fielded Spec>
Result<Spec> read_spec(const Node& node, const std::string& path = "") {
  Spec spec{};
  SL_TRY(read_fields(node, spec, path));
  return spec;
}

template <Fielded Spec>
Status set_tunable(Spec& spec, std::string_view field_path, const Node& value, const std::string& prefix = "",
                   std::string_view unit = "");

/// The part `rest` of one member: of a struct, an optional one, or an element of a list of them.
template <class T>
Status set_part(T& member, const Field& f, std::string_view rest, const Node& value,
                const std::string& path) {
  if constexpr (Fielded<T>) {
    return set_tunable(member, rest, value, path, f.unit);
  } else if constexpr (is_optional<T>::value) {
    if constexpr (Fielded<typename T::value_type>) {
      if (member) return set_tunable(*member, rest, value, path, f.unit);
      return Error{"there is no '" + std::string(f.key) + "' here", "", value.place(), path};
    }
  } else if constexpr (is_vector<T>::value) {
    if constexpr (Fielded<typename T::value_type>) {
      const std::size_t slash = rest.find('/');
      double index = 0;
      if (!parse_number(rest.substr(0, slash), index) || !(index >= 0) || index != std::floor(index) ||
          index >= static_cast<double>(member.size()))
        return Error{"no element '" + std::string(rest.substr(0, slash).substr(0, 60)) + "'",
                     "there are " + std::to_string(member.size()) + ", counted from 0", value.place(), path};
      if (slash == std::string_view::npos)
        return Error{"an element of a list is fixed; its parts may be tunable", "", value.place(), path};
      return set_tunable(member[static_cast<std::size_t>(index)], rest.substr(slash + 1), value,
                         path + "/" + std::string(rest.substr(0, slash)), f.unit);
    }
  }
  return Error{"'" + std::string(f.key) + "' has no parts", "", value.place(), path};
}

/// Sets one tunable field by its path ("noise/white", "gains/p", "noise/0/gaussian/std") while the run goes on.
/// @param prefix  path of `spec` itself, for messages
/// @param unit    of the field that `spec` is the value of
template <Fielded Spec>
Status set_tunable(Spec& spec, std::string_view field_path, const Node& value, const std::string& prefix,
                   std::string_view unit) {
  if constexpr (requires { Spec::list_key; }) {
    if (!field_path.empty() && field_path.front() >= '0' && field_path.front() <= '9')
      return set_tunable(spec, std::string(Spec::list_key) + "/" + std::string(field_path), value, prefix,
                         unit);
  }
  const std::size_t slash = field_path.find('/');
  const std::string_view key = field_path.substr(0, slash);
  std::vector<std::string> known;
  bool found = false;
  Status status;
  Spec::fields(spec, [&](const Field& inner, auto& member) {
    known.emplace_back(inner.key);
    if (found || key != inner.key) return;
    found = true;
    const std::string own_unit = unit_within(inner.unit, unit);
    Field f = inner;
    f.unit = own_unit.c_str();
    const std::string path = prefix + "/" + f.key;
    if (slash != std::string_view::npos) {
      status = set_part(member, f, field_path.substr(slash + 1), value, path);
    } else if (!(f.flags & Field::tunable)) {
      status = Error{"'" + std::string(f.key) + "' is fixed once the run has started", "", value.place(),
                     path};
    } else {
      status = read_value(value, f, member, path);
    }
  });
  if (!found)
    return Error{"no parameter '" + std::string(key.substr(0, 60)) + "'", suggestion(key, known),
                 value.place(), prefix};
  if (!status) return status;
  return check_rules(value, spec, prefix);
}

}  // namespace sandlot
