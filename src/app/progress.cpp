#include "app/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "sim/world/simulation.h"

namespace sandlot::app {

Progress::Progress() : shown_(isatty(STDERR_FILENO)) {}

void Progress::clear() {
  if (std::exchange(drawn_, false)) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(const Simulation& simulation) {
  if (!shown_) return;
  const auto now = std::chrono::steady_clock::now();
  if (drawn_ && now - last_ < std::chrono::milliseconds(200)) return;
  if (!drawn_) begin_ = now, sim_begin_ = simulation.now();
  last_ = now;
  drawn_ = true;
  const double wall_s = std::chrono::duration<double>(now - begin_).count();
  const double done_s = (simulation.now() - sim_begin_).s();
  const std::optional<Time> end = simulation.setup().stop;
  std::string line = fmt::format("\r\x1b[K{:.1f} s", simulation.now().s());
  if (wall_s > 0) line += fmt::format("  {:.1f} x real time", done_s / wall_s);
  if (end && done_s > 0)
    line += fmt::format("  {:.0f} % done, {:.0f} s left", 100.0 * simulation.now().s() / end->s(),
                        (end->s() - simulation.now().s()) * wall_s / done_s);
  std::fputs(line.c_str(), stderr);
}

}  // namespace sandlot::app
