#pragma once
/// Memory that the simulator shares with one program (robios/slot.h), and the turns on it.
///
/// Trust    the file is sealed: the program cannot make it shorter. What stands in it may change at any moment; orders are
///          copied before they are read.
/// Errors   no memory, or no file descriptor.
#include <chrono>
#include <cstddef>
#include <vector>

#include "base/result.h"
#include "programs/robios/slot.h"

namespace sandlot::programs::robios {

class SharedMemory {
 public:
  using Clock = std::chrono::steady_clock;

  static Result<SharedMemory> make();
  SharedMemory(SharedMemory&& other) noexcept { *this = std::move(other); }
  SharedMemory& operator=(SharedMemory&& other) noexcept;
  ~SharedMemory();

  sandlot::robios::Memory& memory() { return *memory_; }
  int descriptor() const { return descriptor_; }

  /// Gives the program its turn and wakes it.
  void give_turn();
  /// Whether the program has given the turn back.
  bool has_turn() const;
  /// Waits until it has, or a process has touched the turn, or `until`.
  void await_turn(Clock::time_point until) const;
  /// Lets a program that waits end.
  void end();
  /// Copy of the orders of a turn; has_turn() is true.
  std::vector<std::byte> orders() const;

 private:
  SharedMemory() = default;
  sandlot::robios::Memory* memory_ = nullptr;
  int descriptor_ = -1;
};

}  // namespace sandlot::programs::robios
