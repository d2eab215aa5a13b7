#include "run/tournament/tournament.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <thread>

#include "base/hash.h"
#include "base/text.h"
#include "statistics/ratings.h"
#include "statistics/store.h"

namespace sandlot::tournament {
namespace {

/// Results of the games, by teams, sides and seed.
class Results {
 public:
  static Result<Results> open(const TournamentSpec& spec) {
    Results out;
    if (spec.store_file.empty()) return out;
    SL_ASSIGN(auto store, statistics::ResultStore::open(spec.store_file));
    out.store_.emplace(std::move(store));
    return out;
  }

  Result<std::optional<GameResult>> find(const TournamentSpec& spec, const Match& match) {
    if (!store_) return std::optional<GameResult>();
    SL_ASSIGN(const std::int64_t experiment, experiment_of(spec, match));
    SL_ASSIGN(const auto runs, store_->runs(experiment, match.game.seed, 1));
    if (runs.empty()) return std::optional<GameResult>();
    return std::optional(from_stored(runs.front()));
  }

  Status add(const TournamentSpec& spec, const Match& match, const GameResult& result) {
    if (!store_) return {};
    SL_ASSIGN(const std::int64_t experiment, experiment_of(spec, match));
    const auto [left, right] = result.goals;
    std::vector<statistics::StoredCriterion> criteria{{"", double(left - right), !result.walk_over},
                                                      {"left", double(left), std::nullopt},
                                                      {"right", double(right), std::nullopt}};
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}})
      if (result.penalty_kicks[i] > 0)
        criteria.push_back({kicks_of[i], double(result.penalty_kicks[i]), std::nullopt});
    return store_->add(experiment, {match.game.seed, result.sim_s, result.reason,
                                    hash_text(result.state_hash.value), std::move(criteria)});
  }

 private:
  static constexpr std::array<const char*, 2> kicks_of{"left penalties", "right penalties"};

  Result<std::int64_t> experiment_of(const TournamentSpec& spec, const Match& match) {
    const auto& [left, right] = match.teams;
    const auto known = experiments_.find({left.content, right.content});
    if (known != experiments_.end()) return known->second;
    std::uint64_t hash = hash64("game of a tournament, 1");
    for (const std::string& each : {left.content, right.content, spec.options})
      hash = hash_combine(hash, hash64(each));
    SL_ASSIGN(const std::int64_t number,
              store_->experiment(
                  {fmt::format("game {:016x}", hash), left.name + " : " + right.name, "", spec.options}));
    experiments_.emplace(std::pair(left.content, right.content), number);
    return number;
  }

  static GameResult from_stored(const statistics::StoredRun& stored) {
    GameResult out;
    out.sim_s = stored.end_s;
    out.reason = stored.stopped;
    std::from_chars(stored.state_hash.data(), stored.state_hash.data() + stored.state_hash.size(),
                    out.state_hash.value, 16);
    for (const statistics::StoredCriterion& each : stored.criteria) {
      if (each.team.empty()) out.walk_over = !each.success.value_or(true);
      else if (each.team == "left") out.goals[0] = static_cast<int>(each.value.value_or(0));
      else if (each.team == "right") out.goals[1] = static_cast<int>(each.value.value_or(0));
      for (const std::size_t i : {std::size_t{0}, std::size_t{1}})
        if (each.team == kicks_of[i]) out.penalty_kicks[i] = static_cast<int>(each.value.value_or(0));
    }
    return out;
  }

  std::optional<statistics::ResultStore> store_;
  std::map<std::pair<std::string, std::string>, std::int64_t> experiments_;
};

Match match_of(const TournamentSpec& spec, const Game& game) {
  const Team &left = spec.teams[game.teams[0]], &right = spec.teams[game.teams[1]];
  Match out{.game = game, .teams = {left, right}, .recording = "", .name = ""};
  out.name = fmt::format("r{}_{}_{}_s{}", game.round, sanitised(left.name), sanitised(right.name), game.seed);
  if (!spec.recordings.empty())
    out.recording = (std::filesystem::path(spec.recordings) / (out.name + ".mcap")).string();
  return out;
}

