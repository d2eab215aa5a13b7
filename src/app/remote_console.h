#pragma once
/// Console of a run in another program: lines over the Foxglove protocol (docs/viewer_protocol.md).
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/transport.h"

namespace sandlot::app {

struct RemoteAnswer {
  bool ok = true;
  std::string text;
};

/// Text for the query of an address.
std::string url_encoded(std::string_view text);

/// "ws://127.0.0.1:8765/?token=..." from what people write: a port, HOST:PORT, an http or ws address,
/// nothing.
Result<std::string> console_url(std::string_view written, std::string_view token);

class RemoteConsole {
 public:
  /// Errors: nobody listens, or it is not Sandlot, or it has no console.
  static Result<std::unique_ptr<RemoteConsole>> connect(const std::string& url);

  /// Waits for the answer; `give_up` is called ten times a second. Errors: the connection is gone, or
  /// `give_up` returned true.
  Result<RemoteAnswer> say(const std::string& line, bool (*give_up)());
  /// Continuations of the last word; none when they take longer than a second.
  std::vector<std::string> complete(const std::string& line);
  /// "admin" or "spectator"
  const std::string& role() const { return role_; }

 private:
  explicit RemoteConsole(std::unique_ptr<server::WebSocketClient> socket) : socket_(std::move(socket)) {}
  /// Takes one message. @return whether it answers `call`; `answer_` then has the text
  Result<bool> take(double timeout_s, std::uint32_t call);
  Status ask(std::uint32_t service, const std::string& line);
  void read_text(std::string_view text, std::uint32_t call);

  std::unique_ptr<server::WebSocketClient> socket_;
  std::string role_, answer_;
  bool failed_ = false, answered_ = false;
  std::uint32_t console_ = 0, complete_ = 0;  ///< ids of the services; 0: not known yet
  bool has_console_ = false, has_complete_ = false;
  std::uint32_t calls_ = 0;
};

}  // namespace sandlot::app
