#include "sim/session/session.h"

#include <algorithm>
#include <chrono>

#include "base/text.h"

namespace sandlot {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr std::size_t most_tasks = 10'000;
constexpr auto nap = std::chrono::milliseconds(100);  ///< sleeps no longer without asking whether to go on
constexpr auto tasks_pause = std::chrono::milliseconds(10);  ///< so long they may hold up the next tick

std::string time_text(Time time) { return number_text(time.s()) + " s"; }

bool from_outside(const LogEntry& entry) {
  return entry.kind == LogEntry::step || entry.source.kind != Source::Kind::program;
}

}  // namespace

/// Writes down what comes from outside, so that the run can be made again.
struct Session::Input final : Observer {
  explicit Input(InputLog& to) : tape(to) {}
  InputLog& tape;
  Wants wants() const override { return {.input = true, .instances = false}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    std::vector<LogEntry> entries;
    for (const LogEntry& entry : frame->log)
      if (from_outside(entry)) entries.push_back(entry);
    if (entries.empty()) tape.entries.erase(frame->tick);
    else tape.entries[frame->tick] = std::move(entries);
  }
};

/// When the next tick is due, and how fast the run has been of late.
struct Session::Pacer {
  bool set = false;
  Clock::time_point origin, cycle_begin;
  Time sim_origin;

  struct Mark {
    Clock::time_point wall;
    Time sim;
  };
  std::deque<Mark> marks;

  void begin(Time now) {
    if (set) return;
    set = true;
    origin = cycle_begin = Clock::now();
    sim_origin = now;
    marks.assign(1, {origin, now});
  }
  /// Of a run that stood still: its clock begins anew.
  void forget() { set = false; }
  Clock::time_point due(Time now, double factor) const {
    return origin + std::chrono::duration_cast<Clock::duration>(Seconds((now - sim_origin).s() / factor));
  }
  double real_time_factor(Time now) {
    constexpr double window_s = 1, between_s = 0.1;
    const auto wall = Clock::now();
    if (Seconds(wall - marks.back().wall).count() >= between_s) marks.push_back({wall, now});
    while (marks.size() > 2 && Seconds(wall - marks[1].wall).count() >= window_s) marks.pop_front();
    const double passed_s = Seconds(wall - marks.front().wall).count();
    return passed_s > 0 ? (now - marks.front().sim).s() / passed_s : 0;
  }
};

Session::Session(std::unique_ptr<Simulation> simulation, Options options)
    : options_(std::move(options)),
      simulation_(std::move(simulation)),
      history_gap_s_(options_.history_every_s),
      playing_(!options_.paused),
      pace_(options_.pace) {
  if (options_.input_log) past_ = std::move(*options_.input_log);
  else input_ = std::make_unique<Input>(past_);
  if (input_ && options_.history_mb > 0) simulation_->add_observer(input_.get());
  if (options_.history_mb <= 0 && options_.may_not_rewind.empty())
    options_.may_not_rewind = "no snapshots are kept";
  report_.begin = simulation_->now();
  report_.replay = options_.input_log.has_value();
  report_.may_not_rewind = options_.may_not_rewind;
  report_.state = playing_ ? State::playing : State::paused;
  refresh_report();
}

Session::~Session() {
  for (Observer* observer : observers_) simulation_->remove_observer(observer);
}

void Session::order(const std::function<void()>& give) {
  {
    const std::lock_guard lock(mutex_);
    give();
    woken_ = true;
  }
  changed_.notify_all();
  if (on_change) on_change();
}

void Session::play() {
  order([&] {
    playing_ = true;
    steps_left_ = 0;
  });
}

void Session::pause() {
  order([&] {
    playing_ = seeking_ = false;
    jump_.reset();
    steps_left_ = 0;
    // At once: who asks before the loop comes by must not wait for a tick that will not be.
    if (report_.state == State::playing || report_.state == State::seeking) report_.state = State::paused;
    report_.real_time_factor = 0;
  });
}

void Session::step(std::uint64_t ticks) {
  SL_CHECK(ticks > 0);
  order([&] {
    playing_ = seeking_ = false;
    steps_left_ = ticks;
  });
}

Status Session::set_speed(std::optional<double> factor) {
  if (factor && !(*factor >= 0.001 && *factor <= 1000))
    return Error{"a speed of " + number_text(*factor) + " is out of range", "0.001 to 1000, or max"};
  order([&] { report_.speed = pace_.factor = factor; });
  return {};
}

Status Session::may_rewind() const {
  if (options_.may_not_rewind.empty()) return {};
  return Error{"this run cannot be rewound: " + options_.may_not_rewind};
}

