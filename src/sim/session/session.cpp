/// Orders and reports of a session: everything that other threads call.
#include "sim/session/session.h"

#include "base/text.h"
#include "sim/session/input_recorder.h"

namespace sandlot {
namespace {

constexpr std::size_t most_tasks = 10'000;

std::string time_text(Time time) { return number_text(time.s()) + " s"; }

}  // namespace

Session::Session(std::unique_ptr<Simulation> simulation, Options options)
    : options_(std::move(options)),
      simulation_(std::move(simulation)),
      history_gap_s_(options_.history_every_s),
      mode_(options_.paused ? Mode::paused : Mode::playing),
      pace_(options_.pace) {
  if (options_.input_log) past_ = std::move(*options_.input_log);
  else input_recorder_ = std::make_unique<InputRecorder>(past_);
  if (input_recorder_ && options_.history_mb > 0) simulation_->add_observer(input_recorder_.get());
  if (options_.history_mb <= 0 && options_.may_not_rewind.empty())
    options_.may_not_rewind = "no snapshots are kept";
  report_.begin = simulation_->now();
  report_.replay = options_.input_log.has_value();
  report_.may_not_rewind = options_.may_not_rewind;
  report_.state = mode_ == Mode::playing ? State::playing : State::paused;
  note_first_entities();
  refresh_report();
}

void Session::note_first_entities() {
  first_serials_ = 0;
  for (const auto& each : std::as_const(*simulation_).entities())
    first_serials_ = std::max(first_serials_, each->serial + 1);
}

Session::~Session() {
  for (Observer* observer : observers_) simulation_->remove_observer(observer);
}

void Session::wake() {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  changed_.notify_all();  // not under the lock, which who is woken needs
}

/// Applies an order under the lock and wakes the loop.
void Session::post_order(const std::function<void()>& apply) {
  {
    const std::lock_guard lock(mutex_);
    apply();
    woken_ = true;
  }
  changed_.notify_all();
  if (on_change) on_change();
}

/// @pre mutex_ is held
void Session::cancel_seek() {
  if (seek_ == Seek::active) seek_ = Seek::cancelled;
}

void Session::play() {
  post_order([&] {
    mode_ = Mode::playing;
    steps_left_ = 0;
  });
}

void Session::pause() {
  post_order([&] {
    mode_ = Mode::paused;
    steps_left_ = 0;
    cancel_seek();
    pending_.jump.reset();
    // At once: a caller that reads the report before the loop comes by must not wait for a tick that will not happen.
    if (report_.state == State::playing || report_.state == State::seeking) report_.state = State::paused;
    report_.real_time_factor = 0;
  });
}

/// A pending jump stays: the steps are taken from its target.
void Session::step(std::uint64_t ticks) {
  SL_CHECK(ticks > 0);
  post_order([&] {
    mode_ = Mode::stepping;
    steps_left_ = ticks;
    cancel_seek();
  });
}

Status Session::set_speed(std::optional<double> factor) {
  if (factor && !(*factor >= 0.001 && *factor <= 1000))
    return Error{"a speed of " + number_text(*factor) + " is out of range", "0.001 to 1000, or max"};
  post_order([&] { report_.speed = pace_.factor = factor; });
  return {};
}

Status Session::may_rewind() const {
  if (options_.may_not_rewind.empty()) return {};
  return Error{"this run cannot be rewound: " + options_.may_not_rewind};
}

Status Session::reset() {
  SL_TRY(may_rewind());
  post_order([&] {
    pending_.reset = true;
    pending_.jump.reset();
    cancel_seek();
    stop_stepping();
  });
  return {};
}

Error Session::forgotten_before(Time kept_from) {
  return {"the history of the run begins at " + time_text(kept_from) + ": input before it was forgotten",
          "a reset goes back to the beginning"};
}

Status Session::jump(Time to) {
  {
    const std::lock_guard lock(mutex_);
    if (to < report_.begin) return Error{"the run begins at " + time_text(report_.begin)};
    if (to < report_.now) SL_TRY(may_rewind());
    if (to < report_.kept_from) return forgotten_before(report_.kept_from);
    const std::optional<Time> end = report_.end;
    if (end && to > *end) return Error{"the run ends at " + time_text(*end)};
  }
  post_order([&] {
    pending_.jump = to;
    stop_stepping();
  });
  return {};
}

/// @pre mutex_ is held
void Session::stop_stepping() {
  if (mode_ == Mode::stepping) mode_ = Mode::paused;
  steps_left_ = 0;
}

void Session::load(std::vector<std::byte> snapshot, std::function<void(const Status&)> done) {
  bool over = false;
  post_order([&] {
    over = !running_;
    if (!over) pending_.loads.push_back({std::move(snapshot), std::move(done)});
  });
  if (over && done) done(Error{"the run has ended"});
}

void Session::quit() {
  post_order([&] { quit_ = true; });
}

Result<std::uint64_t> Session::submit(Request request, Source source, Done done) {
  Waiting waiting;
  if (done) waiting = [done = std::move(done)](const Outcome& outcome) { done(outcome.status); };
  return submit_waiting(std::move(request), source, std::move(waiting));
}

Result<std::uint64_t> Session::call(CallRequest request, Source source, Answer answer) {
  return submit_waiting(std::move(request), source, [answer = std::move(answer)](const Outcome& outcome) {
    if (outcome.status) answer(outcome.response);
    else answer(outcome.status.error());
  });
}

Result<std::uint64_t> Session::submit_waiting(Request request, Source source, Waiting waiting) {
  const std::lock_guard lock(mutex_);
  if (!running_) return Error{"the run has ended"};
  if (!report_.takes_no_input.empty()) return Error{report_.takes_no_input};
  const std::uint64_t sequence = simulation_->submit(std::move(request), source);
  if (waiting) waiting_.emplace(sequence, std::move(waiting));
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

const char* Session::name_of(State state) {
  switch (state) {
    case State::playing: return "playing";
    case State::paused: return "paused";
    case State::seeking: return "seeking";
    case State::ended: return "ended";
    case State::failed: break;
  }
  return "failed";
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

void Session::remove_step_observer(StepObserver* observer) {
  std::erase(step_observers_, observer);
  if (step_observers_.empty()) step_end_.reset();
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
  report_.kept_from = history_.empty() ? report_.begin : kept_from();
  if (report_.history.size() != history_.size() ||
      (!history_.empty() && report_.history.back() != history_.back().now)) {
    report_.history.clear();
    for (const Kept& kept : history_) report_.history.push_back(kept.now);
  }
}

}  // namespace sandlot
