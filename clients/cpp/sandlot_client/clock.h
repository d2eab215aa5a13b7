#pragma once
/// Simulated time for programs: clock, estimate of the simulation's speed, interval timers, sleep_until. C++17, standard library only.
///
///   sandlot_client::Clock clock({}, [&](double s) { connection.poll(s); });        // waits, and meanwhile calls take()
///   clock.take(stamp_s, step_s, wall_s, arrival_s, restarted);                     // for each message of /sandlot/step_times
///   sandlot_client::IntervalTimer timer = clock.timer(0.1);
///   while (true) timer.wait();                                                     // every 100 ms of simulated time
///
/// The server sends how long its latest steps took. From them follows the speed, simulated seconds per second of the wall clock, and
/// from the speed the time between two messages and how long a simulated interval will take.
///
/// Speed      over the last 5, 10, 20 or 50 steps: simulated time over wall time, or the mean of the speeds of the steps. For each length
///            of interval (1, 2, 4 ... 64 steps) the one of these eight is used whose predictions had the least mean relative
///            error recently. Before the first interval: 1.
/// Time       now_s() goes on from the latest message at that speed. It never exceeds the stamp by more than the longest of the last 8
///            messages covered: a run that stalls or is paused holds it there. It never goes back, unless the run is rewound.
/// Arrival    of a message that comes late among the last 32 the delay beyond the smallest one is removed.
/// Timers     fire at begin + k * period, with no drift, and plan again at each message.
/// Errors     a timer fires up to one message's span early or late in simulated time (a step, where each step has a message of its
///            own). What cannot be foreseen stays: a step that takes much longer than those before it.
/// Limits     the smallest delay from server to client is not known: all times lag by it. After a pause the intervals before it count.
/// Threads    none; whoever calls from several holds a lock.
/// Twins      clients/python/sandlot_client/clock.py does the same arithmetic in the same order; a test compares them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace sandlot_client {

class IntervalTimer;

/// Clock of simulated time, fed with step times.
class Clock {
 public:
  using Wall = std::function<double()>;
  using Wait = std::function<void(double)>;

  /// @param wall     the wall clock that arrivals are measured with [s]; unset: std::chrono::steady_clock
  /// @param wait     waits up to so many seconds and takes messages meanwhile; may return early; unset: sleeps
  /// @param windows  numbers of steps to average over, of which the best is used; not empty, each above 0
  explicit Clock(Wall wall = {}, Wait wait = {}, std::vector<std::size_t> windows = {5, 10, 20, 50})
      : wall_(wall ? std::move(wall) : Wall(steady_s)),
        wait_(wait ? std::move(wait) : Wait(sleep)),
        windows_(std::move(windows)) {
    for (const std::size_t window : windows_)
      if (window == 0) throw std::invalid_argument("a window has at least one step");
    if (windows_.empty()) throw std::invalid_argument("a clock needs a window");
    history_ = *std::max_element(windows_.begin(), windows_.end()) + horizons[horizon_count - 1] + 1;
    for (std::size_t h = 0; h < horizon_count; ++h) {
      errors_.emplace_back(2 * windows_.size(), 0.0);
      best_.push_back(0);
    }
  }

  /// Takes a message of step times.
  /// @param wall_s     wall time of each step [s]; with `restarted` the first step has none
  /// @param arrival_s  when it came, by the wall clock; unset: now
  void take(double stamp_s, double step_s, const std::vector<double>& wall_s,
            std::optional<double> arrival_s = {}, bool restarted = false) {
    const double came_s = arrival_s ? *arrival_s : wall_();
    const std::size_t steps = wall_s.size() + (restarted ? 1 : 0);
    const double span_s = static_cast<double>(steps) * step_s;
    bool follows = messages_ > 0 && !restarted;
    if (messages_ > 0 && stamp_s < stamp_s_) {
      ++rewinds_;
      shown_s_ = -std::numeric_limits<double>::infinity();
      follows = false;
    } else if (std::abs(stamp_s - stamp_s_ - span_s) > 0.5 * step_s) {
      follows = false;  // messages were lost
    }
    const std::size_t first = wall_s.size() > history_ ? wall_s.size() - history_ : 0;
    const std::size_t stride = wall_s.size() / judged_per_message + 1;
    for (std::size_t i = first; i < wall_s.size(); ++i) {
      add(step_s, std::max(wall_s[i], least_wall_s));
      if ((wall_s.size() - 1 - i) % stride == 0) judge(class_of(static_cast<double>(steps)));
    }
    for (const double each : wall_s) server_s_ += each;
    if (!follows) {
      server_s_ = 0;
      delays_.clear();
    }
    if (delays_.size() == delay_count) delays_.pop_front();
    delays_.push_back(came_s - server_s_);
    if (spans_.size() == span_count) spans_.pop_front();
    spans_.push_back(span_s);
    anchor_s_ = server_s_ + *std::min_element(delays_.begin(), delays_.end());
    stamp_s_ = stamp_s;
    step_s_ = step_s;
    steps_ = std::max<std::size_t>(steps, 1);
    ++messages_;
  }