Status Session::reset() {
  SL_TRY(may_rewind());
  order([&] {
    reset_ = true;
    seeking_ = false;
    jump_.reset();
    steps_left_ = 0;
  });
  return {};
}

Status Session::jump(Time to) {
  {
    const std::lock_guard lock(mutex_);
    if (to < report_.begin) return Error{"the run begins at " + time_text(report_.begin)};
    if (to < report_.now) SL_TRY(may_rewind());
    const std::optional<Time> end = report_.end;
    if (end && to > *end) return Error{"the run ends at " + time_text(*end)};
  }
  order([&] {
    jump_ = to;
    steps_left_ = 0;
  });
  return {};
}

void Session::load(std::vector<std::byte> snapshot, std::function<void(const Status&)> done) {
  bool over = false;
  order([&] {
    over = !running_;
    if (!over) loads_.push_back({std::move(snapshot), std::move(done)});
  });
  if (over && done) done(Error{"the run has ended"});
}

void Session::quit() {
  order([&] { quit_ = true; });
}

Result<std::uint64_t> Session::submit(Request request, Source source, Done done) {
  const std::lock_guard lock(mutex_);
  if (!running_) return Error{"the run has ended"};
  if (!report_.takes_no_input.empty()) return Error{report_.takes_no_input};
  const std::uint64_t sequence = simulation_->submit(std::move(request), source);
  if (done) waiting_.emplace(sequence, std::move(done));
  return sequence;
}

bool Session::post(std::function<void(Session&)> task) {
  {
    const std::lock_guard lock(mutex_);
    if (!running_ || tasks_.size() >= most_tasks) return false;
    tasks_.push_back(std::move(task));
    woken_ = true;
  }
  changed_.notify_all();
  return true;
}

Session::Report Session::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

void Session::add_observer(Observer* observer) {
  observers_.push_back(observer);
  simulation_->add_observer(observer);
}

void Session::remove_observer(Observer* observer) {
  std::erase(observers_, observer);
  simulation_->remove_observer(observer);
}

void Session::set_state(State state) {
  {
    const std::lock_guard lock(mutex_);
    if (report_.state == state) return;
    report_.state = state;
    if (state != State::playing && state != State::seeking) report_.real_time_factor = 0;
  }
  if (on_change) on_change();
}

std::string Session::why_no_input() const {
  if (options_.input_log) return "this is a recording: it takes no input";
  return rerunning() ? "the run is on its way to " + time_text(target_.value_or(Time{})) : "";
}

void Session::refresh_report() {
  const std::lock_guard lock(mutex_);
  report_.now = simulation_->now();
  report_.step = simulation_->setup().step;
  report_.tick = simulation_->tick_index();
  report_.revision = simulation_->revision();
  report_.epoch = epoch_;
  report_.speed = pace_.factor;
  report_.end = simulation_->setup().stop;
  if (options_.input_log) report_.end = past_.end;
  report_.target = target_;
  report_.takes_no_input = why_no_input();
  if (report_.history.size() != history_.size() ||
      (!history_.empty() && report_.history.back() != history_.back().now)) {
    report_.history.clear();
    for (const Kept& kept : history_) report_.history.push_back(kept.now);
  }
}

Status Session::advance(std::optional<Time> measured, RunReport& report) {
  if (options_.input_log || rerunning())
    if (const std::optional<Time> logged = feed_input_log()) measured = logged;
  const Time before = simulation_->now();
  const bool rerun = rerunning();
  Status status = options_.tick ? options_.tick(*simulation_, measured) : simulation_->tick(measured);
  const Time length = simulation_->now() - before;
  report.shortest = ++report.ticks == 1 ? length : std::min(report.shortest, length);
  report.longest = std::max(report.longest, length);
  report.sim_s += length.s();
  if (rerun && !rerunning()) forget_future();
  answer_outcomes();
  return status;
}

void Session::answer_outcomes() {
  std::vector<std::pair<Done, const Status*>> answers;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return;
    for (const Outcome& outcome : simulation_->outcomes()) {
      const auto found = waiting_.find(outcome.sequence);
      if (found == waiting_.end()) continue;
      answers.emplace_back(std::move(found->second), &outcome.status);
      waiting_.erase(found);
    }
  }
  for (const auto& [done, status] : answers) done(*status);
}

