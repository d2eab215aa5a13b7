#include "app/prepare.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "record/playback.h"
#include "run/snapshot_files.h"
#include "sim/load/load.h"

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

/// The world of the file, or of the snapshot that the run goes on from.
Result<std::unique_ptr<Simulation>> make_world(const RunOptions& options,
                                               const SimulationOptions& simulation_options,
                                               Diagnostics& diagnostics) {
  if (!options.from_file.empty()) {
    if (options.seed) return Error{"--seed cannot change a run that has begun", "leave it out with --from"};
    if (options.errors)
      return Error{"--errors cannot change a run that has begun", "leave it out with --from"};
    if (!options.overrides.empty())
      return Error{"--set cannot change a run that has begun", "leave it out with --from"};
    SL_ASSIGN(auto simulation, restore_file(options.from_file, simulation_options, diagnostics));
    // A run that goes on from a snapshot counts --duration from there.
    if (options.duration_s) simulation->set_stop(simulation->now() + Time::from_s(*options.duration_s));
    return simulation;
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
  if (!setup.stop && !may_stop && !options.snapshots.at_s && !options.serve && !isatty(STDOUT_FILENO))
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

}  // namespace

Result<Prepared> prepare(const RunOptions& options, Diagnostics& diagnostics) {
  Prepared out;
  out.options = {.threads = options.threads, .paths = options.paths};
  if (options.hooks) out.options.extra_controllers = options.hooks->controllers;
  SL_ASSIGN(out.simulation, make_world(options, out.options, diagnostics));
  SL_TRY(configure(*out.simulation, options));
  SL_ASSIGN(out.log, log_wanted(options, *out.simulation));
  SL_ASSIGN(out.recording, recording_of(options, *out.simulation));
  SL_TRY(check_apart({options.file, out.recording ? out.recording->recording.file : "",
                      out.log ? out.log->file : "", options.svg_file, options.summary_file,
                      options.snapshots.file, options.film.file}));
  return out;
}

Status configure(Simulation& simulation, const RunOptions& options) {
  if (options.stop_when.empty()) return {};
  const Place flag{std::make_shared<const std::string>("--stop-when")};
  return simulation.add_event({"--stop-when", options.stop_when, {}, false, true, flag});
}

}  // namespace sandlot::app
