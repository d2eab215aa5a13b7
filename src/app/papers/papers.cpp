#include "app/papers/papers.h"

#include <fmt/format.h>

#include <algorithm>

#include "run/summary.h"

namespace sandlot::app {
namespace {

constexpr Paper all[] = {
    {"cooperation", "Simulator for cooperation and competition of mobile robots", 20, 19, "95 %",
     make_cooperation},
    {"eyesim", "Mobile Robot Simulation with Realistic Error Models", 20, 0, "99.9 %", make_eyesim},
    {"lpzrobots", "Goal-oriented control of self-organizing behavior in autonomous robots", 20, 39, "95 %",
     make_lpzrobots},
    {.name = "mario",
     .title =
         "Modelling and simulation of a non-holonomic omnidirectional mobile robot for offline programming "
         "and system performance analysis",
     .repeat = 0,
     .conditions = 0,
     .intervals = "",
     .make = make_mario,
     .quick = true},
    {.name = "msl",
     .title = "A Simulation Environment for Middle-Size Robots with Multi-level Abstraction",
     .repeat = 0,
     .conditions = 0,
     .intervals = "",
     .make = make_msl,
     .traces = true,
     .quick = true},
};

}  // namespace

std::span<const Paper> papers() { return all; }

std::string text_of(const Estimate& e, int digits) {
  if (!e.mean) return "no run has a value";
  if (!e.low) return fmt::format("{:.{}g}", *e.mean, digits);
  return fmt::format("{:.{}g} ({:.{}g} to {:.{}g})", *e.mean, digits, *e.low, digits, *e.high, digits);
}

std::string text_of(const SuccessRate& r) {
  return fmt::format("{} of {}: {:.1f} % ({:.1f} to {:.1f} %)", r.successes, r.count,
                     100 * r.rate.value_or(0), 100 * r.low.value_or(0), 100 * r.high.value_or(1));
}

Estimate paired_difference(const RepeatSummary& a, const RepeatSummary& b,
                           const std::function<std::optional<double>(const RepeatedRun&)>& figure) {
  statistics::Sample sample;
  for (const RepeatedRun& one : a.runs) {
    const auto other = std::find_if(b.runs.begin(), b.runs.end(),
                                    [&](const RepeatedRun& run) { return run.seed == one.seed; });
    if (other == b.runs.end() || !one.errors.empty() || !other->errors.empty()) continue;
    const auto x = figure(one), y = figure(*other);
    if (x && y) sample.add(*y - *x);
  }
  return estimate_of(sample);
}

std::string csv_of(const std::vector<std::pair<std::string, const RepeatSummary*>>& conditions) {
  std::string csv = "condition,seed,criterion,success,end_time [s],state_hash\n";
  for (const auto& [name, runs] : conditions)
    for (const RepeatedRun& run : runs->runs)
      if (run.errors.empty())
        csv += fmt::format(
            "\"{}\",{},{},{},{},{}\n", name, run.seed, run.criterion ? fmt::format("{}", *run.criterion) : "",
            run.success ? (*run.success ? "1" : "0") : "", run.end_s, hash_text(run.state_hash.value));
  return csv;
}

}  // namespace sandlot::app
