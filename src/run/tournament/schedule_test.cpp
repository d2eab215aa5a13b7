/// Schedules: who meets whom, on which side, with which seed, and what the results make of it.
#include "run/tournament/schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <set>

#include "base/random.h"

namespace sandlot::tournament {
namespace {

using Goals = std::array<int, 2>;
using Play = std::function<Goals(const Game&)>;

/// The whole tournament; `play` gives each game's goals.
std::vector<ScoredGame> played(const Schedule& schedule, const Play& play) {
  std::vector<ScoredGame> out;
  for (;;) {
    const auto games = next_games(schedule, out);
    if (games.empty()) return out;
    for (const Game& game : games) out.push_back({game, play(game)});
  }
}

/// The team with the lower number wins by the difference of the numbers.
Goals stronger_wins(const Game& game) {
  const auto [a, b] = game.teams;
  return a < b ? Goals{static_cast<int>(b - a), 0} : Goals{0, static_cast<int>(a - b)};
}

std::pair<std::size_t, std::size_t> pair_of(const Game& game) {
  return std::minmax(game.teams[0], game.teams[1]);
}

TEST(RoundRobin, EachPairPlaysAllSeedsAndSidesAreBalanced) {
  for (const std::size_t teams : {2u, 3u, 4u, 5u, 8u})
    for (const int games : {1, 2, 3, 4}) {
      const Schedule schedule{Format::round_robin, teams, games, 0, 10};
      const auto all = played(schedule, stronger_wins);
      EXPECT_EQ(all.size(), teams * (teams - 1) / 2 * static_cast<std::size_t>(games));
      std::map<std::pair<std::size_t, std::size_t>, std::vector<Game>> pairs;
      std::vector<int> more_left(teams, 0);
      for (const ScoredGame& each : all) {
        pairs[pair_of(each.game)].push_back(each.game);
        ++more_left[each.game.teams[0]];
        --more_left[each.game.teams[1]];
      }
      for (const auto& [pair, meeting] : pairs)
        for (std::size_t i = 0; i < meeting.size(); ++i) {
          EXPECT_EQ(meeting[i].seed, 10 + i);
          EXPECT_TRUE(i == 0 || meeting[i].teams[0] == meeting[i - 1].teams[1]);
        }
      for (const int each : more_left)
        EXPECT_LE(std::abs(each), games % 2 == 0 ? 0 : 1) << teams << " " << games;
      const auto table = standings(schedule, all);
      for (std::size_t i = 0; i < teams; ++i) {
        EXPECT_EQ(table[i].team, i);
        EXPECT_EQ(table[i].won, games * static_cast<int>(teams - 1 - i));
        EXPECT_EQ(table[i].points, 3 * table[i].won);
      }
    }
}

TEST(Standings, AreByPointsThenDifferenceThenGoals) {
  const Schedule schedule{Format::round_robin, 4};
  const std::map<std::pair<std::size_t, std::size_t>, Goals> goals{{{0, 1}, {1, 1}}, {{0, 2}, {0, 0}},
                                                                   {{0, 3}, {1, 0}}, {{1, 2}, {2, 2}},
                                                                   {{1, 3}, {2, 1}}, {{2, 3}, {1, 0}}};
  const auto all = played(schedule, [&](const Game& game) {
    const Goals of = goals.at(pair_of(game));
    return game.teams[0] < game.teams[1] ? of : Goals{of[1], of[0]};
  });
  const auto table = standings(schedule, all);  // 0, 1 and 2 have 5 points and difference 1; goals 2, 5, 3
  EXPECT_EQ(table[0].team, 1u);
  EXPECT_EQ(table[1].team, 2u);
  EXPECT_EQ(table[2].team, 0u);
  EXPECT_EQ(table[3].team, 3u);
  EXPECT_EQ(table[0].points, 5);
  EXPECT_EQ(table[0].drawn, 2);
  EXPECT_EQ(table[0].goals, 5);
  EXPECT_EQ(table[0].against, 4);
}

TEST(Swiss, TeamsOfLikeStandingMeetAndNobodyMeetsTwice) {
  for (const std::size_t teams : {4u, 5u, 8u, 9u, 16u}) {
    const Schedule schedule{Format::swiss, teams, 2};
    const auto all = played(schedule, stronger_wins);
    const int rounds = static_cast<int>(std::bit_width(teams - 1));
    EXPECT_EQ(all.back().game.round, rounds);
    EXPECT_EQ(all.size(), static_cast<std::size_t>(rounds) * (teams / 2) * 2);
    std::map<std::pair<std::size_t, std::size_t>, int> met;
    for (const ScoredGame& each : all) ++met[pair_of(each.game)];
    for (const auto& [pair, games] : met) EXPECT_EQ(games, 2);
    const auto table = standings(schedule, all);
    EXPECT_EQ(table.front().team, 0u);
    int byes = 0;
    for (const Standing& each : table) {
      EXPECT_LE(each.byes, 1);
      EXPECT_EQ(each.played + 2 * each.byes, 2 * rounds);
      EXPECT_EQ(each.points, 6 * each.byes + 3 * each.won);
      byes += each.byes;
    }
    EXPECT_EQ(byes, teams % 2 == 1 ? rounds : 0);
  }
}

TEST(Swiss, TheFirstRoundsOfFourTeamsAreThoseByHand) {
  const Schedule schedule{Format::swiss, 4};
  const auto all = played(schedule, stronger_wins);  // 0-1, 2-3; then the winners 0-2 and the losers 1-3
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(pair_of(all[0].game), std::pair(std::size_t{0}, std::size_t{1}));
  EXPECT_EQ(pair_of(all[1].game), std::pair(std::size_t{2}, std::size_t{3}));
  EXPECT_EQ(pair_of(all[2].game), std::pair(std::size_t{0}, std::size_t{2}));
  EXPECT_EQ(pair_of(all[3].game), std::pair(std::size_t{1}, std::size_t{3}));
  // Who was on the left before is on the right now.
  EXPECT_EQ(all[0].game.teams[0], 0u);
  EXPECT_EQ(all[3].game.teams[0], 1u);
}

TEST(Swiss, PairingsThatAreRepeatedHaveOtherSeeds) {
  // Nine rounds of six teams cannot do without; results by chance.
  for (std::uint64_t run = 0; run < 30; ++run) {
    const Schedule schedule{Format::swiss, 6, 1, 9};
    const auto all = played(schedule, [&](const Game& game) {
      Stream stream(run, game.teams[0] * 100 + game.teams[1], Purpose::experiment,
                    static_cast<std::uint64_t>(game.round));
      const int left = static_cast<int>(stream.below(3));
      return Goals{left, static_cast<int>(stream.below(3))};
    });
    std::map<std::pair<std::size_t, std::size_t>, std::set<std::uint64_t>> seeds;
    std::map<int, std::set<std::size_t>> in_round;
    for (const ScoredGame& each : all) {
      auto& known = seeds[pair_of(each.game)];
      EXPECT_TRUE(known.insert(each.game.seed).second);
      EXPECT_EQ(*known.rbegin(), known.size());
      EXPECT_TRUE(in_round[each.game.round].insert(each.game.teams[0]).second);
      EXPECT_TRUE(in_round[each.game.round].insert(each.game.teams[1]).second);
    }
    EXPECT_EQ(in_round.size(), 9u);
    for (const auto& [round, teams] : in_round) EXPECT_EQ(teams.size(), 6u);
  }
}

/// Whether the vertices that are not `used` can be paired along `edges`, by trying everything.
bool pairable(const std::vector<std::vector<int>>& met, std::vector<bool>& used, int most) {
  const std::size_t n = used.size();
  std::size_t a = 0;
  while (a < n && used[a]) ++a;
  if (a == n) return true;
  used[a] = true;
  bool found = false;
  for (std::size_t b = a + 1; b < n && !found; ++b) {
    if (used[b] || met[a][b] > most) continue;
    used[b] = true;
    found = pairable(met, used, most);
    used[b] = false;
  }
  used[a] = false;
  return found;
}

TEST(Swiss, RepeatsNoPairingWhereTryingEverythingFindsAWay) {
  int possible = 0, impossible = 0;
  for (std::uint64_t run = 0; run < 300; ++run) {
    Stream stream(run, 1, Purpose::experiment, 0);
    const std::size_t n = 6 + 2 * stream.below(3);
    std::vector<std::vector<int>> met(n, std::vector<int>(n, 0));
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b) met[a][b] = met[b][a] = stream.uniform() < 0.75;
    std::vector<std::size_t> ranked(n);
    for (std::size_t i = 0; i < n; ++i) ranked[i] = n - 1 - i;
    const std::vector<int> byes(n, 0);
    const auto pairs = swiss_pairs(ranked, met, byes);
    ASSERT_EQ(pairs.size(), n / 2);
    std::set<std::size_t> seen;
    bool repeats = false;
    for (const auto& [a, b] : pairs) {
      seen.insert(a);
      seen.insert(b);
      repeats = repeats || met[a][b] > 0;
    }
    EXPECT_EQ(seen.size(), n);
    std::vector<bool> used(n, false);
    const bool can = pairable(met, used, 0);
    ++(can ? possible : impossible);
    EXPECT_EQ(repeats, !can) << run;
  }
  EXPECT_GT(possible, 30);
  EXPECT_GT(impossible, 30);
}

TEST(Knockout, TheBracketKeepsTheStrongestApart) {
  EXPECT_EQ(bracket(8), (std::vector<std::size_t>{0, 7, 3, 4, 1, 6, 2, 5}));
  const Schedule schedule{Format::knockout, 8};
  const auto all = played(schedule, stronger_wins);
  ASSERT_EQ(all.size(), 7u);
  EXPECT_EQ(pair_of(all[6].game), std::pair(std::size_t{0}, std::size_t{1}));
  EXPECT_EQ(all[6].game.round, 3);
  const auto table = standings(schedule, all);
  EXPECT_EQ(table[0].team, 0u);
  EXPECT_EQ(table[0].out_in, 0);
  EXPECT_EQ(table[1].team, 1u);
  EXPECT_EQ(table[1].out_in, 3);
  EXPECT_EQ(table[7].out_in, 1);
}

TEST(Knockout, ByesGoToTheFirstTeams) {
  for (const std::size_t teams : {2u, 3u, 5u, 6u, 7u}) {
    const Schedule schedule{Format::knockout, teams};
    const auto all = played(schedule, stronger_wins);
    EXPECT_EQ(all.size(), teams - 1);
    std::set<std::size_t> in_first;
    for (const ScoredGame& each : all)
      if (each.game.round == 1) in_first.insert(each.game.teams.begin(), each.game.teams.end());
    const std::size_t byes = std::bit_ceil(teams) - teams;
    for (std::size_t i = 0; i < teams; ++i)
      EXPECT_EQ(in_first.count(i), i < byes ? 0u : 1u) << teams << " " << i;
    EXPECT_EQ(standings(schedule, all).front().team, 0u);
  }
}

TEST(Knockout, TiesAreReplayedThreeTimesAndThenTheOrderDecides) {
  const Schedule schedule{Format::knockout, 2, 2, 0, 5};
  const auto ties = played(schedule, [](const Game&) { return Goals{1, 1}; });
  ASSERT_EQ(ties.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(ties[i].game.seed, 5 + i);
    EXPECT_EQ(ties[i].game.replay, i >= 2);
    EXPECT_EQ(ties[i].game.teams[0], i % 2);
  }
  auto table = standings(schedule, ties);
  EXPECT_EQ(table[0].team, 0u);
  EXPECT_TRUE(table[0].by_order);
  // The second team wins the first replay.
  const auto decided = played(schedule, [](const Game& game) {
    return game.replay ? (game.teams[0] == 1 ? Goals{2, 1} : Goals{1, 2}) : Goals{0, 0};
  });
  EXPECT_EQ(decided.size(), 3u);
  table = standings(schedule, decided);
  EXPECT_EQ(table[0].team, 1u);
  EXPECT_FALSE(table[0].by_order);
}

TEST(Knockout, AMeetingIsDecidedByWinsThenByGoals) {
  const Schedule three{Format::knockout, 2, 3};
  // Team 1 wins two games by one goal, team 0 one game by nine.
  const auto wins = played(three, [](const Game& game) {
    const Goals of_0_and_1 = game.seed == 1 ? Goals{9, 0} : Goals{0, 1};
    return game.teams[0] == 0 ? of_0_and_1 : Goals{of_0_and_1[1], of_0_and_1[0]};
  });
  EXPECT_EQ(wins.size(), 3u);
  EXPECT_EQ(standings(three, wins)[0].team, 1u);
  const Schedule two{Format::knockout, 2, 2};
  const auto goals = played(two, [](const Game& game) {
    const Goals of_0_and_1 = game.seed == 1 ? Goals{1, 0} : Goals{0, 2};
    return game.teams[0] == 0 ? of_0_and_1 : Goals{of_0_and_1[1], of_0_and_1[0]};
  });
  EXPECT_EQ(goals.size(), 2u);
  EXPECT_EQ(standings(two, goals)[0].team, 1u);
}

TEST(Knockout, PenaltyKicksDecideADraw) {
  // Team 1 wins the second of two draws by penalty kicks, on either side; no game is played again.
  const Schedule schedule{Format::knockout, 2, 2};
  std::vector<ScoredGame> all;
  for (const Game& game : next_games(schedule, all)) {
    const int for_team_1 = game.teams[0] == 1 ? 1 : -1;
    all.push_back({game, {2, 2}, game.seed == 2 ? for_team_1 : 0});
  }
  EXPECT_TRUE(next_games(schedule, all).empty());
  const auto table = standings(schedule, all);
  EXPECT_EQ(table[0].team, 1u);
  EXPECT_EQ(table[0].drawn, 2);  // draws all the same
  EXPECT_FALSE(table[0].by_order);
  // A tie after both is played again, and decided by the penalty kicks of that game.
  all[1].penalty_kicks = 0;
  const auto again = next_games(schedule, all);
  ASSERT_EQ(again.size(), 1u);
  all.push_back({again[0], {0, 0}, again[0].teams[0] == 1 ? 1 : -1});
  EXPECT_TRUE(next_games(schedule, all).empty());
  EXPECT_EQ(standings(schedule, all)[0].team, 1u);
}

TEST(Schedule, RefusesWhatIsNoTournament) {
  const auto refusal = [](const Schedule& schedule) {
    const Status status = check(schedule);
    return status ? "" : status.error().text();
  };
  EXPECT_NE(refusal({Format::swiss, 1}).find("two teams at least"), std::string::npos);
  EXPECT_NE(refusal({Format::swiss, 300}).find("[2, 256], is 300"), std::string::npos);
  EXPECT_NE(refusal({Format::swiss, 4, 0}).find("games"), std::string::npos);
  EXPECT_NE(refusal({Format::swiss, 4, 1, -1}).find("rounds"), std::string::npos);
  EXPECT_EQ(refusal({Format::knockout, 4}), "");
  EXPECT_NE(read_format("swis").error().text().find("did you mean 'swiss'"), std::string::npos);
  EXPECT_EQ(read_format("round-robin").value(), Format::round_robin);
}

}  // namespace
}  // namespace sandlot::tournament
