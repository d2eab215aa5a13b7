/// Any bytes: the first picks the message type, the rest is its CDR. What is read is written again as bytes that read as
/// the same; the walk through the bytes, which knows nothing of C++, accepts what the reader accepts and nothing else.
#include <string>

#include "base/check.h"
#include "messages/cbor.h"
#include "messages/cdr.h"
#include "messages/json.h"
#include "messages/registry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  if (size == 0) return 0;
  const auto types = all_messages();
  const MessageInfo& info = *types[data[0] % types.size()];
  const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
  const auto message = message_from_cdr(info, bytes);
  std::string json;
  std::vector<std::byte> cbor;
  const bool walked = static_cast<bool>(cdr_to_json(info, bytes, json));
  SL_CHECK(walked == static_cast<bool>(message));
  SL_CHECK(walked == static_cast<bool>(cdr_to_cbor(info, bytes, cbor)));
  if (!message) {
    SL_CHECK(!message.error().what.empty());
    return 0;
  }
  std::vector<std::byte> first, second;
  message->to_cdr(first);
  const auto again = message_from_cdr(info, first);
  SL_CHECK(again);
  again->to_cdr(second);
  SL_CHECK(first == second);
  const auto from_json = message_from_json(info, message->to_json());
  SL_CHECK(from_json && from_json->to_json() == message->to_json());
  SL_CHECK(message_from_cbor(info, cbor));
  return 0;
}
