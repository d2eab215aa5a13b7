#include "sim/session/runner.h"

#include <algorithm>
#include <chrono>
#include <thread>

namespace sandlot {

Status run(Simulation& simulation, const Pace& pace, RunReport& report,
           const std::function<bool(const Simulation&)>& keep_going, Experiment* experiment) {
  using std::chrono::duration;
  using std::chrono::steady_clock;
  const auto begin = steady_clock::now();
  const Time sim_begin = simulation.now();
  const std::uint64_t tick_begin = simulation.tick_index();
  // When the program falls far behind it does not race to catch up: the clock is set anew.
  constexpr double resync_s = 1.0;
  auto origin = begin;
  Time sim_origin = sim_begin;
  Status status;
  const model::Clock& clock = simulation.setup().clock;
  const bool continuous = clock.mode == model::Clock::Mode::continuous;
  std::optional<Time> measured;
  auto cycle_begin = begin;
  while (!simulation.stop_reason()) {
    if (continuous) {
      const double factor = pace.factor.value_or(1);
      const auto shortest = std::chrono::duration_cast<steady_clock::duration>(
          duration<double>(clock.min_step.s() / factor));
      if (simulation.tick_index() != tick_begin) {
        std::this_thread::sleep_until(cycle_begin + shortest);
        const auto now = steady_clock::now();
        measured = Time::from_s(duration<double>(now - cycle_begin).count() * factor);
        if (*measured > clock.max_step) ++report.late_ticks;
        cycle_begin = now;
      } else {
        measured = simulation.setup().step;
      }
    } else if (pace.factor) {
      const double ahead_s = (simulation.now() - sim_origin).s() / *pace.factor;
      const auto due = origin + std::chrono::duration_cast<steady_clock::duration>(duration<double>(ahead_s));
      const auto now = steady_clock::now();
      if (due > now) {
        std::this_thread::sleep_until(due);
      } else {
        const double behind_s = duration<double>(now - due).count();
        if (behind_s * *pace.factor > simulation.setup().step.s()) ++report.late_ticks;
        if (behind_s > resync_s) {
          origin = now;
          sim_origin = simulation.now();
        }
      }
    }
    const Time before = simulation.now();
    status = experiment ? experiment->tick(measured) : simulation.tick(measured);
    const Time length = simulation.now() - before;
    report.shortest = report.ticks + simulation.tick_index() - tick_begin == 1
                          ? length
                          : std::min(report.shortest, length);
    report.longest = std::max(report.longest, length);
    if (!status || (keep_going && !keep_going(simulation))) break;
  }
  report.ticks += simulation.tick_index() - tick_begin;
  report.sim_s += (simulation.now() - sim_begin).s();
  report.wall_s += duration<double>(steady_clock::now() - begin).count();
  return status;
}

}  // namespace sandlot
