#pragma once
/// Moment between two ticks: poses of all bodies, interpolated for pictures. No part of the run: nothing in it changes.
///
/// Formula  positions in a straight line; orientations about one axis at a constant rate, by the shorter way.
/// Limits   what turns by half a turn or more within a tick seems to turn the other way. A body that is farther away than its speed
///          at both ticks explains, and 0.1 m, was put there: it stays until the tick. So does all when something came or went.
#include <cstdint>
#include <vector>

#include "base/time.h"
#include "geometry/pose.h"

namespace sandlot {
class Simulation;
}

namespace sandlot::draw {

struct Moment {
  Time at;
  std::vector<Pose> X_WB;  ///< in the order of the engine's bodies
};

/// Poses and speeds of the bodies after a tick.
struct TickPoses {
  struct Body {
    Pose X_WB;
    double speed_mps;
  };
  Time at;
  std::uint64_t revision;
  std::vector<Body> bodies;

  static TickPoses of(const Simulation& simulation);
};

/// @param share  from 0 (a) to 1 (b)
Pose interpolated(const Pose& a, const Pose& b, double share);

/// @pre a.at <= at <= b.at
Moment moment_between(const TickPoses& a, const TickPoses& b, Time at);

}  // namespace sandlot::draw
