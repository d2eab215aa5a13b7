#include "server/clients/hub.h"

#include <algorithm>

#include "base/text.h"

namespace sandlot::server {
namespace {

using namespace std::chrono_literals;
using foxglove::Level;

constexpr auto flush_pause =
    20ms;  ///< between two changes of the subscriptions: the simulation's thread carries them out
constexpr auto watch_patience = 10s;             ///< a watch without its subscriber goes
constexpr std::size_t portion = 256;             ///< channels in one message
constexpr std::size_t patient_bytes = 4u << 20;  ///< so much may wait when more channels are advertised
constexpr int most_refusals_per_s = 20;
/// Requests that work on the simulation's thread counts as: who spends all on it has 5 % of the run's time.
constexpr double requests_per_work_s = 10'000, free_work_s = 100e-6;

}  // namespace

Hub::Hub(Session& session, Console& console, const ServerOptions& options, std::shared_ptr<Mailbox> mailbox,
         std::shared_ptr<Feed> feed, wire::Assets assets)
    : session_(session),
      console_(console),
      options_(options),
      mailbox_(std::move(mailbox)),
      feed_(std::move(feed)),
      assets_(std::move(assets)) {
  // Another run of the program is another session; nothing else depends on this number.
  session_id_ = std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  add_channel(ChannelKind::world, "/sandlot/world", "json", "sandlot.World");
  add_channel(ChannelKind::status, "/sandlot/status", "json", "sandlot.Status");
  add_channel(ChannelKind::commands, "/sandlot/commands", "json", "sandlot.Commands");
  add_channel(ChannelKind::poses, "/sandlot/poses", "sandlot-poses", "sandlot.Poses");
  add_channel(ChannelKind::contacts, "/sandlot/contacts", "sandlot-contacts", "sandlot.Contacts");
  add_channel(ChannelKind::deliveries, "/sandlot/deliveries", "sandlot-deliveries", "sandlot.Deliveries");
  add_channel(ChannelKind::batteries, "/sandlot/batteries", "sandlot-batteries", "sandlot.Batteries");
  add_channel(ChannelKind::clients, "/sandlot/clients", "json", "sandlot.Clients");
  add_channel(ChannelKind::transforms, "/tf", "cdr", "tf2_msgs/msg/TFMessage");
  add_channel(ChannelKind::transforms_static, "/tf_static", "cdr", "tf2_msgs/msg/TFMessage");
  add_channel(ChannelKind::clock, "/clock", "cdr", "rosgraph_msgs/msg/Clock");
  add_channel(ChannelKind::step_times, "/sandlot/step_times", "cdr", "sandlot_msgs/msg/StepTimes");
  add_channel(ChannelKind::log, "/rosout", "cdr", "rcl_interfaces/msg/Log");
  report_ = session_.report();
  memory_.world = options_.world;
  for (const Service& row : services()) {
    const std::uint32_t number = next_service_++;
    services_[number] = {{number, row.name, *row.type}, &row, "", nullptr};
  }
}

std::uint32_t Hub::add_channel(ChannelKind kind, const char* topic, const char* encoding,
                               const char* schema) {
  const std::uint32_t id = next_channel_++;
  Channel& made = channels_[id];
  made.kind = kind;
  made.info = {id, topic, encoding, schema, nullptr};
  if (made.info.encoding == "cdr") made.info.type = find_message(schema).value();
  if (kind != ChannelKind::device && kind != ChannelKind::watch) fixed_[static_cast<std::size_t>(kind)] = id;
  return id;
}

Hub::Client* Hub::find(ClientId id) {
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : &found->second;
}

const Hub::Client* Hub::find(ClientId id) const {
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : &found->second;
}

const Access& Hub::access(ClientId id) const {
  static const Access nobody;
  const Client* const client = find(id);
  return client ? client->access : nobody;
}

bool Hub::may_see(const Client& client, ClientId id, const Channel& channel) const {
  if (channel.owner != 0) return channel.owner == id && sees_world(client);
  return sees_topic(client.access, inventory_->sharing, channel.info.topic);
}

/// Takes from a client what it may not see any more.
void Hub::revoke(ClientId id, Client& client) {
  std::vector<std::uint32_t> lost, channels;
  for (const auto& [subscription, channel] : client.subscriptions)
    if (!find_channel(id, channel)) lost.push_back(subscription), channels.push_back(channel);
  for (const std::uint32_t each : lost) (void)unsubscribe(id, each);
  if (!channels.empty()) client.face->remove_channels(channels);
  if (sees_world(client)) return;
  client.parameters.clear();
  client.all_parameters = client.graph = false;
}

void Hub::connected(ClientId id, Access access, Protocol protocol, const MakeFace& make_face) {
  const ConnectionFacts facts = transport_->facts(id);
  if (protocol == Protocol::foxglove && facts.name == "page") protocol = Protocol::page;
  roster_.connected(id, protocol, facts, access, Clock::now());
  Client& client = clients_[id];
  client.access = std::move(access);
  client.budgeted = client.refusals_since = Clock::now();
  client.face = make_face(*this, *transport_, id);
  client.face->welcome(client.access);
  client.face->add_services(offered_services(id));
  advertise_waiting(id, client);
  subscriptions_changed_ = true;
  graph_changed_ = true;
  flush();
}

void Hub::disconnected(ClientId id) {
  Client* const client = find(id);
  if (!client) return;
  end_claim(id, *client, "the client has gone");
  roster_.disconnected(id);
  const auto subscriptions = std::move(client->subscriptions);
  for (const auto& [subscription, channel] : subscriptions) leave_channel(id, channel, subscription);
  std::vector<std::uint32_t> watches;
  for (const auto& [channel, each] : channels_)
    if (each.owner == id) watches.push_back(channel);
  for (const std::uint32_t watch : watches) remove_channel(watch);
  clients_.erase(id);
  subscriptions_changed_ = true;
  graph_changed_ = true;
  flush();
}

void Hub::refuse(ClientId id, const std::string& why, std::string_view about) {
  ++counts_.refused;
  roster_.refused(id);
  Client* const client = find(id);
  if (!client) return;
  const auto now = Clock::now();
  if (now > client->refusals_since + 1s) {
    client->refusals_since = now;
    client->errors = 0;
    if (client->refusals_unsent > 0)
      client->face->report(Level::error,
                           std::to_string(client->refusals_unsent) + " more requests were refused", {});
    client->refusals_unsent = 0;
  }
  if (++client->errors <= most_refusals_per_s) client->face->report(Level::error, why, about);
  else ++client->refusals_unsent;
}

bool Hub::within_budget(ClientId id, Client& client) {
  const auto now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - client.budgeted).count();
  client.budgeted = now;
  client.budget = std::min(most_requests_per_s, client.budget + passed_s * most_requests_per_s);
  if (client.budget < 1) {
    refuse(id, "more than " + number_text(most_requests_per_s) + " requests in a second");
    return false;
  }
  client.budget -= 1;
  return true;
}

