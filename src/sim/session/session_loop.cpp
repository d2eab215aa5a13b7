/// The loop of a session: what happens between two ticks and when the next one is due.
///
/// Each round runs waiting tasks, chooses one step under the lock (next_step) and carries it out. Orders from other threads
/// only change the guarded state; everything that touches the world happens here, on the simulation's thread.
#include <algorithm>
#include <chrono>

#include "sim/session/session.h"

namespace sandlot {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr auto nap = std::chrono::milliseconds(100);         ///< longest sleep without calling keep_going
constexpr auto tasks_pause = std::chrono::milliseconds(10);  ///< longest delay of the next tick by tasks

Clock::duration wall(double seconds) { return std::chrono::duration_cast<Clock::duration>(Seconds(seconds)); }

}  // namespace

/// Wall clock of the run: when the next tick is due, and the recent real-time factor.
struct Session::Pacer {
  bool set = false;  ///< false: the next paced tick begins it
  Clock::time_point origin, cycle_begin;
  Time sim_origin;
  std::optional<double> factor;  ///< speed that it was set for

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
  /// After a stop, a jump or another speed: the clock begins again with the next tick.
  void forget() { set = false; }
  Clock::time_point due(Time now, double speed) const {
    return origin + wall((now - sim_origin).s() / speed);
  }
  double real_time_factor(Time now) {
    if (!set) return 0;
    constexpr double window_s = 1, between_s = 0.1;
    const auto at = Clock::now();
    if (Seconds(at - marks.back().wall).count() >= between_s) marks.push_back({at, now});
    while (marks.size() > 2 && Seconds(at - marks[1].wall).count() >= window_s) marks.pop_front();
    const double passed_s = Seconds(at - marks.front().wall).count();
    return passed_s > 0 ? (now - marks.front().sim).s() / passed_s : 0;
  }
};

Status Session::run(RunReport& report, const std::function<bool(const Simulation&)>& keep_going) {
  const auto wall_begin = Clock::now();
  const auto go_on = [&] { return !keep_going || keep_going(*simulation_); };
  Pacer pacer;
  const auto stand_still = [&] {
    pacer.forget();
    end_stretch();
  };
  if (history_.empty()) keep_snapshot();
  for (bool running = true; running;) {
    run_tasks(tasks_pause);
    switch (next_step()) {
      case Step::leave: running = false; break;
      case Step::process_order:
        stand_still();
        process_order();
        break;
      case Step::end_seek:
        stand_still();
        end_seek();
        break;
      case Step::end:
        stand_still();
        end_run();
        running = options_.stay && go_on();
        if (running) wait_for_order();
        break;
      case Step::pause:
        set_state(State::paused);
        stand_still();
        refresh_report();
        running = go_on();
        if (running) wait_for_order();
        break;
      case Step::tick: {
        std::optional<Time> measured;
        if (wait_until_due(pacer, report, measured)) run_tick(pacer, report, measured);
        refresh_report();
        running = go_on();
        break;
      }
    }
  }
  end_stretch();
  report.wall_s += Seconds(Clock::now() - wall_begin).count();
  answer_the_rest();
  return std::move(status_);
}

/// The one place that says what a state of the session means. An order that comes later acts in the next round.
Session::Step Session::next_step() const {
  const std::lock_guard lock(mutex_);
  if (quit_) return Step::leave;
  if (pending_.any()) return Step::process_order;
  if (seek_ == Seek::cancelled) return Step::end_seek;
  if (seek_ == Seek::active && simulation_->now() >= *target_) return Step::end_seek;
  if (is_over()) return Step::end;
  return seek_ == Seek::none && mode_ == Mode::paused ? Step::pause : Step::tick;
}

/// Whether the run cannot tick any more: it failed, has a reason to stop, or the input log ends here.
bool Session::is_over() const {
  return !status_ || simulation_->stop_reason() ||
         (options_.input_log && simulation_->tick_index() >= past_.last_tick);
}

// -------------------------------------------------------------------------------------------------------- orders

/// Carries out one pending order: a load before a reset before a jump. @pre one is pending
void Session::process_order() {
  Status status;
  std::unique_lock lock(mutex_);
  if (!pending_.loads.empty()) {
    std::vector<Load> loads = std::exchange(pending_.loads, {});
    lock.unlock();
    status = load_last(std::move(loads));
  } else if (std::exchange(pending_.reset, false)) {
    lock.unlock();
    status = reset_world();
  } else {
    const Time to = *std::exchange(pending_.jump, std::nullopt);
    target_ = to;
    seek_ = Seek::active;
    lock.unlock();
    status = go_back(to);
    if (status) clear_end();
    else drop_target();
  }
  if (!status) {
    const std::lock_guard again(mutex_);
    report_.reason = status.error().text();
  }
  refresh_report();
  if (on_change) on_change();
}

