#pragma once
/// Step times: how long the ticks of a session take by the wall clock. Never State, never part of a hash; measured only while there is
/// an observer.
///
/// Intervals  from the end of one tick to the end of the next, waiting for the pace and for clients included, so that their sum over an
///            unpaused stretch is real time. The first tick of a stretch has none: after the start, a pause, a jump, a
///            reset or a load. Ticks that run again on the way back to an earlier time are left out.
/// Threads    the simulation's.
#include <optional>

#include "base/time.h"

namespace sandlot {

struct StepTime {
  Time now;                      ///< at the end of the tick
  Time step;                     ///< length of the tick
  std::optional<double> wall_s;  ///< since the end of the tick before; unset: first of a stretch
  double compute_s = 0;  ///< what the tick took, without waiting for its time or for clients in lockstep
};

class StepObserver {
 public:
  virtual ~StepObserver() = default;
  virtual void on_step(const StepTime& step) = 0;
  /// The run pauses, jumps or ends: the next tick has no interval.
  virtual void on_stretch_end() {}
};

}  // namespace sandlot
