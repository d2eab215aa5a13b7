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

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

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
  add_channel(ChannelKind::transforms, "/tf", "cdr", "tf2_msgs/msg/TFMessage");
  add_channel(ChannelKind::transforms_static, "/tf_static", "cdr", "tf2_msgs/msg/TFMessage");
  add_channel(ChannelKind::clock, "/clock", "cdr", "rosgraph_msgs/msg/Clock");
  add_channel(ChannelKind::log, "/rosout", "cdr", "rcl_interfaces/msg/Log");
  report_ = session_.report();
}

std::uint32_t Hub::add_channel(ChannelKind kind, const char* topic, const char* encoding,
                               const char* schema) {
  const std::uint32_t id = next_channel_++;
  Channel& made = channels_[id];
  made.kind = kind;
  made.advertised = {id, topic, encoding, schema, "", ""};
  if (made.advertised.encoding == "json") {
    made.advertised.schema = R"({"type":"object"})";
    made.advertised.schema_encoding = "jsonschema";
  } else if (made.advertised.encoding == "cdr") {
    made.advertised.schema = find_message(schema).value()->schema;
    made.advertised.schema_encoding = "ros2msg";
  }
  if (kind != ChannelKind::device && kind != ChannelKind::watch) fixed_[static_cast<std::size_t>(kind)] = id;
  return id;
}

Hub::Client* Hub::find(ClientId id) {
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : &found->second;
}

void Hub::connected(ClientId id, bool may_steer) {
  Client& client = clients_[id];
  client.may_steer = may_steer;
  client.budgeted = client.refusals_since = Clock::now();
  foxglove::ServerInfo info;
  info.name = options_.name;
  info.capabilities = {"clientPublish",   "time",  "parameters", "parametersSubscribe", "services",
                       "connectionGraph", "assets"};
  info.encodings = {"cdr", "json"};
  info.metadata = {{"ROS_DISTRO", "humble"},
                   {"sandlot_version", options_.version},
                   {"sandlot_role", may_steer ? "admin" : "spectator"}};
  info.session_id = session_id_;
  transport_->send_text(id, foxglove::server_info(info));
  std::vector<foxglove::Service> offered;
  for (const Service& service : services())
    offered.push_back(
        offered_service(static_cast<std::uint32_t>(offered.size() + 1), service.name, *service.type));
  for (const auto& [number, service] : device_services_)
    offered.push_back(offered_service(number, service.name, service.type));
  transport_->send_text(id, foxglove::advertise_services(offered));
  advertise_waiting(id, client);
  subscriptions_changed_ = true;
  graph_changed_ = true;
  flush();
}

void Hub::disconnected(ClientId id) {
  Client* const client = find(id);
  if (!client) return;
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

bool Hub::refuse(ClientId id, const std::string& why, std::string_view about) {
  ++counts_.refused;
  Client* const client = find(id);
  if (!client) return false;
  const auto now = Clock::now();
  if (now > client->refusals_since + 1s) {
    client->refusals_since = now;
    client->errors = 0;
    if (client->refusals_unsent > 0)
      transport_->send_text(id, foxglove::status(Level::error, std::to_string(client->refusals_unsent) +
                                                                   " more requests were refused"));
    client->refusals_unsent = 0;
  }
  if (++client->errors <= most_refusals_per_s)
    transport_->send_text(id, foxglove::status(Level::error, why, about));
  else ++client->refusals_unsent;
  return false;
}

bool Hub::within_budget(ClientId id, Client& client) {
  const auto now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - client.budgeted).count();
  client.budgeted = now;
  client.budget = std::min(most_requests_per_s, client.budget + passed_s * most_requests_per_s);
  if (client.budget < 1)
    return refuse(id, "more than " + number_text(most_requests_per_s) + " requests in a second");
  client.budget -= 1;
  return true;
}

void Hub::message(ClientId id, std::span<const std::byte> bytes, bool text) {
  Client* const client = find(id);
  if (!client) return;
  const auto read = text ? foxglove::read_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()})
                         : foxglove::read_binary(bytes);
  const auto* const called = read ? std::get_if<foxglove::CallService>(&*read) : nullptr;
  if (!within_budget(id, *client)) {
    if (called)
      transport_->send_text(id,
                            foxglove::service_failure(called->service, called->call, "too many requests"));
    return;
  }
  if (!read) {
    refuse(id, read.error().text());
    return;
  }
  handle(id, *client, *read);
  flush();
}