/// Beyond its patience the rest waits until the loop comes by again: viewers who ask for much hold up the run no longer than
/// one of their questions takes.
void Session::run_tasks(std::chrono::milliseconds patience) {
  const auto end = Clock::now() + patience;
  std::unique_lock lock(mutex_);
  // Not those that come meanwhile: what a task has ordered acts before them.
  std::size_t left = tasks_.size();
  woken_ = false;  // here and not behind the tasks: what comes while they run must wake the loop again
  for (bool first = true; left > 0 && (first || Clock::now() < end); --left, first = false) {
    auto task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task(*this);
    task = nullptr;  // what it holds may answer when it goes: not under the lock
    lock.lock();
  }
  woken_ = woken_ || !tasks_.empty();
}

Status Session::replace(std::span<const std::byte> bytes, const std::string& why) {
  Diagnostics said_before;
  SL_ASSIGN(auto world, Simulation::restore(bytes, options_.simulation, said_before));
  for (Observer* observer : observers_) world->add_observer(observer);
  if (input_) world->add_observer(input_.get());
  std::map<std::uint64_t, Done> waiting;
  {
    const std::lock_guard lock(mutex_);
    std::swap(simulation_, world);
    std::swap(waiting, waiting_);
    ++epoch_;
    // Before anybody can submit to it: what runs again has its input.
    report_.takes_no_input = why_no_input();
  }
  for (const auto& [sequence, done] : waiting) done(Error{"the run was " + why + " before"});
  if (options_.on_world) options_.on_world(*simulation_, why);
  return {};
}

Status Session::go_back(Time to) {
  // The last one not behind `to`. The first is where the run began.
  std::size_t best = 0;
  for (std::size_t i = 0; i < history_.size(); ++i)
    if (history_[i].now <= to) best = i;
  const Time now = simulation_->now();
  const bool ahead = to >= now && status_;
  if (ahead && (history_.empty() || history_[best].now <= now)) return {};  // only run on
  SL_TRY(may_rewind());  // the run may have passed the time since it was asked for
  const std::uint64_t frontier = simulation_->tick_index();
  const std::uint64_t before = rerun_until_;
  if (!options_.input_log) rerun_until_ = std::max(frontier, rerun_until_);
  Status status = replace(history_[best].bytes, "rewound to " + time_text(to));
  if (!status) rerun_until_ = before;
  return status;
}

void Session::refuse_loads(std::vector<Load> loads, const char* why) {
  for (const Load& load : loads)
    if (load.done) load.done(Error{why});
}

bool Session::obey(std::unique_lock<std::mutex>& lock) {
  Status status;
  if (!loads_.empty()) {
    const Load load = std::move(loads_.back());
    loads_.pop_back();
    std::vector<Load> others;
    std::swap(others, loads_);
    lock.unlock();
    refuse_loads(std::move(others), "another one was asked for meanwhile");
    status = may_rewind();
    if (status && options_.input_log) status = Error{"this is a recording: nothing can be loaded into it"};
    if (status) status = replace(load.bytes, "loaded");
    if (status) {
      past_ = {};
      history_.clear();
      history_bytes_ = 0;
      history_gap_s_ = options_.history_every_s;
      rerun_until_ = 0;
      keep_snapshot();
      const std::lock_guard again(mutex_);
      report_.begin = simulation_->now();
      report_.reason.clear();
      status_ = {};
      seeking_ = false;
      target_.reset();
    }
    if (load.done) load.done(status);
  } else if (reset_) {
    reset_ = false;
    lock.unlock();
    status = replace(history_.front().bytes, "reset");
    if (status) {
      forget_future();
      const std::lock_guard again(mutex_);
      report_.reason.clear();
      status_ = {};
      seeking_ = false;
      target_.reset();
    }
  } else if (jump_) {
    const Time to = *jump_;
    jump_.reset();
    target_ = to;
    seeking_ = true;
    lock.unlock();
    status = go_back(to);
    const std::lock_guard again(mutex_);
    if (status) {
      report_.reason.clear();
      status_ = {};
    } else {
      seeking_ = false;
      target_.reset();
    }
  } else {
    return false;
  }
  if (!status) {
    const std::lock_guard again(mutex_);
    report_.reason = status.error().text();
  }
  refresh_report();
  if (on_change) on_change();
  lock.lock();
  return true;
}

