/// Result page of a tournament.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/papers/page.h"
#include "app/tournament.h"
#include "draw/plan.h"
#include "messages/cdr.h"
#include "messages/sandlot_soccer.h"
#include "record/mcap/reader.h"

namespace sandlot::app {
namespace {

using tournament::GameRow;
using tournament::PairRow;
using tournament::TableRow;
using tournament::TournamentSummary;

/// A line for each team: its interval, and a dot at its strength.
std::string strengths_svg(const std::vector<TableRow>& table) {
  constexpr int left = 170, width = 520, row_height = 26, top = 14;
  double reach = 0.5;  // at both sides of the mean
  for (const TableRow& row : table) reach = std::max({reach, std::abs(row.low), std::abs(row.high)});
  const auto x = [&](double strength) { return left + width * 0.5 * (1 + strength / reach); };
  const int bottom = top + row_height * static_cast<int>(table.size());
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" "
      "font-size=\"13\">\n",
      left + width + 20, bottom + 36);
  const double step = reach > 4 ? 2 : reach > 2 ? 1 : 0.5;
  for (double mark = -step * std::floor(reach / step); mark <= reach; mark += step)
    out += fmt::format(
        "<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\" stroke=\"{3}\"/>"
        "<text x=\"{0:.1f}\" y=\"{4}\" text-anchor=\"middle\" fill=\"#555\">{5:g}</text>\n",
        x(mark), top - 6, bottom, std::abs(mark) < step / 2 ? "#888" : "#e4e4e4", bottom + 18, mark);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const TableRow& row = table[i];
    const int y = top + row_height * static_cast<int>(i) + row_height / 2;
    out += fmt::format(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>"
        "<line x1=\"{:.1f}\" y1=\"{}\" x2=\"{:.1f}\" y2=\"{}\" stroke=\"#0072b2\" stroke-width=\"3\" "
        "stroke-opacity=\"0.45\"/>"
        "<circle cx=\"{:.1f}\" cy=\"{}\" r=\"5\" fill=\"#0072b2\"/>\n",
        left - 12, y + 4, draw::xml_text(row.team), x(row.low), y, x(row.high), y, x(row.strength), y);
  }
  return out + "</svg>\n";
}

std::string result_text(const GameRow& game) { return game.played ? tournament::score_text(game) : "-"; }

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// Link from the page of the tournament to a file of a game.
std::string link_to(const std::string& file) { return file.empty() ? "" : "games/" + file_name(file); }

void add_games(ReportPage& page, const TournamentSummary& summary) {
  page.heading("Games");
  std::vector<std::vector<ReportPage::Cell>> rows;
  bool recorded = false;
  for (const GameRow& game : summary.games) {
    recorded = recorded || !game.recording.empty();
    const std::string end = !game.played ? "not played: " : game.walk_over ? "walk-over: " : "";
    rows.push_back(
        {{fmt::format("{}{}", game.round, game.replay ? ", replay" : "")},
         {game.left},
         {result_text(game), game.recording.empty() ? "" : link_to(game_page_file(game.recording))},
         {game.right},
         {std::to_string(game.seed)},
         {end + game.reason},
         {game.played ? hash_text(game.state_hash.value) : ""},
         {file_name(game.recording), link_to(game.recording)}});
  }
  page.paragraph(
      "The team on the left began at negative x. The hash is that of the state at the end: the same game "
      "again gives the same.");
  page.rich_table({"round", "left", "goals", "right", "seed", "end", "hash", "recording"}, rows);
  if (recorded)
    page.paragraph(
        "The goals lead to the page of the game: the referee's decisions, each with the command that shows "
        "the "
        "recording from there.");
}

}  // namespace

