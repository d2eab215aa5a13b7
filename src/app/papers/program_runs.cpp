#include "app/papers/program_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <mutex>
#include <sstream>
#include <thread>

#include "app/flags.h"
#include "app/interrupt.h"
#include "base/log.h"
#include "base/program.h"
#include "files/text.h"
#include "run/run.h"
#include "sim/session/session.h"
#include "sim/watch/values.h"

namespace sandlot::app {
namespace {

using Printed = std::map<std::string, std::vector<Words>>;
/// Lines of the run on this thread.
thread_local Printed* printed_here = nullptr;

void note_line(std::string_view text) {
  constexpr std::string_view program = "/controller: ";
  const std::size_t at = text.find(program);
  if (!printed_here || at == std::string_view::npos) return;
  std::istringstream in{std::string(text.substr(at + program.size()))};
  Words words;
  for (std::string word; in >> word;) words.push_back(std::move(word));
  if (!words.empty()) (*printed_here)[std::string(text.substr(0, at))].push_back(std::move(words));
}

double number_of(const std::string& word) {
  double x = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  return error == std::errc() && end == word.data() + word.size() ? x
                                                                  : std::numeric_limits<double>::quiet_NaN();
}

Result<std::string> example_file(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  for (const fs::path folder : folders_above_program())
    for (const fs::path& place : {folder / "examples", folder / "share" / "doc" / "sandlot" / "examples"})
      if (fs::is_regular_file(place / name, ignored)) return (place / name).lexically_normal().string();
  return Error{"the example '" + name + "' was not found", "install the folder 'examples' with the program"};
}

Result<RunSpec> program_spec(const ProgramRunSpec& spec) {
  RunSpec out;
  SL_ASSIGN(out.file, example_file(spec.file));
  std::vector<std::string> settings;
  for (const auto& [name, value] : spec.settings) settings.push_back(name + "=" + value);
  SL_TRY(read_sets(settings, out.overrides));
  out.duration_s = spec.duration_s;
  out.stop_when = spec.stop_when;
  out.seed = spec.seed;
  out.errors = spec.errors;
  return out;
}

/// Values of a simulation after each tick.
class Trace {
 public:
  Trace(const ProgramRunSpec& spec, ProgramRun& run) : spec_(spec), run_(run) {
    run_.values.resize(spec.values.size());
  }
  Status begin(const Simulation& simulation) {
    for (const std::string& address : spec_.values) {
      SL_ASSIGN(NamedValue value, NamedValue::find(simulation, address));
      values_.push_back(std::move(value));
    }
    take(simulation);
    return {};
  }
  /// A run calls it more often than it ticks.
  void take(const Simulation& simulation) {
    if (!run_.times_s.empty() && simulation.tick_index() == tick_) return;
    tick_ = simulation.tick_index();
    run_.times_s.push_back(simulation.now().s());
    for (std::size_t i = 0; i < values_.size(); ++i)
      run_.values[i].push_back(values_[i].read().value_or(std::numeric_limits<double>::quiet_NaN()));
    if (spec_.watch) spec_.watch(simulation);
  }

 private:
  const ProgramRunSpec& spec_;
  ProgramRun& run_;
  std::vector<NamedValue> values_;
  std::uint64_t tick_ = 0;
};

Result<ProgramRun> run_one(const ProgramRunSpec& spec, const std::string& drawing_file) {
  SL_ASSIGN(RunSpec run, program_spec(spec));
  run.drawing_file = drawing_file;
  ProgramRun out;
  Trace trace(spec, out);
  printed_here = &out.printed;
  const auto ready = [&](const RunParts& parts) -> Status {
    Simulation& simulation = parts.session.simulation();
    if (spec.view) {
      SL_ASSIGN(draw::Viewpoint view, draw::Viewpoint::make(*spec.view, simulation));
      SL_ASSIGN(out.picture, view.picture(simulation));
    }
    return trace.begin(simulation);
  };
  auto summary = sandlot::run(run, {.on_ready = ready, .keep_going = [&](const Simulation& simulation) {
                                      trace.take(simulation);
                                      return !interrupted();
                                    }});
  printed_here = nullptr;
  if (!summary) return std::move(summary.error());
  if (interrupted()) return Error{"interrupted"};
  if (!summary->errors.empty()) return Error{spec.file + ": " + summary->errors.front()};
  out.summary = std::move(*summary);
  return out;
}

}  // namespace

std::vector<Words> ProgramRun::lines(const std::string& robot, const std::string& first) const {
  std::vector<Words> out;
  if (const auto found = printed.find(robot); found != printed.end())
    for (const Words& line : found->second)
      if (line.front() == first) out.emplace_back(line.begin() + 1, line.end());
  return out;
}

std::vector<std::vector<double>> ProgramRun::numbers(const std::string& robot,
                                                     const std::string& first) const {
  std::vector<std::vector<double>> out;
  for (const Words& line : lines(robot, first)) {
    std::vector<double>& row = out.emplace_back();
    for (const std::string& word : line) row.push_back(number_of(word));
  }
  return out;
}

ProgramRuns::ProgramRuns(std::string scratch, int at_a_time)
    : scratch_(std::move(scratch)), at_a_time_(at_a_time) {
  log::set_level(log::Level::warning);  // the lines of programs are for the report
  log::set_listener([](log::Level, std::string_view text) { note_line(text); });
}

ProgramRuns::~ProgramRuns() {
  log::set_listener({});
  log::set_level(log::Level::info);
}

Result<ProgramRun> ProgramRuns::run(const ProgramRunSpec& spec) const {
  namespace fs = std::filesystem;
  const std::string drawing = spec.draws ? (fs::path(scratch_) / "drawing.svg").string() : "";
  SL_ASSIGN(ProgramRun out, run_one(spec, drawing));
  if (spec.draws) {
    SL_ASSIGN(out.drawing, read_text_file(drawing, std::uint64_t{1} << 26));
    std::error_code ignored;
    fs::remove(drawing, ignored);
  }
  fmt::print("{:<50} {:.4g} s\n", spec.file, out.summary.sim_s);
  std::fflush(stdout);
  return out;
}

Result<std::vector<ProgramRun>> ProgramRuns::repeated(const ProgramRunSpec& spec, int count) const {
  std::vector<ProgramRun> out(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  std::mutex mutex;
  std::optional<Error> error;
  const auto work = [&] {
    for (int i; (i = next++) < count;) {
      ProgramRunSpec one = spec;
      one.seed = static_cast<std::uint64_t>(i) + 1;
      auto done = run_one(one, "");
      const std::lock_guard lock(mutex);
      if (done) out[static_cast<std::size_t>(i)] = std::move(*done);
      else if (!error) error = std::move(done.error());
      if (error) return;
    }
  };
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::thread> others;
  for (int i = 1; i < std::min(count, at_a_time_ > 0 ? at_a_time_ : processors); ++i)
    others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (error) return std::move(*error);
  fmt::print("{:<50} {} runs of {:.4g} s\n", spec.file, count, out.front().summary.sim_s);
  std::fflush(stdout);
  return out;
}

}  // namespace sandlot::app
