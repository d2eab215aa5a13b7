#include "run/run.h"

#include <unistd.h>

#include <atomic>
#include <cstdio>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/serve.h"
#include "base/json_text.h"
#include "base/log.h"
#include "run/repeat.h"

namespace sandlot::app {

namespace {

/// Runs of one seed after the other.
int run_again(const RunOptions& options) {
  if (options.hooks) return complain({"--repeat: a program that embeds Sandlot repeats its runs itself", ""});
  if (options.serve) return complain({"--port and --repeat: a page shows one run", "leave one of them out"});
  RepeatSpec spec{.run = options.spec,
                  .count = *options.repeat,
                  .at_a_time = options.at_a_time,
                  .store_file = options.store};
  const bool shows = isatty(STDERR_FILENO);
  std::atomic<int> shown = -1;
  catch_interrupts();
  const auto all = repeat(spec, [&](int ended) {
    if (shows && shown.exchange(ended) != ended) std::fprintf(stderr, "\r%d of %d runs", ended, spec.count);
    return !interrupted();
  });
  if (shows) std::fputs("\r\033[K", stderr);
  if (!all) return complain(all.error());
  std::fputs(options.json ? (json_text(as_json(*all)) + "\n").c_str() : as_text(*all).c_str(), stdout);
  return all->failed == 0 && all->store_error.empty() && static_cast<int>(all->runs.size()) == spec.count
             ? exit_ok
             : exit_failed;
}

}  // namespace

int run(const RunOptions& options) {
  if (options.repeat) return run_again(options);
  if (!options.store.empty())
    return complain({"--store: it keeps the results of repeated runs", "add --repeat 50"});
  RunSpec spec = options.spec;
  spec.steered = options.serve.has_value();
  spec.may_be_endless = options.serve || isatty(STDOUT_FILENO);
  Progress progress;
  std::optional<Served> served;
  const RunCallbacks callbacks{
      .hooks = options.hooks,
      .on_warning = [](const Error& warning) { log::warning(warning.text()); },
      .on_answer = [](const std::string& answer) { log::info(answer); },
      .on_ready = [&](const RunParts& parts) -> Status {
        if (options.serve) {
          ServeOptions serve = *options.serve;
          serve.world = options.spec.file;
          SL_ASSIGN(served, Served::start(serve, parts.session, parts.console, &parts.outputs));
        }
        catch_interrupts();
        return {};
      },
      .keep_going =
          [&](const Simulation& simulation) {
            if (served) served->count_viewers();
            progress.update(simulation);
            return !interrupted();
          },
      .on_end =
          [&](Summary& summary) {
            if (!served) return;
            summary.server = served->stop();
            summary.clients = served->clients();
          }};
  const auto summary = sandlot::run(spec, callbacks);
  if (!summary) return complain(summary.error());
  progress.clear();
  std::fputs(options.json ? as_json_text(*summary).c_str() : as_text(*summary).c_str(), stdout);
  for (const std::string& error : summary->errors) std::fprintf(stderr, "error: %s\n", error.c_str());
  return summary->errors.empty() ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