Status Session::load_last(std::vector<Load> loads) {
  const Load load = std::move(loads.back());
  loads.pop_back();
  for (const Load& other : loads)
    if (other.done) other.done(Error{"another one was asked for meanwhile"});
  Status status = may_rewind();
  if (status && !options_.may_not_load.empty())
    status = Error{"no snapshot can be loaded: " + options_.may_not_load};
  if (status && options_.input_log) status = Error{"this is a recording: nothing can be loaded into it"};
  // The snapshot may be anybody's: it starts no process, nor does a reset to it.
  if (status) options_.simulation.start_programs = false;
  if (status) status = replace(load.bytes, "loaded");
  if (status) {
    past_ = {};
    history_.clear();
    history_bytes_ = 0;
    begins_late_ = false;
    history_gap_s_ = options_.history_every_s;
    rerun_until_ = 0;
    note_first_entities();
    keep_snapshot();
    clear_end();
    drop_target();
    const std::lock_guard lock(mutex_);
    report_.begin = simulation_->now();
  }
  if (load.done) load.done(status);
  return status;
}

Status Session::reset_world() {
  SL_TRY(restore_kept(0, "reset"));
  forget_future();
  clear_end();
  drop_target();
  return {};
}

/// The world was replaced: it has neither failed nor ended.
void Session::clear_end() {
  const std::lock_guard lock(mutex_);
  report_.reason.clear();
  status_ = {};
}

void Session::drop_target() {
  const std::lock_guard lock(mutex_);
  seek_ = Seek::none;
  target_.reset();
}

/// Ends a jump: its target is reached, or an order cancelled it on its way.
void Session::end_seek() {
  drop_target();
  forget_future();
  refresh_report();
  if (on_change) on_change();
}

void Session::end_run() {
  drop_target();
  {
    const std::lock_guard lock(mutex_);
    stop_stepping();
    if (status_) report_.reason = simulation_->stop_reason().value_or("the recording ends here");
  }
  set_state(status_ ? State::ended : State::failed);
  refresh_report();
}

/// Sleeps until something comes, or it is time to call keep_going again.
void Session::wait_for_order() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, nap, [&] { return woken_; });
}

// --------------------------------------------------------------------------------------------------------- ticks

/// Waits until the next tick is due. Seeking, stepping and a run without a speed wait for nothing.
/// @param measured  set to the length of the tick where the clock measures it
/// @return false: it is not due yet; something else came first
bool Session::wait_until_due(Pacer& pacer, RunReport& report, std::optional<Time>& measured) {
  // Clients' time runs from the step on, whenever the tick is due.
  if (!options_.input_log && !rerunning()) {
    simulation_->connect_programs();
    if (const auto deadline = simulation_->await_clients()) {
      set_state(State::playing);
      std::unique_lock lock(mutex_);
      changed_.wait_until(lock, std::min(*deadline, Clock::now() + nap), [&] { return woken_; });
      return false;
    }
  }
  std::unique_lock lock(mutex_);
  const bool hurried = seek_ == Seek::active || mode_ == Mode::stepping;
  // The clock is that of the present world. An input log holds the lengths of its ticks: it is paced like a fixed clock.
  const model::Clock& clock = simulation_->setup().clock;
  const bool continuous = clock.mode == model::Clock::Mode::continuous && !options_.input_log;
  if (std::exchange(pacer.factor, pace_.factor) != pace_.factor) pacer.forget();
  const State state = seek_ == Seek::active ? State::seeking : State::playing;
  const std::optional<double> factor = pace_.factor;
  lock.unlock();
  set_state(state);

  const Time now = simulation_->now();
  if (continuous) measured = simulation_->setup().step;
  if (hurried || (!factor && !continuous)) {
    if (hurried) pacer.forget();
    pacer.begin(now);
    return true;
  }
  const double speed = factor.value_or(1);
  const bool first = !pacer.set;
  pacer.begin(now);
  const auto due = continuous ? pacer.cycle_begin + wall(clock.min_step.s() / speed) : pacer.due(now, speed);
  const auto present = Clock::now();
  if (due > present) {
    lock.lock();
    changed_.wait_until(lock, std::min(due, present + nap), [&] { return woken_; });
    if (woken_ || Clock::now() < due) return false;
  } else if (!continuous) {
    // A run that falls far behind does not race to catch up: its clock begins again.
    constexpr double resync_s = 1.0;
    const double behind_s = Seconds(present - due).count();
    if (behind_s * speed > simulation_->setup().step.s()) ++report.late_ticks;
    if (behind_s > resync_s) pacer.forget();
  }
  // A continuous tick is as long as the cycle before it took, waiting included; the first one has none before it.
  if (continuous && !first) {
    const auto at = Clock::now();
    measured = Time::from_s(Seconds(at - pacer.cycle_begin).count() * speed);
    if (*measured > clock.max_step) ++report.late_ticks;
    pacer.cycle_begin = at;
  }
  return true;
}

