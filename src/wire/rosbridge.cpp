#include "wire/rosbridge.h"

#include <algorithm>
#include <cmath>

#include "base/json_writer.h"
#include "messages/cbor.h"
#include "messages/cdr.h"
#include "messages/command.h"
#include "wire/bounded_json.h"

namespace sandlot::rosbridge {
namespace {

using Json = nlohmann::json;
using wire::shown;

/// One message, with sentences about what is wrong with it.
class Reader {
 public:
  explicit Reader(std::shared_ptr<const Json> object) : object_(std::move(object)) {}

  Result<std::string> text(const char* key, bool required = true) const {
    const auto found = object_->find(key);
    if (found == object_->end() || found->is_null()) {
      if (required) return error(key, "is missing");
      return std::string();
    }
    if (!found->is_string()) return error(key, "is not a text");
    const std::string& text = found->get_ref<const std::string&>();
    if (text.size() > most_name) return error(key, "is longer than " + std::to_string(most_name));
    return text;
  }
  Result<double> number(const char* key, double otherwise, double least, double most) const {
    const auto found = object_->find(key);
    if (found == object_->end() || found->is_null()) return otherwise;
    if (!found->is_number()) return error(key, "is not a number");
    const auto number = found->get<double>();
    if (!(number >= least && number <= most)) return error(key, "is out of its range");
    return number;
  }
  Result<std::size_t> count(const char* key, std::size_t otherwise) const {
    SL_ASSIGN(const double found, number(key, static_cast<double>(otherwise), 0, 1e9));
    return static_cast<std::size_t>(found);
  }
  Body body(const char* key) const {
    const auto found = object_->find(key);
    if (found == object_->end()) return {};
    return Body(std::shared_ptr<const Json>(object_, &*found));
  }
  Error error(const char* key, const std::string& what) const {
    return {"'" + std::string(key) + "' of the message " + what};
  }

