#pragma once
/// Processes below a process, and what they use, as /proc shows it.
///
/// Limits   a process whose parent has ended belongs to the tree only within a sandbox, whose first process takes it over.
///          Processor time of processes that live for less than the time between two samples counts when their parent
///          collects them.
/// Cost     three small files per process and sample, some 20 us each.
#include <cstdint>
#include <map>
#include <vector>

namespace sandlot::programs {

/// Descendants of a process, parents first, without itself.
std::vector<int> processes_below(int process);
/// Halts a process and those below it, or lets them go on.
void halt(int process, bool halted);
/// Number of threads of all processes of a user.
std::uint64_t threads_of_user(unsigned user);

class ProcessMeter {
 public:
  struct Usage {
    double cpu_s = 0;  ///< since the sample before
    std::uint64_t memory_bytes = 0;
    std::size_t processes = 0;
  };
  /// Measures a process and those below it.
  Usage sample(int process);

 private:
  struct Ticks {
    std::uint64_t own = 0, collected = 0;  ///< of children that have ended
  };
  std::map<int, Ticks> ticks_;  ///< by process, at the latest sample
};

}  // namespace sandlot::programs