void Hub::message(ClientId id, std::span<const std::byte> bytes, bool text) {
  Client* const client = find(id);
  if (!client) return;
  roster_.message(id, Clock::now());
  if (within_budget(id, *client)) client->face->message(bytes, text);
  else client->face->over_budget(bytes, text);
  flush();
}

const ChannelInfo* Hub::find_channel(ClientId id, std::uint32_t number) const {
  const Client* const client = find(id);
  const auto found = channels_.find(number);
  return client && found != channels_.end() && may_see(*client, id, found->second) ? &found->second.info
                                                                                   : nullptr;
}

const ChannelInfo* Hub::find_channel(ClientId id, std::string_view topic) const {
  const Client* const client = find(id);
  for (const auto& [number, each] : channels_)
    if (each.info.topic == topic && client && may_see(*client, id, each)) return &each.info;
  return nullptr;
}

std::vector<const ChannelInfo*> Hub::channels(ClientId id) const {
  std::vector<const ChannelInfo*> out;
  const Client* const client = find(id);
  for (const auto& [number, each] : channels_)
    if (client && may_see(*client, id, each)) out.push_back(&each.info);
  return out;
}

Status Hub::subscribe(ClientId id, std::uint32_t subscription, std::uint32_t channel_id) {
  Client& client = clients_.at(id);
  if (!find_channel(id, channel_id)) return Error{"there is no channel " + std::to_string(channel_id)};
  Channel& to = channels_.at(channel_id);
  if (client.subscriptions.count(subscription) > 0)
    return Error{"subscription " + std::to_string(subscription) + " is there already"};
  if (std::any_of(to.subscribers.begin(), to.subscribers.end(),
                  [&](const Subscriber& each) { return each.client == id; }))
    return Error{"channel " + std::to_string(channel_id) + " is subscribed to already"};
  if (client.subscriptions.size() >= most_subscriptions)
    return Error{"more than " + std::to_string(most_subscriptions) + " subscriptions"};
  client.subscriptions[subscription] = channel_id;
  Subscriber made{id, subscription, false};
  switch (to.kind) {
    case ChannelKind::device:
    case ChannelKind::batteries:
    case ChannelKind::watch: initial_.latest.push_back(channel_id); break;
    case ChannelKind::world: initial_.world = true; break;
    case ChannelKind::transforms_static: initial_.transforms_static = true; break;
    case ChannelKind::poses: initial_.frame = true; break;
    case ChannelKind::status: break;
    case ChannelKind::clients:
      made.initial_state_sent = true;
      clients_asked_ = {};  // it is told with the next beat of the timer
      break;
    case ChannelKind::transforms:
    case ChannelKind::clock:
    case ChannelKind::contacts:
      initial_.frame = true;
      made.initial_state_sent = true;
      break;
    default: made.initial_state_sent = true;
  }
  to.subscribers.push_back(made);
  if (to.kind == ChannelKind::status) send_status(true);
  if (to.kind == ChannelKind::log)
    for (const auto& [stamp, bytes] : log_lines_) send(made, {to.info, stamp, bytes}, true);
  subscriptions_changed_ = true;
  graph_changed_ = true;
  return {};
}

