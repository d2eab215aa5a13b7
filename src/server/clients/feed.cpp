#include "server/clients/feed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "messages/sandlot_msgs.h"
#include "programs/remote/link.h"
#include "server/clients/hub.h"
#include "server/clients/parameters.h"
#include "server/clients/preview.h"
#include "sim/watch/parameters.h"
#include "sim/world/transforms.h"

namespace sandlot::server {
Feed::Feed(Session& session, std::shared_ptr<Mailbox> mailbox, wire::Assets assets, double poses_hz)
    : session_(session),
      mailbox_(std::move(mailbox)),
      world_writer_(std::move(assets)),
      period_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / poses_hz))),
      step_feed_(session, mailbox_),
      decisions_(session),
      match_(session) {}

void Feed::set_subscriptions(std::shared_ptr<const SubscriptionSummary> summary) {
  subscribed_ = std::move(summary);
  if (watching_ != subscribed_->clients) {
    watching_ = subscribed_->clients;
    if (watching_) session_.add_observer(this);
    else session_.remove_observer(this);
  }
  step_feed_.send_to(subscribed_->step_times);
  decisions_.attach();
  match_.attach();
  if (!subscribed_->clients) {
    topics_.clear();
    watches_.clear();
    world_ = transforms_static_ = batteries_ = nullptr;
    deliveries_ = {};
    epoch_ = 0;  // the next client gets everything
    return;
  }
  if (subscribed_->deliveries == 0) deliveries_ = {};
  if (!subscribed_->world) world_sent_ = false;
  if (!subscribed_->transforms_static) static_sent_ = false;
  find_topics();
}

void Feed::detach() {
  set_subscriptions(std::make_shared<SubscriptionSummary>());
  decisions_.detach();
  match_.detach();
}

void Feed::follow_session() {
  const Simulation& simulation = session_.simulation();
  const bool other_world = epoch_ != session_.epoch();
  if (!other_world && revision_ == simulation.revision()) return;
  epoch_ = session_.epoch();
  revision_ = simulation.revision();
  inventory_sent_ = world_sent_ = static_sent_ = false;
  find_topics();
  if (!other_world) return;
  deliveries_.clear();
  for (Watch& watch : watches_) {
    watch.begin = simulation.now();
    watch.sample = 0;
    watch.sampled_at.reset();
    for (std::size_t i = 0; i < watch.texts.size(); ++i) {
      auto value = ValueExpression::compile(simulation, watch.texts[i], {}, watch.addresses[i]);
      watch.values[i] = value ? std::optional(std::move(*value)) : std::nullopt;
    }
  }
}

void Feed::find_topics() {
  std::unordered_map<std::uint32_t, std::uint64_t> counts;
  for (const SubscribedTopic& each : topics_) counts[each.channel] = each.count;
  topics_.clear();
  previews_ = 0;
  if (subscribed_->topics.empty()) return;
  std::unordered_map<std::string_view, const TopicBase*> by_name;
  session_.simulation().for_each_topic(
      [&](const TopicBase& topic, const std::string&) { by_name[topic.name()] = &topic; });
  for (const auto& [channel, name] : subscribed_->topics) {
    auto found = by_name.find(name);
    const bool preview = found == by_name.end() && name.ends_with(preview_suffix);
    if (preview) found = by_name.find(previewed_name(name));
    const TopicBase* const topic = found == by_name.end() ? nullptr : found->second;
    const auto count = counts.find(channel);
    // Of one that nobody had subscribed to, new messages count.
    topics_.push_back({channel,
                       topic,
                       count != counts.end() ? count->second
                       : topic               ? topic->count
                                             : 0,
                       preview,
                       {},
                       topic ? session_.simulation().look_rate_hz(*topic) : std::nullopt,
                       {}});
    previews_ += preview;
  }
}

