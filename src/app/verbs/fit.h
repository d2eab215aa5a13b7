#pragma once
/// `sandlot fit`: parameters of a scenario with which a recorded run is met.
///
/// Method    each trial builds the scenario with other values, carries out the commands of the recording tick by tick
///           (record/replay.h, `logged`) and compares numbers of its topics with the recorded messages: residuals are their
///           differences divided by a scale. statistics/least_squares.h searches the parameters.
/// Tables    a recording that is a CSV file is the run of a real robot: a column `time` [s] from the first tick on, and columns that
///           --compare names the values of. The scenario's own programs give the commands; between ticks values are linear.
/// Errors    devices err in no trial: noise of the recording stays in the residuals and widens the intervals.
/// Fields    by themselves: speeds of MotorState, place and velocities of Odometry, each that varies; their scale is the standard
///           deviation of the recorded values.
/// Limits    a recording of ours from its first tick, of the same robots; values within one run do not change. The clocks of a
///           table and of the scenario are taken to begin at the same moment.
/// Cost      a run per trial; trials of one step at a time on all processors.
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"

namespace sandlot::app {

struct FitOptions {
  std::string file, recording;
  std::vector<std::string> parameters;  ///< "ADDRESS=LOW:HIGH[:log]", addresses as in --set
  std::vector<std::string>
      compare;  ///< "TOPIC.FIELD[:SCALE]"; none: those of the class comment. Of a table: "VALUE=COLUMN[:SCALE]"
  int runs = 200;
  int screening = 16;  ///< of these runs, spread over the bounds before the search
  std::optional<double> from_s, to_s;
  std::vector<formats::Override> overrides;  ///< of a parameter: where it starts
  std::vector<std::string> paths;
  std::string out;  ///< file for `--set` words; "": none
  bool json = false;
};
int fit(const FitOptions& options);

}  // namespace sandlot::app
