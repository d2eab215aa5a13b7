/// Any bytes: the first picks the message type, the rest is CBOR. What is read is written as CBOR that reads as the same.
#include "base/check.h"
#include "messages/registry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  if (size == 0) return 0;
  const auto types = all_messages();
  const MessageInfo& info = *types[data[0] % types.size()];
  const auto message = message_from_cbor(info, std::as_bytes(std::span(data + 1, size - 1)));
  if (!message) {
    SL_CHECK(!message.error().what.empty());
    return 0;
  }
  std::vector<std::byte> first, second;
  message->to_cbor(first);
  const auto again = message_from_cbor(info, first);
  SL_CHECK(again);
  again->to_cbor(second);
  SL_CHECK(first == second);
  return 0;
}
