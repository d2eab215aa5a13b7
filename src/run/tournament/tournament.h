#pragma once
/// Tournament: plays the games of a schedule, keeps their results, and draws up the table.
///
///   TournamentSpec spec{.format = Format::swiss, .teams = {{"Passing", hash}, ...}, .games = 4, .store_file = "out/results.db"};
///   Result<TournamentSummary> all = play_tournament(spec, [](const Match& match) { ... });
///
/// Results lie in the store of results (statistics/store.h) from the moment a game has ended, keyed by the contents of the team on the
/// left and of the team on the right, by `options` and by the seed. A game that is there is not played again, so a tournament goes on
/// after its end, however sudden. How many games run at a time changes nothing but the time it takes.
///
/// Store    an experiment per pair of contents, sides and options; `stopped` is the reason, criterion '' has the difference of goals, its
///          `success` is false for a walk-over; criteria 'left' and 'right' have the goals, 'left penalties' and 'right penalties' those of
///          penalty kicks after a draw.
/// Failures a game without a result stays open: it is named, the other games of its round are played, and those of later rounds wait for it.
///          The same command again plays it again.
/// Limits   results of teams with equal contents are those of one team. The caller says what a team's content is.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/result.h"
#include "run/summary.h"
#include "run/tournament/schedule.h"

namespace sandlot::tournament {

struct Team {
  std::string name;     ///< in tables
  std::string content;  ///< hash of all that makes its play; see content_of()
  std::string folder;
};

struct TournamentSpec {
  Format format = Format::round_robin;
  std::vector<Team> teams;  ///< by strength as far as it is known: the order of a knockout
  int games = 1;            ///< of each meeting
  int rounds = 0;           ///< of a swiss tournament; 0: by the number of teams
  std::uint64_t first_seed = 1;
  std::string options;     ///< all else that changes a game
  std::string store_file;  ///< "": results are not kept
  std::string
      recordings;  ///< folder that play() records games into, NAME.mcap; "": none. Read to find those of stored games
  int at_a_time = 1;  ///< games; 0: as many as the machine has processors
};

/// A game that is to be played.
struct Match {
  Game game;
  std::array<Team, 2> teams;  ///< the first begins on the left
  std::string recording;      ///< file to record it into; "": none
  std::string name;           ///< "r1_passing_pressing_s3": of files
};

/// Result of a game, in the order of its teams.
struct GameResult {
  std::array<int, 2> goals{};
  std::array<int, 2> penalty_kicks{};  ///< goals of those that decide a draw
  bool walk_over = false;
  std::string reason;  ///< for the end, or for the walk-over
  StateHash state_hash;
  double sim_s = 0;
  std::string recording;  ///< file; "": none
};

/// Plays a game; called from several threads at a time. An error means that there is no result, and says why.
using PlayGame = std::function<Result<GameResult>(const Match& match)>;

struct GameRow {
  int round = 1;
  std::string left, right;
  int goals_left = 0, goals_right = 0;
  int penalties_left = 0, penalties_right = 0;
  bool played = true, walk_over = false, replay = false, stored = false;
  std::uint64_t seed = 0;
  double sim_s = 0;
  std::string reason, recording;
  StateHash state_hash;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"round", "1", "Number of the round."}, s.round);
    visit(Field{"left", "", "Name of the team that began at negative x."}, s.left);
    visit(Field{"right", "", "Name of the other team."}, s.right);
    visit(Field{"goals_left", "1", "Goals of the team on the left."}, s.goals_left);
    visit(Field{"goals_right", "1", "Goals of the other team."}, s.goals_right);
    visit(Field{"seed", "1", "Seed of the game."}, s.seed);
    visit(Field{"played", "", "Whether there is a result."}, s.played);
    visit(Field{"walk_over", "", "Whether a team lost by rule."}, s.walk_over);
    visit(Field{"replay", "", "Whether the game decided a tie."}, s.replay);
    visit(Field{"reason", "",
                "Reason for the end of the game, for the walk-over, or for its not being played."},
          s.reason);
    visit(Field{"sim_seconds", "s", "Simulated time."}, s.sim_s);
    visit(Field{"state_hash", "", "Hash of the state at the end."}, s.state_hash);
    visit(Field{"recording", "", "File of the recording; empty for none."}, s.recording);
    visit(Field{"stored", "", "Whether the result was taken from the store of results."}, s.stored);
    visit(Field{"penalties_left", "1", "Goals of the team on the left in the penalty kicks after a draw."},
          s.penalties_left);
    visit(Field{"penalties_right", "1", "Goals of the team on the right in the penalty kicks after a draw."},
          s.penalties_right);
  }
};

