#pragma once
/// Interval timers on recorded step times: how far they miss, for clocks that average over various numbers of steps.
///
/// Truth     simulated time grows evenly between the ends of two ticks.
/// Timers    set at moments spread over all ticks, to what the clock shows then plus the interval. `planned`: fires when the estimate of
///           that moment says; `adapting`: plans again at each message, as IntervalTimer does.
/// Error     |simulated time that passed - interval| / interval, mean over the timers.
/// Limits    messages arrive without delay. Timers at the end of a stretch that would fire after it are left out, and so are the first
///           64 steps.
#include <cstddef>
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

/// @param windows    that the clock chooses from
/// @param message_s  wall time between messages; 0: each step has its own
/// @return one per interval
std::vector<TimerErrors> timer_errors(const Stretch& stretch, const std::vector<std::size_t>& windows,
                                      std::span<const double> intervals_s, double message_s = 0);
/// Errors of planned timers by the paper's estimate: the mean of the latest `window` speeds.
std::vector<double> errors_by_mean_speed(const Stretch& stretch, std::size_t window,
                                         std::span<const double> intervals_s);

}  // namespace sandlot::app
