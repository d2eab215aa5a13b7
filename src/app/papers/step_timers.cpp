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

struct Mean {
  double sum = 0;
  std::size_t count = 0;
  void add(double x) {
    sum += x;
    ++count;
  }
  double value() const { return count == 0 ? 0 : sum / static_cast<double>(count); }
};

struct Pending {
  double target_s = 0, set_at_s = 0;  ///< by the clock; true simulated time
  std::size_t interval = 0;
};

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

std::vector<TimerErrors> timer_errors(const Stretch& stretch, const std::vector<std::size_t>& windows,
                                      std::span<const double> intervals_s, double message_s) {
  const Course course(stretch);
  double wall_s = 0;
  sandlot_client::Clock clock([&] { return wall_s; }, {}, windows);
  std::vector<Mean> planned(intervals_s.size()), adapting(intervals_s.size());
  std::vector<Pending> pending;
  const auto error = [&](std::size_t interval, double set_at_s,
                         double fired_wall_s) -> std::optional<double> {
    const auto fired_at_s = course.sim_at(fired_wall_s);
    if (!fired_at_s) return std::nullopt;
    return std::abs(*fired_at_s - set_at_s - intervals_s[interval]) / intervals_s[interval];
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
      if (const auto missed = error(timer.interval, timer.set_at_s, at_s))
        adapting[timer.interval].add(*missed);
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
    first = last;
    const double begin = course.wall_s[last], end = course.wall_s[messages[m + 1] + 1];
    wall_s = begin;
    clock.take(course.sim_s[last], step_s, walls, begin);
    if (last < warm_up) continue;
    const double set_wall_s = begin + phase(++timers) * (end - begin);
    fire(begin, set_wall_s);
    wall_s = set_wall_s;
    const double set_at_s = *course.sim_at(set_wall_s), shown_s = clock.now_s();
    // Room for a timer that is late by half its time, so that late ones are not left out more than early ones.
    if (set_at_s + 1.5 * longest_s < course.sim_s.back())
      for (std::size_t i = 0; i < intervals_s.size(); ++i) {
        const double target_s = shown_s + intervals_s[i];
        const double plan_s = set_wall_s + clock.wall_s_until(target_s);
        if (const auto missed = error(i, set_at_s, plan_s)) planned[i].add(*missed);
        pending.push_back({target_s, set_at_s, i});
      }
    std::stable_sort(pending.begin(), pending.end(),
                     [](const Pending& a, const Pending& b) { return a.target_s < b.target_s; });
    fire(set_wall_s, end);
  }
  std::vector<TimerErrors> out;
  for (std::size_t i = 0; i < intervals_s.size(); ++i)
    out.push_back({planned[i].value(), adapting[i].value(), adapting[i].count});
  return out;
}

std::vector<double> errors_by_mean_speed(const Stretch& stretch, std::size_t window,
                                         std::span<const double> intervals_s) {
  const Course course(stretch);
  const std::vector<double> speeds = smoothed_speeds(stretch, window);
  std::vector<Mean> means(intervals_s.size());
  const double longest_s = *std::max_element(intervals_s.begin(), intervals_s.end());
  std::size_t timers = 0;
  for (std::size_t i = warm_up - 1; i + 1 < stretch.size(); ++i) {
    const double begin = course.wall_s[i + 1], gap = stretch.wall_s[i + 1];
    const double passed_s = phase(++timers) * gap;
    const double set_at_s = *course.sim_at(begin + passed_s);
    if (set_at_s + 1.5 * longest_s >= course.sim_s.back()) break;
    const double shown_s = course.sim_s[i + 1] + std::min(passed_s * speeds[i], stretch.step_s[i]);
    for (std::size_t k = 0; k < intervals_s.size(); ++k) {
      const double plan_s = begin + (shown_s + intervals_s[k] - course.sim_s[i + 1]) / speeds[i];
      const auto fired_at_s = course.sim_at(plan_s);
      if (fired_at_s) means[k].add(std::abs(*fired_at_s - set_at_s - intervals_s[k]) / intervals_s[k]);
    }
  }
  std::vector<double> out;
  for (const Mean& each : means) out.push_back(each.value());
  return out;
}

}  // namespace sandlot::app
