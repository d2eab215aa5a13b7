#include "app/flags.h"

#include "base/text.h"
#include "base/units.h"

namespace sandlot::app {

Status DurationOption::read(const char* flag, std::optional<double>& out) const {
  if (text.empty()) return {};
  auto seconds = parse_quantity(text, "s");
  if (!seconds) return Error{std::string(flag) + ": " + seconds.error().what, seconds.error().fix};
  if (!(*seconds >= 0 && *seconds <= 1e9))
    return Error{std::string(flag) + ": must be in [0, 1e9] s, is " + number_text(*seconds)};
  out = *seconds;
  return {};
}

Status read_sets(const std::vector<std::string>& texts, std::vector<formats::Override>& out) {
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      return Error{"--set: '" + text + "' is not of the form path=value", "for example --set physics=planar"};
    out.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return {};
}

}  // namespace sandlot::app
