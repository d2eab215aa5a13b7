/// Tournaments as text and as CSV.
#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

#include "base/text.h"
#include "run/tournament/tournament.h"

namespace sandlot::tournament {
namespace {

/// A cell of CSV by RFC 4180.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}
std::string cell(const StateHash& hash) { return hash_text(hash.value); }
std::string cell(bool x) { return x ? "true" : "false"; }
std::string cell(double x) { return number_text(x); }
std::string cell(const std::optional<double>& x) { return x ? number_text(*x) : ""; }
template <class T>
requires(std::is_integral_v<T> && !std::is_same_v<T, bool>) std::string cell(T x) {
  return fmt::format("{}", x);
}

/// Rows of one kind, with a head of the keys of their field list.
template <class Row>
std::string csv(const std::vector<Row>& rows) {
  std::string out;
  const Row empty;
  Row::fields(empty, [&](const Field& field, const auto&) {
    out += (out.empty() ? "" : ",") + std::string(field.key);
  });
  out += "\n";
  for (const Row& row : rows) {
    std::string line;
    bool first = true;
    Row::fields(row, [&](const Field&, const auto& member) {
      line += (first ? "" : ",") + cell(member);
      first = false;
    });
    out += line + "\n";
  }
  return out;
}

}  // namespace

std::string table_csv(const TournamentSummary& summary) { return csv(summary.table); }
std::string pairs_csv(const TournamentSummary& summary) { return csv(summary.pairs); }
std::string games_csv(const TournamentSummary& summary) { return csv(summary.games); }

std::string score_text(const GameRow& game) {
  std::string text = fmt::format("{} : {}", game.goals_left, game.goals_right);
  if (game.penalties_left + game.penalties_right > 0)
    text += fmt::format(" ({} : {} by penalty kicks)", game.penalties_left, game.penalties_right);
  return text;
}

std::string as_text(const TournamentSummary& summary) {
  std::size_t width = 4;
  for (const TableRow& row : summary.table) width = std::max(width, row.team.size());
  std::string out = fmt::format("{:>3}  {:<{}} {:>6} {:>4} {:>4} {:>4} {:>9} {:>6}   strength\n", "", "team",
                                width, "played", "won", "tied", "lost", "goals", "points");
  for (std::size_t i = 0; i < summary.table.size(); ++i) {
    const TableRow& row = summary.table[i];
    out += fmt::format("{:>3}  {:<{}} {:>6} {:>4} {:>4} {:>4} {:>9} {:>6}   {:+.2f} ({:+.2f} to {:+.2f}){}\n",
                       i + 1, row.team, width, row.played, row.won, row.drawn, row.lost,
                       fmt::format("{}:{}", row.goals, row.against), row.points, row.strength, row.low,
                       row.high, row.note.empty() ? "" : "  " + row.note);
  }
  const auto walk_overs = std::count_if(summary.games.begin(), summary.games.end(),
                                        [](const GameRow& row) { return row.walk_over; });
  out += fmt::format("{}, {} games", summary.format, summary.games.size() - summary.not_played);
  if (summary.stored > 0) out += fmt::format(", {} of them from the store", summary.stored);
  if (walk_overs > 0) out += fmt::format(", {} by walk-over", walk_overs);
  if (summary.not_played > 0) out += fmt::format(", {} more could not be played", summary.not_played);
  out += summary.ended ? "\n" : "; not at its end: start it again to go on\n";
  out += "strength: in log units from the mean, by Davidson's law of ties; intervals for 95 %\n";
  return out;
}

}  // namespace sandlot::tournament
