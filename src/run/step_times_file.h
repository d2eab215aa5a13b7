#pragma once
/// Step times of a run as CSV: a line per tick.
///
/// File    two comment lines, the names `time_s,step_s,wall_s,compute_s`, then numbers in seconds. wall_s is empty at the first
///         tick of a stretch (sim/session/step_times.h); after a rewind time_s goes back there.
/// Errors  status() holds the first write that failed; what comes after is not written. The file appears when it is whole.
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/result.h"
#include "sim/session/step_times.h"

namespace sandlot {

class StepTimesFile final : public StepObserver {
 public:
  explicit StepTimesFile(const std::string& path);
  const Status& status() const { return status_; }
  void on_step(const StepTime& step) override;
  /// Puts the file in place.
  Status finish();

 private:
  void write(std::string_view text);
  AtomicFile file_;
  std::string held_;
  Status status_;
};

/// Reads such a file; the empty fields of wall_s are unset.
Result<std::vector<StepTime>> read_step_times(std::string_view text, const std::string& file);

}  // namespace sandlot
