#pragma once
/// Level of detail at which this machine plays the demo's match in real time.
///
/// Candidates are levels of senses, drives and engine, from the most to the least detailed. Each is measured by a piece of its match;
/// the first one that is fast enough is chosen. The choice is input of the run, like a flag: with the same level a run gives the same
/// state hash on any machine.
///
/// Cost     a second or two of wall time per candidate that is too slow.
#include <string>
#include <vector>

#include "app/commands.h"

namespace sandlot::app {

struct MatchLevel {
  std::string sense;   ///< image, objects, world
  std::string drive;   ///< roller, contact, ideal
  std::string engine;  ///< rigid, planar

  /// Variables of the scenario.
  std::vector<formats::Override> overrides() const;
  friend bool operator==(const MatchLevel&, const MatchLevel&) = default;
};

/// Levels that may be chosen, from the most to the least detailed.
/// @param fixed  overrides of the caller: where they say one of the three, all candidates have it
std::vector<MatchLevel> candidate_levels(const std::vector<formats::Override>& fixed);

struct MeasuredLevel {
  MatchLevel level;
  double real_time_factor = 0;  ///< simulated per wall time, measured
};

/// The most detailed level that runs at least `margin` times as fast as real time; the last one where none does.
/// @param spec  the match: file, overrides, which count more than those of a level, seed, threads, paths
/// Errors   the match cannot be built at any level: that of the last one.
Result<MeasuredLevel> choose_level(const RunSpec& spec, double margin);

}  // namespace sandlot::app
