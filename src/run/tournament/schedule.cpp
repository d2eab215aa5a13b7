#include "run/tournament/schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "base/check.h"
#include "base/text.h"

namespace sandlot::tournament {
namespace {

constexpr int points_of_win = 3, points_of_tie = 1;

/// All games of a meeting, with sides that alternate.
void add_meeting(std::vector<Game>& out, const Schedule& schedule, int round, std::size_t left_first,
                 std::size_t other, std::uint64_t before) {
  for (int i = 0; i < schedule.games; ++i) {
    Game game{.round = round,
              .teams = {left_first, other},
              .seed = schedule.first_seed + before + static_cast<std::uint64_t>(i)};
    if (i % 2 == 1) std::swap(game.teams[0], game.teams[1]);
    out.push_back(game);
  }
}

std::vector<Game> round_robin(const Schedule& schedule) {
  std::vector<Game> out;
  for (std::size_t a = 0; a < schedule.teams; ++a)
    for (std::size_t b = a + 1; b < schedule.teams; ++b) {
      // Of the others, each team is on the left first against about half.
      if ((a + b) % 2 == 1) add_meeting(out, schedule, 1, a, b, 0);
      else add_meeting(out, schedule, 1, b, a, 0);
    }
  return out;
}

int last_round(std::span<const ScoredGame> played) { return played.empty() ? 0 : played.back().game.round; }

std::vector<Game> swiss(const Schedule& schedule, std::span<const ScoredGame> played) {
  const int round = last_round(played) + 1;
  std::vector<Game> out;
  if (round > schedule.swiss_rounds()) return out;
  const std::size_t n = schedule.teams;
  std::vector<std::vector<int>> games(n, std::vector<int>(n, 0));
  for (const ScoredGame& each : played) {
    const auto [a, b] = each.game.teams;
    ++games[a][b];
    ++games[b][a];
  }
  std::vector<std::vector<int>> met = games;
  for (auto& row : met)
    for (int& count : row) count /= schedule.games;
  std::vector<std::size_t> ranked;
  std::vector<int> byes(n, 0), left(n, 0);
  for (const Standing& each : standings(schedule, played)) {
    ranked.push_back(each.team);
    byes[each.team] = each.byes;
    left[each.team] = 2 * each.left_side - each.played;
  }
  for (const auto& [a, b] : swiss_pairs(ranked, met, byes)) {
    if (b == n) continue;
    const auto before = static_cast<std::uint64_t>(games[a][b]);
    if (left[a] != left[b] ? left[a] < left[b] : a < b) add_meeting(out, schedule, round, a, b, before);
    else add_meeting(out, schedule, round, b, a, before);
  }
  return out;
}

/// Meeting of a knockout: wins, goals and games of `a` (the earlier team) and `b`.
struct Meeting {
  std::size_t a = 0, b = 0;
  int wins = 0, goals = 0;  ///< of a, minus those of b
  int games = 0, replays = 0, last_replay = 0;
  bool left_is_a = false;  ///< in the last game
  bool by_order = false;

