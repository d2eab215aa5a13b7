#include "statistics/ratings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/check.h"
#include "base/math.h"
#include "statistics/dense.h"
#include "statistics/quantiles.h"

namespace sandlot::statistics {
namespace {

using Values = std::vector<double>;

/// Weight of one pair's results: games and prior together.
struct Results {
  std::size_t a = 0, b = 0;
  double wins_a = 0, ties = 0, wins_b = 0;
};

/// All pairs with their share of the prior: each player gets half a win, half a tie and half a defeat in all.
std::vector<Results> results_of(std::size_t players, std::span<const PlayedGame> games) {
  std::vector<Results> out;
  if (players < 2) return out;
  const double share = 0.5 / static_cast<double>(players - 1);
  std::vector<std::size_t> first(players, 0);  // index of the pair (a, a + 1)
  for (std::size_t a = 0; a < players; ++a) {
    first[a] = out.size();
    for (std::size_t b = a + 1; b < players; ++b) out.push_back({a, b, share, share, share});
  }
  for (const PlayedGame& game : games) {
    const auto [a, b] = std::minmax(game.a, game.b);
    Results& pair = out[first[a] + (b - a - 1)];
    if (game.score_a == game.score_b) pair.ties += 1;
    else ((game.score_a > game.score_b) == (game.a == a) ? pair.wins_a : pair.wins_b) += 1;
  }
  return out;
}

/// Logarithm of the likelihood, its gradient and the information (minus its Hessian) for x = (strengths, ln nu).
struct Likelihood {
  double value = 0;
  Values gradient;
  Dense information;
};

/// The law is an exponential family, so the gradient is what was seen minus what is expected, and the information is the covariance of the
/// statistics: half of (wins - defeats) of each player, and the number of ties.
Likelihood likelihood(const Values& x, const std::vector<Results>& all) {
  const std::size_t tie = x.size() - 1;
  Likelihood out{0, Values(x.size(), 0), Dense(x.size(), x.size())};
  for (const Results& pair : all) {
    const std::size_t a = pair.a, b = pair.b;
    const double half = 0.5 * (x[a] - x[b]);
    const double top = std::max({half, -half, x[tie]});
    const double win = math::exp(half - top), loss = math::exp(-half - top), draw = math::exp(x[tie] - top);
    const double sum = win + loss + draw, n = pair.wins_a + pair.ties + pair.wins_b;
    const double p = win / sum, q = loss / sum, t = draw / sum;
    out.value += half * (pair.wins_a - pair.wins_b) + x[tie] * pair.ties - n * (top + math::log(sum));
    const double slope = 0.5 * (pair.wins_a - pair.wins_b - n * (p - q));
    out.gradient[a] += slope;
    out.gradient[b] -= slope;
    out.gradient[tie] += pair.ties - n * t;
    const double spread = 0.25 * n * (p + q - (p - q) * (p - q)), mixed = -0.5 * n * t * (p - q);
    out.information(a, a) += spread;
    out.information(b, b) += spread;
    out.information(a, b) -= spread;
    out.information(b, a) -= spread;
    out.information(a, tie) += mixed;
    out.information(tie, a) += mixed;
    out.information(b, tie) -= mixed;
    out.information(tie, b) -= mixed;
    out.information(tie, tie) += n * t * (1 - t);
  }
  return out;
}

/// Adds the one direction in which the likelihood is flat, all strengths at once, with information 1.
void hold_mean(Dense& information, std::size_t players) {
  for (std::size_t i = 0; i < players; ++i)
    for (std::size_t j = 0; j < players; ++j) information(i, j) += 1.0 / static_cast<double>(players);
}

/// Newton's method. The likelihood is concave, and strictly so but for the mean, because the prior connects all players.
Values most_likely(std::size_t players, const std::vector<Results>& all) {
  Values x(players + 1, 0);
  constexpr int most_steps = 200;
  Likelihood here = likelihood(x, all);
  for (int i = 0; i < most_steps; ++i) {
    Dense information = here.information;
    hold_mean(information, players);
    const Values step = Factors(std::move(information)).solve(here.gradient);
    double part = 1, longest = 0;
    const auto ahead = [&] {
      Values out = x;
      for (std::size_t k = 0; k < out.size(); ++k) out[k] += part * step[k];
      return out;
    };
    Values next = ahead();
    Likelihood there = likelihood(next, all);
    for (; there.value < here.value && part > 1e-9; there = likelihood(next, all)) {
      part /= 2;
      next = ahead();
    }
    if (there.value < here.value) break;  // rounding alone is left
    x = std::move(next);
    here = std::move(there);
    for (const double s : step) longest = std::max(longest, std::abs(s));
    if (part * longest < 1e-12) break;
  }
  double mean = 0;
  for (std::size_t i = 0; i < players; ++i) mean += x[i] / static_cast<double>(players);
  for (std::size_t i = 0; i < players; ++i) x[i] -= mean;
  return x;
}

/// Which players are reached from which by steps that were marked: Warshall's closure.
class Reach {
 public:
  explicit Reach(std::size_t players) : players_(players), marks_(players * players, false) {}
  void mark(std::size_t a, std::size_t b) { marks_[a * players_ + b] = true; }
  bool has(std::size_t a, std::size_t b) const { return a == b || marks_[a * players_ + b]; }
  void close() {
    for (std::size_t k = 0; k < players_; ++k)
      for (std::size_t a = 0; a < players_; ++a)
        for (std::size_t b = 0; has(a, k) && b < players_; ++b)
          if (has(k, b)) mark(a, b);
  }

