#include "app/papers/step_timers.h"

#include <sandlot_client/clock.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace sandlot::app {
namespace {

constexpr std::size_t warm_up = 64;
constexpr double tolerance_s = 1e-9;

/// Fraction of a gap at which the k-th timer is set: spreads evenly over all of them (golden ratio).
double phase(std::size_t k) {
  const double x = static_cast<double>(k) * 0.6180339887498949;
  return x - std::floor(x);
}

/// Ends of the ticks by the wall clock and in simulated time, from 0 on.
struct Course {
  std::vector<double> wall_s{0}, sim_s{0};

  explicit Course(const Stretch& stretch) {
    for (std::size_t i = 0; i < stretch.size(); ++i) {
      wall_s.push_back(wall_s.back() + stretch.wall_s[i]);
      sim_s.push_back(sim_s.back() + stretch.step_s[i]);
    }
  }
  /// Unset: after the end.
  std::optional<double> sim_at(double wall) const {
    const auto next = std::upper_bound(wall_s.begin(), wall_s.end(), wall);
    if (next == wall_s.end() || next == wall_s.begin()) return std::nullopt;
    const auto i = static_cast<std::size_t>(next - wall_s.begin());
    return sim_s[i - 1] + (sim_s[i] - sim_s[i - 1]) * (wall - wall_s[i - 1]) / (wall_s[i] - wall_s[i - 1]);
  }
};

struct Average {
  double sum = 0;
  std::size_t count = 0;
  void add(double x) {
    sum += x;
    ++count;
  }
  double value() const { return count == 0 ? 0 : sum / static_cast<double>(count); }
};

struct Pending {
  double target_s = 0;
  std::size_t interval = 0;
};

std::vector<TimerErrors> timer_errors(const std::vector<Average>& planned,
                                      const std::vector<Average>& adapting) {
  std::vector<TimerErrors> out;
  for (std::size_t i = 0; i < planned.size(); ++i)
    out.push_back({planned[i].value(), adapting[i].value(), adapting[i].count});
  return out;
}

/// The last tick of each message.
std::vector<std::size_t> messages_of(const Stretch& stretch, double message_s) {
  std::vector<std::size_t> last;
  double since_s = 0;
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    since_s += stretch.wall_s[i];
    if (message_s > 0 && since_s < message_s - stretch.wall_s[i] / 2) continue;
    last.push_back(i);
    since_s = 0;
  }
  return last;
}

}  // namespace

Stretch longest_stretch(std::span<const StepTime> trace) {
  Stretch longest, stretch;
  for (const StepTime& step : trace) {
    if (!step.wall_s) {
      if (stretch.size() > longest.size()) longest = std::move(stretch);
      stretch = {};
      stretch.begin_s = step.now.s();
    } else {
      if (stretch.size() == 0) stretch.begin_s = (step.now - step.step).s();
      stretch.step_s.push_back(step.step.s());
      stretch.wall_s.push_back(std::max(*step.wall_s, 1e-9));
    }
  }
  return stretch.size() > longest.size() ? stretch : longest;
}

std::vector<double> smoothed_speeds(const Stretch& stretch, std::size_t window) {
  std::vector<double> out;
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    const std::size_t first = i + 1 > window ? i + 1 - window : 0;
    double sum = 0;
    for (std::size_t k = first; k <= i; ++k) sum += stretch.step_s[k] / stretch.wall_s[k];
    out.push_back(sum / static_cast<double>(i + 1 - first));
  }
  return out;
}

