/// Options of the verb that plays many matches: tournament.
#include <CLI/CLI.hpp>

#include "app/flags.h"
#include "app/options/options.h"
#include "app/options/shared.h"
#include "app/tournament.h"

namespace sandlot::app {
namespace {

struct TournamentFlags {
  TournamentOptions options;
  DurationOption duration, game_limit;
  std::string format = "round-robin";
  std::vector<std::string> sets;

  Status finish() {
    SL_ASSIGN(options.format, tournament::read_format(format));
    if (options.rounds > 0 && options.format != tournament::Format::swiss)
      return Error{"--rounds: only a swiss tournament has a number of rounds",
                   "leave it out, or add --format swiss"};
    SL_TRY(read_half(duration, options.match.half_s));
    SL_TRY(game_limit.read("--game-limit", options.game_limit_s));
    if (options.game_limit_s && !(*options.game_limit_s > 0))
      return Error{"--game-limit: a game needs some time", "give more, such as '30 min'"};
    return read_sets(sets, options.match.run.spec.overrides);
  }
};

}  // namespace

void add_tournament(CommandLine& line) {
  TournamentFlags& flags = line.keep<TournamentFlags>();
  TournamentOptions& options = flags.options;
  CLI::App* const verb = line.app.add_subcommand("tournament", "Let teams of robot soccer play a tournament");
  verb->add_option("folders", options.folders,
                   "Folders of teams, each with a team.yaml, or folders of such folders; in a knockout the "
                   "strongest first")
      ->required();
  verb->add_option("--format", flags.format, "How teams meet")
      ->check(CLI::IsMember({"round-robin", "swiss", "knockout"}))
      ->capture_default_str();
  verb->add_option("--seeds", options.games,
                   "Games of each meeting, with seeds that follow each other; sides alternate")
      ->check(CLI::Range(1, tournament::most_games))
      ->capture_default_str();
  verb->add_option("--first-seed", options.first_seed, "Seed of the first game of each meeting")
      ->capture_default_str();
  verb->add_option("--rounds", options.rounds,
                   "Rounds of a swiss tournament; by the number of teams if left out")
      ->check(CLI::Range(1, 1000));
  verb->add_option("--out", options.out,
                   "Folder for page, tables, recordings and results. Games whose results are there are not "
                   "played again")
      ->required();
  verb->add_option("--jobs", options.jobs,
                   "Games at a time; as many as the machine has processors if left out")
      ->check(CLI::Range(1, 1024));
  verb->add_option(
      "--game-limit", flags.game_limit.text,
      "Wall time after which a game is ended and counts as not played, such as '30 min'; if left out an "
      "hour, or 20 times --duration where that is longer");
  verb->add_flag("!--no-recordings", options.records, "Record no game");
  verb->add_option("--level", options.match.sense, "Level of the robots' senses")
      ->check(CLI::IsMember({"image", "objects", "world"}));
  verb->add_option("--drive", options.match.drive, "Level of the robots' drives")
      ->check(CLI::IsMember({"ideal", "contact", "roller"}));
  verb->add_option("--physics", options.match.engine, "Engine: planar knows no lobs and no rollers")
      ->check(CLI::IsMember({"rigid", "planar"}));
  verb->add_option("--size", options.match.size, "Size of the field in metres")
      ->check(CLI::IsMember({"22x14", "18x12", "12x8"}));
  verb->add_option("--duration", flags.duration.text,
                   "Time of play in both halves together, such as '4 min'; the scenario's if left out");
  add_sets(*verb, flags.sets);
  add_json(*verb, options.json);
  verb->footer(
      "Example: sandlot tournament teams --seeds 10 --out cup\n"
      "         sandlot tournament teams/passing teams/dribbling --format knockout --seeds 3 --out final");
  verb->callback([&line, &flags] {
    if (Status status = flags.finish(); !status) line.result = complain(status.error());
    else line.result = play_tournament(flags.options);
  });
}

}  // namespace sandlot::app
