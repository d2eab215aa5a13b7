/// Devices in their pools: how they are built, sampled, commanded and saved.
#include "sim/world/device_pools.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "assets/image/write.h"
#include "base/text.h"
#include "noise/chain.h"
#include "sim/load/presets.h"
#include "sim/world/device_keys.h"
#include "sim/world/faults.h"

namespace sandlot {
namespace {

/// Collects what a device creates while it is built.
struct SlotMaker final : TopicMaker {
  std::vector<SimulationParts::Slot> topics, commands;
  SimulationParts::DeviceExtras extras;
  void adopt_topic(std::unique_ptr<TopicBase> topic, std::uint32_t level) override {
    topics.push_back({std::move(topic), level, false});
  }
  void adopt_command(std::unique_ptr<TopicBase> slot, std::uint32_t level) override {
    const bool queued = slot->queue_limit() > 0;
    commands.push_back({std::move(slot), level, queued});
  }
  void adopt_frame(std::string name, const Pose& X_SF) override {
    extras.frames.emplace_back(std::move(name), X_SF);
  }
  void adopt_order(std::unique_ptr<DeviceOrder> order) override { extras.orders.push_back(std::move(order)); }
  void adopt_inbox(std::unique_ptr<Inbox> made) override {
    SL_CHECK_MSG(!extras.inbox, "a device has one inbox");
    extras.inbox = std::move(made);
  }
  void adopt_light(std::unique_ptr<SceneLight> made) override {
    SL_CHECK_MSG(!extras.light, "a device has one light");
    extras.light = std::move(made);
  }
};

bool same(const Place& a, const Place& b) {
  return a.file == b.file && a.line == b.line && a.column == b.column;
}

/// Whether two configurations hold the same, written at the same places.
bool same(const Node& a, const Node& b) {
  if (a.type() != b.type() || !same(a.place(), b.place()) || a.text() != b.text()) return false;
  if (!std::equal(a.items().begin(), a.items().end(), b.items().begin(), b.items().end(),
                  [](const Node& x, const Node& y) { return same(x, y); }))
    return false;
  const auto same_entry = [](const Node::Entry& x, const Node::Entry& y) {
    return x.key == y.key && same(x.key_place, y.key_place) && same(x.value, y.value);
  };
  return &a.entries() == &b.entries() || std::equal(a.entries().begin(), a.entries().end(),
                                                    b.entries().begin(), b.entries().end(), same_entry);
}

/// The error for a key that a device of the kind does not have. The kind's reader knows its own keys alone; this one also
/// those of every device.
std::optional<Error> unknown_key(const Node& config, const Kind& kind) {
  std::vector<std::string> own, common{"kind", "link", "pose", "level", "levels", "preset"};
  for (const FieldInfo& field : kind.describe()) {
    std::string key = field.path.substr(0, field.path.find('/'));
    if (own.empty() || own.back() != key) own.push_back(std::move(key));
  }
  const auto add = [&](const Field& field, auto&) { common.emplace_back(field.key); };
  DeviceKeysSpec keys;
  FaultsSpec faults;
  DeviceKeysSpec::fields(keys, add);
  FaultsSpec::fields(faults, add);
  std::vector<std::string> all = own;
  all.insert(all.end(), common.begin(), common.end());
  for (const Node::Entry& entry : config.entries()) {
    if (std::find(all.begin(), all.end(), entry.key) != all.end()) continue;
    const bool near = own.empty() || !nearest(entry.key, all).empty();
    return Error{"unknown key '" + entry.key.substr(0, 60) + "'",
                 near ? suggestion(entry.key, all)
                      : suggestion(entry.key, own) + "; `sandlot list common` has those of every device",
                 entry.key_place};
  }
  return std::nullopt;
}

/// Levels named by `level: x` or `levels: [x, y]`; both keys belong to the simulator, not to the kind's spec.
Result<std::uint32_t> take_levels(Node& config, const Kind& kind, const Place& place) {
  std::vector<std::string> known;
  for (const LevelInfo& level : kind.levels) known.emplace_back(level.name);
  const Node* one = config.find("level");
  const Node* many = config.find("levels");
  if (one && many) return one->error("give either 'level' or 'levels'");
  if (many && (!many->is_sequence() || many->items().empty()))
    return wrong_type(*many, "a list of levels", "/levels");
  std::uint32_t bits = many || one ? 0u : 1u;
  const auto take = [&](const Node& node, const std::string& path) -> Status {
    const Place& at = node.place().file ? node.place() : place;
    if (!node.is_scalar())
      return Error{"expected the name of a level", "several levels at once: levels: [a, b]", at, path};
    const auto found = std::find(known.begin(), known.end(), node.text());
    if (found == known.end())
      return Error{"device kind '" + std::string(kind.name) + "' has no level '" + node.text() + "'",
                   suggestion(node.text(), known), at, path};
    const std::uint32_t bit = 1u << (found - known.begin());
    if (bits & bit) return Error{"level '" + node.text() + "' is named twice", "", at, path};
    bits |= bit;
    return {};
  };
  if (one) SL_TRY(take(*one, "/level"));
  for (std::size_t i = 0; many && i < many->items().size(); ++i)
    SL_TRY(take(many->items()[i], "/levels/" + std::to_string(i)));
  config.erase("level");
  config.erase("levels");
  return bits;
}

std::string encode_image(int width, int height, int channels, std::span<const std::uint8_t> pixels,
                         int quality) {
  const assets::Pixels8 image{width, height, channels, pixels};
  return quality > 0 ? assets::jpeg_of(image, quality) : assets::png_of(image);
}

}  // namespace

void DevicePools::add_kind(const Kind& kind) {
  SL_CHECK(kind.api_version == device_api_version);
  pools_.emplace_back();
  pools_.back().kind = &kind;
  pools_.back().pool = kind.create_pool();
}

const Kind* DevicePools::find_kind(std::string_view name) const {
  const auto found = std::find_if(pools_.begin(), pools_.end(),
                                  [&](const Pool& pool) { return name == pool.kind->name; });
  return found == pools_.end() ? nullptr : found->kind;
}

Status DevicePools::add(Entity& entity, const model::DeviceDecl& declared, const Engine& engine, Time now,
                        Diagnostics& diagnostics) {
  model::DeviceDecl decl = declared;
  const Kind* kind = nullptr;
  std::vector<std::string> names;
  for (const Pool& pool : pools_) {
    names.emplace_back(pool.kind->name);
    if (decl.kind == pool.kind->name) kind = pool.kind;
  }
  if (!kind) return Error{"no kind of device '" + decl.kind + "'", suggestion(decl.kind, names), decl.place};
  const std::string path = entity.instance.name + "/" + sanitised(decl.name);
  if (entity.find_device(path))
    return Error{"robot '" + entity.instance.name + "' has two devices named '" + decl.name + "'",
                 "give one of them another name", decl.place};
  SL_TRY(lay_preset(decl.config, *kind));
  SL_ASSIGN(const std::uint32_t levels, take_levels(decl.config, *kind, decl.place));
  const auto pool = std::find_if(pools_.begin(), pools_.end(), [&](const Pool& p) { return p.kind == kind; });
  SL_CHECK(pool != pools_.end());
  const bool kind_has_errors = pool->pool->has_errors();
  SL_ASSIGN(std::shared_ptr<DeviceKeys> keys, take_device_keys(decl.config, kind_has_errors));
  const bool has_errors = kind_has_errors || (keys && keys->spec.command_errors);
  SL_ASSIGN(std::shared_ptr<Faults> faults, take_faults(decl.config, has_errors, kind->name));

  // Where keys were taken out, each of many devices that are declared alike is left with a map of its own: one serves all.
  if (!pool->devices.empty())
    if (const Node& other = std::as_const(*pool->devices.back()).decl.config; same(other, decl.config))
      decl.config = other;

  Owned<EnergyMeter> meter;
  if (entity.energy) meter = meter_of(entity, *kind);

  SlotMaker maker;
  const DeviceBuild build{
      .decl = decl,
      .instance = entity.instance,
      .path = path,
      .key = entity_key(path),
      .seed = setup_.seed,
      .bodies = engine.bodies(entity.id),
      .joints = engine.joints(entity.id),
      .engine = engine.capabilities(),
      .tick = setup_.step,
      .levels = levels,
      .topics = maker,
      .gravity_mps2 = setup_.gravity,
      .geography = setup_.geography,
      .magnetic_field_T = setup_.magnetic_field_T,
      .errors = setup_.errors * entity.instance.errors,
      .encode_image = encode_image,
      .media = setup_.media,
      .energy = meter.get(),
      .account = kind->stores_energy ? entity.energy.get() : nullptr,
  };
  if (Status added = pool->pool->add(build); !added) {
    if (auto slip = unknown_key(decl.config, *kind)) return std::move(*slip);
    return added;
  }
  const auto index = static_cast<std::uint32_t>(pool->devices.size());
  if (Status fits = faults ? faults->check(maker.topics) : Status(); !fits) {
    pool->pool->remove(index);
    return fits;
  }
  const double rate_hz = pool->pool->rate_hz(index);
  const double tick_hz = 1e9 / static_cast<double>(setup_.step.ns);
  const bool fixed = setup_.clock.mode == model::Clock::Mode::fixed;
  if (fixed && rate_hz > tick_hz * (1 + 1e-9)) {
    pool->pool->remove(index);
    const Node* const rate = decl.config.find("rate");
    return Error{
        "rate " + number_text(rate_hz) + " Hz is above the tick rate of " + number_text(tick_hz) + " Hz",
        "lower the rate or make time.step smaller", rate && rate->place().file ? rate->place() : decl.place,
        "/" + path + "/rate"};
  }
  if (fixed && rate_hz > 0) {
    const double ticks = tick_hz / rate_hz;
    if (std::abs(ticks - std::round(ticks)) > 1e-6 * ticks)
      diagnostics.warn({"rate " + number_text(rate_hz) + " Hz does not divide the tick rate of " +
                            number_text(tick_hz) + " Hz",
                        "samples fall on the next tick, so their spacing varies by one tick", decl.place,
                        "/" + path + "/rate"});
  }

  const auto alike = [&](const model::DeviceDecl& other) {
    return other.name == decl.name && other.scope == decl.scope && other.sdf_types == decl.sdf_types &&
           other.link == decl.link && other.X_LS == decl.X_LS && other.place.file == decl.place.file &&
           other.place.line == decl.place.line &&
           &other.config.entries() == &std::as_const(decl.config).entries();  // copies of one
  };
  auto device = std::make_unique<Device>(!pool->devices.empty() && alike(pool->devices.back()->decl)
                                             ? pool->devices.back()->shared_decl
                                             : std::make_shared<const model::DeviceDecl>(std::move(decl)));
  device->path = path;
  device->key = build.key;
  device->kind = static_cast<std::uint32_t>(pool - pools_.begin());
  device->index = index;
  device->topics = std::move(maker.topics);
  device->commands = std::move(maker.commands);
  if (!maker.extras.empty())
    device->extras = std::make_unique<SimulationParts::DeviceExtras>(std::move(maker.extras));
  device->errors = build.errors;
  device->faults = std::move(faults);
  device->keys = std::move(keys);
  device->energy = std::move(meter);
  if (device->keys) {
    Status begun = device->keys->begin(*device, *kind, rate_hz, kind->phases & phase_sense,
                                       entity.instance.model->joints.size(), setup_.seed);
    if (!begun) {
      pool->pool->remove(index);
      return begun;
    }
  }
  if (device->faults) ++pool->faulty;
  if (device->energy) {
    ++pool->metered;
    ledger_.add(*device->energy);
  }
  const bool on_request = device->keys && device->keys->spec.on_request;
  if (device->keys && device->keys->only_on_request()) device->keys = nullptr;
  note_keys(*device);
  pool->devices.push_back(device.get());
  pool->meters.push_back(device->energy.get());
  pool->all.push_back(index);
  pool->levels.push_back(levels);
  pool->sample.push_back(0);
  pool->since.push_back({});
  pool->timing.push_back({.start = now, .on_request = on_request});
  set_active_levels(*device, levels);
  plan_next_sample(*device);
  entity.devices.push_back(std::move(device));
  return {};
}

void DevicePools::remove(const Device& device) {
  Pool& pool = pools_[device.kind];
  pool.pool->remove(device.index);
  pool.devices.erase(pool.devices.begin() + device.index);
  pool.meters.erase(pool.meters.begin() + device.index);
  pool.all.pop_back();
  pool.timing.erase(pool.timing.begin() + device.index);
  pool.levels.erase(pool.levels.begin() + device.index);
  pool.sample.pop_back();
  pool.since.pop_back();
  if (device.faults) --pool.faulty;
  if (device.keys_act) --pool.keyed;
  if (device.energy) {
    --pool.metered;
    ledger_.remove(*device.energy);
  }
  for (std::uint32_t i = device.index; i < pool.devices.size(); ++i) pool.devices[i]->index = i;
}

void DevicePools::release(const Device& device, const Context& context) {
  pools_[device.kind].pool->release(device.index, context);
}

bool DevicePools::need_render_scene() const {
  return std::any_of(pools_.begin(), pools_.end(),
                     [](const Pool& pool) { return pool.kind->needs_render_scene && !pool.devices.empty(); });
}

void DevicePools::plan_next_sample(const Device& device) {
  Timing& when = pools_[device.kind].timing[device.index];
  when.rate_hz = pools_[device.kind].pool->rate_hz(device.index);
  when.due = when.rate_hz > 0 ? due_time(when.start, static_cast<std::int64_t>(when.sample), when.rate_hz)
                              : Time{};
}

/// Keys that ask for nothing between a command and its device, or a sample and its message, are passed by.
void DevicePools::note_keys(Device& device) {
  const bool act = device.keys && device.keys->act();
  if (act != device.keys_act) pools_[device.kind].keyed += act ? 1u : ~0u;
  device.keys_act = act;
}

void DevicePools::set_active_levels(Device& device, std::uint32_t levels) {
  device.levels = levels;
  pools_[device.kind].levels[device.index] = levels;
}

// ------------------------------------------------------------------------------------------- changes by requests

Status DevicePools::set_levels(Device& device, std::span<const std::string> names, const Context& context) {
  Pool& pool = pools_[device.kind];
  std::vector<std::string> known;
  for (const LevelInfo& level : pool.kind->levels) known.emplace_back(level.name);
  std::uint32_t bits = 0;
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      return Error{"device '" + device.path + "' has no level '" + name + "'", suggestion(name, known)};
    bits |= 1u << (found - known.begin());
  }
  if (bits == 0) return Error{"a device needs at least one active level", suggestion("", known)};
  SL_TRY(pool.pool->switch_level(device.index, device.levels, bits, context));
  set_active_levels(device, bits);
  return {};
}

