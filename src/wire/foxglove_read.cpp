#include "wire/foxglove.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/bytes.h"
#include "base/text.h"
#include "wire/bounded_json.h"

namespace sandlot::foxglove {
namespace {

using Json = nlohmann::json;

using wire::shown;

/// Commas and brackets in one text: a bound on the values that parsing it makes.
constexpr std::size_t most_marks = 8 * most_entries;

Result<Json> parse(std::string_view text) {
  return wire::read_object(text, {.bytes = most_text_bytes, .values = most_marks});
}

/// One message, with sentences about what is wrong with it.
class Reader {
 public:
  Reader(const Json& object, std::string name) : object_(object), name_(std::move(name)) {}
  Error error(std::string what) const { return Error{name_ + ": " + std::move(what)}; }

  Result<std::uint32_t> number(const char* key) const {
    const auto found = object_.find(key);
    if (found == object_.end()) return error("'" + std::string(key) + "' is missing");
    return id(*found, key);
  }
  /// "" when it may be missing and is.
  Result<std::string> text(const char* key, bool required) const {
    const auto found = object_.find(key);
    if (found == object_.end())
      return required ? Result<std::string>(error("'" + std::string(key) + "' is missing")) : std::string();
    return name(*found, key);
  }
  Result<std::vector<std::uint32_t>> numbers(const char* key) const {
    SL_ASSIGN(const Json* const list, this->list(key));
    std::vector<std::uint32_t> out;
    out.reserve(list->size());
    for (const Json& each : *list) { SL_ASSIGN(out.emplace_back(), id(each, key)); }
    SL_TRY(no_two(out, key));
    return out;
  }
  Result<std::vector<std::string>> texts(const char* key) const {
    SL_ASSIGN(const Json* const list, this->list(key));
    std::vector<std::string> out;
    out.reserve(list->size());
    for (const Json& each : *list) { SL_ASSIGN(out.emplace_back(), name(each, key)); }
    return out;
  }
  /// Calls take(reader of the object) for each object of a list.
  template <class Take>
  Status objects(const char* key, Take&& take) const {
    SL_ASSIGN(const Json* const list, this->list(key));
    std::size_t place = 0;
    for (const Json& each : *list) {
      const std::string path = name_ + ": " + key + "[" + std::to_string(place++) + "]";
      if (!each.is_object()) return Error{path + " is not an object"};
      SL_TRY(take(Reader(each, path)));
    }
    return {};
  }
  Status no_two(std::vector<std::uint32_t> ids, const char* key) const {
    std::sort(ids.begin(), ids.end());
    const auto twice = std::adjacent_find(ids.begin(), ids.end());
    if (twice == ids.end()) return {};
    return error("'" + std::string(key) + "' has " + std::to_string(*twice) + " twice");
  }
  const Json* find(const char* key) const {
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }

