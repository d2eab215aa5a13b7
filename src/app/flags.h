#pragma once
/// Texts of the command line that several verbs read in the same way. Each error names the option.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "draw/viewpoint.h"
#include "formats/scenario/scenario.h"

namespace sandlot::app {

/// "30s", "2 min", "1.5": a duration option as text, turned into seconds after parsing.
struct DurationOption {
  std::string text;
  Status read(const char* flag, std::optional<double>& out) const;
};

/// --set path=value.
Status read_sets(const std::vector<std::string>& texts, std::vector<formats::Override>& out);

/// Size of a picture: "640x480".
Status read_size(const char* flag, const std::string& text, draw::ViewpointOptions& out);
/// Point in metres: "1,2,0.5".
Status read_point(const char* flag, const std::string& text, std::optional<Vec3>& out);

/// "a,f(b,c)" as "a" and "f(b,c)": commas within parentheses and brackets do not separate.
std::vector<std::string> split_list(std::string_view text);

}  // namespace sandlot::app