Status DevicePools::set_parameter(Device& device, std::string_view field, const Node& value) {
  PoolBase& pool = *pools_[device.kind].pool;
  if (is_device_key(field, pool.has_errors())) {
    SL_TRY(set_device_key(device, field, value));
    note_keys(device);
    return {};
  }
  SL_TRY(pool.set_parameter(device.index, field, value));
  plan_next_sample(device);
  return {};
}

Status DevicePools::request_sample(Device& device, Time at) {
  Timing& when = pools_[device.kind].timing[device.index];
  if (device.keys && !when.requested)
    SL_TRY(device.keys->take_request(device, at, when.last, when.sample == 0));
  when.requested = true;
  return {};
}

ValueFound DevicePools::value(const Device& device, ValuePart part, std::span<const ValueStep> path) const {
  const auto is_there = [](const ValueFound& each) {
    return each.is == ValueFound::Is::value || each.is == ValueFound::Is::compound;
  };
  const ValueFound found = pools_[device.kind].pool->value(device.index, part, path);
  if (is_there(found)) return found;
  if (device.energy && part == ValuePart::state)
    if (const ValueFound drawn = value_at(device.energy->state, path); is_there(drawn)) return drawn;
  if (!device.keys) return found;
  const ValueFound common = value_at(part, device.keys->spec, device.keys->state, path);
  return is_there(common) ? common : found;
}