  /// The winner; nothing while it is open.
  std::optional<std::size_t> winner(const Schedule& schedule) {
    if (games < schedule.games) return {};
    if (replays > 0 && last_replay != 0) return last_replay > 0 ? a : b;
    if (replays == 0 && wins != 0) return wins > 0 ? a : b;
    if (replays == 0 && goals != 0) return goals > 0 ? a : b;
    if (replays < most_replays) return {};
    by_order = true;
    return a;
  }
};

/// The bracket, filled as far as its games go.
struct Bracket {
  std::vector<Game> next;
  std::vector<int> out_in;
  std::vector<bool> by_order;
};

Meeting meeting_of(std::size_t a, std::size_t b, std::span<const ScoredGame> played) {
  Meeting out{.a = std::min(a, b), .b = std::max(a, b)};
  for (const ScoredGame& each : played) {
    const auto [left, right] = each.game.teams;
    if (std::min(left, right) != out.a || std::max(left, right) != out.b) continue;
    const int side = left == out.a ? 1 : -1, difference = side * (each.goals[0] - each.goals[1]);
    const int decision = difference != 0 ? difference : side * each.penalty_kicks;
    ++out.games;
    out.left_is_a = left == out.a;
    if (each.game.replay) {
      ++out.replays;
      out.last_replay = decision;
    } else {
      out.wins += (decision > 0) - (decision < 0);
      out.goals += difference;
    }
  }
  return out;
}

Bracket knockout(const Schedule& schedule, std::span<const ScoredGame> played) {
  Bracket out;
  out.out_in.resize(schedule.teams, 0);
  out.by_order.resize(schedule.teams, false);
  std::vector<std::size_t> teams = bracket(
      std::bit_ceil(schedule.teams));  // those from schedule.teams on are byes
  for (int round = 1; teams.size() > 1 && out.next.empty(); ++round) {
    std::vector<std::size_t> winners;
    for (std::size_t i = 0; i + 1 < teams.size(); i += 2) {
      const std::size_t a = std::min(teams[i], teams[i + 1]), b = std::max(teams[i], teams[i + 1]);
      if (b >= schedule.teams) {
        winners.push_back(a);
        continue;
      }
      Meeting meeting = meeting_of(a, b, played);
      const auto winner = meeting.winner(schedule);
      if (winner) {
        winners.push_back(*winner);
        out.out_in[*winner == a ? b : a] = round;
        if (meeting.by_order) out.by_order[a] = out.by_order[b] = true;
      } else if (meeting.games == 0) {
        add_meeting(out.next, schedule, round, a, b, 0);
      } else {
        Game game{.round = round,
                  .teams = {a, b},
                  .seed = schedule.first_seed + static_cast<std::uint64_t>(meeting.games),
                  .replay = true};
        if (meeting.left_is_a) std::swap(game.teams[0], game.teams[1]);
        out.next.push_back(game);
      }
    }
    teams = std::move(winners);
  }
  return out;
}

}  // namespace

const char* name_of(Format format) {
  switch (format) {
    case Format::round_robin: return "round-robin";
    case Format::swiss: return "swiss";
    case Format::knockout: return "knockout";
  }
  SL_CHECK(false);
  return "";
}

Result<Format> read_format(std::string_view text) {
  const std::vector<std::string> known{"round-robin", "swiss", "knockout"};
  for (const Format each : {Format::round_robin, Format::swiss, Format::knockout})
    if (text == name_of(each)) return each;
  return Error{"there is no format '" + std::string(text) + "' of a tournament", suggestion(text, known)};
}

int Schedule::swiss_rounds() const {
  return rounds > 0 ? rounds : static_cast<int>(std::bit_width(teams - 1));
}

Status check(const Schedule& schedule) {
  const auto out_of = [](const char* what, std::int64_t is, std::int64_t least, std::int64_t most) {
    return Error{fmt::format("{} must be in [{}, {}], is {}", what, least, most, is)};
  };
  if (schedule.teams < 2)
    return Error{"a tournament needs two teams at least", "name the folders of the teams"};
  if (schedule.teams > most_teams)
    return out_of("the number of teams", static_cast<std::int64_t>(schedule.teams), 2,
                  std::int64_t{most_teams});
  if (schedule.games < 1 || schedule.games > most_games)
    return out_of("the number of games", schedule.games, 1, most_games);
  if (schedule.rounds < 0 || schedule.rounds > 1000)
    return out_of("the number of rounds", schedule.rounds, 0, 1000);
  return {};
}

std::vector<Game> next_games(const Schedule& schedule, std::span<const ScoredGame> played) {
  SL_CHECK(check(schedule));
  switch (schedule.format) {
    case Format::round_robin: return played.empty() ? round_robin(schedule) : std::vector<Game>();
    case Format::swiss: return swiss(schedule, played);
    case Format::knockout: return knockout(schedule, played).next;
  }
  return {};
}

std::vector<Standing> standings(const Schedule& schedule, std::span<const ScoredGame> played) {
  std::vector<Standing> out(schedule.teams);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].team = i;
  std::vector<std::vector<bool>> paired(static_cast<std::size_t>(last_round(played)),
                                        std::vector<bool>(schedule.teams, false));
  for (const ScoredGame& each : played)
    for (std::size_t i = 0; i < 2; ++i) {
      Standing& team = out[each.game.teams[i]];
      const int mine = each.goals[i], theirs = each.goals[1 - i];
      ++team.played;
      team.left_side += i == 0;
      team.goals += mine;
      team.against += theirs;
      ++(mine > theirs ? team.won : mine == theirs ? team.drawn : team.lost);
      team.points += mine > theirs ? points_of_win : mine == theirs ? points_of_tie : 0;
      paired[static_cast<std::size_t>(each.game.round - 1)][team.team] = true;
    }
  if (schedule.format == Format::swiss)
    for (const auto& round : paired)
      for (std::size_t i = 0; i < out.size(); ++i)
        if (!round[i]) {
          ++out[i].byes;
          out[i].points += points_of_win * schedule.games;
        }
  if (schedule.format == Format::knockout) {
    const Bracket reached = knockout(schedule, played);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i].out_in = reached.out_in[i];
      out[i].by_order = reached.by_order[i];
    }
  }
  const auto key = [&](const Standing& team) {
    const int round = schedule.format != Format::knockout ? 0 : team.out_in == 0 ? 1'000'000 : team.out_in;
    return std::array<std::int64_t, 5>{round, team.points, team.goals - team.against, team.goals,
                                       -static_cast<std::int64_t>(team.team)};
  };
  std::sort(out.begin(), out.end(), [&](const Standing& a, const Standing& b) { return key(a) > key(b); });
  return out;
}

std::vector<std::size_t> bracket(std::size_t size) {
  SL_CHECK(std::has_single_bit(size));
  std::vector<std::size_t> slots{0};
  while (slots.size() < size) {
    std::vector<std::size_t> wider;
    for (const std::size_t slot : slots) {
      wider.push_back(slot);
      wider.push_back(2 * slots.size() - 1 - slot);
    }
    slots = std::move(wider);
  }
  return slots;
}

}  // namespace sandlot::tournament
