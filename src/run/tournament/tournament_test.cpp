/// Tournaments: what is played, kept, and played again; table, ratings and files.
#include "run/tournament/tournament.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "base/hash.h"
#include "base/random.h"
#include "base/test_folder.h"
#include "run/fields_json.h"

namespace sandlot::tournament {
namespace {

using test::TestFolder;
using testing::HasSubstr;

/// Teams A, B, C...; a team's content is its name.
TournamentSpec tournament_spec(Format format, int teams, int games, const std::string& store = "") {
  TournamentSpec spec{
      .format = format, .teams = {}, .games = games, .rounds = 0, .first_seed = 1, .options = "half 60 s"};
  for (int i = 0; i < teams; ++i) {
    const std::string name(1, static_cast<char>('A' + i));
    spec.teams.push_back({name, "content of " + name, "teams/" + name});
  }
  spec.store_file = store;
  return spec;
}

/// Chance, but the same for the same game: the team with the earlier letter is better.
GameResult chance(const Match& match) {
  Stream stream(match.game.seed, hash64(match.teams[0].name + match.teams[1].name), Purpose::experiment, 0);
  GameResult out;
  for (std::size_t i = 0; i < 2; ++i)
    for (int shot = 0; shot < 6; ++shot)
      out.goals[i] += stream.uniform() < 0.6 - 0.1 * (match.teams[i].name[0] - 'A');
  out.reason = "the game ended";
  out.state_hash.value = stream.bits64();
  out.sim_s = 60.5;
  return out;
}

TournamentSummary finished(const TournamentSpec& spec, const PlayGame& play = chance) {
  auto all = play_tournament(spec, play);
  EXPECT_TRUE(all) << all.error().text();
  return all ? std::move(*all) : TournamentSummary();
}

/// Without what says where results come from.
std::string outcome(TournamentSummary summary) {
  summary.stored = 0;
  for (GameRow& row : summary.games) row.stored = false;
  return fields_json(summary).dump();
}

TEST(Tournament, GamesAtATimeChangeNothing) {
  for (const Format format : {Format::round_robin, Format::swiss, Format::knockout}) {
    TournamentSpec spec = tournament_spec(format, 5, 4);
    const std::string alone = outcome(finished(spec));
    for (const int at_a_time : {2, 7, 0}) {
      spec.at_a_time = at_a_time;
      EXPECT_EQ(outcome(finished(spec)), alone);
    }
  }
}

TEST(Tournament, TableAddsUpAndTheBetterTeamIsStrongerBeyondItsInterval) {
  const TournamentSummary all = finished(tournament_spec(Format::round_robin, 4, 40));
  EXPECT_TRUE(all.ended);
  ASSERT_EQ(all.games.size(), 240u);
  ASSERT_EQ(all.table.size(), 4u);
  int goals = 0, against = 0, points = 0;
  double strengths = 0;
  for (const TableRow& row : all.table) {
    EXPECT_EQ(row.played, 120);
    EXPECT_EQ(row.won + row.drawn + row.lost, row.played);
    EXPECT_LT(row.low, row.strength);
    EXPECT_LT(row.strength, row.high);
    goals += row.goals, against += row.against, points += row.points;
    strengths += row.strength;
  }
  EXPECT_EQ(goals, against);
  EXPECT_NEAR(strengths, 0, 1e-9);
  int decided = 0;
  for (const GameRow& row : all.games) decided += row.goals_left != row.goals_right;
  EXPECT_EQ(points, 3 * decided + 2 * (240 - decided));
  EXPECT_EQ(all.table.front().team, "A");
  EXPECT_EQ(all.table.back().team, "D");
  EXPECT_GT(all.table.front().low, all.table.back().high);
  ASSERT_EQ(all.pairs.size(), 6u);
  const PairRow& pair = all.pairs[2];  // A and D: 0.3 x 6 goals apart; variance of a game 6 (0.24 + 0.21)
  EXPECT_EQ(pair.a + pair.b, "AD");
  EXPECT_EQ(pair.games, 40u);
  EXPECT_NEAR(pair.difference, 1.8, 5 * std::sqrt(2.7 / 40));
  EXPECT_NEAR(*pair.high - *pair.low, 2 * 2.0227 * std::sqrt(2.7 / 40),
              0.35);  // t of 39; deviation +- 5 / sqrt(78)
}

TEST(Tournament, WhatIsInTheStoreIsNotPlayedAgain) {
  const TestFolder folder;
  const std::string store = folder.file("results.db");
  TournamentSpec spec = tournament_spec(Format::swiss, 5, 2, store);
  const std::string whole = outcome(finished(tournament_spec(Format::swiss, 5, 2)));
  // Stopped within the eighth game, which does not count.
  std::atomic<int> count = 0;
  const auto part = play_tournament(
      spec, [&](const Match& match) { return ++count, chance(match); }, {}, [&] { return count < 8; });
  ASSERT_TRUE(part) << part.error().text();
  EXPECT_FALSE(part->ended);
  EXPECT_EQ(part->games.size(), 7u);
  EXPECT_THAT(as_text(*part), HasSubstr("not at its end"));
  count = 0;
  const TournamentSummary rest = finished(spec, [&](const Match& match) { return ++count, chance(match); });
  EXPECT_TRUE(rest.ended);
  EXPECT_EQ(count, 12 - 7);  // three rounds of two meetings with two games
  EXPECT_EQ(rest.stored, 7u);
  EXPECT_EQ(outcome(rest), whole);
  // Other options, another content: other games.
  count = 0;
  spec.options = "half 30 s";
  finished(spec, [&](const Match& match) { return ++count, chance(match); });
  EXPECT_EQ(count, 12);
  count = 0;
  spec.options = "half 60 s";
  spec.teams[0].content = "changed";
  const TournamentSummary changed = finished(spec,
                                             [&](const Match& match) { return ++count, chance(match); });
  int of_a = 0;
  for (const GameRow& row : changed.games) of_a += row.left == "A" || row.right == "A";
  EXPECT_EQ(count, of_a);
  EXPECT_GT(of_a, 0);
}

TEST(Tournament, SidesAreDifferentGamesAndTheOrderOfTeamsIsNone) {
  const TestFolder folder;
  TournamentSpec spec = tournament_spec(Format::round_robin, 3, 2, folder.file("results.db"));
  const TournamentSummary first = finished(spec);
  std::set<std::uint64_t> hashes;
  for (const GameRow& row : first.games) hashes.insert(row.state_hash.value);
  EXPECT_EQ(hashes.size(), 6u);
  // The same teams in another order meet on other sides in some games, with the same result where they meet on the same.
  std::reverse(spec.teams.begin(), spec.teams.end());
  const TournamentSummary second = finished(spec);
  TournamentSpec without = spec;
  without.store_file = "";
  EXPECT_EQ(outcome(second), outcome(finished(without)));
  for (const GameRow& b : second.games)
    for (const GameRow& a : first.games) {
      if (a.left != b.left || a.right != b.right || a.seed != b.seed) continue;
      EXPECT_TRUE(b.stored);
      EXPECT_EQ(a.state_hash, b.state_hash);
    }
}

TEST(Tournament, GoesOnAfterItWasKilled) {
  const TestFolder folder;
  const TournamentSpec spec = tournament_spec(Format::knockout, 6, 3, folder.file("results.db"));
  // A process that kills itself within its fifth game, as kill -9 does.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    int begun = 0;
    (void)play_tournament(spec, [&](const Match& match) {
      if (++begun == 5) kill(getpid(), SIGKILL);
      return chance(match);
    });
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  std::atomic<std::size_t> count = 0;
  const TournamentSummary rest = finished(spec, [&](const Match& match) { return ++count, chance(match); });
  EXPECT_TRUE(rest.ended);
  EXPECT_EQ(rest.stored, 4u);
  EXPECT_EQ(count, rest.games.size() - 4);
  EXPECT_EQ(outcome(rest), outcome(finished(tournament_spec(Format::knockout, 6, 3))));
}

TEST(Tournament, WalkOversAreKeptWithTheirReason) {
  const TestFolder folder;
  const TournamentSpec spec = tournament_spec(Format::round_robin, 2, 2, folder.file("results.db"));
  const auto never_there = [](const Match& match) {
    const std::size_t loser = match.teams[0].name == "B" ? 0 : 1;
    GameResult out;
    out.goals[1 - loser] = 3;
    out.walk_over = true;
    out.reason = "B loses by rule: none of its programs answered, \"no\"";
    return out;
  };
  const TournamentSummary first = finished(spec, never_there), second = finished(spec, never_there);
  EXPECT_EQ(second.stored, 2u);
  EXPECT_EQ(outcome(first), outcome(second));
  EXPECT_TRUE(second.games[0].walk_over);
  EXPECT_EQ(second.games[0].reason, "B loses by rule: none of its programs answered, \"no\"");
  EXPECT_EQ(second.table[0].points, 6);
  EXPECT_THAT(second.table[0].note, HasSubstr("won every game"));
  EXPECT_THAT(as_text(second), HasSubstr("2 by walk-over"));
  EXPECT_THAT(games_csv(second), HasSubstr("\"B loses by rule: none of its programs answered, \"\"no\"\"\""));
}

TEST(Tournament, RecordingsOfStoredGamesAreFoundAgain) {
  const TestFolder folder;
  TournamentSpec spec = tournament_spec(Format::round_robin, 2, 2, folder.file("results.db"));
  spec.recordings = folder.path.string();
  const auto recorded = [&](const Match& match) {
    GameResult out = chance(match);
    if (match.game.seed == 1) out.recording = folder.write(match.name + ".mcap", "bytes");
    return out;
  };
  const TournamentSummary first = finished(spec, recorded), second = finished(spec, recorded);
  EXPECT_EQ(second.stored, 2u);
  EXPECT_EQ(first.games[0].recording, folder.file("r1_A_B_s1.mcap"));
  EXPECT_EQ(second.games[0].recording, first.games[0].recording);
  EXPECT_EQ(second.games[1].recording, "");
}

TEST(Tournament, AGameWithoutAResultIsNamedAndTheOthersOfItsRoundArePlayed) {
  const TestFolder folder;
  const TournamentSpec spec = tournament_spec(Format::round_robin, 3, 2, folder.file("results.db"));
  std::string failed;
  int count = 0;
  const auto fails_once = [&](const Match& match) -> Result<GameResult> {
    if (++count != 4) return chance(match);
    failed = match.teams[0].name + match.teams[1].name;
    return Error{"it was ended by signal 11"};
  };
  std::string shown;
  const auto first = play_tournament(spec, fails_once, [&](const GameRow& row) {
    if (!row.played) shown += row.left + row.right;
  });
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_FALSE(first->ended);
  EXPECT_EQ(first->not_played, 1u);
  EXPECT_EQ(count, 6);
  EXPECT_EQ(shown, failed);
  ASSERT_EQ(first->games.size(), 6u);
  const GameRow& row = first->games[3];
  EXPECT_FALSE(row.played);
  EXPECT_EQ(row.left + row.right, failed);
  EXPECT_THAT(row.reason, HasSubstr("signal 11"));
  // Two teams have played three games, one all four.
  int games = 0;
  for (const TableRow& team : first->table) games += team.played;
  EXPECT_EQ(games, 10);
  EXPECT_THAT(as_text(*first), HasSubstr("5 games, 1 more could not be played; not at its end"));
  EXPECT_THAT(games_csv(*first), HasSubstr(",false,false,false,it was ended by signal 11,"));
  // Once more: it alone.
  const TournamentSummary second = finished(spec);
  EXPECT_TRUE(second.ended);
  EXPECT_EQ(second.stored, 5u);
  EXPECT_EQ(second.not_played, 0u);
  EXPECT_EQ(outcome(second), outcome(finished(tournament_spec(Format::round_robin, 3, 2))));
}

TEST(Tournament, LaterRoundsWaitForAGameWithoutAResult) {
  const TestFolder folder;
  const TournamentSpec spec = tournament_spec(Format::knockout, 4, 1, folder.file("results.db"));
  const auto without_d = [&](const Match& match) -> Result<GameResult> {
    if (match.teams[0].name == "D" || match.teams[1].name == "D") return Error{"no"};
    GameResult out = chance(match);
    out.goals = {1, 0};
    return out;
  };
  const auto first = play_tournament(spec, without_d);
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_FALSE(first->ended);
  ASSERT_EQ(first->games.size(), 2u);  // both semi-finals, not the final
  EXPECT_EQ(first->not_played, 1u);
}

TEST(Tournament, PenaltyKicksAreStoredAndDecideAMeeting) {
  const TestFolder folder;
  const TournamentSpec spec = tournament_spec(Format::knockout, 2, 1, folder.file("results.db"));
  const auto b_wins = [&](const Match& match) -> Result<GameResult> {
    GameResult out = chance(match);
    out.goals = {1, 1};
    out.penalty_kicks = match.teams[0].name == "B" ? std::array{3, 2} : std::array{2, 3};
    return out;
  };
  for (const std::uint64_t stored : {0u, 1u}) {
    const auto all = play_tournament(spec, b_wins);
    ASSERT_TRUE(all) << all.error().text();
    EXPECT_TRUE(all->ended);
    EXPECT_EQ(all->stored, stored);
    ASSERT_EQ(all->games.size(), 1u);
    EXPECT_EQ(all->table[0].team, "B");
    EXPECT_EQ(score_text(all->games[0]), all->games[0].left == "B" ? "1 : 1 (3 : 2 by penalty kicks)"
                                                                   : "1 : 1 (2 : 3 by penalty kicks)");
  }
}

TEST(Tournament, RefusesTwoTeamsOfOneNameAndStoresThatAreNone) {
  const TestFolder folder;
  TournamentSpec spec = tournament_spec(Format::round_robin, 2, 1);
  spec.teams[1].name = "A";
  EXPECT_THAT(play_tournament(spec, chance).error().text(), HasSubstr("two teams are called 'A'"));
  spec = tournament_spec(Format::round_robin, 2, 1, folder.write("notes.txt", std::string(4096, 'x')));
  EXPECT_THAT(play_tournament(spec, chance).error().text(), HasSubstr("is not a store of results"));
  spec = tournament_spec(Format::round_robin, 1, 1);
  EXPECT_THAT(play_tournament(spec, chance).error().text(), HasSubstr("two teams"));
}

TEST(TournamentReports, HaveALineForEachRow) {
  const TournamentSummary all = finished(tournament_spec(Format::round_robin, 3, 2));
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  EXPECT_EQ(lines(table_csv(all)), 4);
  EXPECT_EQ(lines(pairs_csv(all)), 4);
  EXPECT_EQ(lines(games_csv(all)), 7);
  EXPECT_TRUE(table_csv(all).starts_with(
      "team,played,won,drawn,lost,goals,against,points,byes,strength,low,high,note\n"));
  const GameRow& game = all.games[0];
  EXPECT_THAT(games_csv(all),
              HasSubstr("1," + game.left + "," + game.right + "," + std::to_string(game.goals_left) + "," +
                        std::to_string(game.goals_right) + ",1,true,false,false,the game ended,60.5," +
                        hash_text(game.state_hash.value) + ",,false,0,0\n"));
  EXPECT_THAT(as_text(all), HasSubstr("round-robin, 6 games"));
}

TEST(ContentOfATeam, IsThatOfItsFilesAndNames) {
  const TestFolder folder;
  folder.write("team.yaml", "version: 1");
  std::filesystem::create_directory(folder.path / "lib");
  folder.write("lib/play.py", "pass");
  const auto content = [&] { return content_of(folder.path.string()).value(); };
  const std::string first = content();
  EXPECT_EQ(content_of(folder.path.string() + "/").value(), first);
  std::filesystem::create_directory(folder.path / "__pycache__");
  folder.write("__pycache__/play.pyc", "x");
  folder.write(".hidden", "x");
  EXPECT_EQ(content(), first);
  folder.write("lib/play.py", "stop");
  const std::string second = content();
  EXPECT_NE(second, first);
  std::filesystem::rename(folder.path / "lib/play.py", folder.path / "lib/plan.py");
  EXPECT_NE(content(), second);
  EXPECT_FALSE(content_of(folder.file("nothing")));
}

}  // namespace
}  // namespace sandlot::tournament