 private:
  std::size_t players_;
  std::vector<bool> marks_;
};

/// Ford's condition: strengths of two players are bounded by games when each has taken something from the other, directly or through others.
void name_bounds(Ratings& out, std::span<const PlayedGame> games) {
  const std::size_t players = out.players.size();
  Reach met(players), took(players);
  std::vector<std::size_t> wins(players, 0), losses(players, 0);
  for (const PlayedGame& game : games) {
    met.mark(game.a, game.b);
    met.mark(game.b, game.a);
    if (game.score_a >= game.score_b) took.mark(game.a, game.b);
    if (game.score_b >= game.score_a) took.mark(game.b, game.a);
    ++out.players[game.a].games;
    ++out.players[game.b].games;
    if (game.score_a == game.score_b) continue;
    ++wins[game.score_a > game.score_b ? game.a : game.b];
    ++losses[game.score_a > game.score_b ? game.b : game.a];
  }
  met.close();
  took.close();
  for (std::size_t i = 0; i < players; ++i) {
    Rating& rating = out.players[i];
    std::size_t first = 0;
    while (!met.has(first, i)) ++first;
    rating.group = first == i ? out.groups++ : out.players[first].group;
    bool mutual = true;
    for (std::size_t j = 0; j < players; ++j)
      mutual = mutual && (!met.has(i, j) || (took.has(i, j) && took.has(j, i)));
    if (rating.games == 0) rating.bound = Bound::no_games;
    else if (wins[i] == rating.games) rating.bound = Bound::only_wins;
    else if (losses[i] == rating.games) rating.bound = Bound::only_losses;
    else if (!mutual) rating.bound = Bound::one_sided;
  }
}

double quantile(double confidence) { return normal_quantile(0.5 + confidence / 2); }

void check_games(std::span<const PlayedGame> games, double confidence) {
  SL_CHECK(confidence > 0 && confidence < 1);
  for (const PlayedGame& game : games)
    SL_CHECK(game.a != game.b && std::isfinite(game.score_a) && std::isfinite(game.score_b));
}

}  // namespace

Interval Ratings::difference(std::size_t a, std::size_t b) const {
  const std::size_t n = players.size();
  SL_CHECK(a < n && b < n && a != b);
  const double variance = covariance[a * n + a] + covariance[b * n + b] - 2 * covariance[a * n + b];
  const double middle = players[a].strength - players[b].strength;
  const double half = quantile(confidence) * std::sqrt(std::max(0.0, variance));
  return {middle - half, middle + half};
}

Ratings rate(std::size_t players, std::span<const PlayedGame> games, double confidence) {
  check_games(games, confidence);
  for (const PlayedGame& game : games) SL_CHECK(game.a < players && game.b < players);
  Ratings out;
  out.confidence = confidence;
  out.players.resize(players);
  out.covariance.resize(players * players);
  out.order.resize(players);
  std::iota(out.order.begin(), out.order.end(), std::size_t{0});
  name_bounds(out, games);
  if (players < 2) return out;

  const std::vector<Results> all = results_of(players, games);
  const Values x = most_likely(players, all);
  out.tie = math::exp(x[players]);
  Dense information = likelihood(x, all).information;
  hold_mean(information, players);
  const Dense inverse = Factors(std::move(information)).inverse();
  const auto covariance = [&](std::size_t i, std::size_t j) {
    return inverse(i, j) - 1.0 / static_cast<double>(players);
  };
  const double z = quantile(confidence);
  for (std::size_t i = 0; i < players; ++i) {
    Rating& rating = out.players[i];
    rating.strength = x[i];
    const double half = z * std::sqrt(std::max(0.0, covariance(i, i)));
    rating.interval = {rating.strength - half, rating.strength + half};
    for (std::size_t j = 0; j < players; ++j) out.covariance[i * players + j] = covariance(i, j);
  }
  // Strengths that are equal but for rounding are equal.
  std::stable_sort(out.order.begin(), out.order.end(), [&](std::size_t a, std::size_t b) {
    return std::round(out.players[a].strength * 1e9) > std::round(out.players[b].strength * 1e9);
  });
  return out;
}

std::vector<PairScores> pair_scores(std::span<const PlayedGame> games, double confidence) {
  check_games(games, confidence);
  std::map<std::pair<std::size_t, std::size_t>, PairScores> pairs;
  for (const PlayedGame& game : games) {
    const auto [a, b] = std::minmax(game.a, game.b);
    PairScores& pair = pairs[{a, b}];
    pair.a = a, pair.b = b;
    const double difference = (game.a == a ? 1 : -1) * (game.score_a - game.score_b);
    pair.difference.add(difference);
    ++(difference == 0 ? pair.ties : difference > 0 ? pair.wins_a : pair.wins_b);
  }
  std::vector<PairScores> out;
  for (auto& [key, pair] : pairs) {
    pair.interval = mean_interval(pair.difference, confidence);
    out.push_back(pair);
  }
  return out;
}

}  // namespace sandlot::statistics
