#include "messages/json.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/base64.h"
#include "base/json_writer.h"
#include "base/text.h"
#include "base/time.h"
#include "messages/cdr.h"
#include "messages/typed_array.h"

namespace sandlot {
namespace {

using Json = nlohmann::json;
using Count = MessageField::Count;

template <class T>
T number_of_type(const std::byte* value) {
  T number;
  std::memcpy(&number, value, sizeof number);
  return number;
}

void write_number(JsonWriter& w, Wire type, const std::byte* value) {
  switch (type) {
    case Wire::boolean: w.flag(*value != std::byte{0}); break;
    case Wire::byte:
    case Wire::character:
    case Wire::uint8: w.integer(number_of_type<std::uint8_t>(value)); break;
    case Wire::int8: w.integer(number_of_type<std::int8_t>(value)); break;
    case Wire::int16: w.integer(number_of_type<std::int16_t>(value)); break;
    case Wire::uint16: w.integer(number_of_type<std::uint16_t>(value)); break;
    case Wire::int32: w.integer(number_of_type<std::int32_t>(value)); break;
    case Wire::uint32: w.integer(number_of_type<std::uint32_t>(value)); break;
    case Wire::int64: w.integer(number_of_type<std::int64_t>(value)); break;
    case Wire::uint64: w.integer(number_of_type<std::uint64_t>(value)); break;
    case Wire::float32: w.number(number_of_type<float>(value)); break;
    case Wire::float64: w.number(number_of_type<double>(value)); break;
    case Wire::string:
    case Wire::message: break;
  }
}

/// Writes what a walk through a message meets.
class MessageWriter : public CdrVisitor {
 public:
  explicit MessageWriter(std::string& out) : json_(out) { out.clear(); }
  void open(const MessageInfo&) override { json_.begin_object(); }
  void close() override { json_.end_object(); }
  void field(const MessageField& field) override { json_.key(field.name); }
  void open_list(std::size_t) override { json_.begin_list(); }
  void close_list() override { json_.end_list(); }
  void text(std::string_view text) override { json_.text(text); }
  void number(Wire type, const std::byte* value) override { write_number(json_, type, value); }
  void numbers(Wire type, std::span<const std::byte> bytes) override {
    if (is_octet(type)) {
      std::string text = "\"";
      add_base64(bytes, text);
      return json_.raw(text += '"');
    }
    json_.begin_list();
    for (std::size_t i = 0; i < bytes.size(); i += size_of(type)) write_number(json_, type, &bytes[i]);
    json_.end_list();
  }

