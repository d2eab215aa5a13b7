/// Command line and result of a game in a process of its own. tests/match_test.py plays such games.
#include "app/game_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandlot::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

tournament::Match game_of_seed(std::uint64_t seed) {
  tournament::Match game;
  game.game.seed = seed;
  game.teams[0] = {"A", "", "teams/a"};
  game.teams[1] = {"B", "", "teams/b b"};
  return game;
}

TEST(GameProcess, ArgumentsHaveAllThatMakesTheGame) {
  MatchSpec spec;
  EXPECT_THAT(match_arguments(spec, game_of_seed(3)),
              ElementsAre("match", "teams/a", "teams/b b", "--seed", "3"));
  spec.sense = "objects", spec.drive = "ideal", spec.engine = "planar", spec.size = "12x8";
  spec.half_s = 0.1;
  spec.run.spec.overrides = {{"players", "2"}, {"break", "1 s"}};
  tournament::Match game = game_of_seed(18446744073709551615u);
  game.recording = "cup/games/a.mcap";
  EXPECT_THAT(match_arguments(spec, game),
              ElementsAre("match", "teams/a", "teams/b b", "--seed", "18446744073709551615", "--level",
                          "objects", "--drive", "ideal", "--physics", "planar", "--size", "12x8",
                          "--duration", "0.2 s", "--set", "players=2", "--set", "break=1 s", "--record",
                          "cup/games/a.mcap", "--record-topics", "/rules/*"));
}

TEST(GameProcess, ResultIsThatOfTheJson) {
  const auto played = read_game(
      R"({"goals": [2, 2], "penalty_kicks": [1, 3], "walk_over": "", "state_hash": "00000000000000ff", "sim_seconds": 61.5,
          "recording": "a.mcap", "summary": {"stopped": "the game has ended"}})");
  ASSERT_TRUE(played) << played.error().text();
  EXPECT_THAT(played->goals, ElementsAre(2, 2));
  EXPECT_THAT(played->penalty_kicks, ElementsAre(1, 3));
  EXPECT_FALSE(played->walk_over);
  EXPECT_EQ(played->reason, "the game has ended");
  EXPECT_EQ(played->state_hash.value, 255u);
  EXPECT_EQ(played->sim_s, 61.5);
  EXPECT_EQ(played->recording, "a.mcap");
  const auto by_rule = read_game(
      R"({"goals": [0, 3], "penalty_kicks": [0, 0], "walk_over": "A loses by rule", "state_hash": "1", "sim_seconds": 1, "recording": "",
          "summary": {"stopped": "the game has ended"}})");
  ASSERT_TRUE(by_rule);
  EXPECT_TRUE(by_rule->walk_over);
  EXPECT_EQ(by_rule->reason, "A loses by rule");
}

TEST(GameProcess, TextsThatAreNoResultAreRefused) {
  for (
      const char* const text :
      {"", "[]", "3", "{", "{}", R"({"goals": [1]})",
       R"({"goals": [1, 2], "penalty_kicks": [0, 0], "walk_over": 3, "state_hash": "1", "sim_seconds": 1, "recording": ""})",
       R"({"goals": ["a", 2], "penalty_kicks": [0, 0], "walk_over": "", "state_hash": "1", "sim_seconds": 1, "recording": "", "summary": {"stopped": ""}})",
       R"({"goals": [1, 2], "penalty_kicks": [0, 0], "walk_over": "", "state_hash": "no", "sim_seconds": 1, "recording": "", "summary": {"stopped": ""}})"})
    EXPECT_FALSE(read_game(text)) << text;
}

}  // namespace
}  // namespace sandlot::app
