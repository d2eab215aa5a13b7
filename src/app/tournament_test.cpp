/// Teams of folders, and the page of a tournament.
#include "app/tournament.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/test_folder.h"

namespace sandlot::app {
namespace {

using test::TestFolder;
using testing::HasSubstr;
using testing::Not;
using tournament::TournamentSummary;

void add_team(const TestFolder& folder, const std::string& path, const std::string& name) {
  std::filesystem::create_directories(folder.path / path);
  folder.write(path + "/team.yaml",
               "version: 1\nname: " + name + "\nrobots: [{controller: {kind: soccer_player}}]\n");
}

TEST(TeamsOf, TakesTeamsAndFoldersOfTeamsByName) {
  const TestFolder folder;
  add_team(folder, "league/b", "Bold");
  add_team(folder, "league/a", "Agile");
  std::filesystem::create_directories(folder.path / "league/notes");
  add_team(folder, "guest", "Guest");
  const auto teams = teams_of({folder.file("guest"), folder.file("league"), folder.file("guest")});
  ASSERT_TRUE(teams) << teams.error().text();
  std::string names;
  for (const tournament::Team& each : *teams) names += each.name + ",";
  EXPECT_EQ(names, "Guest,Agile,Bold,Guest 2,");
  EXPECT_EQ((*teams)[0].content, (*teams)[3].content);
  EXPECT_NE((*teams)[0].content, (*teams)[1].content);
  EXPECT_EQ((*teams)[1].folder, folder.file("league/a"));
}

TEST(TeamsOf, NamesFoldersWithoutATeamAndBadTeams) {
  const TestFolder folder;
  std::filesystem::create_directories(folder.path / "empty");
  EXPECT_THAT(teams_of({folder.file("empty")}).error().text(), HasSubstr("there is no team in"));
  EXPECT_THAT(teams_of({folder.file("nowhere")}).error().text(), HasSubstr("cannot be read"));
  std::filesystem::create_directories(folder.path / "bad");
  folder.write("bad/team.yaml", "version: 1\nname: Bad\nrobts: []\n");
  EXPECT_THAT(teams_of({folder.file("bad")}).error().text(), HasSubstr("bad/team.yaml:3"));
}

TEST(TournamentPage, HasTheTableTheStrengthsAndTheGames) {
  TournamentSummary summary;
  summary.format = "swiss";
  summary.ended = true;
  summary.groups = 1;
  summary.table.push_back({"<Fast> & \"bold\"", 2, 1, 1, 0, 5, 2, 4, 1, 0.75, -1.25, 2.75, "a note"});
  summary.table.push_back({"Slow", 2, 0, 1, 1, 2, 5, 1, 0, -0.75, -2.75, 1.25, ""});
  summary.pairs.push_back({"Fast", "Slow", 2, 1, 1, 0, 1.5, -17.56, 20.56});
  tournament::GameRow game;
  game.left = "Slow", game.right = "Fast", game.goals_right = 3, game.seed = 7, game.walk_over = true;
  game.reason = "none of its programs answered";
  game.recording = "cup/games/r1_Slow_Fast_s7.mcap";
  game.state_hash.value = 0xabc;
  summary.games.push_back(game);
  tournament::GameRow failed;
  failed.left = "Fast", failed.right = "Slow", failed.played = false, failed.reason = "it crashed";
  summary.games.push_back(failed);
  summary.not_played = 1;
  const std::string page = tournament_page(summary, "Made by a test.");
  EXPECT_THAT(page, HasSubstr("Tournament: swiss"));
  EXPECT_THAT(page, HasSubstr("&lt;Fast&gt; &amp; "));
  EXPECT_THAT(page, Not(HasSubstr("<Fast>")));
  EXPECT_THAT(page, HasSubstr("+0.75 (-1.25 to +2.75)"));
  EXPECT_THAT(page, HasSubstr("<td><a href=\"games/r1_Slow_Fast_s7.html\">0 : 3</a></td>"));
  EXPECT_THAT(
      page,
      HasSubstr("<td>Fast</td><td>-</td><td>Slow</td><td>0</td><td>not played: it crashed</td><td></td>"));
  EXPECT_THAT(page, HasSubstr("1 of its games could not be played"));
  EXPECT_THAT(page, HasSubstr("walk-over: none of its programs answered"));
  EXPECT_THAT(page, HasSubstr("<td>0000000000000abc</td>"
                              "<td><a href=\"games/r1_Slow_Fast_s7.mcap\">r1_Slow_Fast_s7.mcap</a></td>"));
  EXPECT_THAT(page, HasSubstr("<th>byes</th>"));
  EXPECT_THAT(page, HasSubstr("+1.50 (-17.56 to +20.56)"));
  EXPECT_THAT(page, Not(HasSubstr("not at its end")));
  // The figure is symmetric about the mean, which lies in its middle: 170 + 520 / 2; the interval's end, 2.75, at the edge.
  EXPECT_THAT(page, HasSubstr("x1=\"430.0\""));
  EXPECT_THAT(page, HasSubstr("x2=\"690.0\""));
  summary.ended = false;
  EXPECT_THAT(tournament_page(summary, ""), HasSubstr("not at its end"));
}

TEST(GamePage, HasACommandForEachDecisionThatBeginsBeforeIt) {
  tournament::GameRow game;
  game.left = "Slow", game.right = "Fast & Co", game.goals_left = 1, game.goals_right = 2, game.seed = 7;
  game.reason = "the game has ended";
  game.recording = "cup/games/r1_Slow_Fast_s7.mcap";
  EXPECT_EQ(game_page_file(game.recording), "cup/games/r1_Slow_Fast_s7.html");
  const std::string page = game_page(game, {{1.5, "begin", "cyan", "", "the first half", {0, 0}},
                                            {62.25, "goal", "cyan", "cyan2", "over the line", {1, 0}}});
  EXPECT_THAT(page, HasSubstr("Slow 1 : 2 Fast &amp; Co"));
  EXPECT_THAT(page, HasSubstr("<td>1.50</td><td>0 : 0</td><td>begin</td><td>cyan</td>"));
  EXPECT_THAT(page, HasSubstr("<code>sandlot replay r1_Slow_Fast_s7.mcap --port 8765 --from 0.00s</code>"));
  EXPECT_THAT(page,
              HasSubstr("<td>62.25</td><td>1 : 0</td><td>goal</td><td>cyan2</td><td>over the line</td>"));
  // Three seconds before.
  EXPECT_THAT(page, HasSubstr("<code>sandlot replay r1_Slow_Fast_s7.mcap --port 8765 --from 59.25s</code>"));
  EXPECT_THAT(page, Not(HasSubstr("href=\"http")));
}

TEST(TeamsOf, ContentHasTheFilesOutsideThatATeamNames) {
  const TestFolder folder;
  std::filesystem::create_directories(folder.path / "one/lib");
  std::filesystem::create_directories(folder.path / "shared");
  folder.write("robot.yaml", "a");
  folder.write("shared/play.py", "a");
  folder.write("other.yaml", "a");
  folder.write("one/lib/near.py", "a");
  folder.write("one/team.yaml",
               "version: 1\nname: One\nrobots:\n"
               "  - {model: ../robot.yaml, controller: {kind: remote, command: [python3, play.py], folder: "
               "../shared}}\n");
  const auto content = [&] { return teams_of({folder.file("one")}).value().front().content; };
  const std::string first = content();
  EXPECT_EQ(content(), first);
  folder.write("other.yaml", "b");  // named nowhere
  EXPECT_EQ(content(), first);
  folder.write("robot.yaml", "b");
  const std::string second = content();
  EXPECT_NE(second, first);
  folder.write("shared/play.py", "b");
  const std::string third = content();
  EXPECT_NE(third, second);
  folder.write("one/lib/near.py", "b");
  EXPECT_NE(content(), third);
}

}  // namespace
}  // namespace sandlot::app