void DevicePools::list_values(const Device& device, ValuePart part, const ValueVisit& visit) const {
  pools_[device.kind].pool->list_values(device.index, part, visit);
  if (device.energy && part == ValuePart::state)
    sandlot::list_values(device.energy->state, "", "", "", visit);
  if (!device.keys) return;
  const bool kind_has_errors = pools_[device.kind].pool->has_errors();
  sandlot::list_values(part, device.keys->spec, device.keys->state, [&](ValueEntry entry) {
    if (!kind_has_errors || entry.path != errors_field.key) visit(std::move(entry));
  });
}

Status DevicePools::order_failure(Device& device, const FailureOrder& order) {
  Pool& pool = pools_[device.kind];
  return sandlot::order_failure(device, has_errors(device), pool.faulty, order);
}

void DevicePools::scale_errors(Device& device, double factor) {
  device.errors = factor;
  pools_[device.kind].pool->scale_errors(device.index, factor);
}

/// Few devices have any faults: pools without them are not searched.
bool DevicePools::any_failure_ordered() const {
  return std::any_of(pools_.begin(), pools_.end(), [](const Pool& pool) {
    return pool.faulty > 0 && std::any_of(pool.devices.begin(), pool.devices.end(),
                                          [](const Device* device) { return is_ordered(*device); });
  });
}

