#include "app/interrupt.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace sandlot::app {
namespace {

std::atomic<bool> interrupt_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

}  // namespace

bool interrupted() { return interrupt_requested.load(std::memory_order_relaxed); }

void catch_interrupts() {
  const auto handler = [](int signal) {
    // A second signal ends the program at once, unless it is the echo of the first: timeout(1) and some
    // shells signal the process and then its whole group.
    static std::atomic<std::int64_t> first_ns{0};
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const std::int64_t now_ns = now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
    if (!interrupt_requested.exchange(true)) first_ns = now_ns;
    else if (now_ns - first_ns > 500'000'000) std::_Exit(128 + signal);
  };
  std::signal(SIGINT, handler);
  std::signal(SIGTERM, handler);
}

}  // namespace sandlot::app
