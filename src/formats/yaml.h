#pragma once
/// YAML text as Nodes with positions. Shared by the formats that are written in YAML.
#include <string>
#include <string_view>

#include "base/node.h"

namespace sandlot::formats {

/// What a reader accepts before it gives up with an error; bounds time and memory on hostile input.
struct TextLimits {
  std::size_t max_bytes = 16u << 20;
  std::size_t max_depth = 64;
  std::size_t max_nodes = 1'000'000;  ///< after expansion of YAML aliases
};

/// Reads a whole file, refusing directories, unreadable files and files over the limit before reading them.
Result<std::string> read_text_file(const std::string& path, std::size_t max_bytes);

/// Parses one YAML document. Duplicate keys, tabs, bad indentation ... are errors with file:line:column.
/// @param file  name for messages
Result<Node> parse_yaml(std::string_view text, const std::string& file, const TextLimits& limits = {});

}  // namespace sandlot::formats
