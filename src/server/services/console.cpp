/// Sandlot's own services: the console, its completion, watched values, clients.
#include "console/console.h"

#include "server/services/service.h"

namespace sandlot::server::service {

void console(const ServiceContext& context, const msg::Console::Request& request,
             const Reply<msg::Console>& reply) {
  const Caller caller{context.may_steer, {Source::Kind::admin, context.client}};
  context.host.post([&console = context.host.console(), caller, reply, line = request.line](Session&) {
    console.execute(line, caller, [reply](const Answer& answer) { reply({answer.ok, answer.text}); });
  });
}

void complete(const ServiceContext& context, const msg::Complete::Request& request,
              const Reply<msg::Complete>& reply) {
  context.host.post([&console = context.host.console(), reply, line = request.line](Session&) {
    reply({console.complete(line)});
  });
}

void watch_values(const ServiceContext& context, const msg::WatchValues::Request& request,
                  const Reply<msg::WatchValues>& reply) {
  if (request.values.empty()) return reply({.text = "no values are named"});
  if (!(request.rate_hz >= 0 && request.rate_hz <= 1e6))
    return reply({.text = "the rate is not within 0 and 1e6 Hz"});
  context.host.watch(context.client, request.values, request.rate_hz,
                     [reply](const Result<std::string>& topic) {
                       if (topic) reply({.ok = true, .topic = *topic});
                       else reply({.text = topic.error().text()});
                     });
}

void decisions(const ServiceContext& context, const msg::Decisions::Request& request,
               const Reply<msg::Decisions>& reply) {
  context.host.decisions(request.topic,
                         [reply](std::vector<msg::RefereeDecision> found) { reply({std::move(found)}); });
}

void match_track(const ServiceContext& context, const msg::MatchTrack::Request&,
                 const Reply<msg::MatchTrack>& reply) {
  context.host.match_track([reply](const msg::MatchTrack::Response& track) { reply(track); });
}

void disconnect_client(const ServiceContext& context, const msg::DisconnectClient::Request& request,
                       const Reply<msg::DisconnectClient>& reply) {
  const Status status = context.host.disconnect(request.client);
  reply({static_cast<bool>(status), status ? "" : status.error().text()});
}

}  // namespace sandlot::server::service
