/// Promises of scenarios/soccer_attack.yaml and scenarios/soccer_game.yaml: the controller soccer_player in whole runs.
#include <gtest/gtest.h>

#include "command.h"

namespace sandlot::test {
namespace {

/// Goals in `seeds` runs, each with the ball in another place, of at most 20 s.
int goals(int seeds, const std::string& more) {
  int sum = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto s = summary_of("scenarios/soccer_attack.yaml --duration 20s --seed " + std::to_string(seed) +
                              more);
    if (s.contains("failed")) {
      ADD_FAILURE() << s["failed"];
      continue;
    }
    if (s["criterion"] == 1.0) ++sum;
  }
  return sum;
}

TEST(SoccerPlayers, ScoreOnAnEmptyGoalFromTwentyPlaces) { EXPECT_EQ(goals(20, ""), 20); }

TEST(SoccerPlayers, ScoreAtTheOtherLevelsAndOnTheOtherEngine) {
  for (const char* const more : {" --set sense=world", " --set drive=contact", " --set engine=planar",
                                 " --set play=run_and_kick", " --set play=dribbling", " --set play=pressing"})
    EXPECT_GE(goals(3, more), 2) << more;
  EXPECT_EQ(goals(1, " --set sense=image"), 1);
}

TEST(SoccerPlayers, PlayTheSameGameOnAnyNumberOfThreadsAndFromASnapshot) {
  const std::string scenario = "scenarios/soccer_game.yaml";
  const auto whole = summary_of(scenario + " --duration 6s");
  ASSERT_FALSE(whole.contains("failed")) << whole["failed"];
  const TestFolder scratch;
  const std::string half = scratch.file("half.snapshot");
  ASSERT_EQ(sandlot("run " + scenario + " --headless --duration 3s --snapshot " + half).exit_code, 0);
  for (const int threads : {1, 2, 4}) {
    const std::string more = " --threads " + std::to_string(threads);
    EXPECT_EQ(summary_of(scenario + " --duration 6s" + more)["state_hash"], whole["state_hash"]) << threads;
    EXPECT_EQ(summary_of("--from " + half + " --duration 3s" + more)["state_hash"], whole["state_hash"])
        << threads;
  }
}

}  // namespace
}  // namespace sandlot::test