void Feed::send_world_if_changed(bool again_world, bool again_static) {
  const Simulation& simulation = session_.simulation();
  WorldUpdate update;
  update.now = simulation.now();
  if (!inventory_sent_) update.inventory = take_inventory(simulation, epoch_);
  inventory_sent_ = true;
  if (subscribed_->world && !world_sent_) world_ = payload_of(world_writer_.write(simulation, epoch_));
  if (subscribed_->world && (!world_sent_ || again_world)) update.world = world_;
  world_sent_ = subscribed_->world;
  if (subscribed_->transforms_static && !static_sent_) {
    const msg::TFMessage message = static_transforms(simulation);
    std::vector<std::byte> bytes;
    write_cdr(message_info<msg::TFMessage>(), &message, bytes);
    transforms_static_ = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  }
  if (subscribed_->transforms_static && (!static_sent_ || again_static))
    update.transforms_static = transforms_static_;
  static_sent_ = subscribed_->transforms_static;
  if (!update.inventory && !update.world && !update.transforms_static) return;
  mailbox_->push([update = std::move(update)](Hub& hub) { hub.send_world(update); });
  // A world that changes at every tick is sent twice a second.
  next_world_update_ = Clock::now() + std::chrono::milliseconds(500);
}

/// Of a device that samples on request, what it would have measured; at its rate.
void Feed::look_through(SubscribedTopic& each, Batch& batch) const {
  Simulation& simulation = session_.simulation();
  const Time now = simulation.now();
  if (now < each.next_look || (each.preview && Clock::now() < each.next)) return;
  each.next_look = *each.look_hz > 0 ? now + Time::from_s(1 / *each.look_hz) : now;
  if (const auto seen = simulation.look_through(*each.topic)) batch.messages.push_back(message(each, *seen));
}

ChannelMessage Feed::message(SubscribedTopic& each, const TopicBase& seen) const {
  auto bytes = std::make_shared<std::vector<std::byte>>();
  if (each.preview) {
    const Clock::time_point begin = Clock::now();
    if (const auto* const image = topic_cast<msg::Image>(&seen)) *bytes = preview_of(image->message);
    // All previews together take a quarter of the time at most.
    const auto rest = 4 * static_cast<Clock::rep>(previews_) * (Clock::now() - begin);
    each.next = begin + std::max<Clock::duration>(preview_period, rest);
    return {each.channel, seen.stamp, std::move(bytes)};
  }
  bytes->reserve(scratch_.capacity());
  seen.to_cdr(*bytes);
  return {each.channel, seen.stamp, std::move(bytes)};
}

void Feed::send_initial(const InitialSend& initial) {
  if (!subscribed_->clients) return;
  follow_session();
  send_world_if_changed(initial.world, initial.transforms_static);
  // What was missed, in a world that stands still or is another one.
  Batch batch;
  batch.now = session_.simulation().now();
  batch.epoch = epoch_;
  constexpr std::size_t most_bytes = 8u << 20;
  std::size_t bytes = 0;
  std::vector<ChannelMessage> latest;
  for (SubscribedTopic& each : topics_) {
    const bool wanted = std::binary_search(initial.latest.begin(), initial.latest.end(), each.channel);
    if (each.topic && each.topic->count == 0 && each.look_hz && bytes <= most_bytes) {
      look_through(each, batch);
      if (!batch.messages.empty()) bytes += batch.messages.back().bytes->size();
    }
    if (!each.topic || each.topic->count == 0) continue;
    if (!wanted && each.topic->count == each.count) continue;
    if (bytes > most_bytes) continue;  // the next message comes as well
    ChannelMessage made = message(each, *each.topic);
    bytes += made.bytes->size();
    if (each.topic->count != each.count) {
      each.count = each.topic->count;
      batch.messages.push_back(made);
    }
    if (wanted) latest.push_back(std::move(made));
  }
  const Session::State state = session_.report().state;
  const bool stands = state != Session::State::playing && state != Session::State::seeking;
  for (Watch& watch : watches_) {
    // A run that stands still sends its values, whatever the rate.
    const bool wanted = std::binary_search(initial.latest.begin(), initial.latest.end(), watch.channel);
    if (!wanted && (!stands || watch.sampled_at == batch.now)) continue;
    (wanted ? latest : batch.messages).push_back(sample(watch));
  }
  add_deliveries(batch, session_.simulation().tick_index());
  if (subscribed_->batteries != 0) {
    const bool wanted = std::binary_search(initial.latest.begin(), initial.latest.end(),
                                           subscribed_->batteries);
    const Payload changed = changed_batteries();
    if (changed) batch.messages.push_back({subscribed_->batteries, batch.now, changed});
    if (wanted) latest.push_back({subscribed_->batteries, batch.now, batteries_});
  }
  if (subscribed_->frames || subscribed_->contacts) {
    batch.frame = session_.simulation().look(
        {.links = subscribed_->frames, .contacts = subscribed_->contacts});
    batch.contacts = subscribed_->contacts;
  }
  stale_ = false;
  mailbox_->push(std::move(batch));
  mailbox_->push([latest = std::move(latest), channels = initial.latest](Hub& hub) {
    hub.send_latest(latest, channels);
  });
}

