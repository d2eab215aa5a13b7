/// Commands on their way into devices: from requests, from programs, from other devices; services.
#include <algorithm>

#include "base/text.h"
#include "sim/world/commands.h"
#include "sim/world/device_keys.h"
#include "sim/world/device_pools.h"
#include "sim/world/faults.h"

namespace sandlot {
namespace {

/// Slot of a device of the same robot, as the destination of orders: like a program's they wait for no one at the controls.
class SlotSink final : public OrderSink {
 public:
  SlotSink(const DevicePools& pools, Commands& commands, SimulationParts::Device& device,
           SimulationParts::Slot& slot)
      : pools_(pools), commands_(commands), device_(device), slot_(slot) {}
  bool take(std::span<const std::byte> message, Time now) override {
    const bool taken = !commands_.is_overridden(device_) &&
                       pools_.deliver(device_, slot_, message, now, false);
    if (!taken) commands_.count_refused();
    return taken;
  }
  const TopicBase* latest(Time now) const override {
    return DevicePools::takes_commands(device_, now) ? &DevicePools::latest_command(device_, slot_) : nullptr;
  }

 private:
  const DevicePools& pools_;
  Commands& commands_;
  SimulationParts::Device& device_;
  SimulationParts::Slot& slot_;
};

}  // namespace

DevicePools::Slot* DevicePools::command_slot(Device& device, std::string_view type,
                                             std::string_view level) const {
  const auto& levels = pools_[device.kind].kind->levels;
  for (Slot& slot : device.commands) {
    if (type != slot.topic->type()) continue;
    const bool always = slot.level >= levels.size();
    if (!level.empty() && (always || level != levels[slot.level].name)) continue;
    if (always || (device.levels >> slot.level & 1)) return &slot;
  }
  return nullptr;
}

bool DevicePools::takes_commands(const Device& device, Time now) {
  if (!device.faults) return true;
  const Failing failing = device.faults->at(now);
  return !failing.stuck && !failing.dead;
}

/// Commands that arrive, and their errors, of a pool with common keys.
void DevicePools::prepare_commands(Pool& pool, const Context& context) const {
  const Time begin = context.now - context.tick;
  for (Device* const device : pool.devices) {
    if (!device->keys_act || device->commands.empty()) continue;
    device->keys->prepare_commands(
        *device, {begin, context.tick, context.tick_index, context.seed, all_errors(*device, begin)},
        takes_commands(*device, begin));
  }
}

Status DevicePools::deliver(Device& device, Slot& slot, std::span<const std::byte> bytes, Time now,
                            bool explain) const {
  if (!takes_commands(device, now)) {
    if (device.keys) device.keys->count_refused();
    return explain ? Error{"'" + device.path + "' has failed"} : Error{};
  }
  const auto take = [&]() -> Status {
    if (!explain && slot.queued && is_full(*slot.topic)) return Error{};
    SL_TRY(slot.topic->assign(bytes));
    slot.topic->stamp = now;
    ++slot.topic->count;
    return {};
  };
  if (!device.keys) return take();
  const auto take_late = [&] {
    const auto index = static_cast<std::size_t>(&slot - device.commands.data());
    return device.keys->take_command(device, index, bytes, now, all_errors(device, now), explain);
  };
  Status taken = device.keys_act ? take_late() : take();
  if (!taken) {
    device.keys->count_refused();
    return taken;
  }
  device.keys->state.accepted = now;
  if (device.energy && device.energy->use() == EnergyMeter::Use::commands) device.energy->draw_for_use();
  return {};
}

const TopicBase& DevicePools::latest_command(const Device& device, const Slot& slot) {
  if (!device.keys) return *slot.topic;
  return *device.keys->latest_command(device, static_cast<std::size_t>(&slot - device.commands.data()));
}

Status DevicePools::connect_orders(Entity& entity, Device& device, Commands& commands) const {
  for (const auto& order : device.orders()) {
    const auto error = [&](std::string what, std::string fix) {
      return Error{std::move(what), std::move(fix), order->place(), order->key()};
    };
    Device* const other = entity.find_device(order->device());
    if (!other) {
      std::vector<std::string> known;
      for (const auto& each : entity.devices) known.push_back(each->path);
      return error("'" + device.path + "' gives orders to '" + order->device() + "', which is not there",
                   suggestion(order->device(), known));
    }
    const auto slot = std::find_if(other->commands.begin(), other->commands.end(), [&](const Slot& each) {
      return each.topic->name() == order->slot() && std::string_view(each.topic->type()) == order->type();
    });
    if (slot == other->commands.end())
      return error("'" + device.path + "' gives orders to '" + other->path + "', which takes no " +
                       order->type() + " at " + order->slot(),
                   "name a device that does");
    order->connect(std::make_unique<SlotSink>(*this, commands, *other, *slot));
  }
  return {};
}

Status DevicePools::call(Device& device, std::string_view service, std::span<const std::byte> request,
                         std::vector<std::byte>& response, const Context& context) {
  SL_ASSIGN(const DeviceService* const found, service_of(kind(device), device.path, service));
  if (!takes_commands(device, context.now)) return Error{"'" + device.path + "' has failed"};
  return pools_[device.kind].pool->call(device.index, *found, request, response, context);
}

}  // namespace sandlot
