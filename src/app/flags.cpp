#include "app/flags.h"

#include <cmath>

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

Status read_size(const char* flag, const std::string& text, draw::ViewpointOptions& out) {
  if (text.empty()) return {};
  const std::size_t x = text.find('x');
  double width = 0, height = 0;
  if (x == std::string::npos || !parse_number(text.substr(0, x), width) ||
      !parse_number(text.substr(x + 1), height) || !(width >= 1 && width <= 1e9) ||
      !(height >= 1 && height <= 1e9) || width != std::floor(width) || height != std::floor(height))
    return Error{std::string(flag) + ": '" + text + "' is not the size of a picture",
                 "write width and height: 640x480"};
  out.width = static_cast<int>(width);
  out.height = static_cast<int>(height);
  return {};
}

Status read_point(const char* flag, const std::string& text, std::optional<Vec3>& out) {
  if (text.empty()) return {};
  Vec3 point;
  std::size_t from = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = i < 2 ? text.find(',', from) : text.size();
    if (comma == std::string::npos || !parse_number(text.substr(from, comma - from), point[i]) ||
        !(std::abs(point[i]) <= 1e6))
      return Error{std::string(flag) + ": '" + text + "' is not a point",
                   "write x, y and z in metres: 1,2,0.5"};
    from = comma + 1;
  }
  out = point;
  return {};
}

std::vector<std::string> split_list(std::string_view text) {
  std::vector<std::string> out;
  int depth = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size()) {
      depth += text[i] == '(' || text[i] == '[' ? 1 : text[i] == ')' || text[i] == ']' ? -1 : 0;
      if (text[i] != ',' || depth > 0) continue;
    }
    if (const auto part = trim(text.substr(begin, i - begin)); !part.empty()) out.emplace_back(part);
    begin = i + 1;
  }
  return out;
}

}  // namespace sandlot::app
