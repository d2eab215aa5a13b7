#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/follow.h"
#include "app/json_text.h"
#include "app/prepare.h"
#include "app/report.h"
#include "app/serve.h"
#include "base/atomic_file.h"
#include "base/log.h"
#include "base/text.h"
#include "console/console.h"
#include "sim/session/session.h"

namespace sandlot::app {
namespace {

/// Prints the summary and leaves the files that are written at the end. @return the exit code
int conclude(const RunOptions& options, const nlohmann::ordered_json& summary, Followers& followers) {
  const std::string summary_text = json_text(summary) + "\n";
  std::fputs(options.json ? summary_text.c_str() : as_text(summary).c_str(), stdout);
  const auto leave = [&](const std::string& file, const std::string& content) {
    if (Status status = write_file(file, content); !status) followers.errors().push_back(status.error());
  };
  if (!options.summary_file.empty()) leave(options.summary_file, summary_text);
  if (const auto drawing = followers.drawing()) leave(options.svg_file, *drawing);
  for (const Error& error : followers.errors()) std::fprintf(stderr, "error: %s\n", error.text().c_str());
  return followers.errors().empty() ? exit_ok : exit_failed;
}

}  // namespace

int run(const RunOptions& options) {
  Diagnostics diagnostics;
  auto prepared = prepare(options, diagnostics);
  print_warnings(diagnostics);
  if (!prepared) return complain(prepared.error());
  const Time begin = prepared->simulation->now();

  std::optional<Experiment> experiment;
  if (options.hooks) experiment.emplace(*prepared->simulation, *options.hooks);
  Followers* following = nullptr;
  Console* saying = nullptr;
  Session session(
      std::move(prepared->simulation),
      {.pace = {options.rate},
       .paused = options.paused,
       .history_mb = options.serve ? Session::Options().history_mb : 0,
       .simulation = prepared->options,
       .may_not_rewind = experiment ? "its experiment in C++ keeps a state of its own" : "",
       .on_world = [&](Simulation& next, const std::string& why) { following->leave_world(next, why); },
       .tick = [&](Simulation& simulation, std::optional<Time> measured) -> Status {
         // What runs again has all its input already.
         if (!session.rerunning()) SL_TRY(saying->before_tick());
         return experiment ? experiment->tick(measured) : simulation.tick(measured);
       }});
  Followers followers(options, session);
  following = &followers;
  Console console(session, {.paths = options.paths,
                            .experiment = experiment ? &*experiment : nullptr,
                            .record = [&](const std::string& file) { return followers.record(file); }});
  saying = &console;
  if (Status opened = followers.open(*prepared); !opened) return complain(opened.error());
  for (const std::string& line : options.lines)
    if (Status status = console.schedule(line); !status) return complain(status.error());
  if (!options.script_file.empty())
    if (Status status = console.schedule_script(options.script_file); !status)
      return complain(status.error());
  std::optional<Served> served;
  if (options.serve) {
    auto started = Served::start(*options.serve, session, console, [&] { return followers.recording(); });
    if (!started) return complain(started.error());
    served = std::move(*started);
  }
  if (Status started = followers.start(*prepared, diagnostics); !started) return complain(started.error());

  catch_interrupts();
  RunReport report;
  std::optional<std::uint64_t> seen;  // tick
  const auto keep_going = [&](const Simulation& simulation) {
    const bool stands = std::exchange(seen, simulation.tick_index()) == simulation.tick_index();
    for (const std::string& answer : console.take_answers()) log::info(answer);
    if (served) {
      served->look();
    } else if (stands && session.report().state == Session::State::paused) {
      followers.errors().push_back(
          {"the run was paused at " + number_text(simulation.now().s()) + " s, and nobody can let it go on",
           "add --port 8765, or leave what pauses it out of the script"});
      return false;
    }
    return followers.after_tick() && !interrupted();
  };
  Status status = experiment ? experiment->start() : Status();
  if (status) status = session.run(report, keep_going);
  if (status) status = console.finish();
  if (!status) {
    followers.rescue(status.error());
    followers.errors().push_back(status.error());
  }
  if (experiment)
    if (Status ended = experiment->finish(); !ended) followers.errors().push_back(ended.error());
  // A difference, where the sum over the ticks would carry their rounding.
  if (session.epoch() == 1) report.sim_s = (session.simulation().now() - begin).s();
  followers.finish(diagnostics);

  auto summary = summarise(session.simulation(), report, followers.travel(), diagnostics, followers.errors());
  followers.add_to(summary);
  if (served) summary["server"] = served->stop();
  return conclude(options, summary, followers);
}

}  // namespace sandlot::app
