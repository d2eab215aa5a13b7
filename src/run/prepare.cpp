#include "run/prepare.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "base/text.h"
#include "record/playback.h"
#include "run/snapshot_files.h"
#include "sim/load/load.h"

namespace sandlot {
namespace {

/// Checks that the files of a run, the scenario and its results, are all different. "" is none; devices may
/// be shared.
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

/// Checks that a result's file does not claim another format: pictures of other kinds, other recordings.
Status check_extension(const char* option, const std::string& file, const char* extension, const char* what) {
  const std::filesystem::path path(file);
  if (!path.has_extension() || path.extension() == extension) return {};
  return Error{std::string(option) + " " + file + ": " + what,
               "name it " + std::filesystem::path(path).replace_extension(extension).string()};
}

/// Fields that do not go together.
Status check_spec(const RunSpec& spec) {
  if (spec.file.empty() == spec.from_file.empty())
    return Error{"run needs either a file or --from", "sandlot run scenarios/indoor.yaml"};
  if (!spec.from_file.empty()) {
    const auto refuse = [](const char* option) {
      return Error{std::string(option) + " cannot change a run that has begun", "leave it out with --from"};
    };
    if (spec.seed) return refuse("--seed");
    if (spec.errors) return refuse("--errors");
    if (!spec.overrides.empty()) return refuse("--set");
  }
  if (spec.from_file.empty() && spec.allow_programs)
    return Error{"--allow-programs belongs to --from",
                 "a scenario that is run may start its programs anyway"};
  if (spec.duration_s && !(*spec.duration_s >= 0 && *spec.duration_s <= 1e9))
    return Error{"--duration: must be in [0, 1e9] s, is " + number_text(*spec.duration_s)};
  if (spec.rate && !(*spec.rate > 0 && *spec.rate <= 1e6))
    return Error{"--rate: must be in (0, 1e6], is " + number_text(*spec.rate)};
  SL_TRY(check_extension("--svg", spec.drawing_file, ".svg", "drawings are SVG"));
  SL_TRY(check_extension("--record", spec.record_file, ".mcap", "recordings are MCAP"));
  SL_TRY(check_snapshot_options(spec.snapshots));
  if (spec.film.file.empty() != spec.film.view.camera.empty())
    return Error{"--video and --camera go together: the film, and what takes it",
                 "add --camera overhead, or --video run.mp4"};
  return {};
}

/// World of the file, or of the snapshot from which the run continues.
Result<std::unique_ptr<Simulation>> make_world(const RunSpec& spec,
                                               const SimulationOptions& simulation_options,
                                               Diagnostics& diagnostics) {
  if (!spec.from_file.empty()) {
    SL_ASSIGN(auto simulation, restore_snapshot_file(spec.from_file, simulation_options, diagnostics));
    // Duration counts from the snapshot.
    if (spec.duration_s) simulation->set_stop(simulation->now() + Time::from_s(*spec.duration_s));
    return simulation;
  }
  SL_ASSIGN(model::Setup setup, record::load_with_playbacks(spec.file,
                                                            {.overrides = spec.overrides,
                                                             .seed = spec.seed,
                                                             .stop_s = spec.duration_s,
                                                             .paths = spec.paths,
                                                             .skip_missing = spec.skip_missing,
                                                             .errors = spec.errors.value_or(1)},
                                                            diagnostics));
  const bool may_stop = !spec.stop_when.empty() ||
                        std::any_of(setup.events.begin(), setup.events.end(),
                                    [](const model::EventDecl& event) { return event.stop; });
  if (!setup.stop && !may_stop && !spec.snapshots.at_s && !spec.may_be_endless)
    diagnostics.warn({"the run has no end", "give --duration, or time.stop in the scenario"});
  return Simulation::create(std::move(setup), simulation_options, diagnostics);
}

/// Log of the run: the scenario's `log`, changed by the spec. Nothing: no log.
Result<std::optional<model::LogDecl>> log_declaration(const RunSpec& spec, const Simulation& simulation) {
  std::optional<model::LogDecl> log = simulation.setup().log;
  if (spec.log_file.empty() && spec.log_values.empty() && !spec.log_rate_hz) return log;
  if (!log) log.emplace();
  if (!spec.log_file.empty()) log->file = spec.log_file;
  if (log->file.empty())
    return Error{"--log-values and --log-rate say what to log, but not where to", "add --log FILE"};
  if (spec.log_rate_hz) log->rate_hz = *spec.log_rate_hz;
  if (!spec.log_values.empty()) {
    log->values.clear();
    const Place flag{std::make_shared<const std::string>("--log-values")};
    for (const std::string& value : spec.log_values) log->values.push_back({value, flag});
  }
  if (log->values.empty())
    return Error{"--log says where to, but not what", "add --log-values 'rover.pose.x,rover.pose.y'"};
  return log;
}

/// Recording of the run: the scenario's, changed by the spec. Nothing when neither has one.
Result<std::optional<RecordOptions>> record_options(const RunSpec& spec, const Simulation& simulation) {
  RecordOptions out;
  if (simulation.setup().record) out.recording = *simulation.setup().record;
  else if (spec.record_file.empty()) {
    if (!spec.record_topics.empty() || !spec.record_compression.empty())
      return Error{"--record-topics and --record-compression say how to record, but not where to",
                   "add --record FILE"};
    return std::optional<RecordOptions>();
  }
  if (!spec.record_file.empty()) out.recording.file = spec.record_file;
  if (!spec.record_topics.empty()) out.recording.topics = spec.record_topics;
  if (!spec.record_compression.empty()) {
    const auto names = enum_names(model::Recording::Compression{});
    const auto found = std::find_if(names.begin(), names.end(),
                                    [&](const auto& entry) { return spec.record_compression == entry.name; });
    if (found == names.end())
      return Error{"--record-compression: there is no '" + spec.record_compression + "'",
                   "known are: none, lz4, zstd"};
    out.recording.compression = found->value;
  }
  out.version = SANDLOT_VERSION;
  out.scenario_file = spec.file;
  if (!spec.file.empty()) {
    std::ifstream in(spec.file, std::ios::binary);
    out.scenario_text.assign(std::istreambuf_iterator<char>(in), {});
  }
  return std::optional(std::move(out));
}

/// A scenario that somebody runs may start its programs. A snapshot carries command lines, too, but is often another's.
bool starts_programs(const RunSpec& spec) { return spec.from_file.empty() || spec.allow_programs; }

/// Programs that wait for a client need a server to which one can come.
Status check_clients(Simulation& simulation, const RunSpec& spec) {
  Status status;
  if (spec.steered) return status;
  simulation.for_each_outside([&](const SimulationParts::ProgramEntry& entry, const Outside& outside) {
    if (spec.starts_clients && starts_programs(spec) && outside.has_command()) return;
    if (outside.is_client() && status)
      status = Error{"'" + entry.path + "' waits for a client, and nobody can connect to this run",
                     "add --port 8765, or give it another controller: --set robots.NAME.controller=wander",
                     entry.decl.place};
  });
  return status;
}

}  // namespace

Result<PreparedRun> prepare(const RunSpec& spec, std::span<const ControllerKind* const> controllers,
                            Diagnostics& diagnostics) {
  SL_TRY(check_spec(spec));
  PreparedRun out;
  out.options = {.threads = spec.threads, .paths = spec.paths};
  out.options.extra_controllers = controllers;
  out.options.start_programs = starts_programs(spec);
  SL_ASSIGN(out.simulation, make_world(spec, out.options, diagnostics));
  SL_TRY(check_clients(*out.simulation, spec));
  SL_TRY(configure(*out.simulation, spec));
  SL_ASSIGN(out.log, log_declaration(spec, *out.simulation));
  SL_ASSIGN(out.recording, record_options(spec, *out.simulation));
  SL_TRY(check_apart({spec.file, out.recording ? out.recording->recording.file : "",
                      out.log ? out.log->file : "", spec.drawing_file, spec.summary_file, spec.snapshots.file,
                      spec.film.file}));
  return out;
}

Status configure(Simulation& simulation, const RunSpec& spec) {
  if (spec.stop_when.empty()) return {};
  const Place flag{std::make_shared<const std::string>("--stop-when")};
  return simulation.add_event({"--stop-when", spec.stop_when, {}, false, true, flag});
}

}  // namespace sandlot
