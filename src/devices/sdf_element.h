#pragma once
/// Reading the XML elements that SDF sensors and plugins arrive as, for the from_sdf functions of kinds.
///
/// An element is a Node: children by name, attributes by '@name', repeated children as a sequence. An element
/// with text and attributes is a map whose text stands under "".
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "base/node.h"
#include "base/result.h"

namespace sandlot::sdf_element {

/// The element at a path of names, "scan/horizontal/samples"; the first of repeated ones; null when absent.
const Node* find(const Node& element, std::string_view path);

/// Its text without blanks around it; "" when absent.
std::string text(const Node* element);

/// Its number; nothing when absent, an error when it is not a finite number.
Result<std::optional<double>> number(const Node& element, std::string_view path);

/// Puts the text at `path` under `key` of `config`, keeping its place; nothing happens when it is absent.
void copy(const Node& element, std::string_view path, Node& config, const char* key);

/// A scalar made from a computed value, with the place of what it was computed from.
Node scalar(double value, const Node& from);

/// One warning for each child of `element` that `known` does not list; attributes are left alone.
void warn_unknown(const Node& element, std::initializer_list<std::string_view> known, const std::string& what,
                  Diagnostics& diagnostics);

}  // namespace sandlot::sdf_element