// --------------------------------------------------------------------------------------------------------- phases

bool DevicePools::has_errors(const Device& device) const {
  return pool(device).has_errors() || (device.keys && device.keys->spec.command_errors);
}

double DevicePools::all_errors(const Device& device, Time now) const {
  const double own = pool(device).errors(device.index) * (device.keys ? device.keys->spec.errors : 1);
  const double failing = device.faults ? device.faults->at(now).factor : 1;
  return std::min(max_errors, own * device.errors * failing);
}

void DevicePools::actuate(const Context& context) {
  for (Pool& pool : pools_)
    if (pool.keyed > 0) prepare_commands(pool, context);
  if (!ledger_.empty()) drain(context);
  for (Pool& pool : pools_)
    if ((pool.kind->phases & phase_actuate) && !pool.devices.empty())
      pool.pool->actuate(context, {acting(pool, context, true), pool.sample, pool.levels, pool.since});
  if (!ledger_.empty()) ledger_.begin_physics(context.engine);
}

void DevicePools::pre_substep(const Context& context, double h_s) {
  for (Pool& pool : pools_)
    if ((pool.kind->phases & phase_pre_substep) && !pool.devices.empty())
      pool.pool->pre_substep(context, {acting(pool, context, false), pool.sample, pool.levels, pool.since},
                             h_s);
}

