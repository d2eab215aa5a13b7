#pragma once
/// Snapshot files: written during a run, read to continue from, shown by `info` and `doctor`.
///
///   --snapshot a.snapshot                          at the end of the run
///   --snapshot a.snapshot --snapshot-at 5s         once, at the first tick not before 5 s
///   --snapshot a.snapshot --snapshot-every 10s     a-000010.000.snapshot ..., and one at the end
///
/// A file appears under its name when it is whole: a full disk, or the end of the process, costs none that is
/// there.
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "run/spec.h"
#include "sim/world/simulation.h"

namespace sandlot {

/// Errors: options that do not go together.
Status check_snapshot_options(const SnapshotOptions& options);

/// "a-000010.000.snapshot" for "a.snapshot" and 10 s.
std::string numbered_file(const std::string& file, Time now);

/// Writes what the options ask for; call after_tick() after each tick and finish() at the end.
class SnapshotFiles {
 public:
  SnapshotFiles(const SnapshotOptions& options, const Simulation& simulation);
  /// Call after each tick. Errors: the first one is returned once; later files are tried all the same.
  Status after_tick(const Simulation& simulation);
  /// Call at the end of the run, which may come before the time that was asked for: a warning.
  Status finish(const Simulation& simulation, Diagnostics& diagnostics);

 private:
  Status write(const Simulation& simulation, const std::string& file);
  SnapshotOptions options_;
  bool taken_;  ///< the one at the end or at `at_s`
  std::optional<Time> next_;
  std::deque<std::string> written_;
  bool failed_ = false;
};

/// Bytes of a file of at most 4 GiB, whatever they are.
Result<std::vector<std::byte>> read_snapshot_file(const std::string& path);
/// Whether a file begins as a snapshot does; false for a file that cannot be read.
bool is_snapshot_file(const std::string& path);
/// Facts about a snapshot file, as names and values for people; errors name the file.
Result<std::vector<std::pair<std::string, std::string>>> snapshot_facts(const std::string& path);
/// World of a snapshot file; errors name the file.
Result<std::unique_ptr<Simulation>> restore_snapshot_file(const std::string& path,
                                                          const SimulationOptions& options,
                                                          Diagnostics& diagnostics);

}  // namespace sandlot
