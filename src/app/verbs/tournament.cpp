/// sandlot tournament: games of several teams, a table with ratings, and a page.
#include "app/tournament.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "app/demos.h"
#include "app/game_process.h"
#include "app/interrupt.h"
#include "base/atomic_file.h"
#include "base/hash.h"
#include "base/json_text.h"
#include "base/program.h"
#include "base/text.h"
#include "files/resources.h"
#include "files/text.h"
#include "files/yaml.h"
#include "programs/child.h"
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
  if (const std::string models = own_folder("models"); !models.empty()) {
    SL_ASSIGN(const std::string content, tournament::content_of(models));
    add("models " + content);
  }
  for (const std::string& folder : client_folders()) {
    SL_ASSIGN(const std::string content, tournament::content_of(folder));
    add("clients " + content);
  }
  for (const std::string& file : program_files()) {
    SL_ASSIGN(const std::string content, file_hash(file));
    add("program " + content);
  }
  return out;
}

/// What a team depends on outside its folder, as far as its team.yaml names it.
class OutsideFolder {
 public:
  explicit OutsideFolder(const std::string& folder) : folder_(fs::weakly_canonical(folder, ignored_)) {}

  /// @param base  folder that names are relative to
  void look_at(const Node& node, const fs::path& base) {
    if (node.is_scalar()) add(base / node.text());
    for (const Node& item : node.items()) look_at(item, base);
    fs::path within = base;
    if (const Node* const folder = node.is_map() ? node.find("folder") : nullptr;
        folder && folder->is_scalar()) {
      within = base / folder->text();
      if (!is_inside(within) && fs::is_directory(within, ignored_)) folders_.insert(canonical(within));
    }
    for (const Node::Entry& entry : node.entries()) {
      look_at(entry.value, within);
      if (entry.key != "command" || entry.value.items().empty()) continue;
      const char* const path = std::getenv("PATH");
      add(programs::find_program(entry.value.items().front().text(), within.string(), path ? path : ""));
    }
  }

  /// `content` with what was found; as it is where there is nothing.
  Result<std::string> add_to(std::string content) const {
    for (const std::string& file : files_) {
      SL_ASSIGN(const std::string hash, file_hash(file));
      content += " " + hash;
    }
    for (const std::string& folder : folders_) {
      SL_ASSIGN(const std::string hash, tournament::content_of(folder));
      content += " " + hash;
    }
    return content;
  }

 private:
  std::string canonical(const fs::path& path) { return fs::weakly_canonical(path, ignored_).string(); }
  bool is_inside(const fs::path& path) {
    const fs::path relative = fs::weakly_canonical(path, ignored_).lexically_relative(folder_);
    return !relative.empty() && *relative.begin() != "..";
  }
  void add(const fs::path& path) {
    if (!path.empty() && fs::is_regular_file(path, ignored_) && !is_inside(path))
      files_.insert(canonical(path));
  }

  std::error_code ignored_;
  fs::path folder_;
  std::set<std::string> files_, folders_;
};

Result<std::string> team_content(const formats::TeamSoftware& software, const std::string& folder) {
  SL_ASSIGN(std::string content, tournament::content_of(folder));
  SL_ASSIGN(const std::string text, read_text_file(software.file, TextLimits{}.max_bytes));
  SL_ASSIGN(const Node root, parse_yaml(text, software.file));
  OutsideFolder outside(folder);
  outside.look_at(root, folder);
  return outside.add_to(std::move(content));
}

double game_limit_s(const TournamentOptions& options) {
  return options.game_limit_s.value_or(std::max(3600.0, 40 * options.match.half_s.value_or(0)));
}

Status write_files(const TournamentOptions& options, const TournamentSummary& summary) {
  const auto write = [&](const char* name, const std::string& text) {
    return write_file((fs::path(options.out) / name).string(), text);
  };
  SL_TRY(write("table.csv", table_csv(summary)));
  SL_TRY(write("pairs.csv", pairs_csv(summary)));
  SL_TRY(write("games.csv", games_csv(summary)));
  for (const GameRow& game : summary.games) {
    if (game.recording.empty()) continue;
    SL_ASSIGN(const std::vector<RecordedDecision> decisions, decisions_of(game.recording));
    SL_TRY(write_file(game_page_file(game.recording), game_page(game, decisions)));
  }
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
    SL_ASSIGN(team.content, team_content(software, folder));
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
    if (!game.played) {
      fmt::print("{:>5}  round {}  {} - {}  not played: {}\n", ended, game.round, game.left, game.right,
                 game.reason);
      std::fflush(stdout);
      return;
    }
    fmt::print("{:>5}  round {}  {} {} {}{}{}\n", ended, game.round, game.left, tournament::score_text(game),
               game.right, game.stored ? "  (from the store)" : "",
               game.walk_over ? "  walk-over: " + game.reason : "");
    std::fflush(stdout);
  };
  const auto summary = tournament::play_tournament(
      spec,
      [&](const tournament::Match& game) {
        return play_in_process(match_arguments(options.match, game), game_limit_s(options));
      },
      show, [] { return !interrupted(); });
  if (!summary) return complain(summary.error());
  if (Status written = write_files(options, *summary); !written) return complain(written.error());
  if (options.json) fmt::print("{}\n", json_text(fields_json(*summary)));
  else fmt::print("{}{}\n", as_text(*summary), (fs::path(options.out) / "index.html").string());
  return summary->ended ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
