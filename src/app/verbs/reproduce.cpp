/// sandlot reproduce: makes the experiment of a paper, its figures and tables as a page that needs no network.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "app/commands.h"
#include "app/demos.h"
#include "app/flags.h"
#include "app/interrupt.h"
#include "app/papers/papers.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "files/text.h"
#include "run/run.h"
#include "sim/session/session.h"

namespace sandlot::app {
namespace {

/// File of a run that is read and removed again.
struct Scratch {
  Scratch(const std::string& folder, const std::string& name)
      : path((std::filesystem::path(folder) / name).string()) {}
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::string path;
};

/// Makes the folder, tries whether files can be written there.
Status prepare_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  const auto refused = [&](const std::string& why) {
    return Error{"--out " + folder + ": " + why, "name a folder that can be written"};
  };
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return refused(error.message());
  if (!fs::is_directory(folder, error)) return refused("it is not a folder");
  const Scratch probe(folder, "index.html.probe");
  std::ofstream out(probe.path);
  out << "probe\n" << std::flush;
  if (!out) return refused("no file can be written there");
  return {};
}

Result<RunSpec> condition_spec(const Condition& condition) {
  RunSpec spec;
  SL_ASSIGN(spec.file, demo_file(condition.scenario));
  std::vector<std::string> settings;
  for (const auto& [name, value] : condition.settings) settings.push_back(name + "=" + value);
  SL_TRY(read_sets(settings, spec.overrides));
  return spec;
}

/// Runs one condition after the other; shows which, and how many of its runs have ended.
class Runner {
 public:
  Runner(const ReproduceOptions& options, const Paper& paper, int repeat)
      : options_(options), paper_(paper), repeat_(repeat) {}

  Result<RepeatSummary> runs(const Condition& condition) {
    ++begun_;
    SL_ASSIGN(RunSpec run, condition_spec(condition));
    const RepeatSpec spec{.run = std::move(run), .count = repeat_, .at_a_time = options_.at_a_time};
    const bool shows = isatty(STDERR_FILENO);
    std::atomic<int> shown = -1;
    auto all = repeat(spec, [&](int ended) {
      if (shows && shown.exchange(ended) != ended)
        std::fprintf(stderr, "\r\033[K%d of %d: %s, %d of %d runs", begun_, paper_.conditions,
                     condition.name.c_str(), ended, repeat_);
      return !interrupted();
    });
    if (shows) std::fputs("\r\033[K", stderr);
    if (!all) return std::move(all.error());
    if (interrupted()) return Error{"interrupted"};
    failed_ += all->failed;
    for (const RepeatedRun& each : all->runs)
      if (!each.errors.empty() && reported_++ < 5)
        std::fprintf(stderr, "error: %s, seed %llu: %s\n", condition.name.c_str(),
                     static_cast<unsigned long long>(each.seed), each.errors.front().c_str());
    fmt::print("{:<40} {}\n", condition.scenario + ": " + condition.name,
               all->all && all->all->success ? text_of(*all->all->success)
                                             : text_of(all->all ? all->all->criterion : Estimate()));
    std::fflush(stdout);
    return all;
  }

  Result<std::string> drawing(const Condition& condition, double until_s) const {
    SL_ASSIGN(RunSpec spec, condition_spec(condition));
    spec.duration_s = until_s;
    const std::string file = (std::filesystem::path(options_.out) / "drawing.svg").string();
    spec.drawing_file = file;
    SL_ASSIGN(const Summary summary, sandlot::run(spec));
    if (!summary.errors.empty()) return Error{summary.errors.front()};
    SL_ASSIGN(std::string text, read_text_file(file, std::uint64_t{1} << 26));
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    return text;
  }

  Result<std::vector<StepTime>> step_times(const Condition& condition, double duration_s,
                                           std::optional<double> rate) const {
    SL_ASSIGN(RunSpec spec, condition_spec(condition));
    spec.duration_s = duration_s;
    spec.rate = rate;
    spec.step_times_file = (std::filesystem::path(options_.out) / (condition.name + ".csv")).string();
    const bool shows = isatty(STDERR_FILENO);
    if (shows) std::fprintf(stderr, "\r\033[Krunning %s", condition.name.c_str());
    const auto summary = sandlot::run(spec, {.keep_going = [](const Simulation&) { return !interrupted(); }});
    if (shows) std::fputs("\r\033[K", stderr);
    if (!summary) return summary.error();
    if (interrupted()) return Error{"interrupted"};
    if (!summary->errors.empty()) return Error{condition.name + ": " + summary->errors.front()};
    SL_ASSIGN(const std::string text, read_text_file(spec.step_times_file, std::uint64_t{1} << 28));
    SL_ASSIGN(std::vector<StepTime> steps, read_step_times(text, spec.step_times_file));
    fmt::print("{:<40} {} steps\n", condition.scenario + ": " + condition.name, steps.size());
    std::fflush(stdout);
    return steps;
  }

