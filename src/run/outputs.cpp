#include "run/outputs.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/atomic_file.h"
#include "base/text.h"
#include "record/glob.h"
#include "record/layout.h"

namespace sandlot {
namespace {

/// Warning for a pattern that fits no topic: a robot spawned later may have one, but a misspelling is more
/// likely.
std::optional<Error> unmatched(const std::string& pattern, const Simulation& simulation) {
  std::vector<std::string> known{recording::tf_topic,  recording::tf_static_topic, recording::clock_topic,
                                 recording::log_topic, recording::hash_topic,      recording::parts_topic};
  for (const TopicBase* topic : simulation.topics()) known.push_back(topic->name());
  for (const std::string& topic : known)
    if (glob_matches(pattern, topic)) return std::nullopt;
  return Error{"no topic to record fits '" + pattern + "'", suggestion(pattern, known)};
}

}  // namespace

RunOutputs::RunOutputs(const RunSpec& spec, Session& session, std::function<void(Error)> warn)
    : spec_(spec), session_(session), warn_(std::move(warn)) {}

void RunOutputs::record_error(Status status) {
  if (!status) errors_.push_back(std::move(status.error()));
}

Status RunOutputs::open_log(const PreparedRun& prepared) {
  if (!spec_.step_times_file.empty()) SL_TRY(step_times_.emplace(spec_.step_times_file).status());
  const Simulation& simulation = session_.simulation();
  // Of a run that goes on from a snapshot the scenario's logs are not begun again, as its CSV log is not.
  std::vector<AgentLogDecl> agents = spec_.from_file.empty() ? declared_agent_logs(simulation)
                                                             : std::vector<AgentLogDecl>();
  for (const std::string& text : spec_.agent_logs) agents.push_back(parse_agent_log(text));
  for (AgentLogDecl& decl : agents) {
    SL_ASSIGN(auto log, AgentLog::open(simulation, std::move(decl)));
    agent_logs_.push_back(std::move(log));
  }
  if (!prepared.log) return {};
  SL_ASSIGN(log_, CsvLog::open(session_.simulation(), *prepared.log));
  log_file_ = prepared.log->file;
  return {};
}

Status RunOutputs::start(const PreparedRun& prepared) {
  if (!spec_.film.file.empty()) {
    SL_ASSIGN(film_, Film::begin(spec_.film, session_.simulation()));
    filming_ = true;
  }
  const Simulation& simulation = session_.simulation();
  travel_.restart(simulation.tick_index());
  if (!spec_.drawing_file.empty()) session_.add_observer(&drawing_.emplace(simulation));
  record_options_.version = SANDLOT_VERSION;
  if (prepared.recording) {
    record_options_ = *prepared.recording;
    for (const std::string& pattern : prepared.recording->recording.topics)
      if (auto warning = unmatched(pattern, simulation)) warn_(std::move(*warning));
    SL_ASSIGN(auto recorder, Recorder::start(*prepared.recording, simulation));
    const std::lock_guard lock(recorder_mutex_);
    recorder_ = std::move(recorder);
    recorded_to_ = prepared.recording->recording.file;
    session_.add_observer(recorder_.get());
  }
  if (log_) {
    // Replaces an old file, so it comes after everything that may refuse the run.
    SL_TRY(log_->begin());
    session_.add_observer(log_.get());
  }
  for (const auto& log : agent_logs_) {
    SL_TRY(log->begin());
    session_.add_observer(log.get());
  }
  if (step_times_) session_.add_step_observer(&*step_times_);
  snapshots_.emplace(spec_.snapshots, simulation);
  return {};
}

bool RunOutputs::after_tick() {
  travel_.update(session_.simulation());
  record_error(snapshots_->after_tick(session_.simulation()));
  if (filming_)
    if (Status status = film_->take_due_pictures(session_.simulation()); !status) {
      record_error(std::move(status));
      filming_ = false;
    }
  return !log_ || log_->status();
}

void RunOutputs::on_world_replaced(Simulation& next, const std::string& why) {
  const auto warn_of_end = [&](const char* what, const std::string& file) {
    warn_({fmt::format("{} '{}' ends here: the run was {}", what, file, why)});
  };
  if (log_) {
    session_.remove_observer(log_.get());
    warn_of_end("the log", log_file_);
    end_log();
  }
  for (const auto& log : agent_logs_) {
    session_.remove_observer(log.get());
    warn_of_end("the log", log->file());
  }
  end_agent_logs();
  if (recorder_ && !recorded_) {
    session_.remove_observer(recorder_.get());
    warn_of_end("the recording", recorded_to_);
    end_recording();
  }
  if (filming_) {
    warn_of_end("the film", film_->file());
    end_film();
  }
  travel_.restart(next.tick_index());
  if (drawing_) {
    session_.remove_observer(&*drawing_);
    session_.add_observer(&drawing_.emplace(next));
  }
  record_error(configure(next, spec_));
}

Result<std::string> RunOutputs::record(const std::string& file) {
  const bool recording = recorder_ && !recorded_;
  if (file.empty()) {
    if (!recording) return Error{"nothing is being recorded", "record FILE begins"};
    session_.remove_observer(recorder_.get());
    end_recording();
    return fmt::format("'{}' is whole: {} messages, {} bytes", recorded_to_, recorded_->messages,
                       recorded_->bytes);
  }
  if (recording) return Error{"the run is being recorded to '" + recorded_to_ + "'", "record off ends that"};
  RecordOptions options = record_options_;
  options.recording.file = file;
  SL_ASSIGN(auto recorder, Recorder::start(options, session_.simulation()));
  {
    const std::lock_guard lock(recorder_mutex_);
    recorder_ = std::move(recorder);
    recorded_.reset();
    recorded_to_ = file;
  }
  session_.add_observer(recorder_.get());
  return "recording to '" + file + "'";
}

std::optional<RecordingProgress> RunOutputs::recording() {
  const std::lock_guard lock(recorder_mutex_);
  if (!recorder_ || recorded_) return std::nullopt;
  const Recorder::Report report = recorder_->so_far();
  return RecordingProgress{recorded_to_, report.messages, report.bytes};
}

void RunOutputs::end_log() {
  if (!log_) return;
  record_error(log_->finish());
  log_.reset();
}

void RunOutputs::end_recording() {
  if (!recorder_ || recorded_) return;
  record_error(recorder_->finish());
  {
    const std::lock_guard lock(recorder_mutex_);
    recorded_ = recorder_->report();
  }
  if (recorded_->dropped_messages == 0 && recorded_->complete()) return;
  Error warning{fmt::format("the recording lacks {} messages that the disk was too slow for",
                            recorded_->dropped_messages),
                "record fewer topics, a larger queue, or `when_full: wait`"};
  if (!recorded_->complete())
    warning.what += fmt::format(", and log and hashes of {} ticks: it cannot be replayed",
                                recorded_->lost_frames);
  warn_(std::move(warning));
}

void RunOutputs::end_film() {
  if (!filming_) return;
  filming_ = false;
  record_error(film_->finish());
}

void RunOutputs::rescue(Error& error) {
  const Simulation& simulation = session_.simulation();
  if (simulation.engine().check_finite()) return;
  std::string file = spec_.snapshots.file;
  if (file.empty() || spec_.snapshots.at_s) {
    const std::string& name = simulation.setup().name;
    file = (std::filesystem::path(spec_.summary_file).parent_path() /
            ("sandlot-failed" + (name.empty() ? "" : "-" + sanitised(name)) + ".snapshot"))
               .string();
    const auto bytes = simulation.snapshot();
    if (Status written = write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        !written)
      return record_error(std::move(written));
  }
  error.fix += (error.fix.empty() ? "" : "; ") + ("the world before it is in '" + file + "'");
}

void RunOutputs::end_agent_logs() {
  for (const auto& log : agent_logs_) record_error(log->finish());
  agent_logs_.clear();
}

void RunOutputs::finish() {
  end_agent_logs();
  end_log();
  if (step_times_) {
    session_.remove_step_observer(&*step_times_);
    record_error(step_times_->finish());
  }
  Diagnostics diagnostics;
  record_error(snapshots_->finish(session_.simulation(), diagnostics));
  for (Error& warning : diagnostics.warnings) warn_(std::move(warning));
  end_recording();
  end_film();
}

void RunOutputs::add_to(Summary& summary) const {
  if (film_) summary.video = {film_->file(), film_->pictures()};
  if (!recorded_) return;
  summary.recording = {.file = recorded_to_,
                       .messages = recorded_->messages,
                       .bytes = recorded_->bytes,
                       .dropped_messages = recorded_->dropped_messages,
                       .lost_ticks = recorded_->lost_frames,
                       .complete = recorded_->complete()};
}

std::optional<std::string> RunOutputs::drawing() const {
  if (!drawing_) return std::nullopt;
  return drawing_->draw();
}

}  // namespace sandlot
