#pragma once
/// Snapshot files: written while a run goes on, read to go on from, shown by `info` and `doctor`.
///
///   --snapshot a.snapshot                          at the end of the run
///   --snapshot a.snapshot --snapshot-at 5s         once, at the first tick not before 5 s
///   --snapshot a.snapshot --snapshot-every 10s     a-000010.000.snapshot, a-000020.000.snapshot ..., and at the end
///
/// A file appears under its name when it is whole: a full disk, or the end of the process, costs none that is there.
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/world/simulation.h"
#include "sim/world/snapshot.h"

namespace sandlot {

struct SnapshotOptions {
  std::string file;               ///< "": none
  std::optional<double> at_s;     ///< unset: at the end
  std::optional<double> every_s;  ///< besides
  int keep = 0;                   ///< of those of `every_s` the last so many stay; 0: all
};

/// Errors: options that do not go together.
Status check(const SnapshotOptions& options);

/// "a-000010.000.snapshot" for "a.snapshot" and 10 s.
std::string numbered_file(const std::string& file, Time now);

/// Writes what the options ask for; call after() after each tick and finish() at the end.
class SnapshotFiles {
 public:
  SnapshotFiles(const SnapshotOptions& options, const Simulation& simulation);
  /// An error is told once; later files are tried all the same.
  Status after(const Simulation& simulation);
  Status finish(const Simulation& simulation);

 private:
  Status write(const Simulation& simulation, const std::string& file);
  SnapshotOptions options_;
  bool taken_;  ///< the one at the end or at `at_s`
  std::optional<Time> next_;
  std::deque<std::string> written_;
  bool told_ = false;
};

/// Size limit of a snapshot that is read.
inline constexpr std::uint64_t most_snapshot_bytes = std::uint64_t{4} << 30;

Result<std::vector<std::byte>> read_file(const std::string& path, std::uint64_t most_bytes);
/// False also for what cannot be read.
bool is_snapshot_file(const std::string& path);
/// What a snapshot file says of itself, as names and values; errors name the file.
Result<std::vector<std::pair<std::string, std::string>>> examine_file(const std::string& path);
/// Rebuilds the world of a snapshot file; errors name the file.
Result<std::unique_ptr<Simulation>> restore_file(const std::string& path, const SimulationOptions& options,
                                                 Diagnostics& diagnostics);

}  // namespace sandlot