GameRow row_of(const Match& match, const GameResult& result, bool stored) {
  GameRow out;
  out.round = match.game.round;
  out.left = match.teams[0].name;
  out.right = match.teams[1].name;
  out.goals_left = result.goals[0];
  out.goals_right = result.goals[1];
  out.penalties_left = result.penalty_kicks[0];
  out.penalties_right = result.penalty_kicks[1];
  out.walk_over = result.walk_over;
  out.replay = match.game.replay;
  out.stored = stored;
  out.seed = match.game.seed;
  out.sim_s = result.sim_s;
  out.reason = result.reason;
  out.recording = result.recording;
  out.state_hash = result.state_hash;
  return out;
}

GameRow row_without_result(const Match& match, const Error& why) {
  GameRow out = row_of(match, {}, false);
  out.played = false;
  out.reason = why.text();
  return out;
}

std::string note_of(const statistics::Rating& rating, const statistics::Ratings& all,
                    const Standing& standing) {
  using statistics::Bound;
  std::string out;
  const auto add = [&](const char* text) { out += (out.empty() ? "" : "; ") + std::string(text); };
  switch (rating.bound) {
    case Bound::games: break;
    case Bound::no_games: add("no games: the strength is the prior's"); break;
    case Bound::only_wins: add("won every game: the prior bounds the strength"); break;
    case Bound::only_losses: add("lost every game: the prior bounds the strength"); break;
    case Bound::one_sided:
      add("some opponents only won, or only lost: the prior bounds the distance to them");
      break;
  }
  if (all.groups > 1 && rating.games > 0) add("no game connects it with all the others");
  if (standing.by_order) add("a meeting was decided by the order of the teams");
  return out;
}

void add_table(TournamentSummary& out, const TournamentSpec& spec, const Schedule& schedule,
               const std::vector<ScoredGame>& played) {
  std::vector<statistics::PlayedGame> games;
  for (const ScoredGame& each : played)
    games.push_back({each.game.teams[0], each.game.teams[1], double(each.goals[0]), double(each.goals[1])});
  const statistics::Ratings ratings = statistics::rate(spec.teams.size(), games);
  out.tie = ratings.tie;
  out.groups = ratings.groups;
  for (const Standing& each : standings(schedule, played)) {
    const statistics::Rating& rating = ratings.players[each.team];
    out.table.push_back({spec.teams[each.team].name, each.played, each.won, each.drawn, each.lost, each.goals,
                         each.against, each.points, each.byes, rating.strength, rating.interval.low,
                         rating.interval.high, note_of(rating, ratings, each)});
  }
  for (const statistics::PairScores& pair : statistics::pair_scores(games)) {
    PairRow row;
    row.a = spec.teams[pair.a].name;
    row.b = spec.teams[pair.b].name;
    row.games = pair.difference.count();
    row.won = pair.wins_a;
    row.drawn = pair.ties;
    row.lost = pair.wins_b;
    row.difference = pair.difference.mean();
    if (row.games > 1) row.low = pair.interval.low, row.high = pair.interval.high;
    out.pairs.push_back(row);
  }
}

Status check_teams(const TournamentSpec& spec) {
  if (spec.at_a_time < 0 || spec.at_a_time > 1024)
    return Error{"the number of games at a time must be in [0, 1024], is " + std::to_string(spec.at_a_time)};
  std::map<std::string, std::string> folders;
  for (const Team& team : spec.teams)
    if (const auto [known, added] = folders.emplace(sanitised(team.name), team.folder); !added)
      return Error{"two teams are called '" + team.name + "': " + known->second + " and " + team.folder,
                   "change the name in the team.yaml of one of them"};
  return {};
}

/// Plays games that do not depend on each other.
class Round {
 public:
  Round(const TournamentSpec& spec, Results& results, const PlayGame& play,
        const std::function<void(const GameRow&)>& on_game, const std::function<bool()>& keep_going)
      : spec_(spec), results_(results), play_(play), on_game_(on_game), keep_going_(keep_going) {}

  /// Results in the order of the games; nothing for those that were not played any more.
  Result<std::vector<std::optional<GameRow>>> run(const std::vector<Game>& games) {
    std::vector<std::optional<GameRow>> rows(games.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
      for (std::size_t i = next++; i < games.size() && may_go_on(); i = next++) {
        auto row = one(match_of(spec_, games[i]));
        const std::lock_guard lock(mutex_);
        if (!row) {
          if (!failed_) failed_ = std::move(row.error());
          return;
        }
        if (on_game_ && *row) on_game_(**row);
        rows[i] = std::move(*row);
      }
    };
    const std::size_t processors = std::max(1u, std::thread::hardware_concurrency());
    const std::size_t workers = std::min(
        games.size(), spec_.at_a_time > 0 ? static_cast<std::size_t>(spec_.at_a_time) : processors);
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < workers; ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    if (failed_) return *failed_;
    return rows;
  }

