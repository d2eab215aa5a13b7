#include "server/clients/feed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "messages/sandlot_msgs.h"
#include "server/clients/hub.h"
#include "server/clients/parameters.h"
#include "server/clients/preview.h"
#include "sim/world/transforms.h"

namespace sandlot::server {
namespace {

Payload payload_of(std::string_view text) {
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return std::make_shared<const std::vector<std::byte>>(begin, begin + text.size());
}

}  // namespace

Feed::Feed(Session& session, std::shared_ptr<Mailbox> mailbox, wire::Assets assets, double poses_hz)
    : session_(session),
      mailbox_(std::move(mailbox)),
      teller_(std::move(assets)),
      period_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / poses_hz))) {}

void Feed::attend(std::shared_ptr<const Interest> interest) {
  interest_ = std::move(interest);
  if (watching_ != interest_->clients) {
    watching_ = interest_->clients;
    if (watching_) session_.add_observer(this);
    else session_.remove_observer(this);
  }
  if (!interest_->clients) {
    topics_.clear();
    watches_.clear();
    world_ = transforms_static_ = nullptr;
    epoch_ = 0;  // whoever comes next is told everything
    return;
  }
  if (!interest_->world) told_world_ = false;
  if (!interest_->transforms_static) told_static_ = false;
  find_topics();
}

void Feed::leave() { attend(std::make_shared<Interest>()); }

void Feed::follow() {
  const Simulation& simulation = session_.simulation();
  const bool other_world = epoch_ != session_.epoch();
  if (!other_world && revision_ == simulation.revision()) return;
  epoch_ = session_.epoch();
  revision_ = simulation.revision();
  told_inventory_ = told_world_ = told_static_ = false;
  find_topics();
  if (!other_world) return;
  for (Watch& watch : watches_) {
    watch.begin = simulation.now();
    watch.sample = 0;
    watch.told.reset();
    for (std::size_t i = 0; i < watch.texts.size(); ++i) {
      auto value = ValueExpression::compile(simulation, watch.texts[i], {}, watch.addresses[i]);
      watch.values[i] = value ? std::optional(std::move(*value)) : std::nullopt;
    }
  }
}

void Feed::find_topics() {
  std::unordered_map<std::uint32_t, std::uint64_t> counts;
  for (const Shown& shown : topics_) counts[shown.channel] = shown.count;
  topics_.clear();
  previews_ = 0;
  if (interest_->topics.empty()) return;
  std::unordered_map<std::string_view, const TopicBase*> by_name;
  for (const auto& entity : session_.simulation().entities())
    for (const auto& device : entity->devices)
      for (const Simulation::Slot& slot : device->topics) by_name[slot.topic->name()] = slot.topic.get();
  for (const auto& [channel, name] : interest_->topics) {
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
                       {}});
    previews_ += preview;
  }
}

void Feed::tell(bool again_world, bool again_static) {
  const Simulation& simulation = session_.simulation();
  Told told;
  told.now = simulation.now();
  if (!told_inventory_) told.inventory = take_inventory(simulation, epoch_);
  told_inventory_ = true;
  if (interest_->world && !told_world_) world_ = payload_of(teller_.tell(simulation, epoch_));
  if (interest_->world && (!told_world_ || again_world)) told.world = world_;
  told_world_ = interest_->world;
  if (interest_->transforms_static && !told_static_) {
    const msg::TFMessage message = static_transforms(simulation);
    std::vector<std::byte> bytes;
    write_cdr(message_info<msg::TFMessage>(), &message, bytes);
    transforms_static_ = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  }
  if (interest_->transforms_static && (!told_static_ || again_static))
    told.transforms_static = transforms_static_;
  told_static_ = interest_->transforms_static;
  if (!told.inventory && !told.world && !told.transforms_static) return;
  mailbox_->put([told = std::move(told)](Hub& hub) { hub.tell(told); });
  // A world that changes at every tick is told of twice a second.
  next_tell_ = Clock::now() + std::chrono::milliseconds(500);
}

ChannelMessage Feed::message(Shown& shown) const {
  auto bytes = std::make_shared<std::vector<std::byte>>();
  if (shown.preview) {
    const Clock::time_point begin = Clock::now();
    if (const auto* const image = topic_cast<msg::Image>(shown.topic)) *bytes = preview_of(image->message);
    // All previews together take a quarter of the time at most.
    const auto rest = 4 * static_cast<Clock::rep>(previews_) * (Clock::now() - begin);
    shown.next = begin + std::max<Clock::duration>(preview_period, rest);
    return {shown.channel, shown.topic->stamp, std::move(bytes)};
  }
  bytes->reserve(scratch_.capacity());
  shown.topic->to_cdr(*bytes);
  return {shown.channel, shown.topic->stamp, std::move(bytes)};
}