 private:
  JsonWriter json_;
};

std::string kind_of(const Json& value) {
  if (value.is_number()) return value.dump();
  return value.is_binary() ? "bytes" : value.type_name();
}
Error wrong(Wire type, const Json& value) {
  return {"must be " + std::string(name_of(type)) + ", is " + kind_of(value)};
}

template <class T>
bool integer_from(const Json& value, T& out) {
  using Limits = std::numeric_limits<T>;
  if (value.is_number_unsigned()) {
    const auto x = value.get<std::uint64_t>();
    out = static_cast<T>(x);
    return x <= static_cast<std::uint64_t>(Limits::max());
  }
  if (value.is_number_integer()) {
    const auto x = value.get<std::int64_t>();
    out = static_cast<T>(x);
    return x < 0 ? std::is_signed_v<T> && x >= static_cast<std::int64_t>(Limits::min())
                 : static_cast<std::uint64_t>(x) <= static_cast<std::uint64_t>(Limits::max());
  }
  if (!value.is_number_float()) return false;
  // 3.0 is 3: some clients know only one kind of number. Beyond 2^53 such a number may not be what was meant.
  const double x = value.get<double>();
  if (!(std::abs(x) <= 9007199254740992.0) || std::floor(x) != x) return false;
  const auto whole = static_cast<std::int64_t>(x);
  return integer_from(Json(whole), out);
}
template <class T>
bool set_integer(const Json& value, std::byte* to) {
  T number{};
  if (!integer_from(value, number)) return false;
  std::memcpy(to, &number, sizeof number);
  return true;
}
template <class T>
bool set_float(const Json& value, std::byte* to) {
  if (!value.is_null() && !value.is_number()) return false;
  const double x = value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
  if (std::isfinite(x) && std::abs(x) > static_cast<double>(std::numeric_limits<T>::max())) return false;
  const T number = static_cast<T>(x);
  std::memcpy(to, &number, sizeof number);
  return true;
}

bool set_number(Wire type, const Json& value, std::byte* to) {
  switch (type) {
    case Wire::boolean:
      if (!value.is_boolean()) return false;
      *to = std::byte{value.get<bool>()};
      return true;
    case Wire::byte:
    case Wire::character:
    case Wire::uint8: return set_integer<std::uint8_t>(value, to);
    case Wire::int8: return set_integer<std::int8_t>(value, to);
    case Wire::int16: return set_integer<std::int16_t>(value, to);
    case Wire::uint16: return set_integer<std::uint16_t>(value, to);
    case Wire::int32: return set_integer<std::int32_t>(value, to);
    case Wire::uint32: return set_integer<std::uint32_t>(value, to);
    case Wire::int64: return set_integer<std::int64_t>(value, to);
    case Wire::uint64: return set_integer<std::uint64_t>(value, to);
    case Wire::float32: return set_float<float>(value, to);
    case Wire::float64: return set_float<double>(value, to);
    case Wire::string:
    case Wire::message: break;
  }
  return false;
}

Json number_json(Wire type, const std::byte* value) {
  std::uint64_t big = 0;
  if (type == Wire::uint64) return std::memcpy(&big, value, 8), Json(big);
  std::int64_t whole = 0;
  if (type == Wire::int64) return std::memcpy(&whole, value, 8), Json(whole);
  return number_at(type, value);
}

Status set_message(const MessageInfo& info, const Json& value, void* object);

Status set_one(const MessageField& field, const Json& value, std::byte* to) {
  if (field.type == Wire::message) return set_message(*field.message, value, to);
  if (field.type == Wire::string) {
    if (!value.is_string()) return wrong(field.type, value);
    *reinterpret_cast<std::string*>(to) = value.get_ref<const std::string&>();
    return {};
  }
  if (!set_number(field.type, value, to)) return wrong(field.type, value);
  return {};
}

/// Room for `count` elements of a list, or the error that it cannot have so many.
Result<std::byte*> room(const MessageField& field, std::size_t count, std::byte* place) {
  if (field.count == Count::sequence) return static_cast<std::byte*>(field.vector->remade(place, count));
  if (count != field.length)
    return Error{"must have " + std::to_string(field.length) + " elements, has " + std::to_string(count)};
  return place;
}

Error under(std::string_view key, Error error) {
  error.path = "/" + std::string(key) + error.path;
  return error;
}

/// A list of numbers that came as bytes.
Status set_bytes(const MessageField& field, Wire type, std::span<const std::byte> bytes, std::byte* place) {
  const std::size_t size = size_of(type);
  if (bytes.size() % size) return Error{"is not a whole number of elements"};
  const std::size_t count = bytes.size() / size;
  SL_ASSIGN(std::byte * to, room(field, count, place));
  if (type == field.type || (is_octet(type) && is_octet(field.type))) {
    if (count) std::memcpy(to, bytes.data(), bytes.size());
    return {};
  }
  for (std::size_t i = 0; i < count; ++i, to += field.stride) {
    const Json value = number_json(type, &bytes[i * size]);
    if (!set_number(field.type, value, to)) return under(std::to_string(i), wrong(field.type, value));
  }
  return {};
}

Status set_field(const MessageField& field, const Json& value, std::byte* place) {
  if (field.count == Count::one) return set_one(field, value, place);
  if (value.is_string() && is_octet(field.type)) {
    const auto bytes = from_base64(value.get_ref<const std::string&>());
    if (!bytes) return Error{"is not base64"};
    return set_bytes(field, field.type, std::as_bytes(std::span(*bytes)), place);
  }
  if (value.is_binary() && size_of(field.type) && field.type != Wire::boolean) {
    const auto& binary = value.get_binary();
    const Wire type = binary.has_subtype() ? typed_array_type(static_cast<std::uint64_t>(binary.subtype()))
                                           : Wire::uint8;
    return set_bytes(field, type, std::as_bytes(std::span(binary)), place);
  }
  if (!value.is_array())
    return Error{"must be a list of " +
                 std::string(field.message ? field.message->name : name_of(field.type)) + ", is " +
                 kind_of(value)};
  SL_ASSIGN(std::byte * to, room(field, value.size(), place));
  for (std::size_t i = 0; i < value.size(); ++i, to += field.stride)
    if (Status done = set_one(field, value[i], to); !done)
      return under(std::to_string(i), std::move(done).error());
  return {};
}

Status set_time(const MessageInfo& info, const Json& value, void* object) {
  auto& time = *static_cast<Time*>(object);
  std::int32_t sec = static_cast<std::int32_t>(time.ns / Time::per_s);
  std::uint32_t nanosec = static_cast<std::uint32_t>(time.ns % Time::per_s);
  for (const auto& [key, member] : value.items()) {
    const bool whole = key == info.fields[0].name;
    const bool done = whole ? integer_from(member, sec) : integer_from(member, nanosec);
    if (!done) return under(key, wrong(info.fields[whole ? 0 : 1].type, member));
  }
  time = {sec * Time::per_s + nanosec};
  return {};
}

Status set_message(const MessageInfo& info, const Json& value, void* object) {
  if (!value.is_object()) return Error{"must be an object (" + info.name + "), is " + kind_of(value)};
  const auto known = [&](const std::string& key) -> const MessageField* {
    for (const MessageField& field : info.fields)
      if (field.name == key) return &field;
    return nullptr;
  };
  for (const auto& [key, member] : value.items()) {
    if (known(key)) continue;
    std::vector<std::string> names;
    for (const MessageField& field : info.fields) names.push_back(field.name);
    return Error{info.name + " has no field '" + key.substr(0, 100) + "'", suggestion(key, names)};
  }
  if (info.is_time) return set_time(info, value, object);
  for (const auto& [key, member] : value.items()) {
    const MessageField& field = *known(key);
    if (Status done = set_field(field, member, static_cast<std::byte*>(object) + field.offset); !done)
      return under(key, std::move(done).error());
  }
  return {};
}

}  // namespace

Status cdr_to_json(const MessageInfo& info, std::span<const std::byte> cdr, std::string& out) {
  MessageWriter writer(out);
  return walk_cdr(info, cdr, writer);
}

Status read_json(const MessageInfo& info, const Json& document, void* message) {
  return set_message(info, document, message);
}

Status read_json(const MessageInfo& info, std::string_view text, void* message) {
  Json document;
  try {
    document = Json::parse(text);
  } catch (const Json::exception& e) {  // the library's only way to report the place
    return Error{std::string("is not JSON: ") + e.what()};
  }
  return set_message(info, document, message);
}

}  // namespace sandlot