 private:
  bool may_go_on() {
    {
      const std::lock_guard lock(mutex_);
      if (failed_) return false;
    }
    return !keep_going_ || keep_going_();
  }

  /// Nothing: it may have been cut short.
  Result<std::optional<GameRow>> one(const Match& match) {
    {
      const std::lock_guard lock(mutex_);
      SL_ASSIGN(const auto known, results_.find(spec_, match));
      if (known) {
        GameRow row = row_of(match, *known, true);
        std::error_code ignored;
        if (std::filesystem::exists(match.recording, ignored)) row.recording = match.recording;
        return std::optional(row);
      }
    }
    auto result = play_(match);
    if (keep_going_ && !keep_going_()) return std::optional<GameRow>();
    if (!result) return std::optional(row_without_result(match, result.error()));
    const std::lock_guard lock(mutex_);
    SL_TRY(results_.add(spec_, match, *result));
    return std::optional(row_of(match, *result, false));
  }

  const TournamentSpec& spec_;
  Results& results_;
  const PlayGame& play_;
  const std::function<void(const GameRow&)>& on_game_;
  const std::function<bool()>& keep_going_;
  std::mutex mutex_;
  std::optional<Error> failed_;
};

}  // namespace

Result<TournamentSummary> play_tournament(const TournamentSpec& spec, const PlayGame& play,
                                          const std::function<void(const GameRow&)>& on_game,
                                          const std::function<bool()>& keep_going) {
  const Schedule schedule{spec.format, spec.teams.size(), spec.games, spec.rounds, spec.first_seed};
  SL_TRY(check(schedule));
  SL_TRY(check_teams(spec));
  SL_ASSIGN(Results results, Results::open(spec));
  TournamentSummary out;
  out.format = name_of(spec.format);
  std::vector<ScoredGame> played;
  bool whole = true;
  while (whole) {
    const std::vector<Game> games = next_games(schedule, played);
    out.ended = games.empty();
    if (out.ended) break;
    SL_ASSIGN(const auto rows, Round(spec, results, play, on_game, keep_going).run(games));
    for (std::size_t i = 0; i < games.size(); ++i) {
      whole = whole && rows[i] && rows[i]->played;
      if (!rows[i]) continue;
      if (!rows[i]->played) {
        ++out.not_played;
        out.games.push_back(*rows[i]);
        continue;
      }
      played.push_back({games[i],
                        {rows[i]->goals_left, rows[i]->goals_right},
                        rows[i]->penalties_left - rows[i]->penalties_right});
      out.stored += rows[i]->stored;
      out.games.push_back(*rows[i]);
    }
  }
  add_table(out, spec, schedule, played);
  return out;
}

Result<std::string> content_of(const std::string& folder) {
  namespace fs = std::filesystem;
  constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
  const auto refuse = [&](const std::error_code& error) {
    return Error{"'" + folder + "' cannot be read: " + error.message(), "name the folder of a team"};
  };
  std::error_code error;
  std::vector<fs::path> files;
  fs::recursive_directory_iterator each(folder, error);
  if (error) return refuse(error);
  for (const fs::recursive_directory_iterator end; each != end; each.increment(error)) {
    if (error) return refuse(error);
    const std::string name = each->path().filename().string();
    if (name.starts_with('.') || name == "__pycache__") {
      if (each->is_directory(error)) each.disable_recursion_pending();
    } else if (each->is_regular_file(error)) {
      files.push_back(each->path());
    }
  }
  if (error) return refuse(error);
  std::sort(files.begin(), files.end());
  std::uint64_t hash = hash64("team"), bytes = 0;
  for (const fs::path& file : files) {
    bytes += fs::file_size(file, error);
    if (error) return refuse(error);
    if (bytes > most_bytes)
      return Error{"'" + folder + "' has more than 1 GiB of files", "keep other files elsewhere"};
    std::ifstream in(file, std::ios::binary);
    if (!in) return Error{"'" + file.string() + "' cannot be read"};
    const std::string content(std::istreambuf_iterator<char>(in), {});
    hash = hash_combine(hash, hash64(file.lexically_relative(folder).generic_string()));
    hash = hash_combine(hash, hash64(content));
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace sandlot::tournament
