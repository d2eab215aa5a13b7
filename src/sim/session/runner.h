#pragma once
/// Runs a simulation against a clock: as fast as possible, or at a multiple of real time. The only place where
/// the wall clock has a say, and it decides when a tick happens, never what it does.
#include <functional>
#include <optional>

#include "sim/session/experiment.h"

namespace sandlot {

struct Pace {
  /// Real time x factor; unset: as fast as possible, and real time for a setup with a continuous clock.
  std::optional<double> factor;
};

struct RunReport {
  std::uint64_t ticks = 0;
  double wall_s = 0;
  double sim_s = 0;
  std::uint64_t late_ticks =
      0;  ///< ticks that began more than one step behind the clock; continuous: that were cut
  Time shortest, longest;  ///< tick
};

/// Ticks until the simulation has a reason to stop, or `keep_going` (called after each tick) says no.
/// The report is filled also when a tick fails. Each tick of a setup with a continuous clock is as long as the one
/// before it took, this function's waiting included. The ticks are the experiment's where there is one.
Status run(Simulation& simulation, const Pace& pace, RunReport& report,
           const std::function<bool(const Simulation&)>& keep_going = {}, Experiment* experiment = nullptr);

}  // namespace sandlot
