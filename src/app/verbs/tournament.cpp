/// sandlot tournament: games of several teams, a table with ratings, and a page.
#include "app/tournament.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "app/demos.h"
#include "app/interrupt.h"
#include "base/atomic_file.h"
#include "base/hash.h"
#include "base/json_text.h"
#include "base/program.h"
#include "base/text.h"
#include "run/fields_json.h"

namespace sandlot::app {
namespace {

namespace fs = std::filesystem;
using tournament::GameRow;
using tournament::Team;
using tournament::TournamentSummary;

bool is_team(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "team.yaml", ignored);
}

Result<std::string> file_hash(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return Error{"'" + file + "' cannot be read"};
  const std::string content(std::istreambuf_iterator<char>(in), {});
  return fmt::format("{:016x}", hash64(content));
}

/// All that makes a game, but for teams, sides and seed: settings, scenario and the code of this program.
Result<std::string> options_of(const MatchSpec& match) {
  std::string out;
  const auto add = [&](const std::string& text) { out += (out.empty() ? "" : "; ") + text; };
  const auto choose = [&](const char* name, const std::string& value) {
    if (!value.empty()) add(std::string(name) + "=" + value);
  };
  choose("drive", match.drive);
  choose("sense", match.sense);
  choose("engine", match.engine);
  choose("size", match.size);
  if (match.half_s) choose("half", number_text(*match.half_s));
  for (const formats::Override& each : match.run.spec.overrides) add(each.path + "=" + each.value);
  SL_ASSIGN(const std::string scenario, demo_file("match"));
  SL_ASSIGN(const std::string hash, file_hash(scenario));
  add("scenario " + hash);
  if (const fs::path parts = fs::path(scenario).parent_path() / "parts"; fs::is_directory(parts)) {
    SL_ASSIGN(const std::string content, tournament::content_of(parts.string()));
    add("parts " + content);
  }
  for (const std::string& file : program_files()) {
    SL_ASSIGN(const std::string content, file_hash(file));
    add("program " + content);
  }
  return out;
}

Result<tournament::GameResult> play(const TournamentOptions& options, const tournament::Match& game) {
  MatchSpec spec = options.match;
  for (std::size_t i = 0; i < 2; ++i) spec.teams[i] = game.teams[i].folder;
  spec.run.spec.seed = game.game.seed;
  spec.run.spec.threads = 1;
  spec.run.spec.record_file = game.recording;
  SL_ASSIGN(const Match played, play_match(spec, false));
  const MatchResult& result = played.result;
  // A run that failed for no team's fault is no result.
  if (!played.summary.errors.empty() && result.walk_over.empty()) return Error{played.summary.errors.front()};
  tournament::GameResult out;
  out.goals = result.goals;
  out.walk_over = !result.walk_over.empty();
  out.reason = out.walk_over ? result.walk_over : played.summary.stopped;
  out.state_hash = result.state_hash;
  out.sim_s = result.sim_s;
  out.recording = result.recording;
  return out;
}

Status write_files(const TournamentOptions& options, const TournamentSummary& summary) {
  const auto write = [&](const char* name, const std::string& text) {
    return write_file((fs::path(options.out) / name).string(), text);
  };
  SL_TRY(write("table.csv", table_csv(summary)));
  SL_TRY(write("pairs.csv", pairs_csv(summary)));
  SL_TRY(write("games.csv", games_csv(summary)));
  SL_TRY(write("tournament.json", json_text(fields_json(summary)) + "\n"));
  std::string source = fmt::format("Made by `sandlot tournament --format {} --seeds {}", summary.format,
                                   options.games);
  if (options.rounds > 0) source += fmt::format(" --rounds {}", options.rounds);
  return write("index.html", tournament_page(summary, source + "`."));
}

}  // namespace

Result<std::vector<Team>> teams_of(const std::vector<std::string>& folders) {
  std::vector<std::string> found;
  for (const std::string& folder : folders) {
    if (is_team(folder)) {
      found.push_back(folder);
      continue;
    }
    std::error_code error;
    std::vector<std::string> inner;
    fs::directory_iterator each(folder, error);
    for (const fs::directory_iterator end; !error && each != end; each.increment(error))
      if (is_team(each->path())) inner.push_back(each->path().string());
    if (error)
      return Error{"'" + folder + "' cannot be read: " + error.message(), "name a folder with a team.yaml"};
    if (inner.empty())
      return Error{"there is no team in '" + folder + "'", "the folder of a team has a team.yaml"};
    std::sort(inner.begin(), inner.end());
    found.insert(found.end(), inner.begin(), inner.end());
  }
  std::vector<Team> out;
  std::set<std::string> names;
  for (const std::string& folder : found) {
    SL_ASSIGN(const formats::TeamSoftware software, formats::read_team_software(folder));
    Team team{software.name, "", folder};
    SL_ASSIGN(team.content, tournament::content_of(folder));
    for (int i = 2; !names.insert(sanitised(team.name)).second; ++i)
      team.name = fmt::format("{} {}", software.name, i);
    out.push_back(std::move(team));
  }
  return out;
}

int play_tournament(const TournamentOptions& options) {
  tournament::TournamentSpec spec{
      .format = options.format, .teams = {}, .games = options.games, .rounds = options.rounds};
  spec.first_seed = options.first_seed;
  spec.at_a_time = options.jobs;
  auto teams = teams_of(options.folders);
  if (!teams) return complain(teams.error());
  spec.teams = std::move(*teams);
  std::error_code error;
  fs::create_directories(fs::path(options.out) / (options.records ? "games" : "."), error);
  if (error)
    return complain({"--out " + options.out + ": " + error.message(), "name a folder that can be written"});
  auto settings = options_of(options.match);
  if (!settings) return complain(settings.error());
  spec.options = std::move(*settings);
  spec.store_file = (fs::path(options.out) / "results.db").string();
  if (options.records) spec.recordings = (fs::path(options.out) / "games").string();

  catch_interrupts();
  int ended = 0;
  const auto show = [&](const GameRow& game) {
    ++ended;
    if (options.json) return;
    fmt::print("{:>5}  round {}  {} {} : {} {}{}{}\n", ended, game.round, game.left, game.goals_left,
               game.goals_right, game.right, game.stored ? "  (from the store)" : "",
               game.walk_over ? "  walk-over: " + game.reason : "");
    std::fflush(stdout);
  };
  const auto summary = tournament::play_tournament(
      spec, [&](const tournament::Match& game) { return play(options, game); }, show,
      [] { return !interrupted(); });
  if (!summary) return complain(summary.error());
  if (Status written = write_files(options, *summary); !written) return complain(written.error());
  if (options.json) fmt::print("{}\n", json_text(fields_json(*summary)));
  else fmt::print("{}{}\n", as_text(*summary), (fs::path(options.out) / "index.html").string());
  return summary->ended ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