std::string tournament_page(const TournamentSummary& summary, const std::string& source) {
  ReportPage page(fmt::format("Tournament: {}", summary.format), source);
  if (!summary.ended) page.paragraph("This tournament is not at its end. The same command goes on with it.");
  if (summary.not_played > 0)
    page.paragraph(fmt::format("{} of its games could not be played; they are in no table but that of games.",
                               summary.not_played));
  page.heading("Table");
  std::vector<std::vector<std::string>> rows;
  bool byes = false;
  for (const TableRow& row : summary.table) byes = byes || row.byes > 0;
  for (std::size_t i = 0; i < summary.table.size(); ++i) {
    const TableRow& row = summary.table[i];
    rows.push_back({std::to_string(i + 1), row.team, std::to_string(row.played), std::to_string(row.won),
                    std::to_string(row.drawn), std::to_string(row.lost),
                    fmt::format("{} : {}", row.goals, row.against), std::to_string(row.points),
                    fmt::format("{:+.2f} ({:+.2f} to {:+.2f})", row.strength, row.low, row.high), row.note});
    if (byes) rows.back().insert(rows.back().begin() + 3, std::to_string(row.byes));
  }
  std::vector<std::string> names{"",     "team",  "played", "won",      "tied",
                                 "lost", "goals", "points", "strength", ""};
  if (byes) names.insert(names.begin() + 3, "byes");
  page.table(names, rows);
  if (summary.format == std::string("knockout"))
    page.paragraph(
        "The order is that of the rounds that teams reached. A meeting is decided by won games, then by "
        "goals; a tie by up to three more games, "
        "then by the order in which the teams were given.");
  page.figure(strengths_svg(summary.table),
              fmt::format("Strengths with 95 % intervals, in log units from the mean: two teams with a "
                          "difference of 1 win against each other "
                          "with odds of e to 1, ties aside. Davidson's law; its parameter of ties is {:.3g}. "
                          "The prior is one and a half "
                          "games of each team.",
                          summary.tie));
  if (summary.groups > 1)
    page.paragraph(fmt::format(
        "No game connects the {} groups of teams: strengths of different groups cannot be compared.",
        summary.groups));
  page.heading("Meetings");
  rows.clear();
  for (const PairRow& pair : summary.pairs)
    rows.push_back({pair.a, pair.b, std::to_string(pair.games), std::to_string(pair.won),
                    std::to_string(pair.drawn), std::to_string(pair.lost),
                    pair.low
                        ? fmt::format("{:+.2f} ({:+.2f} to {:+.2f})", pair.difference, *pair.low, *pair.high)
                        : fmt::format("{:+.2f}", pair.difference)});
  page.paragraph("Mean difference of goals, with Student's interval for 95 %.");
  page.table({"team", "against", "games", "won", "tied", "lost", "difference"}, rows);
  add_games(page, summary);
  return page.html();
}

Result<std::vector<RecordedDecision>> decisions_of(const std::string& recording) {
  SL_ASSIGN(const mcap::Reader reader, mcap::Reader::open(recording));
  const std::string topic = "/rules/referee/decision";
  std::vector<RecordedDecision> out;
  if (!reader.find_channel(topic)) return out;
  mcap::Cursor cursor = reader.messages({.topics = {topic}});
  for (;;) {
    SL_ASSIGN(const mcap::Message* const message, cursor.next());
    if (!message) return out;
    msg::RefereeDecision decision;
    SL_TRY(read_cdr(message_info<msg::RefereeDecision>(), message->data, &decision));
    out.push_back({static_cast<double>(message->log_time) * 1e-9, decision.rule, decision.team,
                   decision.robot, decision.reason, decision.score});
  }
}

std::string game_page_file(const std::string& recording) {
  return std::filesystem::path(recording).replace_extension(".html").string();
}

std::string game_page(const GameRow& game, const std::vector<RecordedDecision>& decisions) {
  constexpr double before_s = 3;  // what led to a decision
  ReportPage page(
      fmt::format("{} {} {}", game.left, result_text(game), game.right),
      fmt::format("Round {}, seed {}. {} began at negative x, as cyan. {}.", game.round, game.seed, game.left,
                  game.walk_over ? "Walk-over: " + game.reason : "End: " + game.reason));
  const std::string file = file_name(game.recording);
  page.rich_table({"", ""}, {{{"recording"}, {file, file}},
                             {{"watch it"}, {fmt::format("sandlot replay {} --port 8765", file), "", true}},
                             {{"prove it"}, {fmt::format("sandlot replay {} --verify", file), "", true}}});
  page.heading("Decisions of the referee");
  page.paragraph(
      fmt::format("Commands are for the folder of this page. They show the recording from {} s before the "
                  "decision on; the page "
                  "they name plays it on, and goes to any other moment.",
                  before_s));
  std::vector<std::vector<ReportPage::Cell>> rows;
  for (const RecordedDecision& each : decisions)
    rows.push_back({{fmt::format("{:.2f}", each.time_s)},
                    {each.score.size() == 2 ? fmt::format("{} : {}", each.score[0], each.score[1]) : ""},
                    {each.rule},
                    {each.robot.empty() ? each.team : each.robot},
                    {each.reason},
                    {fmt::format("sandlot replay {} --port 8765 --from {:.2f}s", file,
                                 std::max(0.0, each.time_s - before_s)),
                     "", true}});
  page.rich_table({"time [s]", "score", "rule", "of", "reason", "replay from here"}, rows);
  return page.html();
}

}  // namespace sandlot::app
