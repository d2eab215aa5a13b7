#include "server/clients/hub.h"

#include <algorithm>

#include "base/text.h"

namespace sandlot::server {
namespace {

using namespace std::chrono_literals;
using foxglove::Level;

constexpr auto flush_pause =
    20ms;  ///< between two changes of what all want: the simulation's thread carries them out
constexpr auto watch_patience = 10s;             ///< a watch without its subscriber goes
constexpr std::size_t portion = 256;             ///< channels in one message
constexpr std::size_t patient_bytes = 4u << 20;  ///< so much may wait when more channels are told
constexpr int complaints_per_s = 20;

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
  add_channel(What::world, "/sandlot/world", "json", "sandlot.World");
  add_channel(What::status, "/sandlot/status", "json", "sandlot.Status");
  add_channel(What::commands, "/sandlot/commands", "json", "sandlot.Commands");
  add_channel(What::poses, "/sandlot/poses", "sandlot-poses", "sandlot.Poses");
  add_channel(What::contacts, "/sandlot/contacts", "sandlot-contacts", "sandlot.Contacts");
  add_channel(What::transforms, "/tf", "cdr", "tf2_msgs/msg/TFMessage");
  add_channel(What::transforms_static, "/tf_static", "cdr", "tf2_msgs/msg/TFMessage");
  add_channel(What::clock, "/clock", "cdr", "rosgraph_msgs/msg/Clock");
  add_channel(What::log, "/rosout", "cdr", "rcl_interfaces/msg/Log");
  add_services();
  report_ = session_.report();
}

std::uint32_t Hub::add_channel(What what, const char* topic, const char* encoding, const char* schema) {
  const std::uint32_t id = next_channel_++;
  Channel& made = channels_[id];
  made.what = what;
  made.said = {id, topic, encoding, schema, "", ""};
  if (made.said.encoding == "json") {
    made.said.schema = R"({"type":"object"})";
    made.said.schema_encoding = "jsonschema";
  } else if (made.said.encoding == "cdr") {
    made.said.schema = find_message(schema).value()->schema;
    made.said.schema_encoding = "ros2msg";
  }
  if (what != What::device && what != What::watch) fixed_[static_cast<std::size_t>(what)] = id;
  return id;
}

Hub::Client* Hub::find(ClientId id) {
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : &found->second;
}

void Hub::connected(ClientId id, bool may_steer) {
  Client& client = clients_[id];
  client.may_steer = may_steer;
  client.budgeted = client.complained = Clock::now();
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
  std::vector<foxglove::Service> services;
  for (std::size_t i = 0; i < services_.size(); ++i) {
    const ServiceInfo& type = *services_[i].type;
    const auto side = [](const MessageInfo& message) {
      return foxglove::Service::Side{"cdr", message.name, "ros2msg", message.schema};
    };
    services.push_back({static_cast<std::uint32_t>(i + 1), services_[i].name, type.name, side(*type.request),
                        side(*type.response)});
  }
  transport_->send_text(id, foxglove::advertise_services(services));
  advertise_waiting(id, client);
  interest_changed_ = true;
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
  interest_changed_ = true;
  graph_changed_ = true;
  flush();
}

bool Hub::refuse(ClientId id, const std::string& why, std::string_view about) {
  ++counts_.refused;
  Client* const client = find(id);
  if (!client) return false;
  const auto now = Clock::now();
  if (now > client->complained + 1s) {
    client->complained = now;
    client->complaints = 0;
    if (client->kept_quiet > 0)
      transport_->send_text(id, foxglove::status(Level::error, std::to_string(client->kept_quiet) +
                                                                   " more requests were refused"));
    client->kept_quiet = 0;
  }
  if (++client->complaints <= complaints_per_s)
    transport_->send_text(id, foxglove::status(Level::error, why, about));
  else ++client->kept_quiet;
  return false;
}

bool Hub::may_ask(ClientId id, Client& client) {
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
  if (!may_ask(id, *client)) {
    if (called)
      transport_->send_text(id,
                            foxglove::service_failure(called->service, called->call, "too many requests"));
    return;
  }
  if (!read) {
    refuse(id, read.error().text());
    return;
  }
  obey(id, *client, *read);
  flush();
}

void Hub::obey(ClientId id, Client& client, const foxglove::ClientMessage& message) {
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
                   interest_changed_ = true;
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
    switch (to.what) {
      case What::device:
      case What::watch: demand_.latest.push_back(channel_id); break;
      case What::world: demand_.world = true; break;
      case What::transforms_static: demand_.transforms_static = true; break;
      case What::poses: demand_.frame = true; break;
      case What::status: break;
      case What::transforms:
      case What::clock:
      case What::contacts:
        demand_.frame = true;
        made.primed = true;
        break;
      default: made.primed = true;
    }
    to.subscribers.push_back(made);
    if (to.what == What::status) send_status();
  }
  interest_changed_ = true;
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
  interest_changed_ = true;
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
  if (found->second.what == What::watch) {
    watched_ -= found->second.numbers;
    if (Client* const owner = find(found->second.owner)) owner->watched -= found->second.numbers;
    post([feed = feed_, id](Session&) { feed->unwatch(id); });
  }
  channels_.erase(found);
  interest_changed_ = true;
}