Status Hub::unsubscribe(ClientId id, std::uint32_t subscription) {
  Client& client = clients_.at(id);
  const auto found = client.subscriptions.find(subscription);
  if (found == client.subscriptions.end())
    return Error{"there is no subscription " + std::to_string(subscription)};
  const std::uint32_t channel_id = found->second;
  client.subscriptions.erase(found);
  leave_channel(id, channel_id, subscription);
  const auto left = channels_.find(channel_id);
  if (left != channels_.end() && left->second.owner != 0) {
    const std::uint32_t gone[] = {channel_id};
    remove_channel(channel_id);
    client.face->remove_channels(gone);
  }
  subscriptions_changed_ = true;
  graph_changed_ = true;
  return {};
}

Status Hub::subscribe_parameters(ClientId id, const std::vector<std::string>& names, bool subscribe) {
  Client& client = clients_.at(id);
  if (!sees_world(client)) return Error{"parameters are for those who see the world"};
  if (names.empty()) {
    client.all_parameters = subscribe;
    if (!subscribe) client.parameters.clear();
  }
  for (const std::string& name : names) {
    if (!subscribe) client.parameters.erase(name);
    else if (client.parameters.size() < most_subscriptions) client.parameters.insert(name);
    else return Error{"more than 10000 parameters are subscribed to"};
  }
  subscriptions_changed_ = true;
  return {};
}

void Hub::subscribe_graph(ClientId id, bool subscribe) {
  Client& client = clients_.at(id);
  if (!sees_world(client)) return refuse(id, "the graph is for those who see the world");
  client.graph = subscribe;
  if (subscribe) send_graph(id);
}

void Hub::leave_channel(ClientId id, std::uint32_t channel_id, std::uint32_t subscription) {
  const auto found = channels_.find(channel_id);
  if (found == channels_.end()) return;
  std::erase_if(found->second.subscribers,
                [&](const Subscriber& each) { return each.client == id && each.id == subscription; });
}

void Hub::remove_channel(std::uint32_t id) {
  const auto found = channels_.find(id);
  if (found == channels_.end()) return;
  for (const Subscriber& each : found->second.subscribers)
    if (Client* const client = find(each.client)) client->subscriptions.erase(each.id);
  if (found->second.kind == ChannelKind::watch) {
    watched_ -= found->second.numbers;
    if (Client* const owner = find(found->second.owner)) owner->watched -= found->second.numbers;
    post([feed = feed_, id](Session&) { feed->unwatch(id); });
  }
  channels_.erase(found);
  subscriptions_changed_ = true;
}

/// Advertises in portions: ten thousand robots have many channels, and a queue has an end.
void Hub::advertise_waiting(ClientId id, Client& client) {
  while (client.advertised_below < next_channel_ && transport_->waiting_bytes(id) < patient_bytes) {
    std::vector<const ChannelInfo*> batch;
    auto next = channels_.lower_bound(client.advertised_below);
    for (; next != channels_.end() && batch.size() < portion; ++next)
      if (next->second.owner == 0 && may_see(client, id, next->second)) batch.push_back(&next->second.info);
    client.advertised_below = next == channels_.end() ? next_channel_ : next->first;
    if (!batch.empty()) client.face->add_channels(batch);
  }
}