void Session::run_tick(Pacer& pacer, RunReport& report, std::optional<Time> measured) {
  {
    const std::lock_guard lock(mutex_);
    if (seek_ != Seek::active && mode_ == Mode::stepping && --steps_left_ == 0) mode_ = Mode::paused;
  }
  const bool measures = !step_observers_.empty() && !rerunning();
  const Clock::time_point begin = measures ? Clock::now() : Clock::time_point();
  const Time before = simulation_->now();
  status_ = advance(measured, report);
  if (measures && status_) report_step(before, begin);
  const double factor = pacer.real_time_factor(simulation_->now());
  {
    const std::lock_guard lock(mutex_);
    report_.late_ticks = report.late_ticks;
    report_.real_time_factor = factor;
    // The reason of an order that failed is shown until the run goes on.
    report_.reason = status_ ? "" : status_.error().text();
  }
  if (status_) keep_snapshot();
}

void Session::report_step(Time before, Clock::time_point begin) {
  const Clock::time_point end = Clock::now();
  StepTime step{.now = simulation_->now(), .compute_s = Seconds(end - begin).count()};
  step.step = step.now - before;
  if (step_end_) step.wall_s = Seconds(end - *step_end_).count();
  step_end_ = end;
  for (StepObserver* const each : step_observers_) each->on_step(step);
}

void Session::end_stretch() {
  if (!step_end_) return;
  step_end_.reset();
  for (StepObserver* const each : step_observers_) each->on_stretch_end();
}

Status Session::advance(std::optional<Time> measured, RunReport& report) {
  const bool rerun = rerunning();
  // What ran outside is in the log as far as that goes; then it begins again.
  if (!options_.input_log && !rerun) simulation_->connect_programs();
  if (options_.input_log || rerun)
    if (const std::optional<Time> logged = feed_input_log()) measured = logged;
  const Time before = simulation_->now();
  Status status = options_.tick ? options_.tick(*simulation_, measured) : simulation_->tick(measured);
  const Time length = simulation_->now() - before;
  report.shortest = ++report.ticks == 1 ? length : std::min(report.shortest, length);
  report.longest = std::max(report.longest, length);
  report.sim_s += length.s();
  if (rerun && !rerunning()) forget_future();
  answer_outcomes();
  return status;
}

/// Calls `done` of the requests that the latest tick carried out.
void Session::answer_outcomes() {
  std::vector<std::pair<Waiting, const Outcome*>> answers;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return;
    for (const Outcome& outcome : simulation_->outcomes()) {
      if (outcome.source.is_inside()) continue;  // they count by themselves
      const auto found = waiting_.find(outcome.sequence);
      if (found == waiting_.end()) continue;
      answers.emplace_back(std::move(found->second), &outcome);
      waiting_.erase(found);
    }
  }
  for (const auto& [answer, outcome] : answers) answer(*outcome);
}

/// Runs the tasks that are waiting now. When `patience` is over, the rest waits for the next round, so that viewers who ask
/// for much delay a tick by no more than one of their tasks.
void Session::run_tasks(std::chrono::milliseconds patience) {
  const auto end = Clock::now() + patience;
  std::unique_lock lock(mutex_);
  // Not those that come meanwhile: what a task has ordered acts before them.
  std::size_t left = tasks_.size();
  woken_ = false;  // before the tasks and not after: what comes while they run must wake the loop again
  for (bool first = true; left > 0 && (first || Clock::now() < end); --left, first = false) {
    auto task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task(*this);
    task = nullptr;  // its captures may answer when they are destroyed: not under the lock
    lock.lock();
  }
  woken_ = woken_ || !tasks_.empty();
}

/// After the last round: runs all tasks, and refuses requests and loads that were not carried out.
void Session::answer_the_rest() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  run_tasks(std::chrono::hours(1));
  std::map<std::uint64_t, Waiting> waiting;
  std::vector<Load> loads;
  {
    const std::lock_guard lock(mutex_);
    std::swap(waiting, waiting_);
    std::swap(loads, pending_.loads);
  }
  const Error over{"the run has ended"};
  for (const auto& [sequence, answer] : waiting) answer({{}, sequence, over});
  for (const Load& load : loads)
    if (load.done) load.done(over);
}

}  // namespace sandlot