void Hub::handle(ClientId id, Client& client, const foxglove::ClientMessage& message) {
  std::visit(Overloaded{
                 [&](const foxglove::Subscribe& m) { subscribe(id, client, m); },
                 [&](const foxglove::Unsubscribe& m) {
                   for (const std::uint32_t each : m.ids) unsubscribe(id, client, each);
                 },
                 [&](const foxglove::Advertise& m) { advertise(id, client, m); },
                 [&](const foxglove::Unadvertise& m) {
                   for (const std::uint32_t each : m.ids) client.publications.erase(each);
                   graph_changed_ = true;
                 },
                 [&](const foxglove::GetParameters& m) { get_parameters(id, client, m); },
                 [&](const foxglove::SetParameters& m) { set_parameters(id, client, m); },
                 [&](const foxglove::SubscribeParameters& m) {
                   if (m.names.empty()) {
                     client.all_parameters = m.subscribe;
                     if (!m.subscribe) client.parameters.clear();
                   }
                   for (const std::string& name : m.names) {
                     if (!m.subscribe) client.parameters.erase(name);
                     else if (client.parameters.size() < most_subscriptions) client.parameters.insert(name);
                     else return void(refuse(id, "more than 10000 parameters are subscribed to"));
                   }
                   subscriptions_changed_ = true;
                 },
                 [&](const foxglove::SubscribeGraph& m) {
                   client.graph = m.subscribe;
                   if (m.subscribe) send_graph(true);
                 },
                 [&](const foxglove::FetchAsset& m) { fetch(id, m); },
                 [&](const foxglove::ClientData& m) { publish(id, client, m); },
                 [&](const foxglove::CallService& m) { call(id, client, m); },
                 [&](const foxglove::PlaybackControl&) {
                   refuse(id, "playback control is not known here; say it to /sandlot/console");
                 },
             },
             message);
}

void Hub::subscribe(ClientId id, Client& client, const foxglove::Subscribe& request) {
  std::size_t too_many = 0, refused = 0;
  std::string why;
  const auto no = [&](std::string text) {
    if (refused++ == 0) why = std::move(text);
  };
  for (const auto& [subscription, channel_id] : request.subscriptions) {
    if (client.subscriptions.size() >= most_subscriptions) {
      ++too_many;
      continue;
    }
    const auto found = channels_.find(channel_id);
    if (found == channels_.end() || (found->second.owner != 0 && found->second.owner != id)) {
      no("there is no channel " + std::to_string(channel_id));
      continue;
    }
    Channel& to = found->second;
    if (client.subscriptions.count(subscription) > 0) {
      no("subscription " + std::to_string(subscription) + " is there already");
      continue;
    }
    if (std::any_of(to.subscribers.begin(), to.subscribers.end(),
                    [&](const Subscriber& each) { return each.client == id; })) {
      no("channel " + std::to_string(channel_id) + " is subscribed to already");
      continue;
    }
    client.subscriptions[subscription] = channel_id;
    Subscriber made{id, subscription, false};
    switch (to.kind) {
      case ChannelKind::device:
      case ChannelKind::watch: initial_.latest.push_back(channel_id); break;
      case ChannelKind::world: initial_.world = true; break;
      case ChannelKind::transforms_static: initial_.transforms_static = true; break;
      case ChannelKind::poses: initial_.frame = true; break;
      case ChannelKind::status: break;
      case ChannelKind::transforms:
      case ChannelKind::clock:
      case ChannelKind::contacts:
        initial_.frame = true;
        made.initial_state_sent = true;
        break;
      default: made.initial_state_sent = true;
    }
    to.subscribers.push_back(made);
    if (to.kind == ChannelKind::status) send_status();
  }
  subscriptions_changed_ = true;
  graph_changed_ = true;
  if (refused > 0)
    refuse(id, refused == 1 ? why : why + ", and " + std::to_string(refused - 1) + " more were refused");
  if (too_many > 0)
    refuse(id, std::to_string(too_many) + " subscriptions beyond " + std::to_string(most_subscriptions) +
                   " were refused");
}

