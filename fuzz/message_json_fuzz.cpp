/// Any bytes: the first picks the message type, the rest is JSON. What is read is written as JSON that reads as the same.
#include "base/check.h"
#include "messages/registry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  if (size == 0) return 0;
  const auto types = all_messages();
  const MessageInfo& info = *types[data[0] % types.size()];
  const auto message = message_from_json(info, {reinterpret_cast<const char*>(data) + 1, size - 1});
  if (!message) {
    SL_CHECK(!message.error().what.empty());
    return 0;
  }
  const std::string text = message->to_json();
  const auto again = message_from_json(info, text);
  SL_CHECK(again && again->to_json() == text);
  return 0;
}
