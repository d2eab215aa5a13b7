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
  const std::string page = tournament_page(summary, "Made by a test.");
  EXPECT_THAT(page, HasSubstr("Tournament: swiss"));
  EXPECT_THAT(page, HasSubstr("&lt;Fast&gt; &amp; "));
  EXPECT_THAT(page, Not(HasSubstr("<Fast>")));
  EXPECT_THAT(page, HasSubstr("+0.75 (-1.25 to +2.75)"));
  EXPECT_THAT(page, HasSubstr("<td>0 : 3</td>"));
  EXPECT_THAT(page, HasSubstr("walk-over: none of its programs answered"));
  EXPECT_THAT(page, HasSubstr("<td>0000000000000abc</td><td>r1_Slow_Fast_s7.mcap</td>"));
  EXPECT_THAT(page, HasSubstr("<th>byes</th>"));
  EXPECT_THAT(page, HasSubstr("+1.50 (-17.56 to +20.56)"));
  EXPECT_THAT(page, Not(HasSubstr("not at its end")));
  // The figure is symmetric about the mean, which lies in its middle: 170 + 520 / 2; the interval's end, 2.75, at the edge.
  EXPECT_THAT(page, HasSubstr("x1=\"430.0\""));
  EXPECT_THAT(page, HasSubstr("x2=\"690.0\""));
  summary.ended = false;
  EXPECT_THAT(tournament_page(summary, ""), HasSubstr("not at its end"));
}

}  // namespace
}  // namespace sandlot::app
