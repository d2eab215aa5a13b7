#pragma once
/// Schedules of tournaments: which games are to be played next, from those that have been played.
///
/// Pure and deterministic: a tournament that was interrupted goes on from its results alone.
///
///   round robin   each pair plays `games`. Sides alternate from game to game; with an odd number of games, each team has its
///                 one game more on the left against half of the others, or half of them rounded up or down.
///   swiss         `rounds`: in each, teams of like standing meet. A pairing is not repeated as long as there is another way to pair all
///                 teams; then those that met least often meet again. With an odd number, the lowest team that had none has a bye, which
///                 counts as a won game each.
///   knockout      the bracket by the order in which teams are given, the strongest first; byes go to the first ones. A meeting is decided
///                 by won games (also by penalty kicks), then by goals; a tie by one more game with the next seed, and after three of those by the order of teams.
///
/// Seeds    the k-th game of two teams with each other has seed first_seed + k - 1.
/// Limits   a knockout has no game for the third place.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot::tournament {

enum class Format { round_robin, swiss, knockout };

/// "round-robin", "swiss", "knockout".
Result<Format> read_format(std::string_view text);
const char* name_of(Format format);

inline constexpr std::size_t most_teams = 256;
inline constexpr int most_games = 100'000;
inline constexpr int most_replays = 3;

struct Schedule {
  Format format = Format::round_robin;
  std::size_t teams = 0;
  int games = 1;   ///< of each meeting
  int rounds = 0;  ///< of a swiss tournament; 0: the fewest that leave one team without a defeat
  std::uint64_t first_seed = 1;

  int swiss_rounds() const;
};

/// Errors  fewer than two teams, too many, numbers out of range.
Status check(const Schedule& schedule);

struct Game {
  int round = 1;                     ///< from 1
  std::array<std::size_t, 2> teams;  ///< the first begins on the left: at negative x
  std::uint64_t seed = 1;
  bool replay = false;  ///< of a tie in a knockout

  friend bool operator==(const Game&, const Game&) = default;
};

/// Game with its goals, in the order of its teams.
struct ScoredGame {
  Game game;
  std::array<int, 2> goals;
  int penalty_kicks =
      0;  ///< after a draw: goals of the first team minus those of the second one. A draw all the same, but in a knockout
};

/// Games to be played next, which do not depend on each other; empty: the tournament has ended.
/// @param played  all games that earlier calls gave, with their goals, in that order
/// @pre  check(schedule)
std::vector<Game> next_games(const Schedule& schedule, std::span<const ScoredGame> played);

struct Standing {
  std::size_t team = 0;
  int played = 0, won = 0, drawn = 0, lost = 0, goals = 0, against = 0, byes = 0;
  int points = 0;  ///< 3 for a win, 1 for a tie; for a bye as for a win of each of its games
  int left_side = 0;
  int out_in = 0;         ///< knockout: round in which the team lost; 0: not
  bool by_order = false;  ///< knockout: a meeting of it was decided by the order of the teams
};

/// Standings, the best first: by points, difference of goals, goals, order of teams; in a knockout first by the round a team reached.
std::vector<Standing> standings(const Schedule& schedule, std::span<const ScoredGame> played);

/// Pairs of all but at most one of `ranked`, the best first, so that each plays the nearest one that leaves the others a way to be paired;
/// `met[a][b]` says how often a and b have met, `byes[a]` how often a was left out. Second of a pair: `ranked.size()` is the bye.
/// @pre  numbers in `ranked` are all those below its size; met is symmetric
std::vector<std::array<std::size_t, 2>> swiss_pairs(std::span<const std::size_t> ranked,
                                                    const std::vector<std::vector<int>>& met,
                                                    std::span<const int> byes);

/// Slots of a bracket of `size` (a power of two) in order of play: 0 meets size - 1, and 0 and 1 only in the final.
std::vector<std::size_t> bracket(std::size_t size);

}  // namespace sandlot::tournament
