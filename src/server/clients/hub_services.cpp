/// Services: calls, their answers, and what the services need of the server.
#include "base/text.h"
#include "server/clients/hub.h"

namespace sandlot::server {

/// Those of devices are for who drives the robot; administrators' are not for others.
bool Hub::may_call(const Client& client, const OfferedService& service) const {
  if (!service.row) return client.access.may_command(service.device);
  return client.access.is_admin() || (service.row->right == Right::watch && sees_world(client));
}

std::vector<const ServiceOffer*> Hub::offered_services(ClientId id) const {
  std::vector<const ServiceOffer*> out;
  const Client* const client = find(id);
  // Spectators are told of what they may not call, too: their viewers show it.
  for (const auto& [number, each] : services_)
    if (client && (sees_world(*client) || may_call(*client, each))) out.push_back(&each.offer);
  return out;
}

const ServiceOffer* Hub::find_service(ClientId id, std::uint32_t number) const {
  const Client* const client = find(id);
  const auto found = services_.find(number);
  if (!client || found == services_.end()) return nullptr;
  return sees_world(*client) || may_call(*client, found->second) ? &found->second.offer : nullptr;
}

const ServiceOffer* Hub::find_service(ClientId id, std::string_view name) const {
  for (const auto& [number, each] : services_)
    if (each.offer.name == name) return find_service(id, number);
  return nullptr;
}

void Hub::call(ClientId id, const ServiceOffer& service, const AnyMessage& request, Answer answer) {
  Client& client = clients_.at(id);
  const OfferedService& offered = services_.at(service.number);
  const auto fail = [&](const std::string& why) {
    ++counts_.refused;
    answer(*client.face, Error{why});
  };
  if (!may_call(client, offered)) {
    const std::string why = std::string("a ") + name_of(client.access.role) + " may not call " + service.name;
    fail(why);
    return refuse(id, why);
  }
  if (client.calls >= most_calls)
    return fail("more than " + std::to_string(most_calls) + " calls wait for their answers");
  ++client.calls;
  const auto waiting = std::make_shared<ServiceCall>(
      [mailbox = mailbox_, id, answer = std::move(answer)](ServiceCall::Outcome outcome) {
        mailbox->push([id, answer, outcome = std::move(outcome)](Hub& hub) {
          hub.answer(id, [&](Face& face) { answer(face, outcome); });
        });
      });
  const Charged charged(*this, client.access.is_admin() ? 0 : id);
  if (offered.row) offered.row->call({*this, id, client.access.is_admin()}, request, waiting);
  else call_device(id, offered, request, waiting);
}

Status Hub::restart_program(const std::string& program) {
  if (!processes_) return Error{"this run has started no program"};
  return processes_->restart(program);
}

/// A call of a device's service is a request to the run, which answers when a tick has carried it out.
void Hub::call_device(ClientId id, const OfferedService& offered, const AnyMessage& request,
                      const std::shared_ptr<ServiceCall>& call) {
  CallRequest made{offered.device, offered.service->name, {}};
  request.to_cdr(made.bytes);
  const auto kind = access(id).is_scoped() ? Source::Kind::robot : Source::Kind::admin;
  const auto queued = session_.call(std::move(made), {kind, id}, [call](const auto& response) {
    if (response) call->answer(*response);
    else call->fail(response.error().text());
  });
  if (!queued) call->fail(queued.error().text());
}

/// Follows the devices of the world: the services of those that came and went.
void Hub::adopt_services(const Inventory& inventory) {
  std::map<std::string, std::uint32_t> known;
  for (const auto& [number, each] : services_)
    if (!each.row) known.emplace(each.offer.name, number);
  std::vector<std::uint32_t> gone, fresh;
  for (const Inventory::Service& each : inventory.services) {
    if (const auto found = known.find(each.name);
        found != known.end() && services_.at(found->second).service == each.service) {
      known.erase(found);
      continue;
    }
    const std::uint32_t number = next_service_++;
    const ServiceInfo type{each.service->type, &each.service->request(), &each.service->response()};
    services_[number] = {{number, each.name, type}, nullptr, each.device, each.service};
    fresh.push_back(number);
  }
  for (const auto& [name, number] : known) {
    services_.erase(number);
    gone.push_back(number);
  }
  for (const auto& [id, client] : clients_) {
    if (!gone.empty()) client.face->remove_services(gone);
    std::vector<const ServiceOffer*> offers;
    for (const std::uint32_t number : fresh)
      if (const ServiceOffer* const offer = find_service(id, number)) offers.push_back(offer);
    if (!offers.empty()) client.face->add_services(offers);
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
  made.info = {channel_id, "/sandlot/watch/" + std::to_string(channel_id), "cdr", info.name, &info};
  const ChannelInfo* const advertised[] = {&made.info};
  client->face->add_channels(advertised);
  done(made.info.topic);
}

void Hub::decisions(const std::string& topic, std::function<void(std::vector<msg::RefereeDecision>)> done) {
  post([feed = feed_, topic, done = std::move(done)](Session&) { done(feed->decisions().decisions(topic)); });
}

void Hub::match_track(std::function<void(const msg::MatchTrack::Response&)> done) {
  post([feed = feed_, done = std::move(done)](Session&) { done(feed->match().track()); });
}

void Hub::wait(std::function<std::optional<Status>(const Session::Report&)> reached,
               std::function<void(const Status&)> done) {
  waiting_.push_back({std::move(reached), std::move(done), report_.tick, Clock::now()});
}

std::function<void(std::function<void()>)> Hub::way_back() {
  return [mailbox = mailbox_](std::function<void()> task) {
    mailbox->push([task = std::move(task)](Hub&) { task(); });
  };
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
