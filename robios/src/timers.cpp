#include "timers.h"

#include <algorithm>
#include <array>

#include "machine.h"
#include "tasks.h"

namespace robios {
namespace {

struct Timer {
  Task* task = nullptr;
  bool on = false;
};
std::array<Timer, 16> timers;

}  // namespace

int attach_timer(int scale, std::int64_t unit_ns, void (*function)()) {
  if (scale < 1 || !function) return 0;
  for (std::size_t i = 0; i < timers.size(); i++) {
    Timer& timer = timers[i];
    if (timer.on) continue;
    const std::int64_t period = scale * unit_ns, first = machine.clock_ns + period;
    timer.on = true;
    timer.task = make_task(
        "timer",
        [period, first, function, &timer]() -> void* {
          Task* const me = tasks.current;
          for (std::int64_t due = first; timer.on && timer.task == me;) {
            sleep_until(due, Others::run);
            if (!timer.on || timer.task != me) break;
            function();
            // Periods that passed meanwhile are left out.
            due += period * std::max<std::int64_t>(1, (machine.clock_ns - due) / period + 1);
          }
          return nullptr;
        },
        256u << 10, 0, nullptr);
    if (!timer.task) {
      timer.on = false;
      return 0;
    }
    timer.task->timer = timer.task->detached = true;
    start(*timer.task);
    return static_cast<int>(i) + 1;
  }
  return 0;
}

bool detach_timer(int number) {
  if (number < 1 || number > static_cast<int>(timers.size())) return false;
  Timer& timer = timers[static_cast<std::size_t>(number - 1)];
  if (!timer.on) return false;
  timer.on = false;
  if (timer.task != tasks.current) kill_task(*timer.task);
  return true;
}

}  // namespace robios
