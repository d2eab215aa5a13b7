/// Services over the Foxglove protocol: calls, their answers, and what the services need of the server.
#include "base/text.h"
#include "messages/cdr.h"
#include "messages/json.h"
#include "server/clients/hub.h"

namespace sandlot::server {
namespace {

/// The bytes that carry a service's outcome, and whether they are a text message.
std::pair<Payload, bool> encode(const ServiceCall::Outcome& outcome, const MessageInfo& type,
                                std::uint32_t service, std::uint32_t call, const std::string& encoding) {
  if (!outcome) return {payload_of(foxglove::service_failure(service, call, outcome.error().text())), true};
  std::string json;
  std::span<const std::byte> body = *outcome;
  if (encoding == "json") {
    const Status written = cdr_to_json(type, *outcome, json);
    SL_CHECK_MSG(written, "what was written just now can be read");
    body = std::as_bytes(std::span(json));
  }
  return {std::make_shared<const std::vector<std::byte>>(
              foxglove::service_response(service, call, encoding, body)),
          false};
}

}  // namespace

void Hub::call(ClientId id, Client& client, const foxglove::CallService& request) {
  const auto fail = [&](const std::string& why) {
    ++counts_.refused;
    transport_->send_text(id, foxglove::service_failure(request.service, request.call, why));
  };
  if (request.service == 0 || request.service > services().size())
    return fail("there is no service " + std::to_string(request.service));
  const Service& service = services()[request.service - 1];
  if (service.right == Right::steer && !client.may_steer) {
    fail("a spectator may not call " + std::string(service.name));
    refuse(id, "a spectator may not call " + std::string(service.name));
    return;
  }
  if (client.calls >= most_calls)
    return fail("more than " + std::to_string(most_calls) + " calls wait for their answers");
  const bool json = request.encoding == "json";
  if (!json && request.encoding != "cdr")
    return fail("'" + request.encoding.substr(0, 60) + "' is no encoding of requests; cdr and json are");
  const MessageInfo& info = *service.type->request;
  const auto message = json ? message_from_json(info, {reinterpret_cast<const char*>(request.bytes.data()),
                                                       request.bytes.size()})
                            : message_from_cdr(info, request.bytes);
  if (!message) return fail(std::string(service.name) + ": " + message.error().text());
  ++client.calls;
  const auto send = [mailbox = mailbox_, id, type = service.type->response, service_id = request.service,
                     call = request.call, encoding = request.encoding](const ServiceCall::Outcome& outcome) {
    auto [bytes, text] = encode(outcome, *type, service_id, call, encoding);
    mailbox->push([id, bytes = std::move(bytes), text = text](Hub& hub) { hub.answer(id, bytes, text); });
  };
  service.call({*this, id, client.may_steer}, *message, std::make_shared<ServiceCall>(send));
}

void Hub::watch(ClientId id, const std::vector<std::string>& values, double rate_hz, WatchDone done) {
  Client& client = clients_.at(id);
  const std::size_t count = values.size();
  if (client.watched + count > most_watched || watched_ + count > most_watched_by_all) {
    ++counts_.refused;
    return done(Error{"at most " + std::to_string(most_watched) + " numbers can be watched, " +
                      std::to_string(most_watched_by_all) + " by all viewers together"});
  }
  const std::uint32_t channel = next_channel_++;
  const bool posted = post(
      [feed = feed_, mailbox = mailbox_, id, channel, values, rate_hz, done = std::move(done)](Session&) {
        const Status status = feed->watch(channel, values, rate_hz);
        mailbox->push([id, channel, count = values.size(), status, done](Hub& hub) {
          hub.open_watch(id, channel, count, status, done);
        });
      });
  if (!posted) return;  // nobody will give them back
  client.watched += count;
  watched_ += count;
}

void Hub::open_watch(ClientId id, std::uint32_t channel_id, std::size_t values, const Status& status,
                     const WatchDone& done) {
  Client* const client = find(id);
  if (!status || !client) {
    watched_ -= values;
    if (client) client->watched -= values;
    else post([feed = feed_, channel_id](Session&) { feed->unwatch(channel_id); });
    return done(status ? Error{"the client has gone"} : status.error());
  }
  Channel& made = channels_[channel_id];
  made.kind = ChannelKind::watch;
  made.owner = id;
  made.numbers = values;
  made.unused_since = Clock::now();
  const MessageInfo& info = *find_message("sandlot_msgs/msg/Samples").value();
  made.advertised = {
      channel_id, "/sandlot/watch/" + std::to_string(channel_id), "cdr", info.name, info.schema, "ros2msg"};
  transport_->send_text(id, foxglove::advertise(std::span(&made.advertised, 1)));
  done(made.advertised.topic);
}

void Hub::wait(std::function<std::optional<Status>(const Session::Report&)> reached,
               std::function<void(const Status&)> done) {
  waiting_.push_back({std::move(reached), std::move(done), report_.tick, Clock::now()});
}

/// Ends the waiting calls whose state the run has reached. A run that stands still will not reach it any more.
void Hub::end_waiting() {
  constexpr std::chrono::seconds patience{5};
  const auto now = Clock::now();
  for (Waiting& each : waiting_) {
    std::optional<Status> result = each.reached(report_);
    if (!result && std::exchange(each.tick, report_.tick) != report_.tick) each.since = now;
    if (!result && now > each.since + patience && report_.state != Session::State::playing)
      result = Error{"something else was asked of the run meanwhile"};
    if (!result) continue;
    each.done(*result);
    each.done = nullptr;
  }
  std::erase_if(waiting_, [](const Waiting& each) { return !each.done; });
}

}  // namespace sandlot::server
