#pragma once
/// Threads and processes that take turns, measured on one processor: to wake another one takes 25 us on some machines, on others 2, and
/// the scheduler is free to choose.
#include <sched.h>

namespace sandlot::bench {

/// Holds this thread, and what it starts, to one processor during its life.
class OneProcessor {
 public:
  OneProcessor() {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(::sched_getcpu(), &one);
    held_ = ::sched_getaffinity(0, sizeof before_, &before_) == 0 &&
            ::sched_setaffinity(0, sizeof one, &one) == 0;
  }
  ~OneProcessor() {
    if (held_) ::sched_setaffinity(0, sizeof before_, &before_);
  }
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

 private:
  cpu_set_t before_{};
  bool held_ = false;
};

}  // namespace sandlot::bench
