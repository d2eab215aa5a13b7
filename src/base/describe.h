#pragma once
/// The field list of a spec as data: for `sandlot list`, the JSON schema, forms and the generated docs.
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "base/text.h"

namespace sandlot {

/// One leaf field of a spec, nested ones with their path.
struct FieldInfo {
  std::string path;  ///< "noise/white"
  std::string type;  ///< "number", "integer", "bool", "text", "choice", "list of number", "list of text",
                     ///< "list of lists of number", "list of maps", "map"
  std::string unit, help;
  double min = 0, max = 0;
  bool tunable = false, required = false, optional = false;
  std::string default_value;  ///< as a file would write it
  std::vector<std::string> choices;
  std::size_t length = 0;  ///< of fixed vectors (or of the inner lists), 0 otherwise
  std::string elements;    ///< of a list whose elements are described elsewhere: under which name
  bool for_map = false;    ///< this list may be written in place of the map that holds it
  std::size_t min_count = 0, max_count = 0;  ///< of "list of maps"
};

/// A value as a file would write it.
template <class T>
std::string file_text(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    return value;
  } else if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (Number<T>) {
    return number_text(static_cast<double>(value));
  } else if constexpr (NamedEnum<T>) {
    for (const auto& entry : enum_names(value))
      if (entry.value == value) return entry.name;
    return "";
  } else {
    std::string text = "[";
    const auto add = [&](const auto& element) { text += (text.size() > 1 ? ", " : "") + file_text(element); };
    if constexpr (FixedVector<T>) {
      for (std::size_t i = 0; i < T::extent; ++i) add(value[i]);
    } else {
      for (const auto& element : value) add(element);
    }
    return text + "]";
  }
}

template <class T>
void describe_value(const Field& f, const T& value, const std::string& path, std::vector<FieldInfo>& out,
                    bool optional);

/// The fields of a struct that is the value of a field with the unit `unit`.
template <Fielded T>
void describe_struct(const T& value, const std::string& prefix, std::string_view unit,
                     std::vector<FieldInfo>& out, bool optional) {
  T::fields(value, [&](const Field& inner, const auto& member) {
    const std::string own_unit = unit_within(inner.unit, unit);
    Field f = inner;
    f.unit = own_unit.c_str();
    const std::size_t first = out.size();
    describe_value(f, member, prefix + f.key, out, optional);
    if constexpr (requires { T::list_key; })
      if (std::string_view(f.key) == T::list_key) out[first].for_map = true;
  });
}

template <class T>
void describe_value(const Field& f, const T& value, const std::string& path, std::vector<FieldInfo>& out,
                    bool optional) {
  FieldInfo info{path,
                 "",
                 f.unit,
                 f.help,
                 f.min,
                 f.max,
                 (f.flags & Field::tunable) != 0,
                 (f.flags & Field::required) != 0,
                 optional};
  if constexpr (std::is_same_v<T, bool>) {
    info.type = "bool";
    info.default_value = file_text(value);
  } else if constexpr (Number<T>) {
    info.type = std::is_integral_v<T> ? "integer" : "number";
    info.default_value = file_text(value);
  } else if constexpr (NamedEnum<T>) {
    info.type = "choice";
    for (const auto& entry : enum_names(value)) info.choices.emplace_back(entry.name);
    info.default_value = file_text(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    info.type = "text";
    info.default_value = value;
  } else if constexpr (std::is_same_v<T, Node>) {
    info.type = "map";
  } else if constexpr (FixedVector<T> || is_array<T>::value) {
    info.type = "list of number";
    info.default_value = file_text(value);
    if constexpr (FixedVector<T>) info.length = T::extent;
    else info.length = value.size();
  } else if constexpr (is_vector<T>::value) {
    using Element = typename T::value_type;
    if constexpr (Fielded<Element>) {
      info.type = "list of maps";
      info.min_count = f.min_count;
      info.max_count = f.max_count;
      if constexpr (requires { Element::described_as; }) info.elements = Element::described_as;
      out.push_back(info);
      if (info.elements.empty()) describe_struct(Element{}, path + "[]/", f.unit, out, false);
      return;
    } else {
      info.type = Number<Element> ? "list of number" : "list of text";
      if constexpr (FixedVector<Element> || is_array<Element>::value) {
        info.type = "list of lists of number";
        if constexpr (FixedVector<Element>) info.length = Element::extent;
        else info.length = std::tuple_size_v<Element>;
      }
      info.default_value = file_text(value);
    }
  } else if constexpr (is_optional<T>::value) {
    describe_value(f, value.value_or(typename T::value_type{}), path, out, true);
    if (!value && !Fielded<typename T::value_type>) out.back().default_value.clear();  // unset is no value
    return;
  } else {
    describe_struct(value, path + "/", f.unit, out, optional);
    return;
  }
  out.push_back(std::move(info));
}

template <Fielded Spec>
std::vector<FieldInfo> describe_fields(const Spec& spec = {}) {
  std::vector<FieldInfo> out;
  describe_struct(spec, "", "", out, false);
  return out;
}

}  // namespace sandlot
