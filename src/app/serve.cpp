#include "app/serve.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>

#include "app/remote_console.h"
#include "app/tokens.h"
#include "run/outputs.h"
#include "server/http/http.h"
#include "server/server.h"
#include "sim/session/session.h"

namespace sandlot::app {
namespace {

/// Token of 32 random hexadecimal digits. Not for the run, whose random numbers come from streams.
Result<std::string> make_token() {
  std::array<unsigned char, 16> bytes;
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return Error{"the system has no random numbers for a token", "give one: --token WORD"};
  std::string out;
  for (const unsigned char byte : bytes) out += fmt::format("{:02x}", byte);
  return out;
}

}  // namespace

Served::Served(std::unique_ptr<server::Server> server) : server_(std::move(server)) {}
Served::Served(Served&&) noexcept = default;
Served& Served::operator=(Served&&) noexcept = default;
Served::~Served() = default;

Result<Served> Served::start(const ServeOptions& options, Session& session, Console& console,
                             RunOutputs* outputs) {
  server::ServerOptions server_options;
  server::TransportOptions& transport = server_options.transport;
  transport.address = options.address;
  transport.port = static_cast<std::uint16_t>(options.port);
  transport.next_free = options.next_free;
  transport.origins = options.origins;
  transport.most_clients = static_cast<std::size_t>(options.most_clients);
  transport.most_per_address = static_cast<std::size_t>(options.most_per_address);
  transport.most_sockets = std::max(transport.most_sockets, 2 * transport.most_clients);
  transport.most_from_loopback = transport.most_sockets;
  if (!options.tokens_file.empty()) { SL_ASSIGN(transport.tokens, load_tokens(options.tokens_file)); }
  std::string admins = options.token;
  for (const server::Token& each : transport.tokens)
    if (each.access.is_admin() && admins.empty()) admins = each.secret;
  // Somebody has to be able to steer.
  if (admins.empty() && (!transport.tokens.empty() || !server::is_loopback_name(options.address))) {
    SL_ASSIGN(admins, make_token());
  }
  if (!admins.empty() && !server::find_token(admins, transport.tokens))
    transport.tokens.push_back({admins, {.role = server::Role::admin}});
  for (const std::string& origin : options.origins)
    if (server::judge_origin(origin, "", std::span(&origin, 1)) == server::Origin::foreign)
      return Error{"--allow-origin: '" + origin + "' is not an origin", "write https://app.example.org"};
  server_options.name = session.simulation().setup().name;
  server_options.version = SANDLOT_VERSION;
  if (outputs)
    server_options.recording = [outputs]() -> std::optional<server::ServerOptions::Recording> {
      auto progress = outputs->recording();
      if (!progress) return std::nullopt;
      return server::ServerOptions::Recording{std::move(progress->file), progress->messages, progress->bytes};
    };
  SL_ASSIGN(auto server, server::Server::start(server_options, session, console));
  std::fprintf(stderr, "page: %s%s\n", server->url().c_str(),
               admins.empty() ? "" : ("?token=" + url_encoded(admins)).c_str());
  return Served(std::move(server));
}

void Served::count_viewers() { most_ = std::max(most_, server_->counters().clients); }

ServerSummary Served::stop() {
  count_viewers();
  server_->stop();
  const server::Counters counters = server_->counters();
  return {.viewers_most = most_, .refused = counters.refused, .dropped = counters.dropped};
}

}  // namespace sandlot::app
