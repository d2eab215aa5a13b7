#pragma once
/// Commands: requests from outside until a tick carries them out, the manual override of devices, outcomes, and the log of
/// the tick.
///
/// Threads   submit() from any; everything else on the simulation's.
/// State     manual overrides and the number of refused commands.
#include <algorithm>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "base/fields.h"
#include "elements/request.h"
#include "sim/world/frame.h"
#include "sim/world/parts.h"

namespace sandlot {

/// Manual override: after a command from outside, commands of programs to the same device are refused for a while.
struct ManualOverride {
  std::uint64_t device = 0;  ///< its key
  Time until;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"device", "1", "Key of the device."}, s.device);
    visit(Field{"until", "s", "Time at which commands of programs take effect again."}, s.until);
  }
};
/// Duration of a manual override, from the latest command on [s].
inline constexpr double manual_override_s = 0.5;

class Commands {
 public:
  struct Pending {
    Source source;
    std::uint64_t sequence;
    Request request;
    bool logged = false;  ///< of the log of another run
  };

  /// Queues a request for the next tick. @return its sequence number
  std::uint64_t submit(Request request, Source source) { return queue(std::move(request), source, false); }
  /// Queues a request of a log: those are carried out before all others, in the order in which they are queued.
  std::uint64_t repeat(Request request, Source source) { return queue(std::move(request), source, true); }
  /// Drops the requests that wait and are not of a log.
  void drop_unlogged();
  /// Whether a new instance of this name waits for the next tick.
  bool awaits_spawn(std::string_view name) const;
  /// Creation order of the entity that a target belongs to; nothing when there is none.
  using SerialOf = std::function<std::optional<std::uint64_t>(std::string_view target)>;
  /// The requests queued until now, in the order of their execution, which does not depend on who connected or sent first:
  /// by kind of source; clients that drive robots by the creation order of their first robot; clients that are alike in
  /// this by the bytes of what they request. Those of one client stay together, in the order in which it sent them. A
  /// client that drives a robot is named by that robot from here on. Valid until the next call.
  std::span<Pending> take(const SerialOf& serial_of);

  /// Forgets the outcomes of the tick before, and overrides that are over.
  void begin_tick(Time now);
  /// Records the outcome of a request, in the log, too, if `logged`.
  void conclude(const Pending& pending, Status status, bool logged, std::vector<std::byte> response = {});
  std::span<const Outcome> outcomes() const { return outcomes_; }

  void count_refused(std::uint64_t number = 1) { refused_ += number; }
  std::uint64_t refused() const { return refused_; }

  void override_manually(const SimulationParts::Device& device, Time now);
  bool is_overridden(const SimulationParts::Device& device) const {
    return std::any_of(overrides_.begin(), overrides_.end(),
                       [&](const ManualOverride& each) { return each.device == device.key; });
  }
  const std::vector<ManualOverride>& overrides() const { return overrides_; }
  /// From a snapshot.
  void restore(std::uint64_t refused) { refused_ = refused; }
  void restore(std::vector<ManualOverride> overrides);

  /// A new entry of the tick's log, empty but for these.
  LogEntry& log_entry(std::uint8_t kind, const Source& source, std::uint64_t sequence);
  std::span<const LogEntry> tick_log() const { return log_; }
  void clear_log();

 private:
  std::uint64_t queue(Request request, Source source, bool logged);
  void order_clients(std::size_t begin, const SerialOf& serial_of);
  void log_request(const Request& request, const Outcome& outcome);

  mutable std::mutex mutex_;  ///< of the next two
  std::vector<Pending> inbox_;
  std::uint64_t next_sequence_ = 0;

  std::vector<Pending> taken_;
  std::vector<Outcome> outcomes_;
  std::vector<ManualOverride> overrides_;  ///< by device, so that it does not matter which came first
  std::uint64_t refused_ = 0;
  std::vector<LogEntry> log_, spare_log_;  ///< spare: entries to use again, with their memory
};

}  // namespace sandlot