  /// Simulated seconds per second of the wall clock, as they will be over the next interval of simulated time.
  double speed(double interval_s = 0) const {
    const std::size_t last = sim_sums_.size() - 1;
    if (last == 0) return 1;
    const double steps = std::max(static_cast<double>(steps_), step_s_ > 0 ? interval_s / step_s_ : 0.0);
    return estimate(best_[class_of(steps)], last);
  }

  /// Simulated time now; 0 before the first message.
  double now_s() {
    if (messages_ == 0) return 0;
    const double passed_s = (wall_() - anchor_s_) * speed();
    const double most_s = *std::max_element(spans_.begin(), spans_.end());
    shown_s_ = std::max(shown_s_, stamp_s_ + std::min(std::max(passed_s, 0.0), most_s));
    return shown_s_;
  }

  /// Wall time until a simulated time is reached, as far as can be foreseen now; 0: it is there.
  double wall_s_until(double time_s) {
    if (time_s <= now_s()) return 0;
    const double ahead_s = time_s - stamp_s_;
    return std::max(0.0, anchor_s_ + ahead_s / speed(ahead_s) - wall_());
  }

  /// Waits until a simulated time is reached.
  /// @param timeout_s  wall time
  /// @return false: it was not reached by then, or the run was rewound
  bool sleep_until(double time_s, std::optional<double> timeout_s = {}) {
    const double begin_s = wall_();
    const std::uint64_t rewinds = rewinds_;
    while (now_s() < time_s - slack_s && rewinds_ == rewinds) {
      double left_s = std::min(std::max(wall_s_until(time_s), shortest_nap_s), longest_nap_s);
      if (timeout_s) {
        const double still_s = begin_s + *timeout_s - wall_();
        if (still_s <= 0) return false;
        left_s = std::min(left_s, still_s);
      }
      wait_(left_s);
    }
    return rewinds_ == rewinds;
  }

  /// A timer that fires every so many simulated seconds, from now on. It must not outlive the clock.
  IntervalTimer timer(double period_s);

  std::uint64_t messages() const { return messages_; }
  /// How often the run was rewound.
  std::uint64_t rewinds() const { return rewinds_; }

 private:
  friend class IntervalTimer;
  static constexpr std::size_t horizon_count = 7;
  static constexpr std::size_t horizons[horizon_count] = {1, 2, 4, 8, 16, 32, 64};
  static constexpr double keep =
      1.0 / 256;  ///< weight of the latest error of a prediction: the last 256 or so count
  static constexpr std::size_t span_count = 8, delay_count = 32, judged_per_message = 8;
  static constexpr double least_period_s = 1e-6;
  static constexpr double least_wall_s = 1e-9, shortest_nap_s = 0.0005, longest_nap_s = 0.02, slack_s = 1e-9;

  static double steady_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  static void sleep(double s) { std::this_thread::sleep_for(std::chrono::duration<double>(s)); }

  /// Number of the longest horizon that is not above so many steps.
  static std::size_t class_of(double steps) {
    std::size_t h = 0;
    while (h + 1 < horizon_count && static_cast<double>(horizons[h + 1]) <= steps) ++h;
    return h;
  }

  void add(double step_s, double wall_s) {
    sim_sums_.push_back(sim_sums_.back() + step_s);
    wall_sums_.push_back(wall_sums_.back() + wall_s);
    speed_sums_.push_back(speed_sums_.back() + step_s / wall_s);
    if (sim_sums_.size() <= 4 * history_) return;
    const auto old = static_cast<std::ptrdiff_t>(sim_sums_.size() - history_);
    for (std::vector<double>* const sums : {&sim_sums_, &wall_sums_, &speed_sums_})
      sums->erase(sums->begin(), sums->begin() + old);
  }

