#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/interrupt.h"
#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/text.h"
#include "record/recording.h"
#include "run/snapshot_files.h"
#include "run/summary.h"

namespace sandlot::app {
namespace {

/// Result of a replay: how many ticks ran, and the first difference.
struct ReplayOutcome {
  std::uint64_t ticks = 0;
  bool compared = false;  ///< there were hashes
  bool interrupted = false;
  std::optional<record::Difference> difference;
  std::optional<Error> error;
  std::vector<Error> other_errors;  ///< of files that were to be written
};

ReplayOutcome go_through(record::Recording& recording, record::Replay& replay, const ReplayOptions& options) {
  ReplayOutcome out;
  SnapshotFiles snapshots(options.snapshots, replay.simulation());
  const auto record_error = [&](Status status) {
    if (!status) out.other_errors.push_back(std::move(status.error()));
  };
  const Time until = options.until_s ? Time::from_s(*options.until_s) : Time{INT64_MAX};
  while (replay.simulation().now() < until) {
    if (interrupted()) {
      out.interrupted = true;
      break;
    }
    auto tick = recording.next();
    if (!tick) {
      out.error = std::move(tick.error());
      out.error->what = "behind " +
                        record::tick_text(replay.simulation().tick_index(), replay.simulation().now()) +
                        ": " + out.error->what;
      break;
    }
    if (!*tick) break;
    const std::uint64_t before = replay.simulation().tick_index();
    auto difference = replay.tick(**tick);
    if (!difference) {
      out.error = std::move(difference.error());
      break;
    }
    if (replay.simulation().tick_index() == before) continue;
    ++out.ticks;
    out.compared = out.compared || !(*tick)->parts.empty();
    record_error(snapshots.after_tick(replay.simulation()));
    if (*difference) {
      out.difference = std::move(**difference);
      break;
    }
  }
  Diagnostics diagnostics;
  record_error(snapshots.finish(replay.simulation(), diagnostics));
  print_warnings(diagnostics);
  return out;
}

nlohmann::ordered_json replay_json(const ReplayOutcome& out, const record::Recording& recording,
                                   const Simulation& simulation, const ReplayOptions& options) {
  using Json = nlohmann::ordered_json;
  Json json{{"file", options.file},
            {"ticks", out.ticks},
            {"end_tick", simulation.tick_index()},
            {"end_time", simulation.now().s()},
            {"state_hash", hash_text(simulation.state_hash())},
            {"profile", Simulation::profile()},
            {"recorded_profile", recording.begin().profile},
            {"verified", options.verify && out.compared && !out.difference && !out.error && !out.interrupted},
            {"difference", nullptr},
            {"torn", nullptr},
            {"error", nullptr}};
  if (out.difference)
    json["difference"] = {{"tick", out.difference->tick},
                          {"time", out.difference->now.s()},
                          {"parts", out.difference->parts},
                          {"orders", out.difference->orders}};
  if (recording.torn()) json["torn"] = recording.torn()->text();
  if (out.error) json["error"] = out.error->text();
  return json;
}

}  // namespace

int replay(const ReplayOptions& options) {
  if (options.serve) return play(options);
  if (options.logged && !options.snapshots.file.empty())
    return complain(
        {"--logged does not run the controllers, so a snapshot would hold them as they were at the beginning",
         "leave --logged out with --snapshot"});
  auto recording = record::Recording::open(options.file);
  if (!recording) return complain(recording.error());
  Diagnostics diagnostics;
  auto replay = record::Replay::begin(
      recording->snapshot(),
      {.programs = options.logged ? record::Programs::logged : record::Programs::recompute,
       .threads = options.threads,
       .compare = options.verify,
       .paths = options.paths},
      diagnostics);
  print_warnings(diagnostics);
  if (!replay) return complain(replay.error());
  catch_interrupts();
  const ReplayOutcome out = go_through(*recording, *replay, options);
  const Simulation& simulation = replay->simulation();
  const auto json = replay_json(out, *recording, simulation, options);
  if (options.json) {
    fmt::print("{}\n", json_text(json));
  } else {
    fmt::print("replayed   {} ticks, {} s to {} s\n", out.ticks, number_text(recording->begin().now.s()),
               number_text(simulation.now().s()));
    if (recording->torn())
      fmt::print("torn off   the recording ends at {}: {}\n",
                 record::tick_text(simulation.tick_index(), simulation.now()), recording->torn()->what);
    if (json["verified"].get<bool>())
      fmt::print("verified   {}\n",
                 options.logged
                     ? "every tick, but for the programs' own state: it was logged orders that drove"
                     : "every tick has the recorded hash");
    fmt::print("state      {} ({})\n", hash_text(simulation.state_hash()), Simulation::profile());
  }
  bool failed = out.difference || out.error || !out.other_errors.empty();
  const auto tell = [](const std::string& text) { fmt::print(stderr, "error: {}\n", text); };
  if (out.difference) tell(out.difference->text());
  if (out.difference && recording->begin().profile != Simulation::profile())
    tell("it was recorded with another numeric profile (" + recording->begin().profile + "), this is " +
         Simulation::profile() + ": last bits differ for that reason");
  if (out.error) tell(out.error->text());
  if (out.interrupted && options.verify) {
    tell("interrupted: nothing behind " + record::tick_text(simulation.tick_index(), simulation.now()) +
         " was compared");
    failed = true;
  }
  for (const Error& error : out.other_errors) tell(error.text());
  if (options.verify && !out.compared && !failed) {
    tell("there is nothing to compare with: the recording has no state hashes in these ticks");
    failed = true;
  }
  if (!options.summary_file.empty())
    if (Status status = write_file(options.summary_file, json_text(json) + "\n"); !status) {
      tell(status.error().text());
      failed = true;
    }
  return failed ? exit_failed : exit_ok;
}

}  // namespace sandlot::app
