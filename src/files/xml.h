#pragma once
/// XML elements with their lines, as plain data: the readers of SDF and URDF take their values from these.
///
/// Limits   size, depth, number of elements and of attributes are checked before the XML parser sees the text.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/node.h"
#include "base/result.h"

namespace sandlot {

struct XmlLimits {
  std::size_t max_bytes = 64u << 20;
  std::size_t max_depth = 64;
  std::size_t max_elements = 2'000'000;
};

struct Xml {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::string text;  ///< of its own, trimmed
  std::vector<Xml> children;
  Place place;

  const std::string* attribute(std::string_view key) const;
  void set_attribute(std::string_view key, std::string value);
  /// The first child of that name, or null.
  const Xml* child(std::string_view key) const;
  Xml* child(std::string_view key);

  Error error(std::string what, std::string fix = "") const {
    return {std::move(what), std::move(fix), place};
  }
};

/// The root element of a document.
Result<Xml> parse_xml(std::string_view text, const std::string& file, const XmlLimits& limits);

/// Number of elements, the root included.
std::size_t count_elements(const Xml& root);

/// An element as a Node: attributes as keys with a leading '@', repeated children as a sequence, an element without
/// either as its text. The text of an element that has attributes but no children is the key '#text'.
Node node_of(const Xml& element);

}  // namespace sandlot
