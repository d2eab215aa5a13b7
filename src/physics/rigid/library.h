#pragma once
/// ODE as a library: initialised once per process, its messages and allocations counted instead of printed,
/// its random numbers replaced by ours.
///
/// ODE's quick solver shuffles the order of its constraints with dRandInt, a generator shared by all worlds
/// and threads of a process. library.cpp defines dRandInt itself; the dynamic linker then binds ODE's calls
/// to ours. Its value depends on the seed of the sub-step and on n alone, so neither other worlds nor other
/// islands matter.
#include <cstdint>
#include <string>

namespace sandlot::rigid::library {

/// Call before the first use of ODE in a thread; cheap afterwards. Stops the program if ODE's random numbers
/// are not ours: then no run could be repeated, and only a wrong link of the program can cause it.
void prepare_thread();

/// Thrown out of a call of ODE that stopped at one of its own assertions: with sound input only numbers
/// beyond all bounds bring it there. The world is in no defined state afterwards and must not be stepped
/// again.
struct Fault {
  std::string message;
};

/// Keeps what ODE refuses to destroy after a Fault, so that it still counts as in use.
void abandon(void* item);

/// Seeds what the quick solver draws in this thread from now on.
void seed(std::uint64_t key);

/// Counted in this thread since it began.
struct Counts {
  std::uint64_t messages = 0;
  std::uint64_t allocations = 0;
  std::uint64_t draws = 0;
};
const Counts& counts();

}  // namespace sandlot::rigid::library