void DevicePools::post_substep(const Context& context, double h_s) {
  for (Pool& pool : pools_)
    if ((pool.kind->phases & phase_post_substep) && !pool.devices.empty())
      pool.pool->post_substep(context, {acting(pool, context, false), pool.sample, pool.levels, pool.since},
                              h_s);
  if (!ledger_.empty()) ledger_.after_substep(context.engine, h_s);
}

/// Lists the devices whose sample is due at `now`, and plans their next one.
void DevicePools::find_due(Pool& pool, Time now, Time step) const {
  const bool continuous = setup_.clock.mode == model::Clock::Mode::continuous;
  pool.due.clear();
  for (std::uint32_t i = 0; i < pool.devices.size(); ++i) {
    Timing& when = pool.timing[i];
    if (!when.requested && (when.on_request || when.due > now)) continue;
    when.requested = false;
    pool.due.push_back(i);
    pool.sample[i] = when.sample;
    // The first sample has no predecessor: it counts as one nominal interval after it.
    if (when.sample == 0) pool.since[i] = when.rate_hz > 0 ? due_time({}, 1, when.rate_hz) : step;
    else pool.since[i] = now - when.last;
    when.last = now;
    ++when.sample;
    if (when.rate_hz <= 0) continue;  // due in every tick
    // A tick of a continuous clock may be longer than the interval: the samples that it skips are lost.
    if (continuous && when.due > Time{}) {
      const double passed = (now - when.start).s() * when.rate_hz;
      when.sample = std::max(when.sample, static_cast<std::uint64_t>(passed) + 1);
    }
    when.due = due_time(when.start, static_cast<std::int64_t>(when.sample), when.rate_hz);
  }
}

void DevicePools::sense(const Context& context) {
  const auto for_sensing = [&](auto&& work) {
    for (Pool& pool : pools_)
      if ((pool.kind->phases & phase_sense) && !pool.devices.empty()) work(pool);
  };
  for_sensing([&](Pool& pool) { find_due(pool, context.now, context.tick); });
  if (!ledger_.empty()) settle(context);
  for_sensing([&](Pool& pool) {
    if (pool.keyed > 0) sense_keyed(pool, context);
    else sense_due(pool, context);
  });
}

void DevicePools::sense_due(Pool& pool, const Context& context) const {
  if (pool.due.empty()) return;
  if (pool.faulty > 0) sense_faulty(pool, context);
  else pool.pool->sense(context, {pool.due, pool.sample, pool.levels, pool.since});
}