std::vector<TimerErrors> timer_errors(const Stretch& stretch, std::span<const double> intervals_s,
                                      double message_s) {
  const Course course(stretch);
  double wall_s = 0;
  sandlot_client::Clock clock([&] { return wall_s; });
  std::vector<Average> planned(intervals_s.size()), adapting(intervals_s.size());
  std::vector<Pending> pending;
  const auto missed = [&](const Pending& timer, double fired_wall_s) -> std::optional<double> {
    const auto fired_at_s = course.sim_at(fired_wall_s);
    if (!fired_at_s) return std::nullopt;
    return std::abs(*fired_at_s - timer.target_s) / intervals_s[timer.interval];
  };
  /// Fires what is due within [from, to) of the wall clock.
  const auto fire = [&](double from, double to) {
    std::size_t fired = 0;
    for (; fired < pending.size(); ++fired) {
      const Pending& timer = pending[fired];
      wall_s = from;
      const double at_s = from + clock.wall_s_until(timer.target_s);
      if (at_s >= to) break;
      wall_s = at_s;
      if (clock.now_s() < timer.target_s - tolerance_s) break;
      if (const auto error = missed(timer, at_s)) adapting[timer.interval].add(*error);
      from = at_s;
    }
    pending.erase(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(fired));
  };
  const double longest_s = *std::max_element(intervals_s.begin(), intervals_s.end());
  const std::vector<std::size_t> messages = messages_of(stretch, message_s);
  std::size_t first = 0, timers = 0;
  for (std::size_t m = 0; m + 1 < messages.size(); ++m) {
    const std::size_t last = messages[m] + 1;
    const std::vector<double> walls(stretch.wall_s.begin() + static_cast<std::ptrdiff_t>(first),
                                    stretch.wall_s.begin() + static_cast<std::ptrdiff_t>(last));
    const double step_s = (course.sim_s[last] - course.sim_s[first]) / static_cast<double>(last - first);
    const double begin = course.wall_s[last], end = course.wall_s[messages[m + 1] + 1];
    wall_s = begin;
    clock.take(course.sim_s[last], step_s, walls, begin);
    // Room for a timer that is late by half its time, so that late ones are not left out more than early ones.
    if (last >= warm_up && course.sim_s[last] + 1.5 * longest_s < course.sim_s.back()) {
      const double begin_s = course.sim_s[last] -
                             phase(++timers) * (course.sim_s[last] - course.sim_s[first]);
      for (std::size_t i = 0; i < intervals_s.size(); ++i) {
        const Pending timer{begin_s + intervals_s[i], i};
        if (const auto error = missed(timer, begin + clock.wall_s_until(timer.target_s)))
          planned[i].add(*error);
        pending.push_back(timer);
      }
      std::stable_sort(pending.begin(), pending.end(),
                       [](const Pending& a, const Pending& b) { return a.target_s < b.target_s; });
    }
    first = last;
    fire(begin, end);
  }
  return timer_errors(planned, adapting);
}

std::vector<TimerErrors> fixed_window_errors(const Stretch& stretch, std::size_t window, Mean mean,
                                             std::span<const double> intervals_s) {
  const Course course(stretch);
  const std::size_t count = stretch.size();
  std::vector<double> speeds = smoothed_speeds(stretch, window);
  if (mean == Mean::times)
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t first = i + 1 > window ? i + 1 - window : 0;
      speeds[i] = (course.sim_s[i + 1] - course.sim_s[first]) / (course.wall_s[i + 1] - course.wall_s[first]);
    }
  /// When a clock with the estimate of tick i expects a time.
  const auto expected = [&](std::size_t i, double time_s) {
    return course.wall_s[i + 1] + std::max(0.0, time_s - course.sim_s[i + 1]) / speeds[i];
  };
  std::vector<Average> planned(intervals_s.size()), adapting(intervals_s.size());
  const double longest_s = *std::max_element(intervals_s.begin(), intervals_s.end());
  std::size_t timers = 0;
  for (std::size_t i = warm_up - 1; i + 1 < count; ++i) {
    if (course.sim_s[i + 1] + 1.5 * longest_s >= course.sim_s.back()) break;
    const double begin_s = course.sim_s[i + 1] - phase(++timers) * stretch.step_s[i];
    for (std::size_t k = 0; k < intervals_s.size(); ++k) {
      const double target_s = begin_s + intervals_s[k];
      const auto miss = [&](double wall_s) -> std::optional<double> {
        const auto at_s = course.sim_at(wall_s);
        if (!at_s) return std::nullopt;
        return std::abs(*at_s - target_s) / intervals_s[k];
      };
      if (const auto error = miss(expected(i, target_s))) planned[k].add(*error);
      // The last message before it comes; the next one is there at the latest when it has come.
      std::size_t before = i;
      while (before + 2 < count && course.sim_s[before + 2] < target_s) ++before;
      const double end = course.wall_s[before + 2];
      if (const auto error = miss(std::min(expected(before, target_s), end))) adapting[k].add(*error);
    }
  }
  return timer_errors(planned, adapting);
}

}  // namespace sandlot::app
