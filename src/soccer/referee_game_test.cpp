/// Robots that leave and come back, parts of the game, words of persons, and the referee's State, by matches without physics.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/bytes.h"
#include "soccer/test_match.h"

namespace sandlot::soccer::test {
namespace {

// ------------------------------------------------------------------------------------------------------------ robots

TEST(SoccerRobots, TwoYellowCardsAre90SecondsAndARedOneTheRest) {
  Match match;
  match.into_play();
  match.order("YELLOW_CARD", 1, 2);
  EXPECT_TRUE(match.exclusions.empty());
  match.order("YELLOW_CARD", 1, 2);
  ASSERT_EQ(match.exclusions.size(), 1u);
  EXPECT_TRUE(match.exclusions[0].out);
  EXPECT_EQ(match.exclusions[0].who, player1);
  match.order("RED_CARD", 0, 3);
  match.has_ball = false;  // let nothing else happen
  match.run(89.5);
  EXPECT_EQ(match.exclusions.size(), 2u);
  match.run(1);
  ASSERT_EQ(match.exclusions.size(), 3u);
  EXPECT_FALSE(match.exclusions[2].out);
  EXPECT_EQ(match.exclusions[2].who, player1);
  match.run(500);
  EXPECT_EQ(match.exclusions.size(), 3u);
}

TEST(SoccerRobots, RepairTakes20SecondsAtLeastAndBrokenRobotsAreTakenOut) {
  Match match;
  match.rules.repair_ends = false;
  match.into_play();
  match.order("REPAIR", 0, 3);
  match.order("REPAIR_END", 0, 3);
  EXPECT_EQ(match.laws(), (Laws{"repair", "refused"}));
  match.has_ball = false;
  match.run(21);
  match.decisions.clear();
  match.order("REPAIR_END", 0, 3);
  EXPECT_EQ(match.laws(), Laws{"back"});
  match.decisions.clear();
  match.robot(mate1).tilt_rad = 1.5;
  match.step();
  EXPECT_EQ(match.laws(), Laws{"repair"});
  EXPECT_EQ(match.last().robot, mate1);
}

TEST(SoccerRobots, ThreeSubstitutionsWhileTheGameIsStopped) {
  Match match;
  match.into_play();
  match.order("SUBSTITUTION", 0, 3);
  match.order("STOP");
  match.order("SUBSTITUTION", 0, 3);
  match.order("SUBSTITUTION", 0, 2);
  match.order("SUBSTITUTION", 0, 1);
  EXPECT_EQ(match.laws(), (Laws{"refused", "person", "substitution", "substitution", "substitution"}));
  match.decisions.clear();
  match.run(25);
  match.order("SUBSTITUTION", 0, 3);
  EXPECT_EQ(match.last().law, Law::refused);
}

TEST(SoccerRobots, ATeamOfSevenPlaysWithFiveAndOneWithoutGoalkeeperPlays) {
  Match match;
  for (const std::int32_t number : {4, 5, 6, 7}) {
    SeenRobot robot;
    robot.who = {0, number};
    robot.position_m = {-3.0 - number, 5, 0};
    match.robots.push_back(robot);
  }
  std::sort(match.robots.begin(), match.robots.end(), [](const SeenRobot& a, const SeenRobot& b) {
    return std::pair(a.who.team, a.who.number) < std::pair(b.who.team, b.who.number);
  });
  std::erase_if(match.robots, [](const SeenRobot& each) { return each.who == keeper1; });
  match.step();
  EXPECT_EQ(match.laws(), (Laws{"too_many", "too_many", "no_goalkeeper", "begin"}));
  EXPECT_EQ(match.decisions[0].robot, (Who{0, 6}));
  EXPECT_EQ(match.decisions[2].team, 1);
  match.run(15);
  EXPECT_EQ(match.state.phase, Phase::running);
}

// ------------------------------------------------------------------------------------------------- parts of the game

TEST(SoccerParts, HalvesBreakSidesAndTheOtherTeamsKickOff) {
  Match match;
  match.rules.half_s = 30;
  match.rules.break_s = 5;
  match.rules.stop_clock = false;
  match.run(30.2);
  EXPECT_EQ(match.state.stage, Stage::half_time);
  EXPECT_EQ(match.words.back(), "HALF_TIME");
  EXPECT_EQ(match.state.attacks(0), 1);
  match.run(5.2);
  EXPECT_EQ(match.state.stage, Stage::second_half);
  EXPECT_EQ(match.state.attacks(0), -1);
  EXPECT_EQ(match.state.team, 1);
  match.run(30.2);
  EXPECT_TRUE(match.ended);
  EXPECT_EQ(match.state.stage, Stage::ended);
  EXPECT_EQ(match.words.back(), "END_GAME");
}

TEST(SoccerParts, ADrawGoesToOvertimeAndPenaltyKicks) {
  Match match;
  match.rules.half_s = 10;
  match.rules.break_s = 1;
  match.rules.overtime_s = 10;
  match.rules.shootout = 2;
  match.rules.stop_clock = false;
  match.run(2 * 10.2 + 1.2);
  EXPECT_EQ(match.state.stage, Stage::half_time);
  match.run(1.2);
  EXPECT_EQ(match.state.stage, Stage::overtime_first);
  match.run(2 * 10.2 + 2.4);
  EXPECT_EQ(match.state.stage, Stage::penalties);
  // Team 0 scores both, team 1 none: after the second goal of team 0, team 1 cannot catch up with one shot left.
  for (int shot = 0; shot < 3; ++shot) {
    match.until_started();
    const std::int8_t team = match.state.team;
    EXPECT_EQ(team, shot % 2);
    match.touch({team, 2});
    match.ball_m.x += 0.3 * match.state.attacks(team);
    match.step();
    if (team == 0) match.ball_m = {11.3, 0, 0.11};
    match.run(team == 0 ? 0.1 : 11);
  }
  EXPECT_TRUE(match.ended);
  EXPECT_EQ(match.state.teams[0].shots_in, 2u);
  EXPECT_EQ(match.state.teams[1].shots_in, 0u);
}

// --------------------------------------------------------------------------------------------------- words of persons

TEST(SoccerPersons, StopStartSetPiecesGoalsAndTheBall) {
  Match match;
  match.into_play({2, 1, 0.11});
  match.order("STOP");
  match.run(60);
  EXPECT_EQ(match.state.phase, Phase::stopped) << "until a person lets it go on";
  match.order("START");
  match.run(5);
  EXPECT_EQ(match.state.phase, Phase::running);
  match.order("FREEKICK", 1);
  EXPECT_EQ(match.state.piece, SetPiece::free_kick);
  EXPECT_EQ(match.state.team, 1);
  match.order("GOAL", 0);
  EXPECT_EQ(match.state.score[0], 1u);
  EXPECT_EQ(match.state.piece, SetPiece::kickoff);
  match.order("SUBGOAL", 0);
  EXPECT_EQ(match.state.score[0], 0u);
  match.order("BALL 1.5 -2");
  EXPECT_EQ(match.ball_m, (Vec3{1.5, -2, 0.11}));
}

TEST(SoccerPersons, WordsThatCannotBeAreRefusedAndChangeNothing) {
  for (const Word& word :
       {Word{"KICKOF", 0, 0}, Word{"KICKOFF", -1, 0}, Word{"KICKOFF", 2, 0}, Word{"GOAL", -1, 0},
        Word{"RED_CARD", 0, 9}, Word{"RED_CARD", -1, 1}, Word{"REPAIR_END", 0, 2}, Word{"BALL 1", -1, 0},
        Word{"BALL 1 2x", -1, 0}, Word{"BALL nan 2", -1, 0}, Word{"BALL 100 2", -1, 0}, Word{"", -1, 0}}) {
    Match match;
    match.into_play();
    match.order(word.text, word.team, word.robot);
    EXPECT_EQ(match.laws(), Laws{"refused"}) << word.text;
    EXPECT_EQ(match.state.phase, Phase::running) << word.text;
    EXPECT_TRUE(match.exclusions.empty()) << word.text;
  }
}

// ------------------------------------------------------------------------------------------------------------- State

TEST(SoccerState, SavedInTheMiddleItGoesOnTheSame) {
  Match match;
  match.into_play();
  match.order("YELLOW_CARD", 1, 2);
  ByteWriter w;
  write(w, match.state);
  Match other = match;
  other.state = {};
  ByteReader r(w.bytes());
  read(r, other.state);
  ASSERT_TRUE(r.ok() && r.remaining() == 0 && other.state.fits());
  for (Match* each : {&match, &other}) {
    each->decisions.clear();
    each->shoot(player0, {11.2, 0, 0.11});
    each->run(30);
  }
  EXPECT_GT(match.decisions.size(), 2u);
  EXPECT_EQ(match.laws(), other.laws());
  ByteWriter a, b;
  write(a, match.state), write(b, other.state);
  EXPECT_EQ(a.buffer(), b.buffer());
}

TEST(SoccerState, ForgedOnesDoNotFit) {
  Match match;
  match.into_play();
  State forged = match.state;
  EXPECT_TRUE(forged.fits());
  forged.team = 3;
  EXPECT_FALSE(forged.fits());
  forged = match.state;
  forged.robots[1].who.team = 7;
  EXPECT_FALSE(forged.fits());
  forged = match.state;
  std::swap(forged.robots[0], forged.robots[1]);
  EXPECT_FALSE(forged.fits());
  forged = match.state;
  forged.entries.resize(most_entries + 1);
  EXPECT_FALSE(forged.fits());
}

TEST(SoccerState, TheLogKeepsTheLatestDecisions) {
  Match match;
  match.dt_s = 1e-4;
  for (int i = 0; i < 300; ++i) match.order("NOTHING");
  EXPECT_EQ(match.state.entries.size(), most_entries);
  EXPECT_EQ(match.state.entries.back().sequence, match.state.decisions);
  EXPECT_EQ(match.state.decisions, 301u);
}

}  // namespace
}  // namespace sandlot::soccer::test
