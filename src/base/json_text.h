#pragma once
/// Text of JSON as it is printed and written.
#include <nlohmann/json.hpp>
#include <string>

namespace sandlot {

/// Indented by two. Bytes that are not UTF-8 become U+FFFD: names of files and damaged recordings may hold
/// any.
template <class Json>
std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sandlot