void Hub::unsubscribe(ClientId id, Client& client, std::uint32_t subscription) {
  const auto found = client.subscriptions.find(subscription);
  if (found == client.subscriptions.end())
    return void(refuse(id, "there is no subscription " + std::to_string(subscription)));
  const std::uint32_t channel_id = found->second;
  client.subscriptions.erase(found);
  leave_channel(id, channel_id, subscription);
  const auto left = channels_.find(channel_id);
  if (left != channels_.end() && left->second.owner != 0) {
    const std::uint32_t gone[] = {channel_id};
    remove_channel(channel_id);
    transport_->send_text(id, foxglove::unadvertise(gone));
  }
  subscriptions_changed_ = true;
  graph_changed_ = true;
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
    std::vector<foxglove::Channel> batch;
    auto next = channels_.lower_bound(client.advertised_below);
    for (; next != channels_.end() && batch.size() < portion; ++next)
      if (next->second.owner == 0) batch.push_back(next->second.advertised);
    client.advertised_below = next == channels_.end() ? next_channel_ : next->first;
    if (!batch.empty()) transport_->send_text(id, foxglove::advertise(batch));
  }
}

void Hub::fetch(ClientId id, const foxglove::FetchAsset& request) {
  constexpr std::string_view scheme = "sandlot://";
  std::vector<std::byte> out;
  if (starts_with(request.uri, scheme)) {
    const auto body = assets_.get(std::string_view(request.uri).substr(scheme.size()));
    out = body ? foxglove::asset(request.request, *body->bytes)
               : foxglove::asset_error(request.request, body.error().text());
  } else {
    out = foxglove::asset_error(request.request,
                                "assets are called as the world names them: sandlot://mesh/a5");
  }
  if (out.size() > 4 && out[5] != std::byte{0}) ++counts_.refused;
  transport_->send(id, {}, std::make_shared<const std::vector<std::byte>>(std::move(out)), false, false);
}

bool Hub::post(std::function<void(Session&)> task) { return session_.post(std::move(task)); }

/// Brings changed subscriptions to the simulation's thread.
void Hub::flush() {
  const bool initial_wanted = initial_.frame || initial_.world || initial_.transforms_static ||
                              !initial_.latest.empty();
  const auto now = Clock::now();
  if ((!subscriptions_changed_ && !initial_wanted) || now < flushed_ + flush_pause) return;
  // What the simulation's thread has to copy from now on.
  auto summary = std::make_shared<SubscriptionSummary>();
  summary->clients = !clients_.empty();
  summary->frames = subscribed(ChannelKind::poses) || subscribed(ChannelKind::transforms) ||
                    subscribed(ChannelKind::clock);
  summary->contacts = subscribed(ChannelKind::contacts);
  summary->commands = subscribed(ChannelKind::commands);
  summary->world = subscribed(ChannelKind::world);
  counts_.log_read = subscribed(ChannelKind::log);
  summary->transforms_static = subscribed(ChannelKind::transforms_static);
  for (const auto& [id, client] : clients_)
    if (client.all_parameters || !client.parameters.empty()) summary->parameters = true;
  for (const auto& [id, each] : channels_)
    if (each.kind == ChannelKind::device && !each.subscribers.empty())
      summary->topics.emplace_back(id, each.advertised.topic);
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
  // Watches whose subscriber has not come.
  std::vector<std::uint32_t> unused;
  for (auto& [id, each] : channels_) {
    if (each.kind != ChannelKind::watch) continue;
    if (!each.subscribers.empty()) each.unused_since = now;
    else if (now >= each.unused_since + watch_patience) unused.push_back(id);
  }
  for (const std::uint32_t id : unused) {
    const std::uint32_t gone[] = {id};
    transport_->send_text(channels_.at(id).owner, foxglove::unadvertise(gone));
    remove_channel(id);
  }
  if (graph_changed_ && now >= graph_sent_ + 1s) send_graph(false);
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
