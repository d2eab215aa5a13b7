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

foxglove::Service offered_service(std::uint32_t number, std::string name, const ServiceInfo& type) {
  const auto side = [](const MessageInfo& message) {
    return foxglove::Service::Side{"cdr", message.name, "ros2msg", message.schema};
  };
  return {number, std::move(name), type.name, side(*type.request), side(*type.response)};
}

void Hub::call(ClientId id, Client& client, const foxglove::CallService& request) {
  const auto fail = [&](const std::string& why) {
    ++counts_.refused;
    transport_->send_text(id, foxglove::service_failure(request.service, request.call, why));
  };
  const Service* const row = request.service > 0 && request.service <= services().size()
                                 ? &services()[request.service - 1]
                                 : nullptr;
  const auto of_device = device_services_.find(request.service);
  if (!row && of_device == device_services_.end())
    return fail("there is no service " + std::to_string(request.service));
  const std::string name = row ? row->name : of_device->second.name;
  const ServiceInfo& type = row ? *row->type : of_device->second.type;
  if ((!row || row->right == Right::steer) && !client.may_steer) {
    fail("a spectator may not call " + name);
    refuse(id, "a spectator may not call " + name);
    return;
  }
  if (client.calls >= most_calls)
    return fail("more than " + std::to_string(most_calls) + " calls wait for their answers");
  const bool json = request.encoding == "json";
  if (!json && request.encoding != "cdr")
    return fail("'" + request.encoding.substr(0, 60) + "' is not an encoding of requests; cdr and json are");
  const MessageInfo& info = *type.request;
  const auto message = json ? message_from_json(info, {reinterpret_cast<const char*>(request.bytes.data()),
                                                       request.bytes.size()})
                            : message_from_cdr(info, request.bytes);
  if (!message) return fail(name + ": " + message.error().text());
  ++client.calls;
  const auto send = [mailbox = mailbox_, id, type = type.response, service_id = request.service,
                     call = request.call, encoding = request.encoding](const ServiceCall::Outcome& outcome) {
    auto [bytes, text] = encode(outcome, *type, service_id, call, encoding);
    mailbox->push([id, bytes = std::move(bytes), text = text](Hub& hub) { hub.answer(id, bytes, text); });
  };
  const auto waiting = std::make_shared<ServiceCall>(send);
  if (row) row->call({*this, id, client.may_steer}, *message, waiting);
  else call_device(id, of_device->second, *message, waiting);
}

/// A call of a device's service is a request to the run, which answers when a tick has carried it out.
void Hub::call_device(ClientId id, const OfferedService& offered, const AnyMessage& request,
                      const std::shared_ptr<ServiceCall>& call) {
  CallRequest made{offered.device, offered.service->name, {}};
  request.to_cdr(made.bytes);
  const auto queued = session_.call(std::move(made), {Source::Kind::admin, id}, [call](const auto& response) {
    if (response) call->answer(*response);
    else call->fail(response.error().text());
  });
  if (!queued) call->fail(queued.error().text());
}

/// Follows the devices of the world: the services of those that came and went.
void Hub::adopt_services(const Inventory& inventory) {
  if (next_service_ == 1) next_service_ = static_cast<std::uint32_t>(services().size()) + 1;
  std::map<std::string, std::uint32_t> known;
  for (const auto& [number, each] : device_services_) known.emplace(each.name, number);
  std::vector<std::uint32_t> gone;
  std::vector<foxglove::Service> fresh;
  for (const Inventory::Service& each : inventory.services) {
    if (const auto found = known.find(each.name);
        found != known.end() && device_services_.at(found->second).service == each.service) {
      known.erase(found);
      continue;
    }
    const std::uint32_t number = next_service_++;
    const ServiceInfo type{each.service->type, &each.service->request(), &each.service->response()};
    device_services_[number] = {each.name, each.device, each.service, type};
    fresh.push_back(offered_service(number, each.name, type));
  }
  for (const auto& [name, number] : known) {
    device_services_.erase(number);
    gone.push_back(number);
  }
  for (const auto& [id, client] : clients_) {
    if (!gone.empty()) transport_->send_text(id, foxglove::unadvertise_services(gone));
    if (!fresh.empty()) transport_->send_text(id, foxglove::advertise_services(fresh));
  }
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
        const Status status = feed->watch(id, channel, values, rate_hz);
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