/// Ten thousand robots have many channels, and a queue has an end: they are told in portions.
void Hub::advertise_waiting(ClientId id, Client& client) {
  while (client.told_channels < next_channel_ && transport_->waiting_bytes(id) < patient_bytes) {
    std::vector<foxglove::Channel> told;
    auto next = channels_.lower_bound(client.told_channels);
    for (; next != channels_.end() && told.size() < portion; ++next)
      if (next->second.owner == 0) told.push_back(next->second.said);
    client.told_channels = next == channels_.end() ? next_channel_ : next->first;
    if (!told.empty()) transport_->send_text(id, foxglove::advertise(told));
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

/// Tells the simulation's thread what is wanted now.
void Hub::flush() {
  const bool demanded = demand_.frame || demand_.world || demand_.transforms_static ||
                        !demand_.latest.empty();
  const auto now = Clock::now();
  if ((!interest_changed_ && !demanded) || now < flushed_ + flush_pause) return;
  auto interest = std::make_shared<Interest>();
  interest->clients = !clients_.empty();
  interest->frames = subscribed(What::poses) || subscribed(What::transforms) || subscribed(What::clock);
  interest->contacts = subscribed(What::contacts);
  interest->commands = subscribed(What::commands);
  interest->world = subscribed(What::world);
  counts_.log_read = subscribed(What::log);
  interest->transforms_static = subscribed(What::transforms_static);
  for (const auto& [id, client] : clients_)
    if (client.all_parameters || !client.parameters.empty()) interest->parameters = true;
  for (const auto& [id, each] : channels_)
    if (each.what == What::device && !each.subscribers.empty())
      interest->topics.emplace_back(id, each.said.topic);
  std::sort(demand_.latest.begin(), demand_.latest.end());
  const bool posted = post([feed = feed_, interest, demand = demand_](Session&) {
    feed->attend(interest);
    feed->look(demand);
  });
  flushed_ = now;
  if (!posted) return;  // the timer tries again
  interest_changed_ = false;
  demand_ = {};
  looking_ = interest->clients;
}

void Hub::timer() {
  drain();
  const auto now = Clock::now();
  state_changed();
  if (now >= status_sent_ + 200ms) send_status();
  if (now >= time_sent_ + 200ms) send_time(report_.now);
  const Channel& poses = channel(What::poses);
  const bool key_missing = std::any_of(poses.subscribers.begin(), poses.subscribers.end(),
                                       [](const Subscriber& each) { return !each.primed; });
  if ((feed_->stale() || key_missing) && !looking_ && now >= framed_ + 80ms && now >= looked_ + 80ms) {
    demand_.frame = true;
    looked_ = now;
  }
  for (auto& [id, client] : clients_) advertise_waiting(id, client);
  std::vector<std::uint32_t> unused;
  for (auto& [id, each] : channels_) {
    if (each.what != What::watch) continue;
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
  mailbox_->take(mail_);
  for (Mail& mail : mail_) {
    if (mail.errand) mail.errand(*this);
    else send_batch(mail.batch);
  }
  mail_.clear();
  draining_ = false;
  counts_.dropped = mailbox_->dropped();
  flush();
}

}  // namespace sandlot::server
