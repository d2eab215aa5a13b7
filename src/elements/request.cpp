#include "elements/request.h"

#include <array>

#include "model/model_bytes.h"

namespace sandlot {
namespace {

/// The alternative with this index, empty.
template <std::size_t... I>
bool make(Request& request, std::size_t index, std::index_sequence<I...>) {
  return ((I == index ? (request.emplace<I>(), true) : false) || ...);
}

void put(ByteWriter& w, const Node& x) { write_node(w, x); }
void put(ByteWriter& w, const model::Instance& x) { write_instance(w, x); }
void put(ByteWriter& w, const model::DeviceDecl& x) { write_device(w, x); }
void put(ByteWriter& w, const auto& x) { write(w, x); }

bool take(ByteReader& r, Node& x) { return read_node(r, x); }
bool take(ByteReader& r, model::Instance& x) { return read_instance(r, x); }
bool take(ByteReader& r, model::DeviceDecl& x) { return read_device(r, x); }
bool take(ByteReader& r, auto& x) { return read(r, x), r.ok(); }

/// The names of all alternatives, in their order.
template <class... R>
constexpr auto kinds_of(const std::variant<R...>*) {
  return std::array<const char*, sizeof...(R)>{R::kind...};
}

}  // namespace

static_assert(std::is_same_v<std::variant_alternative_t<0, Request>, CommandRequest>, "LogEntry::command");

const char* request_kind(std::size_t index) {
  static constexpr auto names = kinds_of(static_cast<const Request*>(nullptr));
  return index < names.size() ? names[index] : "unknown";
}

const std::string& request_target(const Request& request) {
  return std::visit(
      [](const auto& x) -> const std::string& {
        if constexpr (requires { x.target(); }) return x.target();
        else return std::get<0>(x.members(x));
      },
      request);
}

void write_request(ByteWriter& w, const Request& request) {
  write(w, static_cast<std::uint8_t>(request.index()));
  std::visit(
      [&](const auto& x) { std::apply([&](const auto&... member) { (put(w, member), ...); }, x.members(x)); },
      request);
}

bool read_request(ByteReader& r, Request& request) {
  std::uint8_t index = 0;
  read(r, index);
  if (!r.ok() || !make(request, index, std::make_index_sequence<std::variant_size_v<Request>>()))
    return false;
  const bool whole = std::visit(
      [&](auto& x) {
        const bool read = std::apply([&](auto&... member) { return (take(r, member) && ...); }, x.members(x));
        if constexpr (requires { x.fits(); }) return read && x.fits();
        else return read;
      },
      request);
  return whole && r.remaining() == 0;
}

}  // namespace sandlot
