#pragma once
/// Delivery trace: who has received what from whom in a tick, for observers.
///
/// It reads the inboxes before and after the media deliver, so that it works for every medium, no medium knows of it, and
/// nothing of it is State.
///
/// Limits   what a full inbox loses is not in the list; of a packet for one robot all that it reached are.
/// Cost     used only while an observer wants deliveries: a number per receiver, a look-up per delivery. At most
///          most_per_tick are listed; in each tick another receiver comes first.
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "media/medium.h"
#include "sim/world/frame.h"

namespace sandlot {

class Simulation;

class DeliveryTrace {
 public:
  static constexpr std::size_t most_per_tick = 2048;

  /// To be called when entities or devices came or went.
  void devices_changed() { devices_.clear(); }
  void clear() { deliveries_.clear(); }
  /// Before a medium delivers.
  void begin(std::span<const Receiver> receivers);
  /// Appends what the medium has delivered since begin(). @param medium  index in the world's list
  void end(std::uint32_t medium, std::span<const Receiver> receivers, const Simulation& simulation);
  std::span<const FrameDelivery> deliveries() const { return deliveries_; }

 private:
  /// Nothing: there is no such device now.
  std::optional<std::uint64_t> serial_of(std::uint64_t device_key) const;
  void list_devices(const Simulation& simulation);

  std::vector<std::size_t> sizes_;                                ///< of the inboxes, before
  std::vector<std::pair<std::uint64_t, std::uint64_t>> devices_;  ///< key, serial of its instance; sorted
  std::vector<FrameDelivery> deliveries_;
};

}  // namespace sandlot
