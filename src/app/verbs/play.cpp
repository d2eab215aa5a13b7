/// `sandlot replay FILE --port N`: a recording on the page, with its timeline.
#include <fmt/format.h>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/serve.h"
#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/log.h"
#include "base/text.h"
#include "console/console.h"
#include "record/input_log.h"
#include "run/summary.h"
#include "sim/session/session.h"

namespace sandlot::app {
namespace {

/// Options that do not go together with showing a recording.
Status check_player(const ReplayOptions& options) {
  const auto refuse = [](const char* flag) {
    return Error{std::string(flag) + " does not go with --port, which shows the recording to viewers",
                 "leave one of them out"};
  };
  if (options.logged) return refuse("--logged");
  if (options.until_s) return refuse("--until");
  if (!options.snapshots.file.empty()) return refuse("--snapshot");
  return {};
}

}  // namespace

int play(const ReplayOptions& options) {
  if (Status fits = check_player(options); !fits) return complain(fits.error());
  auto recording = record::Recording::open(options.file);
  if (!recording) return complain(recording.error());
  auto read = record::read_run(*recording);
  if (!read) return complain(read.error());
  record::RecordedRun& run = *read;
  Diagnostics diagnostics;
  const SimulationOptions simulation_options{.threads = options.threads, .paths = options.paths};
  auto simulation = Simulation::restore(recording->snapshot(), simulation_options, diagnostics);
  if (run.cut)
    diagnostics.warn(
        {fmt::format("the recording ends at {}: {}",
                     record::tick_text(run.input_log.last_tick, run.input_log.end), run.cut->what)});
  const std::string profile = recording->begin().profile;
  if (profile != Simulation::profile())
    diagnostics.warn({"it was recorded with another numeric profile (" + profile + "), this is " +
                      Simulation::profile() + ": last bits differ for that reason"});
  print_warnings(diagnostics);
  if (!simulation) return complain(simulation.error());

  record::RunCheck check(run, [&](std::uint64_t tick, Time now) {
    log::warning("from " + record::tick_text(tick, now) + " on the run differs from what was recorded");
  });
  Session session(std::move(*simulation),
                  {.pace = {options.rate},
                   .paused = true,
                   .stay = true,
                   .simulation = simulation_options,
                   .input_log = std::move(run.input_log),
                   .on_world = [&](Simulation&, const std::string&) { check.begin_again(); }});
  session.add_observer(&check);
  if (options.from_s)
    if (const Status within = session.jump(Time::from_s(*options.from_s)); !within)
      return complain({"--from " + number_text(*options.from_s) + " s: " + within.error().what});
  Console console(session, {.paths = options.paths});
  auto served = Served::start(*options.serve, session, console);
  if (!served) return complain(served.error());
  catch_interrupts();
  RunReport report;
  const Status status = session.run(report, [&](const Simulation&) {
    served->count_viewers();
    return !interrupted();
  });
  const ServerSummary viewers = served->stop();
  nlohmann::ordered_json json{
      {"file", options.file},
      {"ticks", report.ticks},
      {"compared_ticks", check.compared()},
      {"different_ticks", check.different()},
      {"state_hash", hash_text(session.simulation().state_hash())},
      {"profile", Simulation::profile()},
      {"recorded_profile", profile},
      {"server",
       {{"viewers_most", viewers.viewers_most}, {"refused", viewers.refused}, {"dropped", viewers.dropped}}}};
  if (options.json) fmt::print("{}\n", json_text(json));
  else
    fmt::print("played     {} ticks, {}\n", report.ticks,
               check.different() > 0  ? fmt::format("{} of them not as recorded", check.different())
               : check.compared() > 0 ? "all as recorded"
                                      : "none of them compared");
  bool failed = !status;
  if (!status) fmt::print(stderr, "error: {}\n", status.error().text());
  if (!options.summary_file.empty())
    if (Status written = write_file(options.summary_file, json_text(json) + "\n"); !written) {
      fmt::print(stderr, "error: {}\n", written.error().text());
      failed = true;
    }
  if (options.verify && check.different() > 0) failed = true;
  return failed ? exit_failed : exit_ok;
}

}  // namespace sandlot::app