  /// Compares what each estimate predicted for the latest steps with what they took.
  /// @param of_message  horizon of the steps between two messages: what lasts no longer is planned no more, and a clock that is ahead
  ///                    waits there as long as one that is behind lags
  void judge(std::size_t of_message) {
    const std::size_t last = sim_sums_.size() - 1;
    for (std::size_t h = 0; h < horizon_count && last > horizons[h]; ++h) {
      const std::size_t then = last - horizons[h];
      const double sim_s = sim_sums_[last] - sim_sums_[then], took_s = wall_sums_[last] - wall_sums_[then];
      std::vector<double>& errors = errors_[h];
      std::size_t best = 0;
      for (std::size_t i = 0; i < errors.size(); ++i) {
        const double ratio = sim_s / estimate(i, then) / took_s;
        const double error = h > of_message || ratio < 1 ? std::abs(ratio - 1) : 1 - 1 / ratio;
        errors[i] += keep * (error - errors[i]);
        if (errors[i] < errors[best]) best = i;
      }
      best_[h] = best;
    }
  }

  /// Speed by the intervals up to `last`, as many as the window holds or as there are. Even numbers: simulated time over wall time;
  /// odd ones: mean of the speeds of the steps.
  double estimate(std::size_t number, std::size_t last) const {
    const std::size_t window = windows_[number / 2];
    const std::size_t first = last > window ? last - window : 0;
    if (number % 2 == 1) return (speed_sums_[last] - speed_sums_[first]) / static_cast<double>(last - first);
    return (sim_sums_[last] - sim_sums_[first]) / (wall_sums_[last] - wall_sums_[first]);
  }

  Wall wall_;
  Wait wait_;
  std::vector<std::size_t> windows_;
  std::size_t history_ = 0;  ///< intervals that are needed
  /// Sums of simulated time, wall time and speed over the intervals known, oldest first.
  std::vector<double> sim_sums_{0.0}, wall_sums_{0.0}, speed_sums_{0.0};
  std::vector<std::vector<double>> errors_;  ///< by horizon and estimate
  std::vector<std::size_t> best_;            ///< estimate by horizon
  double stamp_s_ = 0, step_s_ = 0;
  std::size_t steps_ = 1;      ///< of the latest message
  std::deque<double> spans_;   ///< simulated time of the latest messages
  double server_s_ = 0;        ///< wall time of the server since messages follow each other
  std::deque<double> delays_;  ///< of the latest messages, but for a constant
  double anchor_s_ = 0;        ///< wall time of `stamp_s_`
  double shown_s_ = -std::numeric_limits<double>::infinity();  ///< latest answer of now_s()
  std::uint64_t messages_ = 0, rewinds_ = 0;
};

/// Timer of simulated time, at begin + k * period. After a rewind it begins again there.
class IntervalTimer {
 public:
  IntervalTimer(Clock& clock, double period_s) : clock_(&clock), period_s_(period_s) {
    if (!(period_s >= Clock::least_period_s) || !std::isfinite(period_s))
      throw std::invalid_argument("a period is a number of seconds, at least a millionth");
    restart();
  }
  double period_s() const { return period_s_; }
  /// Simulated time of the next firing.
  double next_s() const { return begin_s_ + static_cast<double>(count_) * period_s_; }
  /// Wall time until the next firing, as planned now.
  double wall_s_left() const { return clock_->wall_s_until(next_s()); }

  /// How many periods have ended since it was last asked; does not wait.
  std::uint64_t poll() {
    if (rewinds_ != clock_->rewinds_ || (!begun_ && clock_->messages_ > 0)) restart();
    const double now_s = clock_->now_s() + Clock::slack_s;
    if (now_s < next_s()) return 0;
    const auto reached = static_cast<std::uint64_t>((now_s - begin_s_) / period_s_);
    const std::uint64_t ended = std::max<std::uint64_t>(reached + 1 - std::min(count_, reached), 1);
    count_ += ended;
    return ended;
  }

  /// Waits for the next firing. @return 0: it did not come within the timeout; above 1: so many have passed meanwhile
  std::uint64_t wait(std::optional<double> timeout_s = {}) {
    const double begin_s = clock_->wall_();
    while (true) {
      if (const std::uint64_t ended = poll(); ended > 0) return ended;
      std::optional<double> still_s;
      if (timeout_s) still_s = begin_s + *timeout_s - clock_->wall_();
      if (still_s && *still_s <= 0) return 0;
      clock_->sleep_until(next_s(), still_s);
    }
  }

 private:
  void restart() {
    rewinds_ = clock_->rewinds_;
    begun_ = clock_->messages_ > 0;
    begin_s_ = clock_->now_s();
    count_ = 1;
  }

  Clock* clock_;
  double period_s_, begin_s_ = 0;
  std::uint64_t count_ = 1;  ///< of the next firing
  std::uint64_t rewinds_ = 0;
  bool begun_ = false;  ///< the clock had a message when it began
};

inline IntervalTimer Clock::timer(double period_s) { return IntervalTimer(*this, period_s); }

}  // namespace sandlot_client
