/// Any bytes, as a text and as a binary message of a client: one error sentence, or a message within the limits; parameters that
/// were read are written as what reads as the same.
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "wire/foxglove.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  using namespace sandlot::foxglove;
  const std::span bytes(data, size);
  const auto check = [&](const Result<ClientMessage>& message) {
    if (message) return;
    SL_CHECK(!message.error().what.empty());
    SL_CHECK(message.error().text().size() < 400);
  };
  const auto text = read_text({reinterpret_cast<const char*>(data), size});
  check(text);
  check(read_binary(std::as_bytes(bytes)));
  if (!text) return 0;
  if (const auto* const subscribe = std::get_if<Subscribe>(&*text))
    SL_CHECK(subscribe->subscriptions.size() <= most_entries);
  const auto* const set = std::get_if<SetParameters>(&*text);
  if (!set) return 0;
  const std::string said = parameter_values(set->parameters, set->id);
  auto document = nlohmann::json::parse(said);
  document["op"] = "setParameters";
  const std::string sent = document.dump();
  if (sent.size() > most_text_bytes) return 0;  // escapes and numbers may have become longer
  const auto again = read_text(sent);
  SL_CHECK(again);
  const auto& back = std::get<SetParameters>(*again);
  SL_CHECK(parameter_values(back.parameters, back.id) == said);
  return 0;
}
