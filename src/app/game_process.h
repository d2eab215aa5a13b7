#pragma once
/// A game of a tournament in a process of its own: `sandlot match`, whose result is read from what it prints.
///
/// Isolation  a game that crashes, or that goes on for too long, ends alone, with the programs that it has started.
/// Time       a game gets SIGTERM at the end of its time, or when the tournament is interrupted, and SIGKILL two seconds later. It is
///            killed by the kernel when the tournament is.
/// Errors     no result, and why: the last error that the game printed, the signal that ended it, or its time.
#include <string>
#include <vector>

#include "app/match.h"
#include "run/tournament/tournament.h"

namespace sandlot::app {

/// Command line of a game: what `sandlot match` is called with, without the program.
/// @param spec  level, length and overrides; teams, seed and recording are those of `game`
std::vector<std::string> match_arguments(const MatchSpec& spec, const tournament::Match& game);

/// Result of a game from the JSON that `sandlot match --json` prints.
/// Errors   a text that is none, or lacks a value.
Result<tournament::GameResult> read_game(const std::string& text);

/// @param limit_s  wall time that the game may take
Result<tournament::GameResult> play_in_process(const std::vector<std::string>& arguments, double limit_s);

}  // namespace sandlot::app
