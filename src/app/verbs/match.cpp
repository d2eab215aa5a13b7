#include "app/match.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "run/fields_json.h"

namespace sandlot::app {
namespace {

void print_match(const Match& match) {
  const MatchResult& result = match.result;
  const auto [ours, theirs] = result.penalty_kicks;
  fmt::print("{} {} : {} {}{}\n", result.names[0], result.goals[0], result.goals[1], result.names[1],
             ours + theirs > 0       ? fmt::format("   {} : {} by penalty kicks", ours, theirs)
             : result.winner.empty() ? "   a draw"
                                     : "");
  if (!result.walk_over.empty()) fmt::print("{}\n", result.walk_over);
  const Summary& summary = match.summary;
  fmt::print(
      "{} ({})\n", summary.stopped.empty() ? "the game was broken off" : summary.stopped,
      result.swapped ? result.names[1] + " began at negative x" : result.names[0] + " began at negative x");
  fmt::print("{:.1f} s simulated in {:.1f} s, {:.1f} x real time; seed {}; hash {:016x}\n", summary.sim_s,
             summary.wall_s, summary.real_time_factor, result.seed, result.state_hash.value);
  if (!result.recording.empty())
    fmt::print("recorded: watch it with  sandlot replay {} --port 8765\n", result.recording);
}

}  // namespace

int match(const MatchSpec& spec) {
  const Result<Match> played = play_match(spec, true);
  if (!played) return complain(played.error());
  if (spec.run.json) {
    nlohmann::ordered_json out = fields_json(played->result);
    out["summary"] = as_json(played->summary);
    fmt::print("{}\n", json_text(out));
  } else {
    print_match(*played);
  }
  for (const std::string& error : played->summary.errors) fmt::print(stderr, "error: {}\n", error);
  // A walk-over is a result; a run that failed for no team's fault is none.
  return played->summary.errors.empty() || !played->result.walk_over.empty() ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
