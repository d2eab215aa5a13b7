/// Any bytes, as a text, as CBOR and as a stream of objects of a rosbridge client: one error sentence, or a message within the
/// limits; what a stream hands out in pieces is what it hands out at once.
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "messages/messages.h"
#include "messages/services.h"
#include "wire/json_stream.h"
#include "wire/rosbridge.h"

namespace {

using namespace sandlot;
using namespace sandlot::rosbridge;

void check(const Result<ClientMessage>& message) {
  if (!message) {
    SL_CHECK(!message.error().what.empty());
    SL_CHECK(message.error().text().size() < 400);
    return;
  }
  SL_CHECK(message->id.size() <= most_name + 32);
  if (const auto* const publish = std::get_if<Publish>(&message->operation)) {
    SL_CHECK(publish->topic.size() <= most_name);
    (void)publish->message.to_cdr(message_info<msg::Twist>());
    (void)publish->message.text();
  }
  if (const auto* const call = std::get_if<CallService>(&message->operation)) {
    const auto cdr = call->args.to_cdr(message_info<msg::Console::Request>());
    if (cdr) SL_CHECK(message_from_cdr(message_info<msg::Console::Request>(), *cdr));
    (void)text_of(call->args, "topic");
  }
  if (const auto* const subscribe = std::get_if<Subscribe>(&message->operation))
    SL_CHECK(subscribe->fragment_size == 0 || subscribe->fragment_size >= 100);
  if (const auto* const claim = std::get_if<Claim>(&message->operation))
    SL_CHECK(claim->robot.empty() != claim->team.empty() && claim->deadline_s > 0);
}

std::vector<std::string> objects(std::string_view text, std::size_t piece) {
  wire::JsonStream stream(4096);
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    stream.append(text.substr(at, piece));
    while (true) {
      const auto next = stream.next();
      if (!next) return out.emplace_back("refused"), out;
      if (!*next) break;
      out.emplace_back(**next);
    }
    SL_CHECK(stream.waiting() <= 4096 + text.size());
  }
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check(read_text(text));
  check(read_binary(std::as_bytes(std::span(data, size))));
  const auto whole = objects(text, std::max<std::size_t>(1, size)), pieces = objects(text, 3);
  SL_CHECK(whole == pieces);
  std::string joined;
  // The library takes a zero byte for the end of a text.
  if (!text.empty() && text.find('\0') == text.npos && nlohmann::json::accept(text)) {
    for (const std::string& each : fragments(text, 100, "x"))
      joined += nlohmann::json::parse(each)["data"].get<std::string>();
    SL_CHECK(joined == text);
  }
  return 0;
}
