#include "app/serve.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>

#include "app/remote_console.h"
#include "server/http/http.h"

namespace sandlot::app {
namespace {

/// 32 hexadecimal digits that nobody guesses. Not for the run: its random numbers come from streams.
Result<std::string> make_token() {
  std::array<unsigned char, 16> bytes;
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return Error{"the system has no random numbers for a token", "give one: --token WORD"};
  std::string out;
  for (const unsigned char byte : bytes) out += fmt::format("{:02x}", byte);
  return out;
}

}  // namespace

Result<Served> Served::start(const ServeOptions& options, Session& session, Console& console,
                             std::function<std::optional<server::ServerOptions::Recording>()> recording) {
  server::ServerOptions server_options;
  server::TransportOptions& transport = server_options.transport;
  transport.address = options.address;
  transport.port = static_cast<std::uint16_t>(options.port);
  transport.next_free = options.next_free;
  transport.origins = options.origins;
  transport.token = options.token;
  if (transport.token.empty() && !server::is_loopback_name(options.address)) {
    SL_ASSIGN(transport.token, make_token());
  }
  for (const std::string& origin : options.origins)
    if (server::judge_origin(origin, "", std::span(&origin, 1)) == server::Origin::foreign)
      return Error{"--allow-origin: '" + origin + "' is no origin", "write https://app.example.org"};
  server_options.name = session.simulation().setup().name;
  server_options.version = SANDLOT_VERSION;
  server_options.recording = std::move(recording);
  Served out;
  SL_ASSIGN(out.server_, server::Server::start(server_options, session, console));
  std::fprintf(stderr, "page: %s%s\n", out.server_->url().c_str(),
               transport.token.empty() ? "" : ("?token=" + url_encoded(transport.token)).c_str());
  return out;
}

void Served::look() { most_ = std::max(most_, server_->counters().clients); }

nlohmann::ordered_json Served::stop() {
  look();
  server_->stop();
  const server::Counters counters = server_->counters();
  return {{"viewers_most", most_}, {"refused", counters.refused}, {"dropped", counters.dropped}};
}

}  // namespace sandlot::app
