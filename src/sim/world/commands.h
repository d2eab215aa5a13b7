#pragma once
/// Commands: requests from outside until a tick carries them out, the manual override of devices, outcomes, and the log of
/// the tick.
///
/// Threads   submit() from any; everything else on the simulation's.
/// State     manual overrides and the number of refused commands.
#include <algorithm>
#include <mutex>
#include <span>
#include <vector>

#include "base/fields.h"
#include "sim/world/frame.h"
#include "sim/world/parts.h"
#include "sim/world/request.h"

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
  };

  /// Queues a request for the next tick. @return its sequence number
  std::uint64_t submit(Request request, Source source);
  /// The requests queued until now, in the order of their execution: kind of source, source, sequence number. Valid until
  /// the next call.
  std::span<Pending> take();

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
  void restore(std::vector<ManualOverride> overrides) { overrides_ = std::move(overrides); }

  /// A new entry of the tick's log, empty but for these.
  LogEntry& log_entry(std::uint8_t kind, const Source& source, std::uint64_t sequence);
  std::span<const LogEntry> tick_log() const { return log_; }
  void clear_log();

 private:
  void log_request(const Request& request, const Outcome& outcome);

  std::mutex mutex_;  ///< of the next two
  std::vector<Pending> inbox_;
  std::uint64_t next_sequence_ = 0;

  std::vector<Pending> taken_;
  std::vector<Outcome> outcomes_;
  std::vector<ManualOverride> overrides_;
  std::uint64_t refused_ = 0;
  std::vector<LogEntry> log_, spare_log_;  ///< spare: entries to use again, with their memory
};

}  // namespace sandlot
