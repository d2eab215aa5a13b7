#pragma once
/// A client of rosbridge over TCP, for the tests of server.
#include <optional>

#include "server/test_socket.h"
#include "server/test_viewer.h"

namespace sandlot::server::test {

class Bridge {
 public:
  explicit Bridge(const std::string& url)
      : socket_(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)))) {}

  void send(const json& message) { socket_.send(message.dump() + "\n"); }
  void send_text(const std::string& text) { socket_.send(text); }
  /// The next message, whatever it is. Null: nothing came in time, or it has ended.
  json take(double timeout_s = patience_s) {
    std::size_t end = 0;
    while ((end = socket_.seen.find('\n')) == std::string::npos)
      if (!socket_.more(timeout_s)) return {};
    return json::parse(socket_.take(end + 1));
  }
  /// The next message of an operation; those before it are thrown away.
  json next(const std::string& op, double timeout_s = patience_s) {
    while (true) {
      json message = take(timeout_s);
      if (message.is_null() || message["op"] == op) return message;
    }
  }
  json call(const std::string& service, const json& args) {
    send({{"op", "call_service"}, {"service", service}, {"args", args}, {"id", "call"}});
    return next("service_response");
  }
  /// @return its answer: sandlot.claimed, or a status
  json claim(json request) {
    request["op"] = "sandlot.claim";
    request["id"] = "claim";
    send(request);
    while (true) {
      json message = take();
      if (message.is_null() || message.value("id", "") == "claim") return message;
    }
  }
  bool ended() {
    while (socket_.more(patience_s)) socket_.seen.clear();
    return socket_.ended;
  }

 private:
  Socket socket_;
};

}  // namespace sandlot::server::test
