#include "app/remote_console.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "base/bytes.h"
#include "base/text.h"
#include "wire/foxglove.h"

namespace sandlot::app {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

bool is_unreserved(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
         c == '.' || c == '~';
}

Error gone() { return {"the connection is gone: the run has ended, or the network has failed"}; }

std::string text_member(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::string url_encoded(std::string_view text) {
  constexpr const char* digits = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (is_unreserved(c)) out += c;
    else (out += '%') += {digits[byte >> 4], digits[byte & 15]};
  }
  return out;
}

Result<std::string> console_url(std::string_view written, std::string_view token) {
  std::string url(trim(written));
  double port = 0;
  if (url.empty()) url = "ws://127.0.0.1:8765";
  else if (parse_number(url, port)) url = "ws://127.0.0.1:" + url;
  else if (starts_with(url, "http://")) url = "ws://" + url.substr(7);
  else if (url.find("://") == std::string::npos) url = "ws://" + url;
  if (!starts_with(url, "ws://"))
    return Error{"'" + std::string(written.substr(0, 100)) + "' is not the address of a run",
                 "write the port, or ws://HOST:PORT"};
  const std::size_t host = 5;
  // A page's own address has a path and perhaps a token behind it.
  const std::size_t path = url.find_first_of("/?#", host);
  std::string query;
  if (path != std::string::npos) {
    if (const std::size_t mark = url.find('?', path); mark != std::string::npos)
      query = url.substr(mark + 1, url.find('#', mark) - mark - 1);
    url.resize(path);
  }
  if (url.size() == host) return Error{"the address names no host", "write the port, or ws://HOST:PORT"};
  const std::size_t address_end = url[host] == '[' ? std::min(url.find(']', host), url.size())
                                                   : host;  // [::1]
  if (url.find(':', address_end) == std::string::npos) url += ":8765";
  if (!token.empty()) query = (query.empty() ? "" : query + "&") + "token=" + url_encoded(token);
  return url + "/" + (query.empty() ? "" : "?" + query);
}

Result<std::unique_ptr<RemoteConsole>> RemoteConsole::connect(const std::string& url) {
  constexpr double patience_s = 10;
  SL_ASSIGN(auto socket, server::WebSocketClient::connect(url, foxglove::subprotocols[0], patience_s));
  std::unique_ptr<RemoteConsole> console(new RemoteConsole(std::move(socket)));
  const auto end = Clock::now() +
                   std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience_s));
  while (!console->has_console_ || !console->has_complete_) {
    if (Clock::now() > end) return Error{"the server has no console", "is it a Sandlot of this version?"};
    SL_TRY(console->take(0.1, 0));
  }
  return console;
}

void RemoteConsole::read_text(std::string_view text, std::uint32_t call) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) return;
  const std::string op = text_member(message, "op");
  if (op == "serverInfo") {
    if (const auto metadata = message.find("metadata"); metadata != message.end() && metadata->is_object())
      role_ = text_member(*metadata, "sandlot_role");
  } else if (op == "advertiseServices") {
    const auto services = message.find("services");
    if (services == message.end() || !services->is_array()) return;
    for (const Json& service : *services) {
      if (!service.is_object()) continue;
      const auto id = service.find("id");
      if (id == service.end() || !id->is_number_unsigned()) continue;
      const std::string name = text_member(service, "name");
      if (name == "/sandlot/console") console_ = id->get<std::uint32_t>(), has_console_ = true;
      if (name == "/sandlot/complete") complete_ = id->get<std::uint32_t>(), has_complete_ = true;
    }
  } else if (op == "serviceCallFailure") {
    if (const auto id = message.find("callId"); id == message.end() || *id != Json(call)) return;
    answer_ = text_member(message, "message");
    answered_ = failed_ = true;
  }
}

Result<bool> RemoteConsole::take(double timeout_s, std::uint32_t call) {
  auto received = socket_->receive(timeout_s);
  if (!received) return socket_->open() ? Result<bool>(false) : Result<bool>(gone());
  answered_ = failed_ = false;
  const std::span<const std::byte> bytes = received->bytes;
  if (received->text) {
    read_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, call);
    return answered_;
  }
  ByteReader r(bytes);
  std::uint8_t op = 0;
  std::uint32_t service = 0, id = 0, length = 0;
  read(r, op), read(r, service), read(r, id), read(r, length);
  constexpr std::uint8_t service_response = 3;
  if (!r.ok() || op != service_response || id != call) return false;
  r.take(length);  // the encoding, which is the request's
  if (!r.ok()) return false;
  const auto payload = r.take(r.remaining());
  answer_.assign(reinterpret_cast<const char*>(payload.data()), payload.size());
  return true;
}

Status RemoteConsole::ask(std::uint32_t service, const std::string& line) {
  const std::string request = Json({{"line", line}}).dump(-1, ' ', false, Json::error_handler_t::replace);
  ByteWriter w;
  constexpr std::uint8_t call_service = 2;
  write(w, call_service);
  write(w, service);
  write(w, ++calls_);
  write(w, std::string("json"));  // its length as u32 precedes it
  w.raw(request.data(), request.size());
  if (Status sent = socket_->send(w.bytes(), false); !sent) return gone();
  return {};
}

Result<RemoteAnswer> RemoteConsole::say(const std::string& line, bool (*give_up)()) {
  SL_TRY(ask(console_, line));
  while (true) {
    SL_ASSIGN(const bool answered, take(0.1, calls_));
    if (answered) break;
    if (give_up && give_up()) return Error{"no longer waiting for the answer"};
  }
  if (failed_) return RemoteAnswer{false, answer_};
  const Json response = Json::parse(answer_, nullptr, false);
  const auto ok = response.is_object() ? response.find("ok") : response.end();
  if (!response.is_object() || ok == response.end() || !ok->is_boolean())
    return Error{"the server's answer is none", "is it a Sandlot of this version?"};
  return RemoteAnswer{ok->get<bool>(), text_member(response, "text")};
}

std::vector<std::string> RemoteConsole::complete(const std::string& line) {
  std::vector<std::string> out;
  if (!ask(complete_, line)) return out;
  const auto end = Clock::now() + std::chrono::seconds(1);
  while (Clock::now() < end) {
    auto answered = take(0.1, calls_);
    if (!answered) return out;
    if (!*answered) continue;
    const Json response = failed_ ? Json() : Json::parse(answer_, nullptr, false);
    const auto candidates = response.is_object() ? response.find("candidates") : response.end();
    if (!response.is_object() || candidates == response.end() || !candidates->is_array()) return out;
    for (const Json& each : *candidates)
      if (each.is_string()) out.push_back(each.get<std::string>());
    return out;
  }
  return out;
}

}  // namespace sandlot::app
