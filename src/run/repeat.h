#pragma once
/// Runs of one scenario with one seed after the other, and what they give together: other noise, other placements, the same law.
///
///   RepeatSpec spec{.run = {.file = "scenarios/clearing.yaml"}, .count = 50};
///   Result<RepeatSummary> all = repeat(spec);
///
/// Each run is the one that `sandlot run --seed N` gives, to the same state hash; how many run at a time changes nothing but the
/// time it takes. With a store, seeds whose results it holds are not run again: those of the same world, program and settings
/// (fingerprint). Intervals are those of statistics/intervals.h, for 95 %.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "run/run.h"
#include "statistics/sample.h"

namespace sandlot {

struct RepeatSpec {
  RunSpec run;  ///< writes no files; its seed, or the scenario's, is the first one
  int count = 1;
  int at_a_time = 0;  ///< 0: as many as the machine has processors
  std::string
      store_file;  ///< results of earlier runs, to which those of this one are added (statistics/store.h); "": none
};

/// Mean of a figure over runs.
struct Estimate {
  std::uint64_t count = 0;
  std::optional<double> mean, deviation, low, high, min, max;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"count", "1", "Runs that have a value."}, s.count);
    visit(Field{"mean", "", "Mean over the runs."}, s.mean);
    visit(Field{"deviation", "", "Standard deviation over the runs, by n - 1."}, s.deviation);
    visit(Field{"low", "", "Lower end of Student's interval of the mean."}, s.low);
    visit(Field{"high", "", "Upper end of Student's interval of the mean."}, s.high);
    visit(Field{"min", "", "Smallest value of a run."}, s.min);
    visit(Field{"max", "", "Largest value of a run."}, s.max);
  }
};

/// Mean, spread and Student's interval of a sample.
Estimate estimate_of(const statistics::Sample& sample, double confidence = 0.95);

struct SuccessRate {
  std::uint64_t successes = 0, count = 0;
  std::optional<double> rate, low, high;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"successes", "1", "Runs that succeeded."}, s.successes);
    visit(Field{"count", "1", "Runs that ended without an error."}, s.count);
    visit(Field{"rate", "1", "Part of the counted runs that succeeded."}, s.rate);
    visit(Field{"low", "1", "Lower end of Wilson's interval."}, s.low);
    visit(Field{"high", "1", "Upper end of Wilson's interval."}, s.high);
  }
};

/// The same with rate and Wilson's interval of its counts.
SuccessRate with_interval(SuccessRate counts, double confidence = 0.95);

struct JudgedRuns {
  Estimate criterion;
  std::optional<SuccessRate> success;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"criterion", "", "Figure of merit."}, s.criterion);
    visit(Field{"success", "", "How often it succeeded; left out when that is not asked."}, s.success);
  }
};

struct RepeatedRun {
  std::uint64_t seed = 0;
  double end_s = 0;
  std::string stopped;
  StateHash state_hash;
  std::optional<double> criterion;
  std::optional<bool> success;
  std::vector<Named<CriterionSummary>> criteria;
  bool stored = false;              ///< it was in the store, and was not run again
  std::vector<std::string> errors;  ///< it does not count when there are some

  static void fields(auto& s, auto&& visit) {
    visit(Field{"seed", "", "Seed of the run."}, s.seed);
    visit(Field{"end_time", "s", "Simulated time at the end."}, s.end_s);
    visit(Field{"stopped", "", "Reason for the end of the run."}, s.stopped);
    visit(Field{"state_hash", "", "Hash of the whole state."}, s.state_hash);
    visit(Field{"criterion", "1", "Figure of merit at the end; null when it has no value."}, s.criterion);
    visit(Field{"success", "", "Whether the run succeeded."}, s.success);
    visit(Field{"criteria", "1", "Figures of merit of the teams that are judged."}, s.criteria);
    visit(Field{"stored", "", "Whether the result was taken from the store of results."}, s.stored);
    visit(Field{"errors", "", "Errors that ended the run; it counts in no figure then."}, s.errors);
  }
};

struct RepeatSummary {
  std::string name, physics;
  double wall_s = 0, confidence = 0.95;
  std::uint64_t failed = 0;
  std::optional<JudgedRuns> all;
  std::vector<Named<JudgedRuns>> teams;
  Estimate end_s;
  std::vector<RepeatedRun> runs;
  std::string store_error;  ///< why results were not stored; "": they were, or there is no store

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the scenario."}, s.name);
    visit(Field{"physics", "", "Name of the engine."}, s.physics);
    visit(Field{"wall_seconds", "s", "Time that all took."}, s.wall_s);
    visit(Field{"confidence", "1", "Confidence of the intervals."}, s.confidence);
    visit(Field{"failed", "1", "Runs with errors."}, s.failed);
    visit(Field{"all", "", "Runs by the criterion of the scenario; left out when it has none."}, s.all);
    visit(Field{"teams", "", "Runs by the criteria of the teams."}, s.teams);
    visit(Field{"end_time", "s", "Simulated time at the end."}, s.end_s);
    visit(Field{"runs", "", "All runs, in order of their seeds."}, s.runs);
    visit(Field{"store_error", "", "Reason why results were not stored; empty: none."}, s.store_error);
  }
};

/// @param keep_going  asked between and within runs, from several threads, with how many have ended; false: what has ended counts
/// Errors  of the spec and its files: nothing was run. Later ones: RepeatedRun::errors
Result<RepeatSummary> repeat(const RepeatSpec& spec, const std::function<bool(int ended)>& keep_going = {});

nlohmann::ordered_json as_json(const RepeatSummary& summary);
/// Half a dozen lines for people.
std::string as_text(const RepeatSummary& summary);

}  // namespace sandlot
