#pragma once
/// Papers whose experiments `sandlot reproduce` makes again: a function each, and one line in the table of papers.cpp.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "app/papers/page.h"
#include "assets/image/visible.h"
#include "base/result.h"
#include "draw/plot.h"
#include "draw/viewpoint.h"
#include "run/repeat.h"
#include "run/step_times_file.h"
#include "sim/watch/topic_graph.h"

namespace sandlot {
class Simulation;
}

namespace sandlot::app {

/// A condition of an experiment: one scenario, with its overrides, run again and again.
struct Condition {
  std::string name;
  std::string scenario;                                       ///< "clearing"
  std::vector<std::pair<std::string, std::string>> settings;  ///< as --set takes them
};

/// One run of a condition with named values in each sample.
struct LoggedRunSpec {
  Condition condition;
  std::vector<std::string> values;                  ///< as --log-values takes them
  std::optional<double> rate_hz;                    ///< of the samples; unset: each tick
  std::optional<double> duration_s;                 ///< unset: as the scenario says
  std::optional<draw::ViewpointOptions> view;       ///< of a picture of the beginning
  std::function<Status(const Simulation&)> at_end;  ///< reads the world after the last tick
};
struct LoggedRun {
  draw::Table values;  ///< "time", then the values
  std::string csv;     ///< the same as text
  assets::Picture picture;
  TopicGraph graph;  ///< at the end
};

/// What an experiment needs from the command.
struct ReproduceContext {
  int repeat = 20;
  int at_a_time = 0;  ///< runs at the same time; 0: as many as the machine has processors
  std::string out;    ///< folder; it is there
  /// Runs a condition, with progress on the terminal.
  std::function<Result<RepeatSummary>(const Condition&)> runs;
  /// The drawing of one run of a condition, from above, after it has ended or after `until_s`.
  std::function<Result<std::string>(const Condition&, double until_s)> drawing;
  /// Step times of one run of a condition; the file of them is left in the folder. `rate`: as RunSpec has it.
  std::function<Result<std::vector<StepTime>>(const Condition&, double duration_s,
                                              std::optional<double> rate)>
      step_times;
  std::function<Result<LoggedRun>(const LoggedRunSpec&)> logged;
  std::vector<std::string> traces;  ///< files of step times to use instead of runs
  bool quick = false;               ///< without the parts that take long
  /// Writes a text file into the folder.
  std::function<Status(const std::string& name, std::string_view text)> write;
};

struct Paper {
  const char* name;
  const char* title;
  /// Runs per condition, unless the command says another number; 0: it repeats none.
  int repeat;
  int conditions;         ///< how many there are, for the progress
  const char* intervals;  ///< confidence of its intervals: "95 %"
  Status (*make)(const ReproduceContext& context, ReportPage& page);
  bool traces = false;  ///< it takes step times, of runs or of files
  bool quick = false;   ///< it has parts that --quick leaves out
};

std::span<const Paper> papers();

Status make_cooperation(const ReproduceContext& context, ReportPage& page);
Status make_eyesim(const ReproduceContext& context, ReportPage& page);
Status make_lpzrobots(const ReproduceContext& context, ReportPage& page);
Status make_mario(const ReproduceContext& context, ReportPage& page);
Status make_msl(const ReproduceContext& context, ReportPage& page);

/// --- what reports share ---

/// "0.93 (0.85 to 0.97)": a mean or a rate with its interval.
std::string text_of(const Estimate& estimate, int digits = 3);
std::string text_of(const SuccessRate& rate);
/// Difference of two conditions, run by run of one seed: b - a of `figure`, which may have no value.
Estimate paired_difference(const RepeatSummary& a, const RepeatSummary& b,
                           const std::function<std::optional<double>(const RepeatedRun&)>& figure);
/// All runs of conditions as CSV: condition, seed, criterion, success, end time, state hash.
std::string csv_of(const std::vector<std::pair<std::string, const RepeatSummary*>>& conditions);

}  // namespace sandlot::app
