#include "server/clients/call.h"

#include "messages/cdr.h"
#include "messages/json.h"
#include "server/clients/hub.h"

namespace sandlot::server {

void Call::answer(const MessageInfo& info, const void* response) {
  if (answered_.exchange(true)) return;
  std::vector<std::byte> bytes;
  write_cdr(info, response, bytes);
  if (encoding_ == "json") {
    std::string text;
    const Status written = cdr_to_json(info, bytes, text);
    SL_CHECK_MSG(written, "what was written just now can be read");
    const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
    bytes.assign(begin, begin + text.size());
  }
  send(std::make_shared<const std::vector<std::byte>>(
           foxglove::service_response(service_, id_, encoding_, bytes)),
       false);
}

void Call::fail(std::string_view why) {
  if (answered_.exchange(true)) return;
  const std::string text = foxglove::service_failure(service_, id_, why);
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  send(std::make_shared<const std::vector<std::byte>>(begin, begin + text.size()), true);
}

void Call::send(Payload bytes, bool text) {
  mailbox_->put(
      [client = client_, bytes = std::move(bytes), text](Hub& hub) { hub.answer(client, bytes, text); });
}

}  // namespace sandlot::server
