#pragma once
/// What goes along with a run: the way its robots took, the drawing, the CSV log, the recording, the film, snapshot files,
/// and the line on the terminal.
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "app/prepare.h"
#include "app/report.h"
#include "draw/run_drawing.h"
#include "run/film.h"
#include "server/server.h"
#include "sim/session/session.h"
#include "sim/watch/csv_log.h"

namespace sandlot::app {

/// One line on a terminal: how far, how fast, how long still.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void update(const Simulation& simulation);

 private:
  bool shown_, drawn_ = false;
  std::chrono::steady_clock::time_point begin_, last_;
  Time sim_begin_;
};

class Followers {
 public:
  Followers(const RunOptions& options, Session& session);
  Followers(const Followers&) = delete;
  Followers& operator=(const Followers&) = delete;

  /// Opens the log, so that what is wrong with it is said before anything is written.
  Status open(const Prepared& prepared);
  /// Files are replaced from here on.
  Status start(const Prepared& prepared, Diagnostics& diagnostics);
  /// After each tick. @return false: the run cannot go on
  bool after_tick();
  /// Another world has come: log and recording, which tell of one run without a leap, end here.
  void leave_world(Simulation& next, const std::string& why);
  /// Begins a recording of the run as it is now, or ends it (""). @return what to tell
  Result<std::string> record(const std::string& file);
  /// What is being written, for viewers; from any thread.
  std::optional<server::ServerOptions::Recording> recording();
  /// Of a world that has exploded: leaves the state before it as a snapshot where nobody has asked for one that holds it.
  /// `error` tells where it is.
  void rescue(Error& error);
  /// Ends what is still being written.
  void finish(Diagnostics& diagnostics);
  /// What the run leaves in the summary and as files besides.
  void add_to(nlohmann::ordered_json& summary) const;
  std::optional<std::string> drawing() const;

  const TravelRecorder& travel() const { return travel_; }
  std::vector<Error>& errors() { return errors_; }

 private:
  void note(Status status);
  void end_log();
  void end_recording(Diagnostics& diagnostics);
  void end_film();

  const RunOptions& options_;
  Session& session_;
  Progress progress_;
  TravelRecorder travel_;
  std::optional<draw::RunDrawing> svg_;
  std::unique_ptr<CsvLog> log_;
  std::mutex recorder_mutex_;  ///< another thread asks what is being recorded
  std::unique_ptr<Recorder> recorder_;
  std::optional<Recorder::Report> recorded_;  ///< once it has ended
  std::string log_file_, recorded_to_;
  RecordOptions record_options_;  ///< but for the file
  std::optional<SnapshotFiles> snapshots_;
  std::optional<Film> film_;
  bool filming_ = false;
  std::vector<Error> errors_;
  Diagnostics said_;  ///< of results that ended before the run
};

}  // namespace sandlot::app
