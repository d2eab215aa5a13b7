#pragma once
/// Strengths of players from the games they have played, with intervals.
///
/// Law      Davidson's extension of Bradley and Terry's law by ties: with strengths s (in log units) and a tie parameter nu,
///            P(a beats b) : P(tie) : P(b beats a) = exp(s_a) : nu exp((s_a + s_b) / 2) : exp(s_b).
///          Without ties, s_a - s_b is the logarithm of the odds that a beats b. The mean of all strengths is 0.
/// Prior    one and a half games of each player in all, shared out evenly among the others: half a win, half a tie and half a defeat.
///          For two players that is Jeffreys' prior of three results, and the estimates are closed: s_a - s_b =
///          ln((wins + 1/2) / (defeats + 1/2)). It keeps every strength finite: of one who has won every game, of one without a game,
///          and of groups that never met, whose means are then equal.
/// Interval the inverse of the Fisher information of all strengths and ln(nu) at the estimate, games and prior together, in the space
///          of strengths whose mean is 0; normal quantiles. So it is the interval of a player's difference to the mean, and it
///          contains what is not known of the others and of nu.
/// Limits   games are independent; neither sides nor order nor the size of a win count; strengths do not change. Intervals are those
///          of many games: for fewer than about ten per player they are rough.
/// Cost     about ten solutions of a dense system of `players` + 1 unknowns.
/// Source   R. A. Bradley, M. E. Terry, Rank analysis of incomplete block designs (1952). R. R. Davidson, On extending the
///          Bradley-Terry model to accommodate ties in paired comparison experiments (1970). L. R. Ford, Solution of a ranking
///          problem from binary comparisons (1957): when games alone bound the strengths.
#include <cstddef>
#include <span>
#include <vector>

#include "statistics/intervals.h"
#include "statistics/sample.h"

namespace sandlot::statistics {

/// A game of two players, by their numbers. The higher score wins; equal scores are a tie.
struct PlayedGame {
  std::size_t a = 0, b = 0;
  double score_a = 0, score_b = 0;
};

/// What bounds a player's strength.
enum class Bound {
  games,        ///< the games: it has lost to, or tied with, somebody who is bounded by it in turn
  no_games,     ///< the prior alone
  only_wins,    ///< the games from below, the prior from above
  only_losses,  ///< the games from above, the prior from below
  one_sided,    ///< its part of the group won every game against the rest of it, or lost every one
};

struct Rating {
  double strength = 0;  ///< difference to the mean, in log units
  Interval interval;    ///< of the same
  Bound bound = Bound::games;
  std::size_t games = 0;
  std::size_t group =
      0;  ///< players of one group are connected by games; numbered from 0 by their first player
};

struct Ratings {
  std::vector<Rating> players;     ///< by number
  std::vector<std::size_t> order;  ///< numbers by strength, the strongest first; equals by number
  std::size_t groups = 0;  ///< more than one: strengths of different groups are compared by the prior alone
  double tie = 0;          ///< nu
  std::vector<double> covariance;  ///< of the strengths, row by row
  double confidence = 0.95;

  /// Interval of strength a - strength b.
  /// @pre  a and b are players, and not the same
  Interval difference(std::size_t a, std::size_t b) const;
};

/// @param confidence  in (0, 1)
/// @pre  every game has two different players below `players`, with scores that are numbers
Ratings rate(std::size_t players, std::span<const PlayedGame> games, double confidence = 0.95);

/// Games of two players with each other.
struct PairScores {
  std::size_t a = 0, b = 0;  ///< a < b
  std::size_t wins_a = 0, ties = 0, wins_b = 0;
  Sample difference;  ///< score of a - score of b
  Interval interval;  ///< Student's, of the mean difference; infinite for one game
};

/// Pairs with at least one game, by a, then b.
/// @pre  as rate()
std::vector<PairScores> pair_scores(std::span<const PlayedGame> games, double confidence = 0.95);

}  // namespace sandlot::statistics
