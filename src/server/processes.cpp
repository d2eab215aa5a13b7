#include "server/processes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <filesystem>
#include <future>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "base/log.h"
#include "base/text.h"
#include "programs/output_file.h"
#include "programs/process_tree.h"
#include "programs/remote/remote.h"
#include "programs/sandbox.h"
#include "sim/world/simulation.h"

namespace sandlot::server {
namespace {

namespace fs = std::filesystem;
using programs::Child;
using programs::remote::Restart;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto watch_beat = 20ms, measure_every = 40ms, look_every = 500ms, grace = 500ms;
constexpr double first_pause_s = 0.1, longest_pause_s = 5, long_life_s = 10;
constexpr int most_short_lives = 6;
constexpr double output_lines_per_s = 50, output_lines_at_once = 200;
constexpr std::size_t most_files = 1000;
constexpr double share_saved_s = 0.1;  ///< processor time that a program may save up, per core of its share

double seconds_between(Clock::time_point then, Clock::time_point now) {
  return std::chrono::duration<double>(now - then).count();
}
Clock::duration duration_of(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

std::string megabytes(double bytes) { return fmt::format("{:.0f} MB", bytes / 1e6); }

/// When the files of a program were written last.
using FileTimes = std::map<std::string, fs::file_time_type>;

FileTimes file_times(const programs::ProgramLaunch& program) {
  static const std::set<std::string> sources{".py", ".js", ".mjs", ".cjs", ".sh", ".lua", ".rb", ".pl"};
  FileTimes out;
  std::error_code failed;
  const auto add = [&](const fs::path& file) {
    const auto time = fs::last_write_time(file, failed);
    if (!failed) out.emplace(file.string(), time);
  };
  for (const std::string& word : program.command)
    if (const fs::path file = fs::path(program.folder) / word; fs::is_regular_file(file, failed)) add(file);
  fs::recursive_directory_iterator entry(program.folder, fs::directory_options::skip_permission_denied,
                                         failed);
  for (; !failed && entry != fs::end(entry) && out.size() < most_files; entry.increment(failed))
    if (std::error_code none;
        sources.contains(entry->path().extension().string()) && entry->is_regular_file(none))
      add(entry->path());
  return out;
}

/// Whether a process ended by a fault of its own, by its status of waitpid().
bool is_crash(int status) {
  static const std::set<int> faults{SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP};
  return faults.contains(programs::signal_of_exit(status));
}

/// A program and its process. Of the watching thread, but for what never changes.
struct WatchedProgram {
  std::string path;  ///< "red1/controller"
  Place place;
  Restart rule = Restart::never;
  Access access;
  programs::ProgramLaunch launch;
  std::shared_ptr<programs::remote::Link> link;
  std::optional<programs::PrivateFolder> folder;

  std::optional<Child> child;
  Clock::time_point started, measured;
  std::optional<Clock::time_point> start_at;
  int short_lives = 0;
  programs::ProcessMeter meter;
  double balance_s = 0;  ///< processor time it may use
  bool halted = false;
  FileTimes files;

  std::string last_note;
  programs::OutputFile output;
  double lines_left = output_lines_at_once;
  std::uint64_t lines_left_out = 0;
  Clock::time_point lines_counted;

  Status begin();
  void read_output(Clock::time_point now);
  void write_line(const std::string& line, bool is_error);
  void measure(Clock::time_point now);
  void end(const std::string& how, bool success, Clock::time_point now);
  std::string text_of_end(const std::string& how) const;
  void watch(bool expected, Clock::time_point now);
};

Status WatchedProgram::begin() {
  start_at.reset();
  child.reset();
  SL_ASSIGN(const programs::Launch command, programs::launch_of(launch));
  SL_ASSIGN(child, Child::start(command));
  meter = {};
  halted = false;
  balance_s = share_saved_s * launch.budget.cpu;
  started = measured = lines_counted = Clock::now();
  last_note.clear();
  files = file_times(launch);
  log::debug(path + ": started " + launch.command.front());
  return {};
}

void WatchedProgram::write_line(const std::string& line, bool is_error) {
  output.write(line);
  if (is_error && !line.empty()) last_note = line;
  if (lines_left < 1) {
    ++lines_left_out;
    return;
  }
  lines_left -= 1;
  if (is_error) log::warning(path + ": " + line);
  else log::info(path + ": " + line);
}

void WatchedProgram::read_output(Clock::time_point now) {
  lines_left = std::min(output_lines_at_once,
                        lines_left + output_lines_per_s * seconds_between(lines_counted, now));
  lines_counted = now;
  if (lines_left_out > 0 && lines_left >= output_lines_at_once / 2)
    log::warning(fmt::format("{}: {} more lines were left out here", path, std::exchange(lines_left_out, 0)));
  child->move();
  while (const auto line = child->take_line()) write_line(*line, false);
  while (const auto note = child->take_note()) write_line(*note, true);
}

/// Holds it to its share of a processor, and to its memory.
void WatchedProgram::measure(Clock::time_point now) {
  if (now < measured + measure_every) return;
  const programs::Budget& budget = launch.budget;
  const auto used = meter.sample(child->process());
  balance_s += budget.cpu * seconds_between(measured, now) - used.cpu_s;
  balance_s = std::min(balance_s, share_saved_s * budget.cpu);
  measured = now;
  if (static_cast<double>(used.memory_bytes) > budget.memory_bytes) {
    child.reset();
    return end(fmt::format("was ended: it had {} of memory, of {}",
                           megabytes(static_cast<double>(used.memory_bytes)), megabytes(budget.memory_bytes)),
               false, now);
  }
  // Again and again while it lasts: processes may have come meanwhile.
  if (balance_s < 0) programs::halt(child->process(), true);
  else if (halted) programs::halt(child->process(), false);
  halted = balance_s < 0;
}

std::string WatchedProgram::text_of_end(const std::string& how) const {
  return "program '" + path + "' " + how;
}

/// The process is no more: it is started again, or the run no longer waits for it.
void WatchedProgram::end(const std::string& how, bool success, Clock::time_point now) {
  std::string text = text_of_end(how);
  if (!success && !last_note.empty()) text += "; last line of its standard error: " + last_note;
  const bool again = rule == Restart::on_exit || (rule == Restart::on_failure && !success);
  if (seconds_between(started, now) > long_life_s) short_lives = 0;
  if (again && ++short_lives < most_short_lives) {
    const double pause_s = std::min(longest_pause_s, first_pause_s * (1 << (short_lives - 1)));
    start_at = now + duration_of(pause_s);
    log::warning(text + "; it is started again in " + number_text(pause_s) + " s");
    return;
  }
  if (again) text += fmt::format("; it has ended {} times in a row and is not started again", short_lives);
  if (success) log::info(text);
  else log::warning(text);
  link->give_up();
}

void WatchedProgram::watch(bool expected, Clock::time_point now) {
  if (child) {
    read_output(now);
    if (const auto status = child->exit_status()) {
      read_output(now);
      child.reset();
      // One that crashed just before the run ended is found only now.
      if (!expected) end(programs::text_of_exit(*status), *status == 0, now);
      else if (is_crash(*status)) log::warning(text_of_end(programs::text_of_exit(*status)));
    } else {
      measure(now);
    }
  }
  if (expected || !start_at || now < *start_at) return;
  if (const Status begun = begin(); !begun) {
    log::warning("program '" + path + "' is not started again: " + begun.error().text());
    link->give_up();
  }
}

}  // namespace

struct Processes::Impl {
  ProgramOptions options;
  std::vector<std::unique_ptr<WatchedProgram>> programs;
  Clock::time_point looked;