 private:
  std::shared_ptr<const Json> object_;
};

Result<std::size_t> fragment_size(const Reader& read) {
  SL_ASSIGN(const std::size_t size, read.count("fragment_size", 0));
  constexpr std::size_t least = 100;
  if (size > 0 && size < least) return read.error("fragment_size", "is below 100");
  return size;
}

Result<Compression> compression(const Reader& read) {
  SL_ASSIGN(const std::string name, read.text("compression", false));
  if (name.empty() || name == "none") return Compression::none;
  if (name == "png") return Compression::png;
  if (name == "cbor") return Compression::cbor;
  if (name == "cbor-raw") return Compression::cbor_raw;
  return read.error("compression", "is none of none, png, cbor, cbor-raw");
}

Result<Operation> operation(const std::string& op, const Reader& read) {
  if (op == "publish") {
    SL_ASSIGN(std::string topic, read.text("topic"));
    Body message = read.body("msg");
    if (!message) return read.error("msg", "is missing");
    return Operation(Publish{std::move(topic), std::move(message)});
  }
  if (op == "advertise") {
    SL_ASSIGN(std::string topic, read.text("topic"));
    SL_ASSIGN(std::string type, read.text("type"));
    return Operation(Advertise{std::move(topic), std::move(type)});
  }
  if (op == "unadvertise") {
    SL_ASSIGN(std::string topic, read.text("topic"));
    return Operation(Unadvertise{std::move(topic)});
  }
  if (op == "subscribe") {
    Subscribe out;
    SL_ASSIGN(out.topic, read.text("topic"));
    SL_ASSIGN(out.type, read.text("type", false));
    SL_ASSIGN(const double throttle_ms, read.number("throttle_rate", 0, 0, 1e9));
    out.throttle_s = throttle_ms / 1000;
    SL_ASSIGN(out.fragment_size, fragment_size(read));
    SL_ASSIGN(out.compression, compression(read));
    return Operation(std::move(out));
  }
  if (op == "unsubscribe") {
    SL_ASSIGN(std::string topic, read.text("topic"));
    return Operation(Unsubscribe{std::move(topic)});
  }
  if (op == "call_service") {
    CallService out;
    SL_ASSIGN(out.service, read.text("service"));
    out.args = read.body("args");
    SL_ASSIGN(out.fragment_size, fragment_size(read));
    SL_ASSIGN(out.compression, compression(read));
    return Operation(std::move(out));
  }
  if (op == "set_level" || op == "status_level") {
    SL_ASSIGN(const std::string name, read.text("level"));
    constexpr std::string_view names[] = {"info", "warning", "error", "none"};
    for (std::size_t i = 0; i < std::size(names); ++i)
      if (name == names[i]) return Operation(SetLevel{static_cast<Level>(i)});
    return read.error("level", "is none of info, warning, error, none");
  }
  if (op == "fragment") {
    Fragment out;
    const Body data = read.body("data");
    SL_ASSIGN(out.number, read.count("num", 0));
    SL_ASSIGN(out.total, read.count("total", 0));
    if (!data) return read.error("data", "is missing");
    const Json document = Json::parse(data.text(), nullptr, false);
    if (!document.is_string()) return read.error("data", "is not a text");
    out.data = document.get<std::string>();
    return Operation(std::move(out));
  }
  if (op == "sandlot.claim") {
    Claim out;
    SL_ASSIGN(out.robot, read.text("robot", false));
    SL_ASSIGN(out.team, read.text("team", false));
    SL_ASSIGN(out.token, read.text("token", false));
    SL_ASSIGN(const std::string mode, read.text("mode", false));
    if (out.robot.empty() == out.team.empty()) return Error{"a claim names either 'robot' or 'team'"};
    if (!mode.empty() && mode != "free" && mode != "lockstep")
      return read.error("mode", "is neither free nor lockstep");
    out.lockstep = mode == "lockstep";
    SL_ASSIGN(const double deadline_ms, read.number("deadline_ms", 1000, 1, 60'000));
    out.deadline_s = deadline_ms / 1000;
    SL_ASSIGN(out.name, read.text("name", false));
    return Operation(std::move(out));
  }
  if (op == "sandlot.done") {
    Done out;
    SL_ASSIGN(const double step, read.number("step", -1, 0, 1e15));
    if (step < 0) return read.error("step", "is missing");
    out.step = static_cast<std::uint64_t>(step);
    SL_ASSIGN(out.program, read.text("program", false));
    out.orders = read.body("orders");
    out.samples = read.body("samples");
    return Operation(std::move(out));
  }
  if (op == "sandlot.release") return Operation(Release{});
  if (op == "sandlot.hello") return Operation(Hello{});
  return Operation(Other{op});
}

Result<ClientMessage> read_document(Json document) {
  const auto object = std::make_shared<const Json>(std::move(document));
  const Reader read(object);
  ClientMessage out;
  SL_ASSIGN(const std::string op, read.text("op"));
  // Some clients send numbers here.
  const auto id = object->find("id");
  if (id != object->end() && id->is_number()) out.id = id->dump();
  else { SL_ASSIGN(out.id, read.text("id", false)); }
  SL_ASSIGN(out.operation, operation(op, read));
  return out;
}

void append(std::vector<std::byte>& out, std::initializer_list<unsigned> bytes) {
  for (const unsigned each : bytes) out.push_back(static_cast<std::byte>(each));
}

/// Head of a CBOR item: major type and a length.
void append_head(std::vector<std::byte>& out, unsigned major, std::uint64_t length) {
  if (length < 24) return append(out, {major << 5 | static_cast<unsigned>(length)});
  const int bytes = length < 1u << 8 ? 1 : length < 1u << 16 ? 2 : length < 1ull << 32 ? 4 : 8;
  append(out, {major << 5 | static_cast<unsigned>(bytes == 1 ? 24 : bytes == 2 ? 25 : bytes == 4 ? 26 : 27)});
  for (int i = bytes - 1; i >= 0; --i) append(out, {static_cast<unsigned>(length >> (8 * i) & 0xff)});
}

void append_text(std::vector<std::byte>& out, std::string_view text) {
  append_head(out, 3, text.size());
  const auto bytes = std::as_bytes(std::span(text));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void begin_publish(std::vector<std::byte>& out, std::string_view topic) {
  append_head(out, 5, 3);
  append_text(out, "op");
  append_text(out, "publish");
  append_text(out, "topic");
  append_text(out, topic);
  append_text(out, "msg");
}

}  // namespace

Result<std::vector<std::byte>> Body::to_cdr(const MessageInfo& info) const {
  AnyMessage message(info);
  // Services may get their arguments as a list, in the order of the fields.
  if (document_ && document_->is_array()) {
    Json object = Json::object();
    if (document_->size() > info.fields.size())
      return Error{"there are " + std::to_string(document_->size()) + " arguments, and " + info.name +
                   " has " + std::to_string(info.fields.size())};
    for (std::size_t i = 0; i < document_->size(); ++i) object[info.fields[i].name] = (*document_)[i];
    SL_TRY(read_json(info, object, message.data()));
  } else if (document_ && !document_->is_null()) {
    SL_TRY(read_json(info, *document_, message.data()));
  }
  std::vector<std::byte> out;
  message.to_cdr(out);
  return out;
}

Result<std::vector<std::byte>> Body::to_command(const TopicBase& slot) const {
  return command_from_document(slot, document_ ? *document_ : Json());
}

std::string Body::text() const {
  return document_ ? document_->dump(-1, ' ', false, Json::error_handler_t::replace) : "null";
}

Result<ClientMessage> read_text(std::string_view text) {
  SL_ASSIGN(Json document, wire::read_object(text, {.bytes = most_bytes}));
  return read_document(std::move(document));
}

Result<ClientMessage> read_binary(std::span<const std::byte> cbor) {
  if (cbor.size() > most_bytes)
    return Error{"a message of " + std::to_string(cbor.size()) + " bytes",
                 "at most " + std::to_string(most_bytes)};
  SL_ASSIGN(Json document, parse_cbor(cbor));
  if (!document.is_object()) return Error{"a message that is not a map"};
  return read_document(std::move(document));
}

std::string quoted(std::string_view text) {
  std::string out;
  append_json(text, out);
  return out;
}

std::string status(Level level, std::string_view message, std::string_view id) {
  constexpr const char* names[] = {"info", "warning", "error", "none"};
  std::string out;
  JsonWriter w(out);
  w.object([&] {
    w.key("op").text("status");
    w.key("level").text(names[static_cast<std::size_t>(level)]);
    w.key("msg").text(message);
    if (!id.empty()) w.key("id").text(id);
  });
  return out;
}

std::string publish_json(std::string_view topic, const MessageInfo& info, std::span<const std::byte> cdr) {
  std::string out, message;
  const Status written = cdr_to_json(info, cdr, message);
  SL_CHECK_MSG(written, "a message of our own that its type cannot read");
  JsonWriter w(out);
  w.object([&] {
    w.key("op").text("publish");
    w.key("topic").text(topic);
    w.key("msg").raw(message);
  });
  return out;
}

std::vector<std::byte> publish_cbor(std::string_view topic, const MessageInfo& info,
                                    std::span<const std::byte> cdr) {
  std::vector<std::byte> out, message;
  begin_publish(out, topic);
  const Status written = cdr_to_cbor(info, cdr, message);
  SL_CHECK_MSG(written, "a message of our own that its type cannot read");
  out.insert(out.end(), message.begin(), message.end());
  return out;
}

std::vector<std::byte> publish_cbor_raw(std::string_view topic, Time stamp, std::span<const std::byte> cdr) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  std::vector<std::byte> out;
  begin_publish(out, topic);
  append_head(out, 5, 3);
  append_text(out, "secs");
  append_head(out, 0, static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamp.ns / second_ns)));
  append_text(out, "nsecs");
  append_head(out, 0, static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamp.ns % second_ns)));
  append_text(out, "bytes");
  append_head(out, 2, cdr.size());
  out.insert(out.end(), cdr.begin(), cdr.end());
  return out;
}

