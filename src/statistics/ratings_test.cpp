/// Ratings against closed forms, and against tournaments of players whose strengths are known.
#include "statistics/ratings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/random.h"

namespace sandlot::statistics {
namespace {

void add(std::vector<PlayedGame>& games, int count, const PlayedGame& game) {
  games.insert(games.end(), static_cast<std::size_t>(count), game);
}

TEST(Ratings, OfTwoPlayersAreTheLogOddsWithHalfAGameEach) {
  std::vector<PlayedGame> games;
  add(games, 7, {0, 1, 3, 1});
  add(games, 2, {1, 0, 2, 0});
  add(games, 4, {1, 0, 1, 1});
  const Ratings found = rate(2, games);
  const double difference = math::log(7.5 / 2.5);
  EXPECT_NEAR(found.players[0].strength, difference / 2, 1e-9);
  EXPECT_NEAR(found.players[1].strength, -difference / 2, 1e-9);
  EXPECT_NEAR(found.tie, 4.5 / std::sqrt(7.5 * 2.5), 1e-9);
  // Delta method for the logarithm of a ratio of two multinomial counts: variance 1/7.5 + 1/2.5.
  const double half = 1.959963985 * std::sqrt(1 / 7.5 + 1 / 2.5);
  EXPECT_NEAR(found.difference(0, 1).low, difference - half, 1e-6);
  EXPECT_NEAR(found.difference(0, 1).high, difference + half, 1e-6);
  EXPECT_NEAR(found.players[0].interval.high, (difference + half) / 2, 1e-6);
  EXPECT_NEAR(rate(2, games, 0.99).difference(1, 0).high, -difference + half / 1.959963985 * 2.575829304,
              1e-6);
  EXPECT_EQ(found.order, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(found.players[0].bound, Bound::games);
  EXPECT_EQ(found.players[0].games, 13u);
}

TEST(Ratings, OfASymmetricRoundRobinAreEqual) {
  // Each beats the next, 2 to 1, in a ring of three with one tie per pair: by symmetry all are equal. Each pair then has
  // (3 + 1/2) decided games with odds 1 and (1 + 1/4) ties: nu = 2 * 1.25 / 3.5.
  std::vector<PlayedGame> games;
  for (std::size_t i = 0; i < 3; ++i) {
    add(games, 2, {i, (i + 1) % 3, 1, 0});
    add(games, 1, {i, (i + 1) % 3, 0, 1});
    add(games, 1, {i, (i + 1) % 3, 0, 0});
  }
  const Ratings found = rate(3, games);
  EXPECT_NEAR(found.tie, 2 * 1.25 / 3.5, 1e-9);
  // Information of one pair for its difference: n (1 - t) / 4 with n = 4.75, so of the strengths 3.5 / 4 times the Laplacian of a triangle
  // (eigenvalue 3); variance of each difference to the mean (2/3) / (3 * 3.5 / 4).
  const double half = 1.959963985 * std::sqrt(2.0 / 3 / (3 * 3.5 / 4));
  for (const Rating& each : found.players) {
    EXPECT_NEAR(each.strength, 0, 1e-9);
    EXPECT_NEAR(each.interval.high, half, 1e-6);
    EXPECT_NEAR(each.interval.low, -half, 1e-6);
  }
  EXPECT_EQ(found.order, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(found.groups, 1u);
}

TEST(Ratings, DoNotDependOnTheOrderOfGamesOrSides) {
  std::vector<PlayedGame> games{{0, 1, 2, 1}, {1, 2, 0, 0}, {2, 0, 4, 1},
                                {0, 1, 0, 1}, {3, 1, 1, 0}, {3, 2, 0, 2}};
  const Ratings first = rate(4, games);
  std::reverse(games.begin(), games.end());
  for (PlayedGame& game : games) std::swap(game.a, game.b), std::swap(game.score_a, game.score_b);
  const Ratings second = rate(4, games);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(first.players[i].strength, second.players[i].strength, 1e-9);
    EXPECT_NEAR(first.players[i].interval.low, second.players[i].interval.low, 1e-9);
  }
}

/// Games of all pairs by Davidson's law.
std::vector<PlayedGame> simulated(const std::vector<double>& strengths, double tie, int each,
                                  std::uint64_t seed) {
  std::vector<PlayedGame> games;
  Stream stream(seed, entity_key("tournament"), Purpose::experiment, 0);
  for (std::size_t a = 0; a < strengths.size(); ++a)
    for (std::size_t b = a + 1; b < strengths.size(); ++b)
      for (int i = 0; i < each; ++i) {
        const double win = math::exp(strengths[a]), loss = math::exp(strengths[b]);
        const double draw = tie * math::exp(0.5 * (strengths[a] + strengths[b]));
        const double u = stream.uniform() * (win + draw + loss);
        games.push_back({a, b, u < win ? 1.0 : 0.0, u >= win + draw ? 1.0 : 0.0});
      }
  return games;
}

TEST(Ratings, IntervalsCoverKnownStrengthsAsOftenAsTheySay) {
  const std::vector<double> strengths{0.9, 0.3, -0.2, -1.0};  // mean 0
  constexpr int tournaments = 2000, each = 40;
  std::vector<int> covered(4, 0);
  int covered_difference = 0;
  Sample first, tie;
  for (int i = 0; i < tournaments; ++i) {
    const auto found = rate(4, simulated(strengths, 0.8, each, static_cast<std::uint64_t>(i)));
    for (std::size_t p = 0; p < 4; ++p)
      covered[p] += found.players[p].interval.low <= strengths[p] &&
                    strengths[p] <= found.players[p].interval.high;
    const Interval between = found.difference(0, 3);
    covered_difference += between.low <= 1.9 && 1.9 <= between.high;
    first.add(found.players[0].strength);
    tie.add(math::log(found.tie));
  }
  // Five standard deviations of a rate of 0.95 over 2000 tournaments: 0.0244.
  const double most = 5 * std::sqrt(0.95 * 0.05 / tournaments);
  for (const int count : covered) EXPECT_NEAR(count / double{tournaments}, 0.95, most);
  EXPECT_NEAR(covered_difference / double{tournaments}, 0.95, most);
  // The prior, one and a half of 120 games, shrinks strengths by about its part of the information, 1.25 %; five standard errors of the mean.
  EXPECT_NEAR(first.mean(), 0.9, 0.025 * 0.9 + 5 * first.deviation() / std::sqrt(double{tournaments}));
  EXPECT_NEAR(tie.mean(), math::log(0.8), 0.02 + 5 * tie.deviation() / std::sqrt(double{tournaments}));
}

TEST(Ratings, IntervalsShrinkWithTheRootOfTheGames) {
  const auto width = [](int each) {
    const Rating one = rate(4, simulated({0.5, 0.2, -0.2, -0.5}, 0.5, each, 1)).players[0];
    return one.interval.high - one.interval.low;
  };
  EXPECT_NEAR(width(100) / width(1600), 4,
              0.2);  // the estimate itself moves the information by a few percent
}

TEST(Ratings, WhoWinsEverythingIsNamedAndFinite) {
  std::vector<PlayedGame> games;
  add(games, 10, {0, 1, 1, 0});
  add(games, 10, {0, 2, 1, 0});
  add(games, 5, {1, 2, 1, 0});
  add(games, 5, {1, 2, 0, 1});
  const Ratings found = rate(3, games);
  EXPECT_EQ(found.players[0].bound, Bound::only_wins);
  // Not "only losses": each of them beats the other; but both together have lost every game against the first.
  EXPECT_EQ(found.players[1].bound, Bound::one_sided);
  EXPECT_EQ(found.players[2].bound, Bound::one_sided);
  EXPECT_TRUE(std::isfinite(found.players[0].strength) && std::isfinite(found.players[0].interval.high));
  EXPECT_GT(found.players[0].interval.low, found.players[1].strength);
  EXPECT_EQ(found.order.front(), 0u);
  EXPECT_EQ(rate(2, std::vector<PlayedGame>{{0, 1, 1, 0}}).players[1].bound, Bound::only_losses);
  // A million wins and no defeat: ln((n + 1/2) / (1/2)).
  games.clear();
  add(games, 1'000'000, {0, 1, 1, 0});
  const Ratings many = rate(2, games);
  EXPECT_NEAR(many.players[0].strength - many.players[1].strength, math::log(2e6 + 1), 1e-6);
}

TEST(Ratings, WithoutGamesThePriorAloneSpeaks) {
  const Ratings found = rate(2, {});
  for (const Rating& each : found.players) {
    EXPECT_EQ(each.bound, Bound::no_games);
    EXPECT_EQ(each.strength, 0);
    // Jeffreys' prior of three results: half a win and half a defeat, so the difference has variance 4 and its half variance 1.
    EXPECT_NEAR(each.interval.high, 1.959963985, 1e-6);
  }
  EXPECT_EQ(found.groups, 2u);
  EXPECT_TRUE(rate(0, {}).players.empty());
  EXPECT_EQ(rate(1, {}).players.front().strength, 0);
  EXPECT_EQ(rate(1, {}).groups, 1u);
}

TEST(Ratings, GroupsThatNeverMetAreNamedAndHaveEqualMeans) {
  std::vector<PlayedGame> games;
  for (const std::size_t of : {0u, 2u}) {
    add(games, 6, {of, of + 1, 1, 0});
    add(games, 2, {of, of + 1, 0, 1});
  }
  const Ratings found = rate(5, games);
  EXPECT_EQ(found.groups, 3u);
  EXPECT_EQ(found.players[1].group, 0u);
  EXPECT_EQ(found.players[3].group, 1u);
  EXPECT_EQ(found.players[4].group, 2u);
  EXPECT_EQ(found.players[4].bound, Bound::no_games);
  EXPECT_EQ(found.players[0].bound, Bound::games);
  EXPECT_NEAR(found.players[0].strength, found.players[2].strength, 1e-9);
  EXPECT_NEAR(found.players[0].strength + found.players[1].strength, 0, 1e-9);
  // Within a group the games speak, between them nothing but the prior.
  const auto width = [&](std::size_t a, std::size_t b) {
    return found.difference(a, b).high - found.difference(a, b).low;
  };
  EXPECT_GT(width(0, 2), 1.5 * width(0, 1));
}

TEST(PairScores, HaveMeanDifferencesWithStudentsInterval) {
  const std::vector<PlayedGame> games{{0, 1, 3, 1}, {1, 0, 2, 2}, {1, 0, 0, 4}, {2, 1, 1, 0}};
  const auto found = pair_scores(games);
  ASSERT_EQ(found.size(), 2u);
  const PairScores& pair = found[0];  // differences 2, 0, 4
  EXPECT_EQ(pair.a, 0u);
  EXPECT_EQ(pair.b, 1u);
  EXPECT_EQ(pair.wins_a, 2u);
  EXPECT_EQ(pair.ties, 1u);
  EXPECT_EQ(pair.wins_b, 0u);
  EXPECT_DOUBLE_EQ(pair.difference.mean(), 2);
  EXPECT_NEAR(pair.interval.high, 2 + 4.302652730 * 2 / std::sqrt(3.0), 1e-6);  // t of 2 degrees of freedom
  EXPECT_EQ(found[1].a, 1u);
  EXPECT_DOUBLE_EQ(found[1].difference.mean(), -1);
  EXPECT_TRUE(std::isinf(found[1].interval.high));
}

}  // namespace
}  // namespace sandlot::statistics