  Result<LoggedRun> logged(const LoggedRunSpec& wanted) const {
    const Condition& condition = wanted.condition;
    SL_ASSIGN(RunSpec spec, condition_spec(condition));
    const Scratch values(options_.out, "values.csv.part");
    spec.log_file = values.path;
    spec.log_values = wanted.values;
    spec.log_rate_hz = wanted.rate_hz;
    spec.duration_s = wanted.duration_s;
    spec.threads = 0;
    LoggedRun out;
    RunCallbacks callbacks;
    Session* session = nullptr;
    callbacks.on_ready = [&](const RunParts& parts) -> Status {
      session = &parts.session;
      if (!wanted.view) return {};
      SL_ASSIGN(draw::Viewpoint view, draw::Viewpoint::make(*wanted.view, session->simulation()));
      SL_ASSIGN(out.picture, view.picture(session->simulation()));
      return {};
    };
    const bool shows = isatty(STDERR_FILENO);
    int shown = -1;
    callbacks.keep_going = [&](const Simulation& now) {
      if (const int second = static_cast<int>(now.now().s()); shows && second != shown)
        std::fprintf(stderr, "\r\033[Krunning %s, %d s", condition.name.c_str(), shown = second);
      return !interrupted();
    };
    Status read;
    callbacks.on_end = [&](Summary&) {
      if (!session) return;
      out.graph = topic_graph(session->simulation());
      if (wanted.at_end) read = wanted.at_end(session->simulation());
    };
    const auto summary = sandlot::run(spec, callbacks);
    if (shows) std::fputs("\r\033[K", stderr);
    if (!summary) return summary.error();
    if (interrupted()) return Error{"interrupted"};
    if (!summary->errors.empty()) return Error{condition.name + ": " + summary->errors.front()};
    SL_TRY(read);
    SL_ASSIGN(out.csv, read_text_file(values.path, std::uint64_t{1} << 28));
    SL_ASSIGN(out.values, draw::read_csv(out.csv, condition.name + ".csv"));
    fmt::print("{:<40} {:g} s\n", condition.scenario + ": " + condition.name, summary->sim_s);
    std::fflush(stdout);
    return out;
  }

  std::uint64_t failed() const { return failed_; }

 private:
  const ReproduceOptions& options_;
  const Paper& paper_;
  int repeat_, begun_ = 0, reported_ = 0;
  std::uint64_t failed_ = 0;
};

}  // namespace

int reproduce(const ReproduceOptions& options) {
  const Paper* paper = nullptr;
  std::vector<std::string> known;
  for (const Paper& each : papers()) {
    known.emplace_back(each.name);
    if (options.paper == each.name) paper = &each;
  }
  if (!paper)
    return complain(
        {"reproduce: there is no paper '" + options.paper + "'", suggestion(options.paper, known)});
  const int repeat = options.repeat.value_or(paper->repeat);
  const bool repeats = paper->repeat > 0;
  if (!repeats && options.repeat)
    return complain({fmt::format("--repeat: {} repeats no runs", paper->name), "leave it out"});
  if (!paper->traces && !options.traces.empty())
    return complain({fmt::format("--traces: {} takes no step times", paper->name), "leave it out"});
  if (!paper->quick && options.quick)
    return complain({fmt::format("--quick: {} has no parts to leave out", paper->name), "leave it out"});
  if (repeats && (repeat < 1 || repeat > 1'000'000))
    return complain({"--repeat: must be in [1, 1000000], is " + std::to_string(repeat)});
  std::error_code ignored;
  const bool was_there = std::filesystem::exists(options.out, ignored);
  if (Status prepared = prepare_folder(options.out); !prepared) return complain(prepared.error());

  catch_interrupts();
  Runner runner(options, *paper, repeat);
  ReproduceContext context;
  context.repeat = repeat;
  context.at_a_time = options.at_a_time;
  context.out = options.out;
  context.runs = [&](const Condition& condition) { return runner.runs(condition); };
  context.drawing = [&](const Condition& condition, double until_s) {
    return runner.drawing(condition, until_s);
  };
  context.step_times = [&](const Condition& condition, double duration_s, std::optional<double> rate) {
    return runner.step_times(condition, duration_s, rate);
  };
  context.logged = [&](const LoggedRunSpec& spec) { return runner.logged(spec); };
  context.traces = options.traces;
  context.quick = options.quick;
  context.write = [&](const std::string& name, std::string_view text) {
    return write_file((std::filesystem::path(options.out) / name).string(), text);
  };
  ReportPage page(
      paper->title,
      repeats
          ? fmt::format(
                "Made by `sandlot reproduce {} --repeat {}`: {} runs with seeds that follow each other "
                "in each condition. Intervals are for {}.",
                paper->name, repeat, repeat, paper->intervals)
          : fmt::format("Made by `sandlot reproduce {}{}`.", paper->name, options.quick ? " --quick" : ""));
  if (Status made = paper->make(context, page); !made) {
    complain(made.error());
    if (!was_there) std::filesystem::remove(options.out, ignored);  // empty: nothing was written
    return interrupted() ? exit_failed : exit_bad_input;
  }
  if (Status written = context.write("index.html", page.html()); !written) return complain(written.error());
  fmt::print("{}\n", (std::filesystem::path(options.out) / "index.html").string());
  return runner.failed() == 0 ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
