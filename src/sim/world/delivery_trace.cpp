#include "sim/world/delivery_trace.h"

#include <algorithm>

#include "sim/world/simulation.h"

namespace sandlot {

void DeliveryTrace::begin(std::span<const Receiver> receivers) {
  sizes_.clear();
  for (const Receiver& receiver : receivers) sizes_.push_back(receiver.inbox->items().size());
}

void DeliveryTrace::end(std::uint32_t medium, std::span<const Receiver> receivers,
                        const Simulation& simulation) {
  if (receivers.empty()) return;
  if (devices_.empty()) list_devices(simulation);
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    const std::size_t at = (i + simulation.tick_index()) % receivers.size();
    const Receiver& receiver = receivers[at];
    const std::span<const Received> items = receiver.inbox->items();
    if (items.size() <= sizes_[at]) continue;
    const auto to = serial_of(receiver.key);
    for (const Received& received : items.subspan(sizes_[at])) {
      const DeliveryHead& delivery = received.head;
      if (deliveries_.size() >= most_per_tick) return;
      const auto from = serial_of(delivery.emitter);
      if (from && to) deliveries_.push_back({medium, *from, *to, delivery.channel, delivery.strength});
    }
  }
}

std::optional<std::uint64_t> DeliveryTrace::serial_of(std::uint64_t device_key) const {
  const auto found = std::lower_bound(devices_.begin(), devices_.end(),
                                      std::pair(device_key, std::uint64_t{0}));
  return found != devices_.end() && found->first == device_key ? std::optional(found->second) : std::nullopt;
}

void DeliveryTrace::list_devices(const Simulation& simulation) {
  for (const auto& entity : simulation.entities())
    for (const auto& device : entity->devices) devices_.emplace_back(device->key, entity->serial);
  std::sort(devices_.begin(), devices_.end());
}

}  // namespace sandlot
