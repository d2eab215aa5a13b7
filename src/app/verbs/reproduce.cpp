/// sandlot reproduce: makes the experiment of a paper, its figures and tables as a page that needs no network.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <filesystem>

#include "app/commands.h"
#include "app/demos.h"
#include "app/flags.h"
#include "app/interrupt.h"
#include "app/papers/papers.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "files/text.h"

namespace sandlot::app {
namespace {

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
    return complain(
        {fmt::format("--repeat: {} takes step times, not repeated runs", paper->name), "leave it out"});
  if (repeats && !options.traces.empty())
    return complain({fmt::format("--traces: {} takes no step times", paper->name), "leave it out"});
  if (repeats && (repeat < 1 || repeat > 1'000'000))
    return complain({"--repeat: must be in [1, 1000000], is " + std::to_string(repeat)});
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error)
    return complain({"--out " + options.out + ": " + error.message(), "name a folder that can be written"});

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
  context.traces = options.traces;
  context.write = [&](const std::string& name, std::string_view text) {
    return write_file((std::filesystem::path(options.out) / name).string(), text);
  };
  ReportPage page(
      paper->title,
      repeats ? fmt::format(
                    "Made by `sandlot reproduce {} --repeat {}`: {} runs with seeds that follow each other "
                    "in each condition. Intervals are for {}.",
                    paper->name, repeat, repeat, paper->intervals)
              : fmt::format("Made by `sandlot reproduce {}`.", paper->name));
  if (Status made = paper->make(context, page); !made) {
    complain(made.error());
    return interrupted() ? exit_failed : exit_bad_input;
  }
  if (Status written = context.write("index.html", page.html()); !written) return complain(written.error());
  fmt::print("{}\n", (std::filesystem::path(options.out) / "index.html").string());
  return runner.failed() == 0 ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