/// What a request of a client takes of the run's time counts against its requests.
bool Hub::post(std::function<void(Session&)> task) {
  if (calling_ == 0) return session_.post(std::move(task));
  return session_.post([mailbox = mailbox_, id = calling_, task = std::move(task)](Session& session) {
    const auto begin = Clock::now();
    task(session);
    const double used_s = std::chrono::duration<double>(Clock::now() - begin).count();
    if (used_s > free_work_s) mailbox->push([id, used_s](Hub& hub) { hub.charge(id, used_s); });
  });
}

void Hub::charge(ClientId id, double seconds) {
  if (Client* const client = find(id))
    client->budget = std::max(-most_requests_per_s, client->budget - seconds * requests_per_work_s);
}

/// Brings changed subscriptions to the simulation's thread.
void Hub::flush(bool at_once) {
  const bool initial_wanted = initial_.frame || initial_.world || initial_.transforms_static ||
                              !initial_.latest.empty();
  const auto now = Clock::now();
  if ((!subscriptions_changed_ && !initial_wanted) || (now < flushed_ + flush_pause && !at_once)) return;
  // What the simulation's thread has to copy from now on.
  auto summary = std::make_shared<SubscriptionSummary>();
  summary->clients = !clients_.empty();
  summary->frames = subscribed(ChannelKind::poses) || subscribed(ChannelKind::transforms) ||
                    subscribed(ChannelKind::clock);
  summary->contacts = subscribed(ChannelKind::contacts);
  const auto channel_wanted = [&](ChannelKind kind) { return subscribed(kind) ? channel(kind).info.id : 0; };
  summary->deliveries = channel_wanted(ChannelKind::deliveries);
  summary->batteries = channel_wanted(ChannelKind::batteries);
  summary->step_times = channel_wanted(ChannelKind::step_times);
  summary->commands = subscribed(ChannelKind::commands);
  summary->world = subscribed(ChannelKind::world);
  summary->transforms_static = subscribed(ChannelKind::transforms_static);
  for (const auto& [id, client] : clients_)
    if (client.all_parameters || !client.parameters.empty()) summary->parameters = true;
  for (const auto& [id, each] : channels_)
    if (each.kind == ChannelKind::device && !each.subscribers.empty())
      summary->topics.emplace_back(id, each.info.topic);
  std::sort(initial_.latest.begin(), initial_.latest.end());
  const bool posted = post([feed = feed_, summary, initial = initial_](Session&) {
    feed->set_subscriptions(summary);
    feed->send_initial(initial);
  });
  flushed_ = now;
  if (!posted) return;  // the timer tries again
  subscriptions_changed_ = false;
  initial_ = {};
  looking_ = summary->clients;
}

void Hub::timer() {
  drain();
  // The state of the run and the clock, five times a second even while nothing changes.
  const auto now = Clock::now();
  state_changed();
  if (now >= status_sent_ + 200ms) send_status();
  if (now >= time_sent_ + 200ms) send_time(report_.now);
  // A frame out of turn: a subscriber lacks its key frame, or the run stands still behind what viewers have seen.
  const Channel& poses = channel(ChannelKind::poses);
  const bool key_missing = std::any_of(poses.subscribers.begin(), poses.subscribers.end(),
                                       [](const Subscriber& each) { return !each.initial_state_sent; });
  if ((feed_->stale() || key_missing) && !looking_ && now >= framed_ + 80ms && now >= looked_ + 80ms) {
    initial_.frame = true;
    looked_ = now;
  }
  for (auto& [id, client] : clients_) advertise_waiting(id, client);
  watch_claims();
  watch_clients();
  // Watches whose subscriber has not come.
  std::vector<std::uint32_t> unused;
  for (auto& [id, each] : channels_) {
    if (each.kind != ChannelKind::watch) continue;
    if (!each.subscribers.empty()) each.unused_since = now;
    else if (now >= each.unused_since + watch_patience) unused.push_back(id);
  }
  for (const std::uint32_t id : unused) {
    const std::uint32_t gone[] = {id};
    if (const Client* const owner = find(channels_.at(id).owner)) owner->face->remove_channels(gone);
    remove_channel(id);
  }
  if (graph_changed_ && now >= graph_sent_ + 1s) send_graph();
  flush();
}

void Hub::drain() {
  if (draining_) return;
  draining_ = true;
  mailbox_->take(items_);
  for (QueuedItem& item : items_) {
    if (item.task) item.task(*this);
    else send_batch(item.batch);
  }
  items_.clear();
  draining_ = false;
  counts_.dropped = mailbox_->dropped();
  flush();
}

}  // namespace sandlot::server