 private:
  Result<std::uint32_t> id(const Json& value, const char* key) const {
    if (value.is_number_unsigned() && value.get<std::uint64_t>() <= 0xFFFFFFFFu)
      return static_cast<std::uint32_t>(value.get<std::uint64_t>());
    return error("'" + std::string(key) + "' must be a whole number from 0 to 4294967295");
  }
  Result<std::string> name(const Json& value, const char* key) const {
    if (!value.is_string()) return error("'" + std::string(key) + "' must be a text");
    const auto& text = value.get_ref<const std::string&>();
    if (text.size() > most_name_bytes)
      return error("'" + std::string(key) + "' is longer than " + std::to_string(most_name_bytes) + " bytes");
    return text;
  }
  Result<const Json*> list(const char* key) const {
    const auto found = object_.find(key);
    if (found == object_.end()) return error("'" + std::string(key) + "' is missing");
    if (!found->is_array()) return error("'" + std::string(key) + "' must be a list");
    if (found->size() > most_entries)
      return error("'" + std::string(key) + "' has more than " + std::to_string(most_entries) + " entries");
    return &*found;
  }
  const Json& object_;
  std::string name_;
};

Status read_parameter_value(const Reader& in, Parameter& out) {
  const Json* const value = in.find("value");
  if (!value || value->is_null()) return {};
  if (value->is_boolean()) return out.value = value->get<bool>(), Status();
  if (value->is_number()) return out.value = value->get<double>(), Status();
  if (value->is_string()) return out.value = value->get<std::string>(), Status();
  if (!value->is_array()) return in.error("'value' must be a number, a text, true, false, or a list");
  if (!value->empty() && value->front().is_string()) {
    auto& texts = out.value.emplace<std::vector<std::string>>();
    for (const Json& each : *value) {
      if (!each.is_string()) return in.error("'value' mixes texts with other things");
      texts.push_back(each.get<std::string>());
    }
    return {};
  }
  auto& numbers = out.value.emplace<std::vector<double>>();
  for (const Json& each : *value) {
    if (!each.is_number()) return in.error("'value' must be a list of numbers, or of texts");
    numbers.push_back(each.get<double>());
  }
  return {};
}

Result<Parameter> read_parameter(const Reader& in) {
  Parameter out;
  SL_ASSIGN(out.name, in.text("name", true));
  SL_ASSIGN(out.type, in.text("type", false));
  SL_TRY(read_parameter_value(in, out));
  const auto is = [&]<class T>(const T*) { return std::holds_alternative<T>(out.value); };
  const bool none = is(static_cast<std::monostate*>(nullptr));
  const bool fits = none || out.type.empty() ||
                    (out.type == "float64" && is(static_cast<double*>(nullptr))) ||
                    (out.type == "float64_array" && is(static_cast<std::vector<double>*>(nullptr))) ||
                    (out.type == "byte_array" && is(static_cast<std::string*>(nullptr)));
  if (!fits)
    return in.error("'value' is no " + shown(out.type) +
                    " (types are float64, float64_array, byte_array, or none)");
  return out;
}

using Decoded = Result<ClientMessage>;

Decoded read_subscribe(const Reader& in) {
  Subscribe out;
  std::vector<std::uint32_t> ids;
  SL_TRY(in.objects("subscriptions", [&](const Reader& each) -> Status {
    Subscribe::Each one;
    SL_ASSIGN(one.id, each.number("id"));
    SL_ASSIGN(one.channel, each.number("channelId"));
    ids.push_back(one.id);
    out.subscriptions.push_back(one);
    return {};
  }));
  SL_TRY(in.no_two(std::move(ids), "subscriptions"));
  return ClientMessage(std::move(out));
}

Decoded read_advertise(const Reader& in) {
  Advertise out;
  std::vector<std::uint32_t> ids;
  SL_TRY(in.objects("channels", [&](const Reader& each) -> Status {
    Advertise::Each one;
    SL_ASSIGN(one.id, each.number("id"));
    SL_ASSIGN(one.topic, each.text("topic", true));
    SL_ASSIGN(one.encoding, each.text("encoding", true));
    SL_ASSIGN(one.schema_name, each.text("schemaName", false));
    ids.push_back(one.id);
    out.channels.push_back(std::move(one));
    return {};
  }));
  SL_TRY(in.no_two(std::move(ids), "channels"));
  return ClientMessage(std::move(out));
}

Decoded read_set_parameters(const Reader& in) {
  SetParameters out;
  SL_ASSIGN(out.id, in.text("id", false));
  std::set<std::string> names;
  SL_TRY(in.objects("parameters", [&](const Reader& each) -> Status {
    SL_ASSIGN(Parameter one, read_parameter(each));
    if (!names.insert(one.name).second) return each.error(shown(one.name) + " is set twice");
    out.parameters.push_back(std::move(one));
    return {};
  }));
  return ClientMessage(std::move(out));
}

template <class T>
Decoded made(Result<T> message) {
  if (!message) return std::move(message.error());
  return ClientMessage(std::move(*message));
}

Decoded read_unsubscribe(const Reader& in) {
  SL_ASSIGN(auto ids, in.numbers("subscriptionIds"));
  return ClientMessage(Unsubscribe{std::move(ids)});
}
Decoded read_unadvertise(const Reader& in) {
  SL_ASSIGN(auto ids, in.numbers("channelIds"));
  return ClientMessage(Unadvertise{std::move(ids)});
}
Decoded read_get_parameters(const Reader& in) {
  GetParameters out;
  SL_ASSIGN(out.names, in.texts("parameterNames"));
  SL_ASSIGN(out.id, in.text("id", false));
  return ClientMessage(std::move(out));
}
Decoded read_subscribe_parameters(const Reader& in, bool subscribe) {
  SL_ASSIGN(auto names, in.texts("parameterNames"));
  return ClientMessage(SubscribeParameters{std::move(names), subscribe});
}
Decoded read_fetch_asset(const Reader& in) {
  FetchAsset out;
  SL_ASSIGN(out.uri, in.text("uri", true));
  SL_ASSIGN(out.request, in.number("requestId"));
  return ClientMessage(std::move(out));
}

struct Operation {
  const char* name;
  Decoded (*read)(const Reader&);
};
const Operation operations[] = {
    {"subscribe", read_subscribe},
    {"unsubscribe", read_unsubscribe},
    {"advertise", read_advertise},
    {"unadvertise", read_unadvertise},
    {"getParameters", read_get_parameters},
    {"setParameters", read_set_parameters},
    {"subscribeParameterUpdates", [](const Reader& in) { return read_subscribe_parameters(in, true); }},
    {"unsubscribeParameterUpdates", [](const Reader& in) { return read_subscribe_parameters(in, false); }},
    {"subscribeConnectionGraph",
     [](const Reader&) -> Decoded { return ClientMessage(SubscribeGraph{true}); }},
    {"unsubscribeConnectionGraph",
     [](const Reader&) -> Decoded { return ClientMessage(SubscribeGraph{false}); }},
    {"fetchAsset", read_fetch_asset},
};

/// The text whose length is in the next 4 bytes.
bool read_counted(ByteReader& r, std::string& out) {
  std::uint32_t size = 0;
  read(r, size);
  if (size > most_name_bytes) return r.fail(), false;
  const auto bytes = r.take(size);
  out.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return r.ok();
}

Result<PlaybackControl> read_playback(ByteReader& r) {
  PlaybackControl out;
  std::uint8_t command = 0, has_seek = 0;
  float speed = 0;
  std::uint64_t seek = 0;
  read(r, command), read(r, speed), read(r, has_seek), read(r, seek);
  if (!read_counted(r, out.id) || r.remaining() != 0)
    return Error{"a playback control (binary op 3) whose length is wrong"};
  if (command > 1) return Error{"a playback control with the command " + std::to_string(command), "0 or 1"};
  if (!std::isfinite(speed)) return Error{"a playback control whose speed is not a number"};
  out.play = command == 0;
  out.speed = speed;
  if (has_seek) out.seek_ns = seek;
  return out;
}

}  // namespace

Result<ClientMessage> read_text(std::string_view text) {
  SL_ASSIGN(const Json document, parse(text));
  const auto op = document.find("op");
  if (op == document.end() || !op->is_string()) return Error{"a message without an 'op'"};
  const auto& name = op->get_ref<const std::string&>();
  for (const Operation& each : operations)
    if (name == each.name) return each.read(Reader(document, name));
  std::vector<std::string> known;
  for (const Operation& each : operations) known.emplace_back(each.name);
  return Error{"there is no op " + shown(name), suggestion(name, known)};
}

Result<ClientMessage> read_binary(std::span<const std::byte> bytes) {
  if (bytes.size() > most_binary_bytes)
    return Error{"a message of " + std::to_string(bytes.size()) + " bytes",
                 "at most " + std::to_string(most_binary_bytes)};
  ByteReader r(bytes);
  std::uint8_t op = 0;
  read(r, op);
  if (!r.ok()) return Error{"a message without a byte"};
  if (op == 1) {
    ClientData out;
    read(r, out.channel);
    if (!r.ok()) return Error{"client data (binary op 1) that ends before its payload"};
    out.bytes = r.take(r.remaining());
    return ClientMessage(out);
  }
  if (op == 2) {
    CallService out;
    read(r, out.service), read(r, out.call);
    if (!read_counted(r, out.encoding))
      return Error{"a service request (binary op 2) that ends before its payload"};
    out.bytes = r.take(r.remaining());
    return ClientMessage(std::move(out));
  }
  if (op == 3) return made(read_playback(r));
  return Error{"there is no binary op " + std::to_string(op), "known are 1 to 3"};
}

}  // namespace sandlot::foxglove
