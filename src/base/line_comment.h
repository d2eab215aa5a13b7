#pragma once
/// Comments in lines that people write: of the console, of a map's YAML.
#include <string_view>

namespace sandlot {

/// The text before a comment: a # at the beginning of the line or after a blank. One within quotes or within a word begins none.
std::string_view without_comment(std::string_view line);

}  // namespace sandlot
