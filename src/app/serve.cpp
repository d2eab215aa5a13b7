#include "app/serve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <span>

#include "app/remote_console.h"
#include "app/tokens.h"
#include "programs/sandbox.h"
#include "run/outputs.h"
#include "server/http/http.h"
#include "server/server.h"
#include "sim/session/session.h"

namespace sandlot::app {
namespace {

/// Address and tokens. @return the token of an administrator; "": none is needed
Result<std::string> set_address(const ServeOptions& options, server::TransportOptions& transport) {
  transport.address = options.address;
  transport.port = static_cast<std::uint16_t>(options.port);
  transport.next_free = options.next_free;
  transport.origins = options.origins;
  transport.udp = options.udp;
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
    SL_ASSIGN(admins, programs::make_secret());
  }
  if (!admins.empty() && !server::find_token(admins, transport.tokens))
    transport.tokens.push_back({admins, {.role = server::Role::admin}});
  for (const std::string& origin : options.origins)
    if (server::judge_origin(origin, "", std::span(&origin, 1)) == server::Origin::foreign)
      return Error{"--allow-origin: '" + origin + "' is not an origin", "write https://app.example.org"};
  return admins;
}

}  // namespace

Served::Served(std::unique_ptr<server::Server> server) : server_(std::move(server)) {}
Served::Served(Served&&) noexcept = default;
Served& Served::operator=(Served&&) noexcept = default;
Served::~Served() = default;

Result<Served> Served::start(const std::optional<ServeOptions>& options, Session& session, Console& console,
                             RunOutputs* outputs, const server::ProgramOptions& programs) {
  server::ServerOptions server_options;
  std::string admins;
  server_options.transport.listens = options.has_value();
  if (options) { SL_ASSIGN(admins, set_address(*options, server_options.transport)); }
  server_options.programs = programs;
  server_options.name = session.simulation().setup().name;
  server_options.version = SANDLOT_VERSION;
  if (options) server_options.world = options->world;
  if (outputs)
    server_options.recording = [outputs]() -> std::optional<server::ServerOptions::Recording> {
      auto progress = outputs->recording();
      if (!progress) return std::nullopt;
      return server::ServerOptions::Recording{std::move(progress->file), progress->messages, progress->bytes};
    };
  SL_ASSIGN(auto server, server::Server::start(server_options, session, console));
  if (options)
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

std::vector<ClientSummary> Served::clients() const {
  const auto durations = [](const server::DurationMeter& meter) -> std::optional<DurationSummary> {
    const auto figures = meter.all();
    if (figures.count == 0) return std::nullopt;
    return DurationSummary{figures.mean_s, figures.p99_s, figures.max_s};
  };
  std::vector<ClientSummary> out;
  for (const server::Roster::Total& each : server_->clients())
    out.push_back({.name = each.name,
                   .role = server::name_of(each.role),
                   .drives = each.drives,
                   .mode = server::name_of(each.mode),
                   .connections = each.connections,
                   .steps = each.steps,
                   .misses = each.misses,
                   .commands = each.commands,
                   .refused = each.refused,
                   .stops = each.stops,
                   .latency = durations(each.latency),
                   .step = durations(each.step)});
  return out;
}

}  // namespace sandlot::app
