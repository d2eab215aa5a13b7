#pragma once
/// Runs of RoBIOS programs for reports: printed lines of each program, values after each tick, the drawing from above.
///
/// Files     in the folder `examples`, found beside the program, above it, or in share/doc/sandlot.
/// Threads   while a ProgramRuns exists it listens to the log, where the lines of programs arrive on the thread of their run; there
///           is one at a time.
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assets/image/visible.h"
#include "base/result.h"
#include "draw/viewpoint.h"
#include "run/summary.h"

namespace sandlot {
class Simulation;
}

namespace sandlot::app {

struct ProgramRunSpec {
  std::string file;  ///< "eyesim_paper/wheels.sim"
  double duration_s = 10;
  std::string stop_when;
  std::vector<std::pair<std::string, std::string>> settings;  ///< as --set takes them
  std::vector<std::string> values;                            ///< addresses of named values
  std::optional<double> errors;                               ///< factor on all errors
  std::uint64_t seed = 1;
  bool draws = false;
  std::optional<draw::ViewpointOptions> view;    ///< of a picture of the beginning
  std::function<void(const Simulation&)> watch;  ///< after each tick
};

using Words = std::vector<std::string>;

struct ProgramRun {
  std::map<std::string, std::vector<Words>> printed;  ///< by robot
  std::vector<double> times_s;                        ///< of the beginning, and after each tick
  std::vector<std::vector<double>> values;            ///< one list per value, as long as the times
  std::string drawing;                                ///< SVG
  assets::Picture picture;
  Summary summary;

  /// Lines of a robot's program that begin with a word, without it, as numbers; words that are no numbers are NaN.
  std::vector<std::vector<double>> numbers(const std::string& robot, const std::string& first) const;
  /// The same as words.
  std::vector<Words> lines(const std::string& robot, const std::string& first) const;
};

class ProgramRuns {
 public:
  /// @param scratch  folder for files that are removed again
  explicit ProgramRuns(std::string scratch, int at_a_time = 0);
  ~ProgramRuns();
  ProgramRuns(const ProgramRuns&) = delete;
  ProgramRuns& operator=(const ProgramRuns&) = delete;

  /// One run, with a line on the terminal.
  Result<ProgramRun> run(const ProgramRunSpec& spec) const;
  /// Runs with the seeds 1 to `count`, in their order; no drawings.
  Result<std::vector<ProgramRun>> repeated(const ProgramRunSpec& spec, int count) const;

 private:
  std::string scratch_;
  int at_a_time_;
};

}  // namespace sandlot::app
