#include "base/values.h"

#include <cctype>
#include <charconv>

namespace sandlot {

Result<ValuePath> parse_value_path(std::string_view text) {
  constexpr std::size_t most_steps = 16, longest = 256;
  const auto wrong = [&](const std::string& what) {
    return Error{"'" + std::string(text.substr(0, 80)) + "' is no path of a value: " + what,
                 "such as ranges[3] or pose.position.x"};
  };
  if (text.empty() || text.size() > longest) return wrong(text.empty() ? "it is empty" : "it is too long");
  const auto in_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  ValuePath path;
  for (std::size_t at = 0; at < text.size();) {
    if (path.size() == most_steps) return wrong("more than " + std::to_string(most_steps) + " steps");
    if (text[at] == '[') {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(text.data() + at + 1, text.data() + text.size(), index);
      if (error != std::errc() || end == text.data() + text.size() || *end != ']')
        return wrong("'[' needs a number and ']'");
      path.push_back({"", index});
      at = static_cast<std::size_t>(end - text.data()) + 1;
    } else {
      if (!path.empty() && text[at] != '.') return wrong("expected '.' or '['");
      if (!path.empty()) ++at;
      const std::size_t begin = at;
      while (at < text.size() && in_name(text[at])) ++at;
      if (at == begin) return wrong("a name is missing");
      path.push_back({std::string(text.substr(begin, at - begin))});
    }
  }
  return path;
}

std::string to_string(std::span<const ValueStep> path) {
  std::string text;
  for (const ValueStep& step : path)
    text += step.key.empty() ? "[" + std::to_string(step.index) + "]" : (text.empty() ? "" : ".") + step.key;
  return text;
}

}  // namespace sandlot
