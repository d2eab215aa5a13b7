#pragma once
/// A tournament of teams of robot soccer: run/tournament with the matches of app/match.
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
  int jobs = 0;         ///< games at a time; 0: as many as the machine has processors
  MatchSpec match;      ///< how each game is played; its teams, seed and recording are set here
  bool records = true;  ///< every game
  bool json = false;
};

/// Teams of folders: one with a team.yaml is a team; of another, each sub-folder with one, by name. A team that is named twice plays against
/// itself, and the second one is called "Name 2".
/// Errors   a folder without a team, a team.yaml that cannot be read.
Result<std::vector<tournament::Team>> teams_of(const std::vector<std::string>& folders);

/// Page of a tournament: table, strengths as a figure, meetings, games. One HTML file that needs no network.
/// @param source  how it was made
std::string tournament_page(const tournament::TournamentSummary& summary, const std::string& source);

/// The verb.
int play_tournament(const TournamentOptions& options);

}  // namespace sandlot::app
