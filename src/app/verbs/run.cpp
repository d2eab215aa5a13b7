#include "run/run.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/lint_file.h"
#include "app/progress.h"
#include "app/refbox.h"
#include "app/serve.h"
#include "base/json_text.h"
#include "base/log.h"
#include "files/resources.h"
#include "run/repeat.h"
#include "sim/session/session.h"

namespace sandlot::app {

namespace {

/// Runs of one seed after the other.
int run_again(const RunOptions& options) {
  if (options.hooks) return complain({"--repeat: a program that embeds Sandlot repeats its runs itself", ""});
  if (options.serve) return complain({"--port and --repeat: a page shows one run", "leave one of them out"});
  if (!options.refbox.at.empty())
    return complain({"--refbox and --repeat: a referee box is of one run", "leave one of them out"});
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

/// Starts the server, if there is a page or a program that it starts.
Status serve(const RunOptions& options, const RunParts& parts, std::optional<Served>& served) {
  std::string program;
  parts.session.simulation().for_each_outside(
      [&](const SimulationParts::ProgramEntry& entry, const Outside& outside) {
        if (outside.has_command()) program = entry.path;
      });
  const bool allowed = options.spec.from_file.empty() || options.spec.allow_programs;
  if (!allowed && !program.empty())
    log::warning("program '" + program + "' is not started: add --allow-programs if you trust the snapshot");
  const server::ProgramOptions programs{.start = allowed && !program.empty(),
                                        .watch_files = options.watch,
                                        .log_folder = options.program_logs,
                                        .python_folders = client_folders()};
  bool keeps_output = programs.start;
  if (!options.program_logs.empty()) {
    Status status;
    parts.session.simulation().for_each_outside([&](const SimulationParts::ProgramEntry&, Outside& outside) {
      if (!status) return;
      const Result<bool> kept = outside.keep_output(options.program_logs);
      if (kept) keeps_output = keeps_output || *kept;
      else status = kept.error();
    });
    SL_TRY(status);
  }
  const auto without = [](const char* option) {
    return Error{std::string(option) + ", and the run starts none",
                 "name one in the scenario: controller: {kind: remote, command: [python3, team.py]}"};
  };
  if (options.watch && !programs.start) return without("--watch is for programs with a command");
  if (!options.program_logs.empty() && !keeps_output)
    return without("--program-logs is for programs that the run starts");
  if (!options.serve && !programs.start) return {};
  std::optional<ServeOptions> how = options.serve;
  if (how) how->world = options.spec.file;
  SL_ASSIGN(served, Served::start(how, parts.session, parts.console, &parts.outputs, programs));
  return {};
}

}  // namespace

std::vector<std::string> client_folders() {
  std::vector<std::string> out;
  if (const std::string installed = own_folder("python/sandlot_client"); !installed.empty())
    out.push_back(std::filesystem::path(installed).parent_path().string());
  else if (std::string source = own_folder("clients/python"); !source.empty())
    out.push_back(std::move(source));
  return out;
}

Result<Summary> run_once(const RunOptions& options, bool shows_progress, const RunWatch& watch) {
  RunSpec spec = options.spec;
  spec.steered = options.serve.has_value();
  spec.starts_clients = true;
  spec.may_be_endless = spec.may_be_endless || options.serve || !options.refbox.at.empty() ||
                        isatty(STDOUT_FILENO);
  Progress progress;
  std::optional<Served> served;
  std::optional<ServedRefbox> refbox;
  Session* session = nullptr;
  using Clock = std::chrono::steady_clock;
  Clock::time_point looked = Clock::now();
  // Held back until there is a page, so that its log has them, too.
  std::vector<std::string> held;
  bool ready = !options.serve;
  const auto release = [&] {
    ready = true;
    for (const std::string& each : std::exchange(held, {})) log::warning(each);
  };
  const RunCallbacks callbacks{
      .hooks = options.hooks,
      .on_warning =
          [&](const Error& warning) {
            if (ready) log::warning(warning.text());
            else held.push_back(warning.text());
          },
      .on_answer = [](const std::string& answer) { log::info(answer); },
      .on_ready = [&](const RunParts& parts) -> Status {
        session = &parts.session;
        if (watch.on_world) SL_TRY(watch.on_world(parts.session.simulation()));
        catch_interrupts();  // before there are processes and folders of theirs to be left
        SL_TRY(serve(options, parts, served));
        if (!options.refbox.at.empty()) {
          SL_ASSIGN(refbox, ServedRefbox::start(options.refbox, parts.session));
        }
        release();
        if (options.verbose)
          for (const sandlot::Finding& each : lint_file(options.spec.file, options.spec.overrides,
                                                        options.spec.paths, parts.session.simulation()))
            log::warning(text_of(each));
        return {};
      },
      .keep_going =
          [&](const Simulation& simulation) {
            if (served) served->count_viewers();
            if (shows_progress) progress.update(simulation);
            if (watch.goes_on && served && Clock::now() - looked > std::chrono::milliseconds(200)) {
              looked = Clock::now();
              if (!watch.goes_on()) return false;
            }
            return !interrupted();
          },
      .on_end =
          [&](Summary& summary) {
            if (watch.on_end && session) watch.on_end(session->simulation());
            if (refbox) summary.refbox = refbox->stop();
            if (!served) return;
            const ServerSummary ended = served->stop();
            if (options.serve) summary.server = ended;
            summary.clients = served->clients();
          }};
  auto summary = sandlot::run(spec, callbacks);
  release();
  if (summary && shows_progress) progress.clear();
  return summary;
}

int run(const RunOptions& options) {
  if (options.repeat) return run_again(options);
  if (!options.store.empty())
    return complain({"--store: it keeps the results of repeated runs", "add --repeat 50"});
  const auto summary = run_once(options, true);
  if (!summary) return complain(summary.error());
  std::fputs(options.json ? as_json_text(*summary).c_str() : as_text(*summary).c_str(), stdout);
  for (const std::string& error : summary->errors) std::fprintf(stderr, "error: %s\n", error.c_str());
  return summary->errors.empty() ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
