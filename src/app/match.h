#pragma once
/// A match of two teams' software: scenarios/match.yaml with the folders of the teams, and who won it by rule.
///
/// Sides    the first team plays as cyan, which begins at negative x, unless `swap` says otherwise.
/// Result   goals by the rule `referee`. A team loses by 0:3, or by what it lost by if that is more, when the programs of all its
///          robots never answered, when they missed more than half of their steps, or when a controller of it failed and ended
///          the run. Where that holds for both, there is no winner. The game ends early when a team has missed more than half of
///          500 steps or more.
/// Waiting  a program's deadline is 1 s at most, its patience 60 s: a team may not hold up the game.
#include <array>
#include <optional>
#include <string>

#include "app/commands.h"
#include "base/fields.h"
#include "run/summary.h"

namespace sandlot::app {

struct MatchSpec {
  std::array<std::string, 2> teams;        ///< folders
  std::string drive, sense, engine, size;  ///< variables of the scenario; "": its own
  std::optional<double> half_s;
  bool swap = false;
  RunOptions run;  ///< all else; its file is set here
};

/// Goals, names and verdict in the order in which the teams were given.
struct MatchResult {
  std::array<std::string, 2> folders, names;
  std::array<int, 2> goals{};
  std::array<int, 2> penalty_kicks{};  ///< goals of the shoot-out; they decide a draw
  std::string winner;                  ///< "": a draw
  std::string walk_over;               ///< why a team lost by rule; "": it was played
  bool ended = false;                  ///< by the referee
  bool swapped = false;
  std::uint64_t seed = 0;
  double sim_s = 0, wall_s = 0;
  StateHash state_hash;
  std::string recording;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"folders", "", "Folders of the teams."}, s.folders);
    visit(Field{"names", "", "Names of the teams' software."}, s.names);
    visit(Field{"goals", "1", "Number of goals that count for each team."}, s.goals);
    visit(
        Field{"penalty_kicks", "1", "Number of goals of each team in the penalty kicks that decide a draw."},
        s.penalty_kicks);
    visit(Field{"winner", "", "Name of the team that has won; empty for a draw."}, s.winner);
    visit(Field{"walk_over", "", "Reason why a team has lost by rule; empty for none."}, s.walk_over);
    visit(Field{"ended", "", "Whether the referee has ended the game."}, s.ended);
    visit(Field{"swapped", "", "Whether the second team began at negative x."}, s.swapped);
    visit(Field{"seed", "1", "Seed of the run."}, s.seed);
    visit(Field{"sim_seconds", "s", "Simulated time."}, s.sim_s);
    visit(Field{"wall_seconds", "s", "Time that it took."}, s.wall_s);
    visit(Field{"state_hash", "", "Hash of the state at the end."}, s.state_hash);
    visit(Field{"recording", "", "File of the recording; empty for none."}, s.recording);
  }
};

struct Match {
  MatchResult result;
  Summary summary;
};

/// @param shows_progress  on the terminal
/// Errors   a folder without a team, a scenario that cannot be built, a program with too long a deadline: nothing was played.
Result<Match> play_match(const MatchSpec& spec, bool shows_progress);

}  // namespace sandlot::app
