#pragma once
/// Budget of a program that Sandlot starts: what its processes may use of the machine, as a scenario gives it.
///
/// Limits of the kernel (struct Limits) hold for each process; the share of a processor and the memory of all processes
/// together are measured and acted on by who watches them (server/processes.h).
#include <sys/types.h>

#include <cstdint>

#include "base/fields.h"

namespace sandlot::programs {

/// A user of the system.
struct User {
  uid_t user = 0;
  gid_t group = 0;
};

/// Limits of the kernel for a process and all that it starts.
struct Limits {
  std::uint64_t memory_bytes = 0;  ///< private memory that can be written
  std::uint64_t address_bytes =
      16ull << 30;              ///< addresses beyond that: node reserves gigabytes that it never touches
  std::uint64_t processes = 0;  ///< with threads, of the user; 0: as before
  std::uint64_t file_bytes = 100u << 20;  ///< size of a file
  std::uint64_t open_files = 256;
  int niceness = 5;  ///< the run comes first on a processor that both want
};

struct Budget {
  double cpu = 1;
  double memory_bytes = 512e6;
  int processes = 32;
  bool sandbox = true;

  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"cpu", "1",
              "Share of a processor core that the processes of the program may use together; beyond it they "
              "are halted for a while.",
              0.01, 1000},
        s.cpu);
    visit(Field{"memory", "B", "Memory that the processes of the program may use together.", 1e6, 1e13},
          s.memory_bytes);
    visit(Field{"processes", "1", "Number of processes and threads that the program may have.", 1, 100'000},
          s.processes);
    visit(Field{"sandbox", "",
                "Whether the program is shut off from network, files and other processes (on), or runs with "
                "the user's rights (off)."},
          s.sandbox);
  }
};

}  // namespace sandlot::programs
