/// Levels of the demo's match. How fast a machine is is in no test: margins are chosen so that every machine agrees.
#include "app/match_level.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandlot::app {
namespace {

using testing::HasSubstr;

constexpr double any_machine = 1e-9, no_machine = 1e9;

TEST(MatchLevel, CandidatesGoFromTheMostToTheLeastDetailed) {
  const auto all = candidate_levels({});
  ASSERT_GE(all.size(), 4u);
  EXPECT_EQ(all.front(), (MatchLevel{"image", "roller", "rigid"}));
  EXPECT_EQ(all.back(), (MatchLevel{"world", "ideal", "planar"}));
}

TEST(MatchLevel, WhatTheCallerSaysHoldsForAllCandidatesAndNoneComesTwice) {
  const auto of_world = candidate_levels({{"vars.sense", "world"}, {"half", "20"}});
  ASSERT_EQ(of_world.size(), 4u);  // roller, contact and ideal on the rigid engine, ideal on the planar one
  for (const MatchLevel& level : of_world) EXPECT_EQ(level.sense, "world");
  const auto one = candidate_levels({{"sense", "objects"}, {"drive", "contact"}, {"engine", "planar"}});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0], (MatchLevel{"objects", "contact", "planar"}));
}

TEST(MatchLevel, TheFirstFastEnoughOneIsChosenAndTheLastWhereNoneIs) {
  const RunSpec match{.file = "scenarios/match.yaml", .overrides = {{"sense", "world"}, {"players", "1"}}};
  const auto first = choose_level(match, any_machine);
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_EQ(first->level, (MatchLevel{"world", "roller", "rigid"}));
  EXPECT_GT(first->real_time_factor, 0);
  const auto last = choose_level(match, no_machine);
  ASSERT_TRUE(last) << last.error().text();
  EXPECT_EQ(last->level, (MatchLevel{"world", "ideal", "planar"}));
}

TEST(MatchLevel, AMatchThatCannotBeBuiltIsAnError) {
  const RunSpec match{.file = "scenarios/match.yaml", .overrides = {{"cyan", "../docs"}}};
  const auto refused = choose_level(match, any_machine);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text(), HasSubstr("there is no team in"));
}

}  // namespace
}  // namespace sandlot::app
