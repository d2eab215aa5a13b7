#pragma once
/// Replay: a recorded run is repeated and compared, from the snapshot in the recording, with the recorded input of each
/// tick.
///
///   SL_ASSIGN(Replay replay, Replay::begin(snapshot, {.programs = Programs::recompute}, diagnostics));
///   while (const RecordedTick* tick = ...) {
///     SL_ASSIGN(const std::optional<Difference> difference, replay.tick(*tick));
///     ...
///   }
///
/// Programs  `recompute`: controllers run again, and what they order now is compared with what the log says they ordered.
///           `logged`: they stay silent and their orders come from the log; their own State is then not compared.
/// Errors    a tick that is missing, a log entry that cannot be read, a run that fails where the recorded one went on.
/// Cost      that of the run, and of one hash per tick when there are hashes to compare with.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/world/simulation.h"

namespace sandlot::record {

/// What a recording says of one tick.
struct RecordedTick {
  std::uint64_t tick = 0;
  Time now;
  std::vector<LogEntry> log;
  std::uint64_t hash = 0;
  std::vector<std::uint64_t> parts;  ///< empty: the recording has no hashes
  std::shared_ptr<const std::vector<std::string>> part_names;
};

enum class Programs { recompute, logged };

/// How a tick came out other than it was recorded.
struct Difference {
  std::uint64_t tick = 0;
  Time now;
  std::vector<std::string> parts;   ///< entities whose State differs: "rover/laser"
  std::vector<std::string> orders;  ///< what was carried out differently, a sentence each

  /// "tick 12 (0.12 s): ...", one line.
  std::string text() const;
};

/// "tick 12 (0.12 s)"
std::string tick_text(std::uint64_t tick, Time now);

/// Names of the parts whose hashes differ; a part that only one side has counts too. Parts named in `ignored` do not.
std::vector<std::string> differing_parts(const std::vector<std::string>& names_a,
                                         std::span<const std::uint64_t> a,
                                         const std::vector<std::string>& names_b,
                                         std::span<const std::uint64_t> b,
                                         std::span<const std::string> ignored = {});

class Replay {
 public:
  struct Options {
    Programs programs = Programs::recompute;
    int threads = 1;
    bool compare = true;                      ///< false: only runs again
    std::span<const std::string> paths = {};  ///< folders to search first for plugins
  };
  static Result<Replay> begin(std::span<const std::byte> snapshot, const Options& options,
                              Diagnostics& diagnostics);
  Replay(Replay&&) noexcept;
  ~Replay();

  /// Carries out one tick as it was recorded. That of the snapshot is only compared, earlier ones
  /// are passed over.
  Result<std::optional<Difference>> tick(const RecordedTick& recorded);

  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }
  /// State hash after the last tick, if it was computed.
  std::optional<std::uint64_t> hash() const;

 private:
  struct Watch;
  Replay(std::unique_ptr<Simulation> simulation, const Options& options);
  Result<std::optional<Time>> submit(const RecordedTick& recorded);
  void compare_log(const RecordedTick& recorded, Difference& difference) const;
  std::optional<Difference> compare_start(const RecordedTick& recorded) const;
  void compare_state(const RecordedTick& recorded, Difference& difference) const;

  Options options_;
  std::unique_ptr<Watch> watch_;  ///< outlives the simulation that calls it
  std::unique_ptr<Simulation> simulation_;
  std::optional<Error> failed_;
};

}  // namespace sandlot::record
