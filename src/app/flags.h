#pragma once
/// Texts of the command line that several verbs read alike.
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/scenario/scenario.h"

namespace sandlot::app {

/// "30s", "2 min", "1.5": a duration option as text, turned into seconds after parsing.
struct DurationOption {
  std::string text;
  Status read(const char* flag, std::optional<double>& out) const;
};

/// --set path=value.
Status read_sets(const std::vector<std::string>& texts, std::vector<formats::Override>& out);

}  // namespace sandlot::app
