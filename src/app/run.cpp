#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "app/commands.h"
#include "app/json_text.h"
#include "app/report.h"
#include "app/snapshots.h"
#include "app/svg.h"
#include "base/log.h"
#include "base/text.h"
#include "record/glob.h"
#include "record/layout.h"
#include "record/playback.h"
#include "record/recorder.h"
#include "sim/csv_log.h"
#include "sim/load.h"

namespace sandlot::app {
namespace {

/// No two of the files of a run, the scenario first and then what it writes, are one. "" is none; devices may be
/// shared.
Status check_apart(std::initializer_list<std::string> files) {
  std::set<std::filesystem::path> known;
  std::error_code ignored;
  for (const std::string& file : files) {
    const auto status = std::filesystem::status(file, ignored);
    if (file.empty() || (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)))
      continue;
    if (!known.insert(std::filesystem::weakly_canonical(file, ignored)).second)
      return Error{"writing '" + file + "' would overwrite the scenario or another result of the run",
                   "give it another name"};
  }
  return {};
}

Result<std::unique_ptr<Simulation>> prepare(const RunOptions& options, Diagnostics& diagnostics) {
  SimulationOptions simulation_options{.threads = options.threads, .paths = options.paths};
  if (options.hooks) simulation_options.extra_controllers = options.hooks->controllers;
  if (!options.from_file.empty()) {
    if (options.seed) return Error{"--seed cannot change a run that has begun", "leave it out with --from"};
    if (options.errors)
      return Error{"--errors cannot change a run that has begun", "leave it out with --from"};
    if (!options.overrides.empty())
      return Error{"--set cannot change a run that has begun", "leave it out with --from"};
    return restore_file(options.from_file, simulation_options, diagnostics);
  }
  SL_ASSIGN(model::Setup setup, load(options.file,
                                     {.overrides = options.overrides,
                                      .seed = options.seed,
                                      .stop_s = options.duration_s,
                                      .paths = options.paths,
                                      .skip_missing = options.skip_missing,
                                      .errors = options.errors.value_or(1)},
                                     diagnostics));
  SL_TRY(record::resolve_playbacks(setup, options.paths));
  const bool may_stop = !options.stop_when.empty() ||
                        std::any_of(setup.events.begin(), setup.events.end(),
                                    [](const model::EventDecl& event) { return event.stop; });
  if (!setup.stop && !may_stop && !options.snapshots.at_s && !isatty(STDOUT_FILENO))
    diagnostics.warn({"the run has no end", "give --duration, or time.stop in the scenario"});
  return Simulation::create(std::move(setup), simulation_options, diagnostics);
}

/// What to log: the scenario's `log` with the command line's words laid over it. Nothing: no log.
Result<std::optional<model::LogDecl>> log_wanted(const RunOptions& options, const Simulation& simulation) {
  std::optional<model::LogDecl> log = simulation.setup().log;
  if (options.log_file.empty() && options.log_values.empty() && !options.log_rate_hz) return log;
  if (!log) log.emplace();
  if (!options.log_file.empty()) log->file = options.log_file;
  if (log->file.empty())
    return Error{"--log-values and --log-rate say what to log, but not where to", "add --log FILE"};
  if (options.log_rate_hz) log->rate_hz = *options.log_rate_hz;
  if (!options.log_values.empty()) {
    log->values.clear();
    const Place flag{std::make_shared<const std::string>("--log-values")};
    for (const std::string& value : options.log_values) log->values.push_back({value, flag});
  }
  if (log->values.empty())
    return Error{"--log says where to, but not what", "add --log-values 'rover.pose.x,rover.pose.y'"};
  return log;
}

/// A warning for a pattern that fits no topic: something spawned later may bring one, but more likely it is misspelt.
std::optional<Error> unmatched(const std::string& pattern, const Simulation& simulation) {
  std::vector<std::string> known{recording::tf_topic,  recording::tf_static_topic, recording::clock_topic,
                                 recording::log_topic, recording::hash_topic,      recording::parts_topic};
  for (const TopicBase* topic : simulation.topics()) known.push_back(topic->name());
  for (const std::string& topic : known)
    if (glob_matches(pattern, topic)) return std::nullopt;
  return Error{"no topic to record fits '" + pattern + "'", suggestion(pattern, known)};
}

/// What to record: the scenario's word, changed by the command line. Nothing when neither asks for it.
Result<std::optional<RecordOptions>> recording_of(const RunOptions& options, const Simulation& simulation) {
  RecordOptions out;
  if (simulation.setup().record) out.recording = *simulation.setup().record;
  else if (options.record_file.empty()) return std::optional<RecordOptions>();
  if (!options.record_file.empty()) out.recording.file = options.record_file;
  if (!options.record_topics.empty()) out.recording.topics = options.record_topics;
  for (const auto& entry : enum_names(model::Recording::Compression{}))
    if (options.record_compression == entry.name) out.recording.compression = entry.value;
  out.version = SANDLOT_VERSION;
  out.scenario_file = options.file;
  if (!options.file.empty()) {
    std::ifstream in(options.file, std::ios::binary);
    out.scenario_text.assign(std::istreambuf_iterator<char>(in), {});
  }
  return std::optional(std::move(out));
}

/// One line on a terminal: how far, how fast, how long still.
class Progress {
 public:
  explicit Progress(std::optional<Time> end) : end_(end), shown_(isatty(STDERR_FILENO)) {}
  ~Progress() {
    if (drawn_) std::fputs("\r\x1b[K", stderr);
  }
  void update(const Simulation& simulation) {
    if (!shown_) return;
    const auto now = std::chrono::steady_clock::now();
    if (drawn_ && now - last_ < std::chrono::milliseconds(200)) return;
    if (!drawn_) begin_ = now, sim_begin_ = simulation.now();
    last_ = now;
    drawn_ = true;
    const double wall_s = std::chrono::duration<double>(now - begin_).count();
    const double done_s = (simulation.now() - sim_begin_).s();
    std::string line = fmt::format("\r\x1b[K{:.1f} s", simulation.now().s());
    if (wall_s > 0) line += fmt::format("  {:.1f} x real time", done_s / wall_s);
    if (end_ && done_s > 0)
      line += fmt::format("  {:.0f} % done, {:.0f} s left", 100.0 * simulation.now().s() / end_->s(),
                          (end_->s() - simulation.now().s()) * wall_s / done_s);
    std::fputs(line.c_str(), stderr);
  }

