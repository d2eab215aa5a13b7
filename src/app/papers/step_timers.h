#pragma once
/// Interval timers on recorded step times: how far they miss, for clocks that average over various numbers of steps.
///
/// Truth     simulated time grows evenly between the ends of two ticks.
/// Timers    one per message and interval, set when the message comes; what they count from is spread evenly over its ticks.
///           `planned`: fires when the estimate of that moment says; `adapting`: plans again at each message, as IntervalTimer does.
/// Error     |simulated time when it fires - time it was set for| / interval, mean over the timers.
/// Limits    messages arrive without delay. Timers at the end of a stretch that would fire after it are left out, and so are the first
///           64 steps.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/session/step_times.h"

namespace sandlot::app {

/// Ticks that follow each other without a pause; the first one, without an interval, is left out.
struct Stretch {
  double begin_s = 0;  ///< simulated time at the beginning of the first tick
  std::vector<double> step_s, wall_s;
  std::size_t size() const { return wall_s.size(); }
};
/// The longest stretch of a trace.
Stretch longest_stretch(std::span<const StepTime> trace);

/// Mean of the `window` speeds (step over wall time) up to each tick, as the paper smooths them; of fewer at the beginning.
std::vector<double> smoothed_speeds(const Stretch& stretch, std::size_t window);

struct TimerErrors {
  double planned = 0, adapting = 0;  ///< mean errors, fractions of the interval
  std::size_t count = 0;
};

/// Timers by the clock of clients/cpp.
/// @param message_s  wall time between messages; 0: each step has its own
/// @return one per interval
std::vector<TimerErrors> timer_errors(const Stretch& stretch, std::span<const double> intervals_s,
                                      double message_s = 0);

/// Estimate of the speed from a window of steps.
enum class Mean : std::uint8_t {
  speeds,  ///< mean of the speeds of the steps, as in the paper
  times,   ///< simulated time over wall time
};
/// Timers by one estimate throughout, a message per step; without the code of the clock.
std::vector<TimerErrors> fixed_window_errors(const Stretch& stretch, std::size_t window, Mean mean,
                                             std::span<const double> intervals_s);

}  // namespace sandlot::app
