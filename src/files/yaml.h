#pragma once
/// YAML text as Nodes with positions. Shared by the formats that are written in YAML.
///
/// Limits   one document per file; no tags but the standard ones, no merge keys (`<<`), keys are scalars.
/// Cost     one pass of yaml-cpp's event parser, one Node per value; aliases are copied and count as what they stand for.
#include <string>
#include <string_view>

#include "base/node.h"
#include "files/text.h"

namespace sandlot {

/// What a reader accepts before it gives up with an error; bounds time and memory on hostile input.
struct TextLimits {
  std::size_t max_bytes = 16u << 20;
  std::size_t max_depth = 64;
  std::size_t max_nodes = 1'000'000;  ///< after expansion of YAML aliases
};

/// Parses one YAML document. Duplicate keys, tabs, bad indentation ... are errors with file:line:column. An empty
/// document is a null Node.
/// @param file  name for messages
Result<Node> parse_yaml(std::string_view text, const std::string& file, const TextLimits& limits = {});

/// A tree as YAML that parse_yaml() reads as the same tree.
std::string yaml_text(const Node& root);

}  // namespace sandlot
