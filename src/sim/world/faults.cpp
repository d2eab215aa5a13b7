/// Devices that fail, and the factors on the errors of all devices.
#include "sim/world/faults.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "noise/chain.h"
#include "sim/world/simulation.h"

namespace sandlot {

Status FailureSpec::check(const Node& node, const std::string& path) const {
  if (from_s < until_s) return {};
  return node.error("until is not later than from", "it begins at " + number_text(from_s) + " s", path);
}

Result<std::unique_ptr<Faults>> take_faults(Node& config, const PoolBase& pool, std::string_view kind) {
  FaultsSpec spec;
  Place clock_place;
  Status status;
  bool any = false;
  FaultsSpec::fields(spec, [&](const Field& field, auto& member) {
    const Node* const value = config.find(field.key);
    if (!value || !status) return;
    status = read_value(*value, field, member, std::string("/") + field.key);
    const bool noisy = std::any_of(spec.failures.begin(), spec.failures.end(),
                                   [](const auto& each) { return each.kind == FailureSpec::Kind::noisy; });
    if (status && noisy && !pool.has_errors())
      status = value->error("a " + std::string(kind) + " has no errors that could grow",
                            "it can be stuck or dead", "/failures");
    clock_place = value->place();
    config.erase(field.key);
    any = true;
  });
  if (!status) return std::move(status.error());
  if (!any) return std::unique_ptr<Faults>();
  return std::make_unique<Faults>(Faults{std::move(spec), {}, clock_place, {}});
}

Failing failing_at(const FaultsSpec& spec, Time now) {
  Failing out;
  for (const FailureSpec& failure : spec.failures) {
    if (now < Time::from_s(failure.from_s) || now >= Time::from_s(failure.until_s)) continue;
    out.stuck = out.stuck || failure.kind == FailureSpec::Kind::stuck;
    out.dead = out.dead || failure.kind == FailureSpec::Kind::dead;
    if (failure.kind == FailureSpec::Kind::noisy) out.factor *= failure.factor;
  }
  return out;
}

Result<FailureOrder> read_failure_order(const Node& value) {
  FailureOrder order;
  Node whole = value;
  if (value.is_scalar()) {
    whole = Node::map(value.place());
    whole.set("kind", value);
  }
  SL_TRY(read_value(whole, Field{failure_field, "", "What goes wrong."}, order,
                    std::string("/") + failure_field));
  return order;
}

Failing Faults::at(Time now) const {
  switch (order.kind) {
    case FailureOrder::Kind::planned: return failing_at(spec, now);
    case FailureOrder::Kind::none: return {};
    case FailureOrder::Kind::stuck: return {.stuck = true};
    case FailureOrder::Kind::dead: return {.dead = true};
    case FailureOrder::Kind::noisy: return {.factor = order.factor};
  }
  return {};
}

bool Faults::idle() const {
  return order.kind == FailureOrder::Kind::planned && spec.failures.empty() && !spec.clock;
}

Time clock_at(const ClockSpec& spec, Time now, double errors, const Stream& random) {
  Stream own = random.fork(hash64("clock"));
  const double n = spec.jitter_s > 0 ? own.normal() : 0;
  const double error_s = errors * (spec.offset_s + spec.drift * now.s() + spec.jitter_s * n);
  return std::max(Time{}, now + Time::from_s(error_s));
}

/// A clock needs times to be wrong about.
Status Faults::check(std::span<const SimulationParts::Slot> topics) const {
  if (!spec.clock) return {};
  for (const SimulationParts::Slot& slot : topics)
    if (slot.topic->restamp(slot.topic->stamp)) return {};
  return Error{"this device publishes no messages with a time in them", "leave the clock out", clock_place,
               "/clock"};
}

bool Simulation::takes_commands(const Device& device) const {
  if (!device.faults) return true;
  const Failing failing = device.faults->at(now_);
  return !failing.stuck && !failing.dead;
}

/// Takes the samples that are due in a pool with devices that have faults.
void Simulation::sense_faulty(Pool& pool, const Context& ctx) {
  for (const std::uint32_t index : pool.due) {
    const Device& device = *pool.devices[index];
    if (!device.faults) continue;
    const Failing failing = device.faults->at(now_);
    if (failing.factor != 1) pool.pool->scale_errors(index, device.errors * failing.factor);
    auto& before = device.faults->before;
    if (!failing.stuck && !failing.dead) continue;
    if (before.empty())
      for (const Slot& slot : device.topics) before.push_back(slot.topic->clone());
    for (std::size_t i = 0; i < before.size(); ++i) before[i]->copy_from(*device.topics[i].topic);
  }
  pool.pool->sense(ctx, {pool.due, pool.sample, pool.levels, pool.since});
  for (const std::uint32_t index : pool.due) {
    const Device& device = *pool.devices[index];
    if (!device.faults) continue;
    const FaultsSpec& spec = device.faults->spec;
    const Failing failing = device.faults->at(now_);
    if (failing.factor != 1) pool.pool->scale_errors(index, device.errors);
    if (failing.stuck || failing.dead)
      for (std::size_t i = 0; i < device.topics.size(); ++i) {
        TopicBase& topic = *device.topics[i].topic;
        const TopicBase& before = *device.faults->before[i];
        const bool published = topic.count != before.count;
        topic.copy_from(before);
        if (published && !failing.dead && topic.count > 0) topic.republish(now_);
      }
    if (!spec.clock) continue;
    const double errors = std::min(max_errors, pool.pool->errors(index) * device.errors * failing.factor);
    const Stream random(setup_.seed, device.key, Purpose::noise, pool.sample[index]);
    const Time shown = clock_at(*spec.clock, now_, errors, random);
    for (const Slot& slot : device.topics)
      if (slot.topic->count > 0 && slot.topic->stamp == now_) slot.topic->restamp(shown);
  }
}

/// Those that act now, of a pool in which some may be dead: these let go of what they hold.
std::span<const std::uint32_t> Simulation::acting(Pool& pool, const Context* let_go) {
  if (pool.faulty == 0) return pool.all;
  pool.due.clear();
  for (const std::uint32_t index : pool.all) {
    const Device& device = *pool.devices[index];
    if (device.commands.empty() || !device.faults || !device.faults->at(now_).dead) {
      pool.due.push_back(index);
    } else if (let_go) {
      // Wheels keep their rollers: only a switch of the level would bring them back.
      const std::size_t wheels = actuation_.wheels.size();
      pool.pool->release(index, *let_go);
      actuation_.wheels.resize(wheels);
    }
  }
  return pool.due;
}

Status order_failure(SimulationParts::Device& device, const PoolBase& pool, std::uint32_t& faulty,
                     const FailureOrder& order) {
  if (order.kind == FailureOrder::Kind::noisy && !pool.has_errors())
    return Error{"a " + device.decl.kind + " has no errors that could grow", "it can be stuck or dead"};
  if (!device.faults) {
    device.faults = std::make_shared<Faults>();
    ++faulty;
  }
  device.faults->order = order;
  if (device.faults->idle()) {
    device.faults.reset();
    --faulty;
  }
  return {};
}

Status Simulation::set_errors(Entity* entity, std::string_view field, const Node& value) {
  if (field != errors_field.key)
    return Error{"'" + std::string(field.substr(0, 60)) + "' is no parameter of the whole", "errors is",
                 value.place()};
  SL_ASSIGN(const double factor,
            read_number(value, errors_field, errors_field.min, errors_field.max, false, "/errors"));
  (entity ? entity->instance.errors : setup_.errors) = factor;
  for (const auto& each : entities_)
    for (const auto& device : each->devices) {
      device->errors = setup_.errors * each->instance.errors;
      pools_[device->kind].pool->scale_errors(device->index, device->errors);
    }
  return {};
}

bool Simulation::errors_scaled() const {
  return setup_.errors != 1 || std::any_of(entities_.begin(), entities_.end(),
                                           [](const auto& each) { return each->instance.errors != 1; });
}

void Simulation::save_errors(ByteWriter& w) const {
  write(w, setup_.errors);
  for (const auto& entity : entities_)
    if (entity->instance.errors != 1) write(w, entity->serial), write(w, entity->instance.errors);
}

}  // namespace sandlot
