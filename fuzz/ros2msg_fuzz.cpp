/// Any bytes: up to the first NUL a schema, behind it the CDR of a message of that type. A schema that is accepted has
/// fields with names and types within the limits, and the bytes are walked through or refused by every reader alike.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "base/check.h"
#include "messages/cbor.h"
#include "messages/dynamic.h"
#include "messages/json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(all.find('\0'), all.size());
  const auto schema = DynamicSchema::parse("my_msgs/LabelledObject", all.substr(0, end));
  if (!schema) {
    SL_CHECK(!schema.error().what.empty());
    return 0;
  }
  for (const MessageField& field : schema->info().fields) {
    SL_CHECK(!field.name.empty());
    SL_CHECK((field.type == Wire::message) == (field.message != nullptr));
  }
  const auto cdr = std::as_bytes(std::span(data, size)).subspan(std::min(end + 1, size));
  std::string json;
  std::vector<std::byte> cbor;
  const bool walked = static_cast<bool>(cdr_to_json(schema->info(), cdr, json));
  SL_CHECK(walked == static_cast<bool>(cdr_to_cbor(schema->info(), cdr, cbor)));
  std::size_t longest = 0;
  const Status visited = visit_values(schema->info(), cdr, [&](std::string_view path, const MessageValue&) {
    longest = std::max(longest, path.size());
  });
  SL_CHECK(walked == static_cast<bool>(visited));
  SL_CHECK(!walked || parse_cbor(cbor));
  return 0;
}