std::unique_ptr<TopicBase> DevicePools::look_through(Device& device, const TopicBase& topic,
                                                     const Context& context) {
  Pool& pool = pools_[device.kind];
  const std::uint32_t i = device.index;
  const Timing& when = pool.timing[i];
  if (device.faults && device.faults->at(context.now).dead) return nullptr;
  std::vector<std::unique_ptr<TopicBase>> before;
  for (const Slot& slot : device.topics) before.push_back(slot.topic->clone());
  ByteWriter state;
  pool.pool->save(i, state);
  pool.sample[i] = when.sample;
  pool.since[i] = when.sample > 0 ? context.now - when.last : context.tick;
  pool.pool->sense(context, {{&i, 1}, pool.sample, pool.levels, pool.since});
  std::unique_ptr<TopicBase> seen;
  for (std::size_t slot = 0; slot < before.size(); ++slot) {
    TopicBase& published = *device.topics[slot].topic;
    if (&published == &topic && published.count > 0 && published.stamp == context.now)
      seen = published.clone();
    published.copy_from(*before[slot]);
  }
  ByteReader r(state.bytes());
  pool.pool->load(i, r);
  SL_CHECK(r.ok());
  return seen;
}

/// Takes the samples that are due in a pool with common keys: messages may be delayed.
void DevicePools::sense_keyed(Pool& pool, const Context& context) const {
  const auto for_delayed = [&](std::span<const std::uint32_t> indices, auto&& work) {
    for (const std::uint32_t index : indices) {
      Device& device = *pool.devices[index];
      if (device.keys_act && device.keys->delays_messages()) work(device);
    }
  };
  for_delayed(pool.due, [](Device& device) { device.keys->remember_messages(device); });
  sense_due(pool, context);
  for_delayed(pool.due, [&](Device& device) {
    device.keys->hold_back_messages(device, context.now, all_errors(device, context.now));
  });
  for_delayed(pool.all, [&](Device& device) {
    const bool dead = device.faults && device.faults->at(context.now).dead;
    device.keys->publish_messages(device, context.now, dead);
  });
}

/// Takes the samples that are due in a pool with devices that have faults.
void DevicePools::sense_faulty(Pool& pool, const Context& context) const {
  const Time now = context.now;
  for (const std::uint32_t index : pool.due) {
    Device& device = *pool.devices[index];
    if (!device.faults) continue;
    const Failing failing = device.faults->at(now);
    if (failing.factor != 1) pool.pool->scale_errors(index, device.errors * failing.factor);
    auto& before = device.faults->before;
    if (!failing.stuck && !failing.dead) continue;
    if (before.empty())
      for (const Slot& slot : device.topics) before.push_back(slot.topic->clone());
    for (std::size_t i = 0; i < before.size(); ++i) before[i]->copy_from(*device.topics[i].topic);
  }
  pool.pool->sense(context, {pool.due, pool.sample, pool.levels, pool.since});
  for (const std::uint32_t index : pool.due) {
    Device& device = *pool.devices[index];
    if (!device.faults) continue;
    const FaultsSpec& spec = device.faults->spec;
    const Failing failing = device.faults->at(now);
    if (failing.factor != 1) pool.pool->scale_errors(index, device.errors);
    if (failing.stuck || failing.dead)
      for (std::size_t i = 0; i < device.topics.size(); ++i) {
        TopicBase& topic = *device.topics[i].topic;
        const TopicBase& before = *device.faults->before[i];
        const bool published = topic.count != before.count;
        topic.copy_from(before);
        if (published && !failing.dead && topic.count > 0) topic.republish(now);
      }
    if (!spec.clock) continue;
    const double errors = std::min(max_errors, pool.pool->errors(index) * device.errors * failing.factor);
    const Stream random(setup_.seed, device.key, Purpose::noise, pool.sample[index]);
    const Time shown = clock_at(*spec.clock, now, errors, random);
    for (Slot& slot : device.topics)
      if (slot.topic->count > 0 && slot.topic->stamp == now) slot.topic->restamp(shown);
  }
}

/// The devices of a pool that act in this tick: all but dead actuators, which release what they hold.
std::span<const std::uint32_t> DevicePools::acting(Pool& pool, const Context& context, bool release_dead) {
  if (pool.faulty == 0) return pool.all;
  const Time begin = context.now - context.tick;
  pool.due.clear();
  for (const std::uint32_t index : pool.all) {
    const Device& device = *pool.devices[index];
    if (device.commands.empty() || !device.faults || !device.faults->at(begin).dead) {
      pool.due.push_back(index);
    } else if (release_dead) {
      // Wheels keep their rollers: only a switch of the level would bring them back.
      const std::size_t wheels = context.actuation.wheels.size();
      pool.pool->release(index, context);
      context.actuation.wheels.resize(wheels);
    }
  }
  return pool.due;
}

}  // namespace sandlot
