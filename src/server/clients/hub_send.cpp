/// Messages to clients: worlds, poses, topics, state of the run.
#include <algorithm>

#include "base/json_writer.h"
#include "messages/rcl_interfaces.h"
#include "messages/tf2_msgs.h"
#include "server/clients/hub.h"
#include "sim/world/transforms.h"

namespace sandlot::server {
namespace {

template <class M>
Payload cdr_of(const M& message) {
  auto bytes = std::make_shared<std::vector<std::byte>>();
  write_cdr(message_info<M>(), &message, *bytes);
  return bytes;
}

}  // namespace

bool Hub::send(const Subscriber& to, const Outgoing& message, bool droppable) {
  const Client* const client = find(to.client);
  return client && client->face->deliver(to.id, message, droppable);
}

void Hub::send_to_all(Channel& channel, Time stamp, const Payload& bytes, bool droppable) {
  const Outgoing message(channel.info, stamp, bytes);
  for (const Subscriber& each : channel.subscribers)
    if (each.initial_state_sent) send(each, message, droppable);
}

void Hub::send_time(Time now) {
  time_sent_ = Clock::now();
  Payload shared;
  for (const auto& [id, client] : clients_)
    if (!client.subscriptions.empty()) client.face->tell_time(now, shared);
}

void Hub::send_world(const WorldUpdate& update) {
  if (update.inventory) {
    const bool other_world = inventory_->epoch != update.inventory->epoch;
    // Names of the new channels are judged by the new world.
    inventory_ = update.inventory;
    adopt(*inventory_);
    if (other_world)
      for (auto& [id, client] : clients_) revoke(id, client);
    // Its programs are others: they are answered for by the same clients.
    if (other_world)
      for (const auto& [id, client] : clients_)
        if (client.claim && client.claim->request.lockstep) attach(id, nullptr);
  }
  const auto latch = [&](ChannelKind kind, const Payload& payload, Payload& last) {
    if (!payload) return;
    const Outgoing message(channel(kind).info, update.now, payload);
    for (Subscriber& each : channel(kind).subscribers)
      if (!each.initial_state_sent || payload != last) each.initial_state_sent = send(each, message, false);
    last = payload;
  };
  latch(ChannelKind::world, update.world, world_);
  latch(ChannelKind::transforms_static, update.transforms_static, transforms_static_);
}

/// Channels come and go with the devices; those whose name and type stay keep their number.
void Hub::adopt(const Inventory& inventory) {
  std::map<std::pair<std::string, std::string>, std::uint32_t> now;
  for (const Inventory::Topic& topic : inventory.topics) {
    const auto key = std::pair(topic.name, topic.info->name);
    const auto known = devices_.find(key);
    if (known != devices_.end()) {
      now[key] = known->second;
      devices_.erase(known);
    } else {
      now[key] = add_channel(ChannelKind::device, topic.name.c_str(), "cdr", topic.info->name.c_str());
    }
  }
  if (!devices_.empty()) {
    std::vector<std::uint32_t> gone;
    for (const auto& [key, id] : devices_) gone.push_back(id);
    for (const std::uint32_t id : gone) remove_channel(id);
    for (const auto& [id, client] : clients_) {
      std::vector<std::uint32_t> known;
      for (const std::uint32_t each : gone)
        if (each < client.advertised_below) known.push_back(each);
      if (!known.empty()) client.face->remove_channels(known);
    }
  }
  devices_ = std::move(now);
  adopt_services(inventory);
  for (auto& [id, client] : clients_) advertise_waiting(id, client);
  graph_changed_ = true;
}

void Hub::send_latest(std::span<const ChannelMessage> latest, std::span<const std::uint32_t> channels) {
  looking_ = false;
  for (const ChannelMessage& message : latest) {
    const auto found = channels_.find(message.channel);
    if (found == channels_.end()) continue;
    const Outgoing outgoing(found->second.info, message.stamp, message.bytes);
    for (const Subscriber& each : found->second.subscribers)
      if (!each.initial_state_sent) send(each, outgoing, true);
  }
  for (const std::uint32_t id : channels) {
    const auto found = channels_.find(id);
    if (found == channels_.end()) continue;
    for (Subscriber& each : found->second.subscribers) each.initial_state_sent = true;
  }
}

void Hub::send_batch(Batch& batch) {
  now_ = batch.now;
  send_time(batch.now);
  for (const ChannelMessage& message : batch.messages) {
    const auto found = channels_.find(message.channel);
    if (found != channels_.end()) send_to_all(found->second, message.stamp, message.bytes);
  }
  if (batch.commands) send_to_all(channel(ChannelKind::commands), batch.now, batch.commands, false);
  if (!batch.frame) return;
  framed_ = Clock::now();
  send_poses(batch);
  if (subscribed(ChannelKind::transforms)) {
    transforms_of(*batch.frame, transforms_);
    send_to_all(channel(ChannelKind::transforms), batch.now, cdr_of(transforms_));
  }
  if (subscribed(ChannelKind::clock)) {
    msg::Clock clock;
    clock.clock = batch.now;
    send_to_all(channel(ChannelKind::clock), batch.now, cdr_of(clock));
  }
  if (batch.contacts && subscribed(ChannelKind::contacts)) {
    auto bytes = std::make_shared<std::vector<std::byte>>();
    wire::write_contacts(*batch.frame, *bytes);
    send_to_all(channel(ChannelKind::contacts), batch.now, bytes);
  }
  mailbox_->give_back(std::move(batch.frame));
}

void Hub::send_poses(const Batch& batch) {
  std::vector<Subscriber>& subscribers = channel(ChannelKind::poses).subscribers;
  if (subscribers.empty()) return;
  if (batch.epoch != poses_epoch_) {
    poses_ = {};
    poses_epoch_ = batch.epoch;
    for (Subscriber& each : subscribers) each.initial_state_sent = false;
  }
  const auto has_initial_state = [](const Subscriber& each) { return each.initial_state_sent; };
  if (std::any_of(subscribers.begin(), subscribers.end(), has_initial_state)) {
    auto bytes = std::make_shared<std::vector<std::byte>>();
    if (poses_.write(*batch.frame, batch.epoch, false, *bytes)) {
      const Outgoing message(channel(ChannelKind::poses).info, batch.now, bytes);
      for (Subscriber& each : subscribers)
        if (each.initial_state_sent) each.initial_state_sent = send(each, message, true);
    }
  }
  if (std::all_of(subscribers.begin(), subscribers.end(), has_initial_state)) return;
  // Who has missed something needs all; but not before there is room for it.
  constexpr std::size_t room_bytes = 4u << 20;
  auto bytes = std::make_shared<std::vector<std::byte>>();
  for (Subscriber& each : subscribers) {
    if (each.initial_state_sent || transport_->waiting_bytes(each.client) > room_bytes) continue;
    if (bytes->empty()) poses_.write(*batch.frame, batch.epoch, true, *bytes);
    each.initial_state_sent = send(each, {channel(ChannelKind::poses).info, batch.now, bytes}, true);
  }
}

void Hub::state_changed() {
  const Session::Report before = std::exchange(report_, session_.report());
  end_waiting();
  if (report_.state == before.state && report_.epoch == before.epoch && report_.speed == before.speed &&
      report_.reason == before.reason && report_.takes_no_input == before.takes_no_input &&
      report_.target == before.target &&
      (report_.state == Session::State::playing || report_.tick == before.tick))
    return;
  if (report_.epoch != before.epoch || report_.state != Session::State::playing) initial_.frame = true;
  if (report_.state != before.state && !report_.reason.empty())
    send_log(report_.state == Session::State::failed ? 40 : 20, report_.reason);
  if (report_.speed != before.speed ||
      (report_.state == Session::State::paused) != (before.state == Session::State::paused))
    send_own_parameters();
  send_status();
  flush();
}

void Hub::send_status(bool to_new_ones_only) {
  if (!to_new_ones_only) status_sent_ = Clock::now();
  std::vector<Subscriber>& subscribers = channel(ChannelKind::status).subscribers;
  if (subscribers.empty()) return;
  std::optional<ServerOptions::Recording> recording;
  if (options_.recording) recording = options_.recording();
  const auto write = [&](bool admin, bool scoped) {
    const std::string& why_not = !report_.takes_no_input.empty() ? report_.takes_no_input
                                                                 : report_.may_not_rewind;
    std::string out;
    JsonWriter w(out);
    const auto seconds = [&](const char* key, const std::optional<Time>& time) {
      if (time) w.key(key).real(time->s());
      else w.key(key).null();
    };
    w.object([&] {
      w.key("state").text(Session::name_of(report_.state));
      w.key("time_s").real(report_.now.s());
      w.key("tick").integer(report_.tick);
      w.key("step_s").real(report_.step.s());
      if (report_.speed) w.key("speed").real(*report_.speed);
      else w.key("speed").null();
      w.key("real_time_factor").real(report_.real_time_factor);
      w.key("late_ticks").integer(report_.late_ticks);
      w.key("reason").text(report_.reason);
      w.key("begin_s").real(report_.begin.s());
      seconds("end_s", report_.end);
      w.key("kept_from_s").real(report_.kept_from.s());
      w.key("history_s").list([&] {
        for (const Time time : report_.history) w.real(time.s());
      });
      seconds("target_s", report_.target);
      w.key("may_steer").flag(admin && report_.takes_no_input.empty());
      w.key("may_rewind").flag(admin && report_.may_not_rewind.empty());
      w.key("why_not").text(admin ? why_not : scoped ? "you drive a robot" : "you are a spectator");
      w.key("replay").flag(report_.replay);
      if (recording && !scoped)
        w.key("recording").object([&] {
          w.key("file").text(recording->file);
          w.key("messages").integer(recording->messages);
          w.key("bytes").integer(recording->bytes);
        });
      else w.key("recording").null();
      w.key("viewers").integer(clients_.size());
      w.key("epoch").integer(report_.epoch);
      w.key("dropped_frames").integer(mailbox_->dropped());
    });
    return payload_of(out);
  };
  const ChannelInfo& info = channel(ChannelKind::status).info;
  const Outgoing admins(info, report_.now, write(true, false)),
      spectators(info, report_.now, write(false, false)), drivers(info, report_.now, write(false, true));
  for (Subscriber& each : subscribers) {
    const Client* const client = find(each.client);
    if (!client || (to_new_ones_only && each.initial_state_sent)) continue;
    const Access& access = client->access;
    const bool sent = send(each,
                           access.is_admin()    ? admins
                           : access.is_scoped() ? drivers
                                                : spectators,
                           true);
    each.initial_state_sent = each.initial_state_sent || sent;
  }
}

void Hub::send_log(std::uint8_t level, const std::string& text) {
  constexpr std::size_t most_lines = 200;
  msg::Log log;
  log.stamp = report_.now;
  log.level = level;
  log.name = "sandlot";
  log.msg = text;
  if (log_lines_.size() == most_lines) log_lines_.pop_front();
  log_lines_.emplace_back(report_.now, cdr_of(log));
  send_to_all(channel(ChannelKind::log), report_.now, log_lines_.back().second, true);
}

void Hub::answer(ClientId id, const std::function<void(Face&)>& tell) {
  Client* const client = find(id);
  if (!client) return;
  if (client->calls > 0) --client->calls;
  tell(*client->face);
}

void Hub::report_refusal(ClientId client, const std::string& why) { refuse(client, why); }

}  // namespace sandlot::server