Observer::Wants Feed::wants() const {
  due_ = (subscribed_->frames || subscribed_->contacts) && Clock::now() >= next_frame_;
  return {.input = subscribed_->commands || subscribed_->parameters,
          .links = due_ && subscribed_->frames,
          .contacts = due_ && subscribed_->contacts,
          .deliveries = subscribed_->deliveries != 0,
          .instances = due_};
}

void Feed::on_frame(const std::shared_ptr<const Frame>& frame) {
  mailbox_->release();
  follow_session();
  if (!(inventory_sent_ && world_sent_ == subscribed_->world &&
        static_sent_ == subscribed_->transforms_static) &&
      Clock::now() >= next_world_update_)
    send_world_if_changed(false, false);
  Batch batch;
  batch.now = frame->now;
  batch.epoch = epoch_;
  // What is run again on the way to an earlier time has been seen.
  if (!session_.rerunning()) {
    for (SubscribedTopic& each : topics_) {
      if (!each.topic) continue;
      if (each.topic->count == each.count) {
        if (each.look_hz) look_through(each, batch);
        continue;
      }
      if (each.preview && Clock::now() < each.next) continue;
      each.count = each.topic->count;
      if (each.count > 0) {
        batch.messages.push_back(message(each, *each.topic));
        if (each.look_hz && *each.look_hz > 0) each.next_look = frame->now + Time::from_s(1 / *each.look_hz);
      }
    }
    add_samples(batch);
    note_deliveries(*frame);
    if (Clock::now() >= next_deliveries_) add_deliveries(batch, frame->tick);
    if (subscribed_->batteries != 0 && Clock::now() >= next_batteries_)
      if (const Payload changed = changed_batteries())
        batch.messages.push_back({subscribed_->batteries, batch.now, changed});
    const bool from_outside = std::any_of(frame->log.begin(), frame->log.end(), [](const LogEntry& entry) {
      return entry.source.kind != Source::Kind::program && entry.kind != LogEntry::step;
    });
    if (from_outside && subscribed_->commands) {
      const std::string text = wire::commands_json(*frame);
      if (!text.empty()) batch.commands = payload_of(text);
    }
    if (from_outside && subscribed_->parameters) send_parameters(*frame);
  }
  if (due_) {
    next_frame_ = std::max(next_frame_ + period_, Clock::now());
    batch.frame = frame;
    batch.contacts = subscribed_->contacts;
    stale_ = false;
  } else {
    stale_ = subscribed_->frames || subscribed_->contacts || !inventory_sent_;
  }
  for (const Watch& watch : watches_)
    if (watch.sampled_at != batch.now) stale_ = true;
  if (subscribed_->batteries != 0 || !deliveries_.empty()) stale_ = true;
  if (batch.frame || batch.commands || !batch.messages.empty()) mailbox_->push(std::move(batch));
  for (const auto& link : links_) link->release();
}

void Feed::add_link(std::shared_ptr<programs::remote::Link> link) { links_.push_back(std::move(link)); }

void Feed::remove_link(const std::shared_ptr<programs::remote::Link>& link) { std::erase(links_, link); }

