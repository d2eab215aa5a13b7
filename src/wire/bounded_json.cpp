#include "wire/bounded_json.h"

#include <set>
#include <vector>

namespace sandlot::wire {
namespace {

using Json = nlohmann::json;

Status check_size(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.bytes)
    return Error{"a message of " + std::to_string(text.size()) + " bytes",
                 "at most " + std::to_string(limits.bytes)};
  int depth = 0;
  std::size_t marks = 0;  // a bound on the values that parsing makes
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      else if (c == '"') quoted = false;
      continue;
    }
    if (c == '"') quoted = true;
    else if (c == '[' || c == '{') ++depth, ++marks;
    else if (c == ']' || c == '}') --depth;
    else if (c == ',') ++marks;
    if (depth > limits.depth)
      return Error{"a message nested more than " + std::to_string(limits.depth) + " deep"};
    if (marks > limits.values)
      return Error{"a message of more than " + std::to_string(limits.values) + " values"};
  }
  return {};
}

}  // namespace

std::string shown(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 60 ? "...'" : "'");
}

Result<Json> read_object(std::string_view text, const JsonLimits& limits) {
  SL_TRY(check_size(text, limits));
  std::vector<std::set<std::string>> keys;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      twice = parsed.get<std::string>();
    return true;
  };
  Json document = Json::parse(text, watch, false);
  if (document.is_discarded()) return Error{"a message that is not JSON"};
  if (!document.is_object()) return Error{"a message that is not a JSON object"};
  if (!twice.empty()) return Error{"a message with the key " + shown(twice) + " twice"};
  return document;
}

}  // namespace sandlot::wire