std::string service_response(std::string_view service, std::string_view id, std::string_view values,
                             bool result) {
  std::string out;
  JsonWriter w(out);
  w.object([&] {
    w.key("op").text("service_response");
    w.key("service").text(service);
    if (!id.empty()) w.key("id").text(id);
    w.key("values").raw(values);
    w.key("result").flag(result);
  });
  return out;
}

std::string value_of(const Body& args, const char* key) {
  constexpr std::size_t longest = 1000;
  if (!args || !args.document()->is_object()) return "";
  const auto found = args.document()->find(key);
  if (found == args.document()->end() || found->is_null()) return "";
  const auto dumped = [](const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  if (!found->is_string()) return dumped(*found);
  const std::string& text = found->get_ref<const std::string&>();
  if (text.empty() || text.size() > longest) return "";
  const Json inner = Json::parse(text, nullptr, false);
  return dumped(inner.is_discarded() ? *found : inner);
}

std::string text_of(const Body& args, const char* key) {
  if (!args || !args.document()->is_object()) return {};
  const auto found = args.document()->find(key);
  return found != args.document()->end() && found->is_string() ? found->get<std::string>() : "";
}

std::string tick(std::string_view program, std::uint64_t step, Time now, std::uint64_t random) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  std::string out;
  JsonWriter w(out);
  w.object([&] {
    w.key("op").text("sandlot.tick");
    w.key("program").text(program);
    w.key("step").integer(step);
    w.key("time").object([&] {
      w.key("sec").integer(now.ns / second_ns);
      w.key("nanosec").integer(now.ns % second_ns);
    });
    w.key("random").text(std::to_string(random));
  });
  return out;
}

std::vector<std::string> fragments(std::string_view text, std::size_t size, std::string_view id) {
  std::vector<std::string> out;
  const std::size_t total = (text.size() + size - 1) / size;
  for (std::size_t at = 0, number = 0; number < total; ++number) {
    std::size_t length = std::min(size, text.size() - at);
    if (number + 1 == total) length = text.size() - at;
    // Not within a character.
    while (at + length < text.size() && length > 1 &&
           (static_cast<unsigned char>(text[at + length]) & 0xc0) == 0x80)
      --length;
    std::string& made = out.emplace_back();
    JsonWriter w(made);
    w.object([&] {
      w.key("op").text("fragment");
      w.key("id").text(id);
      w.key("data").text(text.substr(at, length));
      w.key("num").integer(number);
      w.key("total").integer(total);
    });
    at += length;
  }
  return out;
}

}  // namespace sandlot::rosbridge