/// "1 : 1 (3 : 2 by penalty kicks)".
std::string score_text(const GameRow& game);

struct TableRow {
  std::string team;
  int played = 0, won = 0, drawn = 0, lost = 0, goals = 0, against = 0, points = 0, byes = 0;
  double strength = 0, low = 0, high = 0;
  std::string note;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"team", "", "Name of the team."}, s.team);
    visit(Field{"played", "1", "Number of games."}, s.played);
    visit(Field{"won", "1", "Number of games won."}, s.won);
    visit(Field{"drawn", "1", "Number of ties."}, s.drawn);
    visit(Field{"lost", "1", "Number of games lost."}, s.lost);
    visit(Field{"goals", "1", "Number of goals scored."}, s.goals);
    visit(Field{"against", "1", "Number of goals of the opponents."}, s.against);
    visit(Field{"points", "1", "Points: 3 for a win, 1 for a tie."}, s.points);
    visit(Field{"byes", "1", "Number of rounds without an opponent."}, s.byes);
    visit(Field{"strength", "", "Strength by Davidson's law, in log units from the mean."}, s.strength);
    visit(Field{"low", "", "Lower end of the strength's interval for 95 %."}, s.low);
    visit(Field{"high", "", "Upper end of the strength's interval for 95 %."}, s.high);
    visit(Field{"note", "", "Remark on what bounds the strength, or on how the team came to its place."},
          s.note);
  }
};

struct PairRow {
  std::string a, b;
  std::uint64_t games = 0, won = 0, drawn = 0, lost = 0;
  double difference = 0;
  std::optional<double> low, high;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"a", "", "Name of a team."}, s.a);
    visit(Field{"b", "", "Name of its opponent."}, s.b);
    visit(Field{"games", "1", "Number of games with each other."}, s.games);
    visit(Field{"won", "1", "Number of games that a won."}, s.won);
    visit(Field{"drawn", "1", "Number of ties."}, s.drawn);
    visit(Field{"lost", "1", "Number of games that b won."}, s.lost);
    visit(Field{"difference", "1", "Mean of the goals of a minus those of b."}, s.difference);
    visit(Field{"low", "1", "Lower end of Student's interval of the mean for 95 %; null for one game."},
          s.low);
    visit(Field{"high", "1", "Upper end of Student's interval of the mean for 95 %; null for one game."},
          s.high);
  }
};

struct TournamentSummary {
  std::string format;
  bool ended = false;  ///< all games have been played
  double tie = 0;
  std::uint64_t stored = 0, not_played = 0, groups = 0;
  std::vector<TableRow> table;
  std::vector<PairRow> pairs;
  std::vector<GameRow> games;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"format", "", "Format of the tournament."}, s.format);
    visit(Field{"ended", "", "Whether all games have been played."}, s.ended);
    visit(Field{"table", "", "Teams, the best first."}, s.table);
    visit(Field{"pairs", "", "Games of each two teams with each other."}, s.pairs);
    visit(Field{"games", "", "All games in their order."}, s.games);
    visit(Field{"tie_parameter", "", "Parameter of ties in Davidson's law."}, s.tie);
    visit(Field{"groups", "1", "Number of groups of teams that no game connects."}, s.groups);
    visit(Field{"stored", "1", "Number of games whose results were taken from the store."}, s.stored);
    visit(Field{"not_played", "1", "Number of games that were begun and gave no result."}, s.not_played);
  }
};

/// @param on_game     called after each game, also a stored one or one without a result, by one thread at a time; may be empty
/// @param keep_going  asked before and after each game, from several threads; false: no further game is begun, and the one that has just
///                    been played may have been cut short and does not count
/// Errors   of the schedule, two teams of one name, a store that cannot be read or written. What had been played by then is in the store.
Result<TournamentSummary> play_tournament(const TournamentSpec& spec, const PlayGame& play,
                                          const std::function<void(const GameRow&)>& on_game = {},
                                          const std::function<bool()>& keep_going = {});

/// Hash of the names and bytes of all files below a folder, but for hidden ones and what Python leaves behind (`__pycache__`).
/// Errors   a folder or file that cannot be read, or more than 1 GiB of them.
Result<std::string> content_of(const std::string& folder);

/// --- reports.cpp ---

/// Table of a tournament for people.
std::string as_text(const TournamentSummary& summary);
/// Files of a spreadsheet: a line for each team, each pair, each game.
std::string table_csv(const TournamentSummary& summary);
std::string pairs_csv(const TournamentSummary& summary);
std::string games_csv(const TournamentSummary& summary);

}  // namespace sandlot::tournament