Status Feed::watch(ClientId viewer, std::uint32_t channel, const std::vector<std::string>& values,
                   double rate_hz) {
  Watch made;
  made.viewer = viewer;
  made.channel = channel;
  made.rate_hz = rate_hz;
  made.begin = session_.simulation().now();
  made.texts = values;
  for (const std::string& text : values) {
    SL_ASSIGN(ValueExpression value, ValueExpression::compile(session_.simulation(), text));
    // Of everybody's time: a scenario may spend it, whoever looks on may not.
    if (value.nesting() > 1)
      return Error{"'" + text + "' has aggregates within each other",
                   "name it in the scenario, under values"};
    made.reads += value.reads();
    made.addresses.push_back(value.addresses());
    made.values.emplace_back(std::move(value));
  }
  follow_session();
  std::size_t reads = made.reads;
  for (const Watch& watch : watches_)
    if (watch.viewer == viewer) reads += watch.reads;
  if (reads > most_reads)
    return Error{"what is watched reads " + std::to_string(reads) + " values; at most " +
                     std::to_string(most_reads) + " can be read",
                 "name it in the scenario, under values"};
  watches_.push_back(std::move(made));
  return {};
}

void Feed::unwatch(std::uint32_t channel) {
  std::erase_if(watches_, [&](const Watch& watch) { return watch.channel == channel; });
}

ChannelMessage Feed::sample(Watch& watch) {
  msg::Samples samples;
  samples.stamp = session_.simulation().now();
  watch.sampled_at = samples.stamp;
  for (auto& value : watch.values) {
    const auto number = value ? value->evaluate() : std::nullopt;
    samples.values.push_back(number ? number->value : std::numeric_limits<double>::quiet_NaN());
  }
  auto bytes = std::make_shared<std::vector<std::byte>>();
  write_cdr(message_info<msg::Samples>(), &samples, *bytes);
  return {watch.channel, samples.stamp, std::move(bytes)};
}

void Feed::add_samples(Batch& batch) {
  for (Watch& watch : watches_) {
    if (watch.rate_hz > 0) {
      if (batch.now < due_time(watch.begin, watch.sample, watch.rate_hz)) continue;
      const double passed = (batch.now - watch.begin).s() * watch.rate_hz;
      watch.sample = std::max(watch.sample, static_cast<std::int64_t>(passed));
      while (due_time(watch.begin, watch.sample, watch.rate_hz) <= batch.now) ++watch.sample;
    }
    batch.messages.push_back(sample(watch));
  }
}

void Feed::note_deliveries(const Frame& frame) {
  if (subscribed_->deliveries == 0) return;
  // What comes between two messages goes with the second one; of a run at full speed not all of it.
  constexpr std::size_t most = 8 * wire::most_links;
  const std::size_t count = std::min(frame.deliveries.size(), most - deliveries_.size());
  deliveries_.insert(deliveries_.end(), frame.deliveries.begin(),
                     frame.deliveries.begin() + static_cast<std::ptrdiff_t>(count));
}

void Feed::add_deliveries(Batch& batch, std::uint64_t tick) {
  if (deliveries_.empty()) return;
  next_deliveries_ = Clock::now() + period_;
  auto bytes = std::make_shared<std::vector<std::byte>>();
  wire::write_deliveries(deliveries_, tick, batch.now, *bytes);
  deliveries_.clear();
  batch.messages.push_back({subscribed_->deliveries, batch.now, std::move(bytes)});
}

Payload Feed::changed_batteries() {
  constexpr std::chrono::milliseconds pause{200};
  next_batteries_ = Clock::now() + pause;
  wire::write_batteries(session_.simulation(), scratch_);
  constexpr std::size_t head = 16;  // its tick and time change always
  if (batteries_ &&
      std::equal(scratch_.begin() + head, scratch_.end(), batteries_->begin() + head, batteries_->end()))
    return nullptr;
  batteries_ = std::make_shared<const std::vector<std::byte>>(scratch_);
  return batteries_;
}

void Feed::send_parameters(const Frame& frame) {
  std::vector<foxglove::Parameter> changed;
  for (const LogEntry& entry : frame.log) {
    if (entry.refused || entry.source.kind == Source::Kind::program || entry.kind == LogEntry::step) continue;
    if (std::string_view(request_kind(entry.kind)) != "parameter") continue;
    ByteReader r(entry.bytes);
    Request request;
    if (!read_request(r, request)) continue;
    const auto& parameter = std::get<ParameterRequest>(request);
    changed.push_back(
        read_parameter(session_.simulation(), Parameter{parameter.target, parameter.field}.address()));
  }
  if (changed.empty()) return;
  mailbox_->push([changed = std::move(changed)](Hub& hub) { hub.send_parameters(changed); });
}

}  // namespace sandlot::server