void Feed::look(const Demand& demand) {
  if (!interest_->clients) return;
  follow();
  tell(demand.world, demand.transforms_static);
  // What was missed, in a world that stands still or is another one.
  Batch batch;
  batch.now = session_.simulation().now();
  batch.epoch = epoch_;
  constexpr std::size_t most_bytes = 8u << 20;
  std::size_t bytes = 0;
  std::vector<ChannelMessage> latest;
  for (Shown& shown : topics_) {
    const bool asked = std::binary_search(demand.latest.begin(), demand.latest.end(), shown.channel);
    if (!shown.topic || shown.topic->count == 0) continue;
    if (!asked && shown.topic->count == shown.count) continue;
    if (bytes > most_bytes) continue;  // the next message comes as well
    ChannelMessage made = message(shown);
    bytes += made.bytes->size();
    if (shown.topic->count != shown.count) {
      shown.count = shown.topic->count;
      batch.messages.push_back(made);
    }
    if (asked) latest.push_back(std::move(made));
  }
  const Session::State state = session_.report().state;
  const bool stands = state != Session::State::playing && state != Session::State::seeking;
  for (Watch& watch : watches_) {
    // A run that stands still tells where it stands, whatever the rate.
    const bool asked = std::binary_search(demand.latest.begin(), demand.latest.end(), watch.channel);
    if (!asked && (!stands || watch.told == batch.now)) continue;
    (asked ? latest : batch.messages).push_back(sample(watch));
  }
  if (interest_->frames || interest_->contacts) {
    batch.frame = session_.simulation().look({.links = interest_->frames, .contacts = interest_->contacts});
    batch.contacts = interest_->contacts;
  }
  stale_ = false;
  mailbox_->put(std::move(batch));
  mailbox_->put([latest = std::move(latest), channels = demand.latest](Hub& hub) {
    hub.tell_latest(latest, channels);
  });
}

Observer::Wants Feed::wants() const {
  due_ = (interest_->frames || interest_->contacts) && Clock::now() >= next_frame_;
  return {.input = interest_->commands || interest_->parameters,
          .links = due_ && interest_->frames,
          .contacts = due_ && interest_->contacts,
          .instances = due_};
}

void Feed::on_frame(const std::shared_ptr<const Frame>& frame) {
  mailbox_->release();
  follow();
  if (!(told_inventory_ && told_world_ == interest_->world && told_static_ == interest_->transforms_static) &&
      Clock::now() >= next_tell_)
    tell(false, false);
  Batch batch;
  batch.now = frame->now;
  batch.epoch = epoch_;
  // What is run again on the way to an earlier time has been seen.
  if (!session_.rerunning()) {
    for (Shown& shown : topics_) {
      if (!shown.topic || shown.topic->count == shown.count) continue;
      if (shown.preview && Clock::now() < shown.next) continue;
      shown.count = shown.topic->count;
      if (shown.count > 0) batch.messages.push_back(message(shown));
    }
    add_samples(batch);
    const bool from_outside = std::any_of(frame->log.begin(), frame->log.end(), [](const LogEntry& entry) {
      return entry.source.kind != Source::Kind::program && entry.kind != LogEntry::step;
    });
    if (from_outside && interest_->commands) {
      const std::string text = wire::commands_json(*frame);
      if (!text.empty()) batch.commands = payload_of(text);
    }
    if (from_outside && interest_->parameters) tell_parameters(*frame);
  }
  if (due_) {
    next_frame_ = std::max(next_frame_ + period_, Clock::now());
    batch.frame = frame;
    batch.contacts = interest_->contacts;
    stale_ = false;
  } else {
    stale_ = interest_->frames || interest_->contacts || !told_inventory_;
  }
  for (const Watch& watch : watches_)
    if (watch.told != batch.now) stale_ = true;
  if (batch.frame || batch.commands || !batch.messages.empty()) mailbox_->put(std::move(batch));
}

Status Feed::watch(std::uint32_t channel, const std::vector<std::string>& values, double rate_hz) {
  Watch made;
  made.channel = channel;
  made.rate_hz = rate_hz;
  made.begin = session_.simulation().now();
  made.texts = values;
  for (const std::string& text : values) {
    SL_ASSIGN(ValueExpression value, ValueExpression::compile(session_.simulation(), text));
    made.addresses.emplace_back(value.addresses().begin(), value.addresses().end());
    made.values.emplace_back(std::move(value));
  }
  follow();
  watches_.push_back(std::move(made));
  return {};
}

void Feed::unwatch(std::uint32_t channel) {
  std::erase_if(watches_, [&](const Watch& watch) { return watch.channel == channel; });
}

ChannelMessage Feed::sample(Watch& watch) {
  msg::Samples samples;
  samples.stamp = session_.simulation().now();
  watch.told = samples.stamp;
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

void Feed::tell_parameters(const Frame& frame) {
  std::vector<foxglove::Parameter> changed;
  for (const LogEntry& entry : frame.log) {
    if (entry.refused || entry.source.kind == Source::Kind::program || entry.kind == LogEntry::step) continue;
    if (std::string_view(request_kind(entry.kind)) != "parameter") continue;
    ByteReader r(entry.bytes);
    Request request;
    if (!read_request(r, request)) continue;
    const auto& parameter = std::get<ParameterRequest>(request);
    changed.push_back(
        read_parameter(session_.simulation(), parameter_name(parameter.target, parameter.field)));
  }
  if (changed.empty()) return;
  mailbox_->put([changed = std::move(changed)](Hub& hub) { hub.tell_parameters(changed); });
}

}  // namespace sandlot::server
