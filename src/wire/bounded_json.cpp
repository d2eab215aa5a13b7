#include "wire/bounded_json.h"

#include <set>
#include <vector>

namespace sandlot::wire {
namespace {

using Json = nlohmann::json;

/// @return the number of keys
Result<std::size_t> check_size(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.bytes)
    return Error{"a message of " + std::to_string(text.size()) + " bytes",
                 "at most " + std::to_string(limits.bytes)};
  int depth = 0;
  std::size_t marks = 0;  // a bound on the values that parsing makes
  std::size_t keys = 0;
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
    else if (c == ':') ++keys;
    if (depth > limits.depth)
      return Error{"a message nested more than " + std::to_string(limits.depth) + " deep"};
    if (marks > limits.values)
      return Error{"a message of more than " + std::to_string(limits.values) + " values"};
  }
  return keys;
}

/// Members of all objects in a document.
std::size_t members(const Json& document) {
  std::size_t sum = document.is_object() ? document.size() : 0;
  if (document.is_structured())
    for (const Json& each : document) sum += members(each);
  return sum;
}

/// A key that an object has twice. @pre there is one
std::string key_twice(std::string_view text) {
  std::vector<std::set<std::string>> keys;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      twice = parsed.get<std::string>();
    return true;
  };
  const Json document = Json::parse(text, watch, false);
  return document.is_discarded() ? std::string() : twice;
}

}  // namespace

std::string shown(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 60 ? "...'" : "'");
}

Result<Json> read_object(std::string_view text, const JsonLimits& limits) {
  SL_ASSIGN(const std::size_t keys, check_size(text, limits));
  Json document = Json::parse(text, nullptr, false);
  if (document.is_discarded()) return Error{"a message that is not JSON"};
  if (!document.is_object()) return Error{"a message that is not a JSON object"};
  if (members(document) < keys) return Error{"a message with the key " + shown(key_twice(text)) + " twice"};
  return document;
}

}  // namespace sandlot::wire
