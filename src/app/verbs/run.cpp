#include "run/run.h"

#include <unistd.h>

#include <cstdio>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/serve.h"
#include "base/json_text.h"
#include "base/log.h"

namespace sandlot::app {

int run(const RunOptions& options) {
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
          SL_ASSIGN(served, Served::start(*options.serve, parts.session, parts.console, &parts.outputs));
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
            if (served) summary.server = served->stop();
          }};
  const auto summary = sandlot::run(spec, callbacks);
  if (!summary) return complain(summary.error());
  progress.clear();
  std::fputs(options.json ? as_json_text(*summary).c_str() : as_text(*summary).c_str(), stdout);
  for (const std::string& error : summary->errors) std::fprintf(stderr, "error: %s\n", error.c_str());
  return summary->errors.empty() ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
