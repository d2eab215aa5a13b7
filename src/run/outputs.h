#pragma once
/// RunOutputs: everything that is written about a run while it runs: CSV log, step times, recording, film, drawing,
/// snapshot files, and the distances for its summary.
///
///   RunOutputs outputs(spec, session, warn);
///   SL_TRY(outputs.open_log(prepared));      // checks the log before any file is replaced
///   SL_TRY(outputs.start(prepared));         // from here on files are replaced
///   ... after each tick: outputs.after_tick()
///   outputs.finish();
///
/// Errors   of files that cannot be written: collected in errors(); the run goes on, but for the log.
/// Threads  the simulation's, except for recording().
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "draw/run_drawing.h"
#include "record/agent_log.h"
#include "run/film.h"
#include "run/prepare.h"
#include "run/snapshot_files.h"
#include "run/step_times_file.h"
#include "run/summary.h"
#include "run/travel.h"
#include "sim/session/session.h"
#include "sim/watch/csv_log.h"

namespace sandlot {

/// A recording that is being written.
struct RecordingProgress {
  std::string file;
  std::uint64_t messages = 0, bytes = 0;
};

class RunOutputs {
 public:
  /// `spec` and `session` must outlive the outputs.
  RunOutputs(const RunSpec& spec, Session& session, std::function<void(Error)> warn);
  RunOutputs(const RunOutputs&) = delete;
  RunOutputs& operator=(const RunOutputs&) = delete;

  Status open_log(const PreparedRun& prepared);
  Status start(const PreparedRun& prepared);
  /// @return false: the log cannot be written, and the run should end
  bool after_tick();
  /// Ends log, recording and film, which hold one run without a leap in time; drawing and distances begin
  /// again.
  /// @param why  "reset", "rewound to 3 s", "loaded"
  void on_world_replaced(Simulation& next, const std::string& why);
  /// Starts a recording of the run from now on, or ends it (""). @return a sentence for the one who asked
  Result<std::string> record(const std::string& file);
  /// Nothing when nothing is recorded. From any thread.
  std::optional<RecordingProgress> recording();
  /// After the engine has failed: stores the state before it as a snapshot, unless one that was asked for
  /// will hold it, and names the file in `error`.
  void rescue(Error& error);
  /// Ends what is still being written.
  void finish();

  /// Adds what was written.
  void add_to(Summary& summary) const;
  /// SVG; nothing when the spec has no `drawing_file`.
  std::optional<std::string> drawing() const;
  const TravelMeter& travel() const { return travel_; }
  const std::vector<Error>& errors() const { return errors_; }
  void record_error(Status status);

 private:
  void end_log();
  void end_agent_logs();
  void end_recording();
  void end_film();

  const RunSpec& spec_;
  Session& session_;
  std::function<void(Error)> warn_;
  TravelMeter travel_;
  std::optional<draw::RunDrawing> drawing_;
  std::unique_ptr<CsvLog> log_;
  std::vector<std::unique_ptr<AgentLog>> agent_logs_;
  std::optional<StepTimesFile> step_times_;
  std::mutex recorder_mutex_;  ///< recording() comes from other threads
  std::unique_ptr<Recorder> recorder_;
  std::optional<Recorder::Report> recorded_;  ///< once it has ended
  std::string log_file_, recorded_to_;
  RecordOptions record_options_;  ///< all but the file, for record()
  std::optional<SnapshotFiles> snapshots_;
  std::optional<Film> film_;
  bool filming_ = false;
  std::vector<Error> errors_;
};

}  // namespace sandlot