  std::mutex mutex;
  std::condition_variable changed;
  // Guarded by mutex:
  std::set<std::string> wanted;  ///< paths of programs to restart
  bool ending = false, stopping = false;
  std::thread thread;

  void run(std::promise<Status> started);
  void look_for_changes();
  bool watch(bool expected);
};

void Processes::Impl::run(std::promise<Status> started) {
  // Here, because the kernel ends a child with the thread that started it.
  for (const auto& each : programs)
    if (Status begun = each->begin(); !begun) {
      if (!begun.error().place.file) begun.error().place = each->place;
      for (const auto& other : programs) other->child.reset();
      return started.set_value(std::move(begun));
    }
  started.set_value({});
  std::optional<Clock::time_point> last_moment;
  std::unique_lock lock(mutex);
  while (true) {
    changed.wait_for(lock, watch_beat, [&] { return !wanted.empty(); });
    const std::set<std::string> again = std::exchange(wanted, {});
    const bool expected = ending || stopping;
    if (stopping && !last_moment) last_moment = Clock::now() + grace;
    lock.unlock();
    if (options.watch_files && !expected) look_for_changes();
    for (const auto& each : programs)
      if (again.contains(each->path) && !expected) {
        each->child.reset();
        each->short_lives = 0;
        each->start_at = Clock::now();
      }
    const bool some_run = watch(expected);
    if (last_moment && (!some_run || Clock::now() > *last_moment)) break;
    lock.lock();
  }
  for (const auto& each : programs) each->child.reset();
}

/// @return whether a process runs
bool Processes::Impl::watch(bool expected) {
  bool some_run = false;
  for (const auto& each : programs) {
    each->watch(expected, Clock::now());
    some_run = some_run || each->child;
  }
  return some_run;
}

void Processes::Impl::look_for_changes() {
  const auto now = Clock::now();
  if (now < looked + look_every) return;
  looked = now;
  for (const auto& each : programs) {
    FileTimes files = file_times(each->launch);
    if (files == each->files) continue;
    each->files = std::move(files);
    log::info("program '" + each->path + "' is started again: a file of it has changed");
    each->child.reset();
    each->short_lives = 0;
    each->start_at = now;
  }
}

Processes::Processes(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Processes::~Processes() { stop(); }

Result<std::unique_ptr<Processes>> Processes::create(Simulation& simulation, const ProgramOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  const auto user = programs::program_user();
  Status status;
  const auto add = [&](const SimulationParts::ProgramEntry& entry,
                       const programs::remote::Remote& remote) -> Status {
    const programs::remote::Spec& spec = remote.spec();
    auto made = std::make_unique<WatchedProgram>();
    made->path = entry.path;
    made->place = entry.decl.place;
    made->rule = spec.restart;
    made->link = remote.link();
    made->access.name = first_part(entry.path);
    made->access.role = std::as_const(simulation).find_entity(made->access.name) ? Role::robot : Role::team;
    for (const auto& other : impl->programs)
      if (other->access.name == made->access.name)
        return Error{"'" + made->access.name + "' has two programs to be started, '" + other->path +
                         "' and '" + made->path + "'",
                     "one connection drives a robot: make one program of them", entry.decl.place};
    SL_ASSIGN(made->folder, programs::PrivateFolder::make(user));
    SL_ASSIGN(const std::string token, programs::make_secret());
    programs::ProgramLaunch& launch = made->launch;
    launch.command = spec.command;
    launch.folder = spec.folder;
    launch.budget = spec.budget;
    launch.socket_folder = made->folder->path();
    launch.python_folders = options.python_folders;
    launch.environment = {
        (made->access.role == Role::robot ? "SANDLOT_ROBOT=" : "SANDLOT_TEAM=") + made->access.name,
        "SANDLOT_PROGRAM=" + made->path, "SANDLOT_TOKEN=" + token,
        std::string("SANDLOT_LOCKSTEP=") + (spec.lockstep ? "1" : "0"),
        "SANDLOT_DEADLINE_S=" + number_text(spec.deadline_s)};
    if (!options.log_folder.empty()) SL_TRY(made->output.open(options.log_folder, made->path));
    impl->programs.push_back(std::move(made));
    return {};
  };
  simulation.for_each_outside([&](const SimulationParts::ProgramEntry& entry, const Outside& outside) {
    const auto* const remote = dynamic_cast<const programs::remote::Remote*>(&outside);
    if (status && remote && remote->has_command()) status = add(entry, *remote);
  });
  SL_TRY(status);
  if (impl->programs.empty()) return std::unique_ptr<Processes>();
  return std::unique_ptr<Processes>(new Processes(std::move(impl)));
}

std::vector<LocalPort> Processes::ports() const {
  std::vector<LocalPort> out;
  for (const auto& each : impl_->programs)
    out.push_back({each->folder->path() + "/" + programs::socket_name, each->access});
  return out;
}

Status Processes::start() {
  std::promise<Status> started;
  std::future<Status> outcome = started.get_future();
  impl_->thread = std::thread(
      [impl = impl_.get(), begun = std::move(started)]() mutable { impl->run(std::move(begun)); });
  return outcome.get();
}

Status Processes::restart(const std::string& program) {
  std::vector<std::string> known;
  for (const auto& each : impl_->programs) known.push_back(each->path);
  if (std::find(known.begin(), known.end(), program) == known.end())
    return Error{"this run has started no program '" + program.substr(0, 200) + "'",
                 suggestion(program, known)};
  const std::lock_guard lock(impl_->mutex);
  if (impl_->ending || impl_->stopping) return Error{"the run ends"};
  impl_->wanted.insert(program);
  impl_->changed.notify_all();
  return {};
}

void Processes::expect_end() {
  const std::lock_guard lock(impl_->mutex);
  impl_->ending = true;
}

void Processes::stop() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stopping = true;
  }
  impl_->changed.notify_all();
  if (impl_->thread.joinable()) impl_->thread.join();
}

}  // namespace sandlot::server
