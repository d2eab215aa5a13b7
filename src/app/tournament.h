#pragma once
/// A tournament of teams of robot soccer: run/tournament with matches in processes of their own (app/game_process.h).
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/match.h"
#include "run/tournament/tournament.h"

namespace sandlot::app {

struct TournamentOptions {
  std::vector<std::string> folders;  ///< of teams, or folders whose sub-folders are teams
  std::string out;                   ///< folder for page, tables, results and recordings
  tournament::Format format = tournament::Format::round_robin;
  int games = 2;   ///< of each meeting
  int rounds = 0;  ///< of a swiss tournament; 0: by the number of teams
  std::uint64_t first_seed = 1;
  int jobs = 0;  ///< games at a time; 0: as many as the machine has processors
  std::optional<double>
      game_limit_s;  ///< wall time of a game; unset: an hour, or 20 times the time of play if that is longer
  MatchSpec match;   ///< how each game is played; its teams, seed and recording are set here
  bool records = true;  ///< every game
  bool json = false;
};

/// Teams of folders: one with a team.yaml is a team; of another, each sub-folder with one, by name. A team that is named twice plays against
/// itself, and the second one is called "Name 2".
/// A team's content is the hash of the files of its folder and of those outside that its team.yaml names: models, plugins, programs.
/// Errors   a folder without a team, a team.yaml that cannot be read.
Result<std::vector<tournament::Team>> teams_of(const std::vector<std::string>& folders);

/// Decision of the referee in a recording.
struct RecordedDecision {
  double time_s = 0;
  std::string rule, team, robot, reason;
  std::vector<std::uint32_t> score;
};
/// Decisions of a recorded game, in their order; none where it has no referee.
/// Errors   no recording, a message that cannot be read.
Result<std::vector<RecordedDecision>> decisions_of(const std::string& recording);

/// Page of a tournament: table, strengths as a figure, meetings, games. One HTML file that needs no network.
/// Games with a recording have a link to it and to their own page.
/// @param source  how it was made
std::string tournament_page(const tournament::TournamentSummary& summary, const std::string& source);

/// Page of a recorded game, which lies beside the recording: its decisions, each with the command that shows the recording from there.
std::string game_page(const tournament::GameRow& game, const std::vector<RecordedDecision>& decisions);
/// File of a game's page: that of its recording with another ending.
std::string game_page_file(const std::string& recording);

/// The verb.
int play_tournament(const TournamentOptions& options);

}  // namespace sandlot::app
