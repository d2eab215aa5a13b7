#pragma once
/// Input log of a recording: the input from outside for a Session, tick by tick, and the hash after each tick to compare
/// the new run with. Programs run again.
///
///   SL_ASSIGN(RecordedRun run, read_run(recording));
///   RunCheck check(run);
///   Session session(std::move(simulation), {.stay = true, .input_log = run.input_log});
///   session.add_observer(&check);
///
/// Errors   a log entry that cannot be read. A recording that is torn off or damaged ends where it is whole, and says why
///          in `cut`.
/// Cost     8 bytes per tick and what came from outside; a hash of the State per tick while it is compared.
#include <functional>
#include <optional>
#include <vector>

#include "record/recording.h"
#include "sim/session/session.h"

namespace sandlot::record {

struct RecordedRun {
  InputLog input_log;
  std::uint64_t first_tick = 0;
  /// After tick first_tick + i. Nothing: the recording does not tell.
  std::vector<std::optional<std::uint64_t>> hashes;
  std::optional<Error> cut;
};

/// Reads the recording to its end.
Result<RecordedRun> read_run(Recording& recording);

/// Compares each tick of a session that runs the recording again.
class RunCheck final : public Observer {
 public:
  /// @param differs  called at the first tick that differs, and again when a new world has come and differs
  RunCheck(const RecordedRun& run, std::function<void(std::uint64_t tick, Time now)> differs)
      : run_(run), differs_(std::move(differs)) {}
  Wants wants() const override { return {.hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override;
  /// Of another world, which begins as it was recorded.
  void begin_again() { differing_ = false; }

  std::uint64_t compared() const { return compared_; }
  std::uint64_t different() const { return different_; }

 private:
  const RecordedRun& run_;
  std::function<void(std::uint64_t tick, Time now)> differs_;
  bool differing_ = false;
  std::uint64_t compared_ = 0, different_ = 0;
};

}  // namespace sandlot::record
