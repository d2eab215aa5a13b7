#pragma once
/// One run from a spec to its summary, for the command line, studies, workers and programs that embed
/// Sandlot.
///
///   RunSpec spec{.file = "scenarios/indoor.yaml", .seed = 3, .duration_s = 10};
///   Result<Summary> summary = run(spec);
///
/// Nothing is printed, and nothing is shared between runs: any number may follow each other in a process, or
/// run on several threads at once, as long as they write different files.
/// Errors   of the spec and its files: the Result, and nothing was run or replaced. What goes wrong later:
///          Summary::errors, with the results so far.
#include <functional>
#include <string>

#include "base/result.h"
#include "run/spec.h"
#include "run/summary.h"

namespace sandlot {

class Console;
class RunOutputs;
class Session;
class Simulation;
struct Hooks;

/// Parts of a run that a caller may attach to. They live until run() returns.
struct RunParts {
  Session& session;
  Console& console;
  RunOutputs& outputs;
};

/// Additions of a caller to a run. All are optional, and called on the thread of run().
struct RunCallbacks {
  const Hooks* hooks = nullptr;  ///< C++ functions around the ticks
  /// Each warning once, as soon as it is known; they are in the summary too.
  std::function<void(const Error& warning)> on_warning;
  /// Answer of a console line that was scheduled.
  std::function<void(const std::string& answer)> on_answer;
  /// Before the first tick, and before any file is replaced. Errors: nothing is run.
  std::function<Status(const RunParts&)> on_ready;
  /// After each tick and at least ten times a second. @return false: the run ends
  std::function<bool(const Simulation&)> keep_going;
  /// Before the summary is written; with an empty one when nothing was run after on_ready.
  std::function<void(Summary&)> on_end;
};

Result<Summary> run(const RunSpec& spec, const RunCallbacks& callbacks = {});

}  // namespace sandlot