Status Session::run(RunReport& report, const std::function<bool(const Simulation&)>& keep_going) {
  const auto wall_begin = Clock::now();
  Pacer pacer;
  std::optional<double> paced_by;
  if (history_.empty()) keep_snapshot();
  const auto go_on = [&] { return !keep_going || keep_going(*simulation_); };
  while (true) {
    run_tasks(tasks_pause);
    std::unique_lock lock(mutex_);
    if (quit_) break;
    if (obey(lock)) {
      pacer.forget();
      continue;
    }
    if (seeking_ && simulation_->now() >= *target_) {
      seeking_ = false;
      target_.reset();
      lock.unlock();
      forget_future();
      pacer.forget();
      refresh_report();
      if (on_change) on_change();
      continue;
    }
    // A jump that was given up: the run goes on from where it came to.
    if (!seeking_ && target_) {
      target_.reset();
      lock.unlock();
      forget_future();
      refresh_report();
      continue;
    }
    const bool log_over = options_.input_log && simulation_->tick_index() >= past_.last_tick;
    const bool over = !status_ || simulation_->stop_reason() || log_over;
    if (over) {
      seeking_ = false;
      steps_left_ = 0;
      target_.reset();
      if (status_) report_.reason = simulation_->stop_reason().value_or("the recording ends here");
      lock.unlock();
      set_state(status_ ? State::ended : State::failed);
      refresh_report();
      lock.lock();
      if (!options_.stay) break;
    }
    if (over || !(playing_ || seeking_ || steps_left_ > 0)) {
      pacer.forget();
      lock.unlock();
      if (!over) set_state(State::paused);
      refresh_report();
      if (!go_on()) break;
      lock.lock();
      changed_.wait_for(lock, nap, [&] { return woken_; });
      continue;
    }
    // Of the world that is there now. A tape has the lengths of its ticks: it is played like one with a fixed clock.
    const model::Clock& clock = simulation_->setup().clock;
    const bool continuous = clock.mode == model::Clock::Mode::continuous && !options_.input_log;
    const bool unpaced = seeking_ || steps_left_ > 0 || (!pace_.factor && !continuous);
    const double factor = pace_.factor.value_or(1);
    if (std::exchange(paced_by, pace_.factor) != pace_.factor) pacer.forget();
    lock.unlock();
    set_state(seeking_ ? State::seeking : State::playing);
    lock.lock();
    std::optional<Time> measured;
    if (continuous) measured = simulation_->setup().step;
    if (!unpaced) {
      const bool fresh = !pacer.set;
      pacer.begin(simulation_->now());
      const auto shortest = std::chrono::duration_cast<Clock::duration>(Seconds(clock.min_step.s() / factor));
      const auto due = continuous ? pacer.cycle_begin + shortest : pacer.due(simulation_->now(), factor);
      const auto now = Clock::now();
      if (due > now) {
        changed_.wait_until(lock, std::min(due, now + nap), [&] { return woken_; });
        if (woken_ || Clock::now() < due) {
          lock.unlock();
          refresh_report();
          if (!go_on()) break;
          continue;
        }
      } else if (!continuous) {
        // When the program falls far behind it does not race to catch up: the clock is set anew.
        constexpr double resync_s = 1.0;
        const double behind_s = Seconds(now - due).count();
        if (behind_s * factor > simulation_->setup().step.s()) ++report.late_ticks;
        if (behind_s > resync_s) pacer.forget();
      }
      if (continuous && !fresh) {
        const auto at = Clock::now();
        measured = Time::from_s(Seconds(at - pacer.cycle_begin).count() * factor);
        if (*measured > clock.max_step) ++report.late_ticks;
        pacer.cycle_begin = at;
      }
    } else {
      if (seeking_ || steps_left_ > 0) pacer.forget();
      pacer.begin(simulation_->now());
    }
    if (!seeking_ && steps_left_ > 0) --steps_left_;
    lock.unlock();
    status_ = advance(measured, report);
    const double rtf = pacer.set ? pacer.real_time_factor(simulation_->now()) : 0;
    {
      const std::lock_guard again(mutex_);
      report_.late_ticks = report.late_ticks;
      report_.real_time_factor = rtf;
      // Of an order that failed it is enough to say so until the run goes on.
      report_.reason = status_ ? "" : status_.error().text();
    }
    if (status_) keep_snapshot();
    refresh_report();
    if (!go_on()) break;
  }
  report.wall_s += Seconds(Clock::now() - wall_begin).count();
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  run_tasks(std::chrono::hours(1));
  std::map<std::uint64_t, Done> waiting;
  std::vector<Load> loads;
  {
    const std::lock_guard lock(mutex_);
    std::swap(waiting, waiting_);
    std::swap(loads, loads_);
  }
  for (const auto& [sequence, done] : waiting) done(Error{"the run has ended"});
  refuse_loads(std::move(loads), "the run has ended");
  return std::move(status_);
}

}  // namespace sandlot