 private:
  std::optional<Time> end_;
  bool shown_, drawn_ = false;
  std::chrono::steady_clock::time_point begin_, last_;
  Time sim_begin_;
};

}  // namespace

int run(const RunOptions& options) {
  Diagnostics diagnostics;
  auto prepared = prepare(options, diagnostics);
  print_warnings(diagnostics);
  if (!prepared) return complain(prepared.error());
  Simulation& simulation = **prepared;
  // A run that goes on from a snapshot counts --duration from there.
  if (!options.from_file.empty() && options.duration_s)
    simulation.set_stop(simulation.now() + Time::from_s(*options.duration_s));
  const std::optional<Time> end = simulation.setup().stop;

  if (!options.stop_when.empty()) {
    const Place flag{std::make_shared<const std::string>("--stop-when")};
    if (Status added = simulation.add_event({"--stop-when", options.stop_when, {}, false, true, flag});
        !added)
      return complain(added.error());
  }
  const auto log_decl = log_wanted(options, simulation);
  if (!log_decl) return complain(log_decl.error());
  const auto recording = recording_of(options, simulation);
  if (!recording) return complain(recording.error());
  if (Status apart = check_apart({options.file, *recording ? (*recording)->recording.file : "",
                                  *log_decl ? (*log_decl)->file : "", options.svg_file, options.summary_file,
                                  options.snapshots.file});
      !apart)
    return complain(apart.error());

  std::unique_ptr<CsvLog> log;
  if (*log_decl) {
    auto opened = CsvLog::open(simulation, **log_decl);
    if (!opened) return complain(opened.error());
    log = std::move(*opened);
  }
  std::optional<Experiment> experiment;
  if (options.hooks) experiment.emplace(simulation, *options.hooks);
  for (const std::string& line : options.lines)
    if (Status status = experiment->schedule(line); !status) return complain(status.error());

  TravelRecorder travel;
  simulation.add_observer(&travel);
  std::optional<SvgRecorder> svg;
  if (!options.svg_file.empty()) simulation.add_observer(&svg.emplace(simulation));

  std::unique_ptr<Recorder> recorder;
  if (*recording) {
    for (const std::string& pattern : (*recording)->recording.topics)
      if (auto warning = unmatched(pattern, simulation)) {
        std::fprintf(stderr, "warning: %s\n", warning->text().c_str());
        diagnostics.warn(std::move(*warning));
      }
    auto started = Recorder::start(**recording, simulation);
    if (!started) return complain(started.error());
    recorder = std::move(*started);
    simulation.add_observer(recorder.get());
  }
  if (log) {
    // Replaces what was there, so it comes after everything that may refuse the run.
    if (Status begun = log->begin(); !begun) return complain(begun.error());
    simulation.add_observer(log.get());
  }

  catch_interrupts();
  std::vector<Error> errors;
  const auto note = [&](Status status) {
    if (!status) errors.push_back(std::move(status.error()));
  };
  SnapshotFiles snapshots(options.snapshots, simulation);
  RunReport report;
  {
    Progress progress(end);
    const auto keep_going = [&](const Simulation& s) {
      progress.update(s);
      if (experiment)
        for (const std::string& answer : experiment->take_answers()) log::info(answer);
      note(snapshots.after(s));
      return !interrupted() && (!log || log->status());
    };
    Status status = experiment ? experiment->start() : Status();
    if (status)
      status = sandlot::run(simulation, {options.rate}, report, keep_going,
                            experiment ? &*experiment : nullptr);
    if (!status) errors.push_back(status.error());
    if (experiment)
      if (Status ended = experiment->finish(); !ended) errors.push_back(ended.error());
  }
  if (log) {
    if (Status finished = log->finish(); !finished) errors.push_back(finished.error());
  }
  note(snapshots.finish(simulation));
  if (recorder) {
    if (Status status = recorder->finish(); !status) errors.push_back(status.error());
    const Recorder::Report& done = recorder->report();
    if (done.dropped_messages > 0 || !done.complete()) {
      Error warning{fmt::format("the recording lacks {} messages that the disk was too slow for",
                                done.dropped_messages),
                    "record fewer topics, a larger queue, or `when_full: wait`"};
      if (!done.complete())
        warning.what += fmt::format(", and log and hashes of {} ticks: it cannot be replayed",
                                    done.lost_frames);
      std::fprintf(stderr, "warning: %s\n", warning.text().c_str());
      diagnostics.warn(std::move(warning));
    }
  }
  auto summary = summarise(simulation, report, travel, diagnostics, errors);
  if (recorder) {
    const Recorder::Report& done = recorder->report();
    summary["recording"] = {{"file", (*recording)->recording.file},
                            {"messages", done.messages},
                            {"bytes", done.bytes},
                            {"dropped_messages", done.dropped_messages},
                            {"lost_ticks", done.lost_frames},
                            {"complete", done.complete()}};
  }
  const std::string summary_text = json_text(summary) + "\n";
  std::fputs(options.json ? summary_text.c_str() : as_text(summary).c_str(), stdout);
  const auto leave = [&](const std::string& file, const std::string& content) {
    if (file.empty()) return;
    if (Status status = write_file(file, content); !status) errors.push_back(status.error());
  };
  leave(options.summary_file, summary_text);
  if (svg) leave(options.svg_file, svg->draw());
  for (const Error& error : errors) std::fprintf(stderr, "error: %s\n", error.text().c_str());
  return errors.empty() ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
