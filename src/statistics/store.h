#pragma once
/// Results of runs in an SQLite file: a series that was interrupted goes on, several series lie side by side, and any tool that
/// reads SQLite evaluates them.
///
///   experiments   id, fingerprint, name, physics, settings: one per series
///   runs          experiment, seed, end_time, stopped, state_hash: one per run that ended without an error
///   criteria      experiment, seed, team ('' is the whole run), value, success
///
/// Files    a file that is not such a store is refused and not changed. Several processes may write one file; each waits for
///          the others up to 10 s.
/// Cost     a transaction per run, about a millisecond.
/// Limits   seeds above 2^63 - 1 are stored as the negative number of the same bits.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace sandlot::statistics {

struct StoredExperiment {
  std::string fingerprint;  ///< equal for runs that differ by their seeds alone
  std::string name, physics;
  std::string settings;  ///< for people
};

struct StoredCriterion {
  std::string team;  ///< "": of the run
  std::optional<double> value;
  std::optional<bool> success;
};

struct StoredRun {
  std::uint64_t seed = 0;
  double end_s = 0;
  std::string stopped, state_hash;
  std::vector<StoredCriterion> criteria;
};

class ResultStore {
 public:
  /// Opens a file or makes it. Errors name the file.
  static Result<ResultStore> open(const std::string& file);
  ResultStore(ResultStore&&) noexcept;
  ResultStore& operator=(ResultStore&&) noexcept;
  ~ResultStore();

  /// The number of the experiment with this fingerprint, which is added if it is not there.
  Result<std::int64_t> experiment(const StoredExperiment& experiment);
  /// Runs with seeds from `first` on, at most `count`, by seed.
  Result<std::vector<StoredRun>> runs(std::int64_t experiment, std::uint64_t first, std::uint64_t count);
  /// Adds a run as a whole, or nothing. One with that seed is replaced.
  Status add(std::int64_t experiment, const StoredRun& run);

 private:
  struct Database;
  explicit ResultStore(std::unique_ptr<Database> database);
  std::unique_ptr<Database> database_;
};

}  // namespace sandlot::statistics
