#include "app/follow.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "app/json_text.h"
#include "base/atomic_file.h"
#include "base/log.h"
#include "base/text.h"
#include "record/glob.h"
#include "record/layout.h"

namespace sandlot::app {
namespace {

/// A warning for a pattern that fits no topic: something spawned later may bring one, but more likely it is misspelt.
std::optional<Error> unmatched(const std::string& pattern, const Simulation& simulation) {
  std::vector<std::string> known{recording::tf_topic,  recording::tf_static_topic, recording::clock_topic,
                                 recording::log_topic, recording::hash_topic,      recording::parts_topic};
  for (const TopicBase* topic : simulation.topics()) known.push_back(topic->name());
  for (const std::string& topic : known)
    if (glob_matches(pattern, topic)) return std::nullopt;
  return Error{"no topic to record fits '" + pattern + "'", suggestion(pattern, known)};
}

void warn(Error warning, Diagnostics& diagnostics) {
  std::fprintf(stderr, "warning: %s\n", warning.text().c_str());
  diagnostics.warn(std::move(warning));
}

}  // namespace

Progress::Progress() : shown_(isatty(STDERR_FILENO)) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(const Simulation& simulation) {
  if (!shown_) return;
  const auto now = std::chrono::steady_clock::now();
  if (drawn_ && now - last_ < std::chrono::milliseconds(200)) return;
  if (!drawn_) begin_ = now, sim_begin_ = simulation.now();
  last_ = now;
  drawn_ = true;
  const double wall_s = std::chrono::duration<double>(now - begin_).count();
  const double done_s = (simulation.now() - sim_begin_).s();
  const std::optional<Time> end = simulation.setup().stop;
  std::string line = fmt::format("\r\x1b[K{:.1f} s", simulation.now().s());
  if (wall_s > 0) line += fmt::format("  {:.1f} x real time", done_s / wall_s);
  if (end && done_s > 0)
    line += fmt::format("  {:.0f} % done, {:.0f} s left", 100.0 * simulation.now().s() / end->s(),
                        (end->s() - simulation.now().s()) * wall_s / done_s);
  std::fputs(line.c_str(), stderr);
}

Followers::Followers(const RunOptions& options, Session& session) : options_(options), session_(session) {}

void Followers::note(Status status) {
  if (!status) errors_.push_back(std::move(status.error()));
}

Status Followers::open(const Prepared& prepared) {
  if (!prepared.log) return {};
  SL_ASSIGN(log_, CsvLog::open(session_.simulation(), *prepared.log));
  log_file_ = prepared.log->file;
  return {};
}

Status Followers::start(const Prepared& prepared, Diagnostics& diagnostics) {
  if (!options_.film.file.empty()) {
    SL_ASSIGN(film_, Film::begin(options_.film, session_.simulation()));
    filming_ = true;
  }
  const Simulation& simulation = session_.simulation();
  travel_.begin_at(simulation.tick_index());
  if (!options_.svg_file.empty()) session_.add_observer(&svg_.emplace(simulation));
  record_options_.version = SANDLOT_VERSION;
  if (prepared.recording) {
    record_options_ = *prepared.recording;
    for (const std::string& pattern : prepared.recording->recording.topics)
      if (auto warning = unmatched(pattern, simulation)) warn(std::move(*warning), diagnostics);
    SL_ASSIGN(auto recorder, Recorder::start(*prepared.recording, simulation));
    const std::lock_guard lock(recorder_mutex_);
    recorder_ = std::move(recorder);
    recorded_to_ = prepared.recording->recording.file;
    session_.add_observer(recorder_.get());
  }
  if (log_) {
    // Replaces what was there, so it comes after everything that may refuse the run.
    SL_TRY(log_->begin());
    session_.add_observer(log_.get());
  }
  snapshots_.emplace(options_.snapshots, simulation);
  return {};
}

bool Followers::after_tick() {
  travel_.look(session_.simulation());
  progress_.update(session_.simulation());
  note(snapshots_->after(session_.simulation()));
  if (filming_)
    if (Status status = film_->look(session_.simulation()); !status) {
      note(std::move(status));
      filming_ = false;
    }
  return !log_ || log_->status();
}

void Followers::leave_world(Simulation& next, const std::string& why) {
  const auto tell = [&](const char* what, const std::string& file) {
    Error warning{fmt::format("{} '{}' ends here: the run was {}", what, file, why)};
    log::warning(warning.what);
    said_.warn(std::move(warning));
  };
  if (log_) {
    session_.remove_observer(log_.get());
    tell("the log", log_file_);
    end_log();
  }
  if (recorder_ && !recorded_) {
    session_.remove_observer(recorder_.get());
    tell("the recording", recorded_to_);
    end_recording(said_);
  }
  if (filming_) {
    tell("the film", film_->file());
    end_film();
  }
  travel_ = {};
  travel_.begin_at(next.tick_index());
  if (svg_) {
    session_.remove_observer(&*svg_);
    session_.add_observer(&svg_.emplace(next));
  }
  note(configure(next, options_));
}

Result<std::string> Followers::record(const std::string& file) {
  const bool recording = recorder_ && !recorded_;
  if (file.empty()) {
    if (!recording) return Error{"nothing is being recorded", "record FILE begins"};
    session_.remove_observer(recorder_.get());
    end_recording(said_);
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

std::optional<server::ServerOptions::Recording> Followers::recording() {
  const std::lock_guard lock(recorder_mutex_);
  if (!recorder_ || recorded_) return std::nullopt;
  const Recorder::Report report = recorder_->so_far();
  return server::ServerOptions::Recording{recorded_to_, report.messages, report.bytes};
}

void Followers::end_log() {
  if (!log_) return;
  note(log_->finish());
  log_.reset();
}

void Followers::end_recording(Diagnostics& diagnostics) {
  if (!recorder_ || recorded_) return;
  note(recorder_->finish());
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
  warn(std::move(warning), diagnostics);
}

void Followers::end_film() {
  if (!filming_) return;
  filming_ = false;
  note(film_->finish());
}

void Followers::rescue(Error& error) {
  const Simulation& simulation = session_.simulation();
  if (simulation.engine().check_finite()) return;
  std::string file = options_.snapshots.file;
  if (file.empty() || options_.snapshots.at_s) {
    const std::string& name = simulation.setup().name;
    file = (std::filesystem::path(options_.summary_file).parent_path() /
            ("sandlot-failed" + (name.empty() ? "" : "-" + sanitised(name)) + ".snapshot"))
               .string();
    const auto bytes = simulation.snapshot();
    if (Status written = write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        !written)
      return note(std::move(written));
  }
  error.fix += (error.fix.empty() ? "" : "; ") + ("the world before it is in '" + file + "'");
}

void Followers::finish(Diagnostics& diagnostics) {
  end_log();
  note(snapshots_->finish(session_.simulation()));
  end_recording(diagnostics);
  end_film();
  for (Error& warning : said_.warnings) diagnostics.warn(std::move(warning));
}

void Followers::add_to(nlohmann::ordered_json& summary) const {
  if (film_) summary["video"] = {{"file", film_->file()}, {"pictures", film_->pictures()}};
  if (!recorded_) return;
  summary["recording"] = {{"file", recorded_to_},
                          {"messages", recorded_->messages},
                          {"bytes", recorded_->bytes},
                          {"dropped_messages", recorded_->dropped_messages},
                          {"lost_ticks", recorded_->lost_frames},
                          {"complete", recorded_->complete()}};
}

std::optional<std::string> Followers::drawing() const {
  if (!svg_) return std::nullopt;
  return svg_->draw();
}

}  // namespace sandlot::app
