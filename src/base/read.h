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
#include "base/struct_info.h"
#include "base/text.h"
#include "base/units.h"

namespace sandlot {

/// A number with unit.
/// @param min, max  what the number must lie within: the field's range, cut to what the type can hold
Result<double> read_number(const Node& node, const Field& field, double min, double max, bool integer,
                           const std::string& path);
Result<bool> read_bool(const Node& node, const std::string& path);
/// The error for a node of the wrong type.
Error wrong_type(const Node& node, const std::string& expected, const std::string& path);

/// Functions behind the templates below, which pass the tables of their type.
namespace read_detail {
Status value(const Node& node, const Field& field, const TypeEdit& type, void* out, const std::string& path);
Status fields(const Node& node, const TypeEdit& type, void* spec, const std::string& path,
              std::string_view unit);
Status tunable(const TypeEdit& type, void* spec, std::string_view field_path, const Node& value,
               const std::string& prefix, std::string_view unit);
}  // namespace read_detail

/// Reads the fields of `spec` that `node` (a map, or null for "all defaults") gives; the others keep their
/// value. The first fault is returned and `spec` is then half-read: callers throw it away.
/// @param unit  of the field that `spec` is the value of
template <Fielded Spec>
Status read_fields(const Node& node, Spec& spec, const std::string& path = "", std::string_view unit = "") {
  return read_detail::fields(node, type_edit<Spec>, &spec, path, unit);
}

/// Reads the value of a field.
template <class T>
Status read_value(const Node& node, const Field& field, T& out, const std::string& path) {
  return read_detail::value(node, field, type_edit<T>, &out, path);
}

/// Defaults overlaid with `node`, every value in range.
template <Fielded Spec>
Result<Spec> read_spec(const Node& node, const std::string& path = "") {
  Spec spec{};
  SL_TRY(read_fields(node, spec, path));
  return spec;
}

/// Sets one tunable field by its path ("noise/white", "gains/p", "noise/0/gaussian/std") while the run goes
/// on.
/// @param prefix  path of `spec` itself, for messages
/// @param unit    of the field that `spec` is the value of
template <Fielded Spec>
Status set_tunable(Spec& spec, std::string_view field_path, const Node& value, const std::string& prefix = "",
                   std::string_view unit = "") {
  return read_detail::tunable(type_edit<Spec>, &spec, field_path, value, prefix, unit);
}

}  // namespace sandlot
