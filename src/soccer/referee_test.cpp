/// The referee against what the rules say, by matches without physics.
#include "soccer/referee.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "soccer/areas.h"
#include "soccer/test_match.h"

namespace sandlot::soccer::test {
namespace {

// -------------------------------------------------------------------------------------------------------- set pieces

TEST(SoccerSetPieces, AKickOffIsStoppedPreparedStartedAndInPlayWithin20cm) {
  Match match;
  match.put(player0, -0.5, 0);
  match.step();
  EXPECT_EQ(match.words, Laws{"FIRST_HALF"});
  EXPECT_EQ(match.laws(), Laws{"begin"});
  match.run(match.rules.stop_s);
  EXPECT_EQ(match.words, (Laws{"FIRST_HALF", "KICKOFF 0"}));
  EXPECT_EQ(match.state.phase, Phase::preparing);
  match.run(match.rules.prepare_min_s + 0.1);
  EXPECT_EQ(match.words.back(), "START");
  EXPECT_EQ(match.last().reason, "all robots are ready");
  EXPECT_FALSE(match.state.in_play);
  match.touch(player0);
  match.ball_m.x = 0.19;
  match.step();
  EXPECT_FALSE(match.state.in_play);
  match.ball_m.x = 0.21;
  match.step();
  EXPECT_TRUE(match.state.in_play);
  EXPECT_EQ(match.last().law, Law::in_play);
  EXPECT_EQ(match.last().robot, player0);
}

TEST(SoccerSetPieces, WaitForMovingRobotsUntilTheTimeIsOver) {
  Match match;
  match.robot(mate1).velocity_mps = {0.5, 0, 0};
  match.run(match.rules.stop_s + match.rules.prepare_kickoff_s -
            0.2);  // longer than that of other set pieces
  EXPECT_EQ(match.state.phase, Phase::preparing);
  match.run(0.6);
  EXPECT_EQ(match.state.phase, Phase::running);
  EXPECT_EQ(match.last().reason, "the time to prepare is over");
}

TEST(SoccerSetPieces, ABallThatNobodyTakesIsInPlayAfterItsTime) {
  Match match;
  match.until_started();
  match.run(match.rules.take_s - 0.2);
  EXPECT_FALSE(match.state.in_play);
  match.run(0.5);
  EXPECT_TRUE(match.state.in_play);
  EXPECT_EQ(match.last().law, Law::not_taken);
}

struct Placed {
  const char* what;
  SetPiece piece;
  Who who;
  double x, y;
  bool wrong;
};

TEST(SoccerSetPieces, DistancesAreHeld) {
  // A set piece of team 0 on the spot (2, 1), or where it belongs. The keeper of team 0 is the taker's team-mate, too.
  const Placed places[] = {
      {"opponent within 3 m", SetPiece::free_kick, player1, 4.8, 1, true},
      {"opponent beyond 3 m", SetPiece::free_kick, player1, 5.1, 1, false},
      {"first team-mate within 2 m", SetPiece::throw_in, mate0, 2, 5.6, false},
      {"opponent near in its penalty area", SetPiece::corner, player1, 9.5, 3, false},
      {"opponent near out of it", SetPiece::corner, player1, 9.5, 5.5, true},
      {"in the other half", SetPiece::kickoff, mate0, 0.5, -4, true},
      {"on the halfway line", SetPiece::kickoff, mate0, 0.05, -4, false},
      {"team-mate within 2 m", SetPiece::kickoff, mate0, -1.5, 0.9, true},
      {"opponent within 3 m of the kick-off", SetPiece::kickoff, player1, 2.8, 0, true},
      {"anybody within 1 m", SetPiece::dropped_ball, mate0, 2.8, 1, true},
      {"anybody beyond 1 m", SetPiece::dropped_ball, mate0, 3.1, 1, false},
      {"field player in the penalty area", SetPiece::penalty, player1, 10, 3, true},
      {"field player outside of it", SetPiece::penalty, player1, 8, 5, false},
      {"attacker too near", SetPiece::penalty, mate0, 7.4, 2, true},
  };
  for (const Placed& place : places) {
    Match match;
    match.step();
    match.state.piece = place.piece;
    match.state.team = place.piece == SetPiece::dropped_ball ? std::int8_t{-1} : std::int8_t{0};
    Input input;
    input.robots = match.robots;
    const Scene before{match.rules, match.field, match.state, input};
    match.state.spot_m = spot_of(before, place.piece, match.state.team,
                                 {2,
                                  place.piece == SetPiece::throw_in ? 7.2
                                  : place.piece == SetPiece::corner ? 6.0
                                                                    : 1.0,
                                  0});
    match.put(player0, match.state.spot_m.x - (place.piece == SetPiece::dropped_ball ? 1.5 : 0.5),
              match.state.spot_m.y);
    match.put(place.who, place.x, place.y);
    input.robots = match.robots;
    const Violation found = violation({match.rules, match.field, match.state, input}, false);
    EXPECT_EQ(static_cast<bool>(found.who), place.wrong) << place.what;
    if (place.wrong) { EXPECT_EQ(found.who, place.who) << place.what; }
  }
}

TEST(SoccerSetPieces, ASecondTeamMateTooNearIsOneTooMany) {
  Match match;
  match.step();
  match.state.piece = SetPiece::free_kick;
  match.state.team = 0;
  match.state.spot_m = {0, 0, 0};
  match.put(player0, -0.5, 0);
  match.put(mate0, 0, 1);
  Input input;
  input.robots = match.robots;
  EXPECT_FALSE(violation({match.rules, match.field, match.state, input}, false).who);
  match.put(keeper0, -1, -1);
  input.robots = match.robots;
  EXPECT_EQ(violation({match.rules, match.field, match.state, input}, false).who, mate0);
}

TEST(SoccerSetPieces, AreRepeatedAfterViolationsAndThenGoOn) {
  Match match;
  match.put(player1, 1, 0);  // never leaves
  for (int i = 0; i < 1000 && match.state.phase != Phase::running; ++i) match.step();
  EXPECT_EQ(match.laws(), (Laws{"begin", "distance", "distance", "start"}));
  EXPECT_EQ(match.decisions[1].robot, player1);
  EXPECT_EQ(match.state.team, 0);
}

TEST(SoccerSetPieces, GoToTheOtherTeamWhenTheirOwnIsToBlameAndChangeSidesOnce) {
  Match match;
  match.into_play();
  match.shoot(player1, {3, 7.3, 0.11});
  EXPECT_EQ(match.last().law, Law::throw_in);
  EXPECT_EQ(match.state.team, 0);
  match.decisions.clear();
  match.put(player0, 3, 5.9), match.put(mate0, 2, 6), match.put(keeper0, 4, 6);  // two too near
  match.put(player1, 3.5, 5), match.put(mate1, 2.5, 5);                          // of the other team, too
  for (int i = 0; i < 2000 && match.state.phase != Phase::running; ++i) match.step();
  EXPECT_EQ(match.laws(), (Laws{"distance", "distance", "distance", "start"}));
  EXPECT_EQ(match.state.piece, SetPiece::free_kick);
  EXPECT_EQ(match.state.team, 1);
}

TEST(SoccerSetPieces, ARobotOnTheSpotIsPutBesideIt) {
  Match match;
  match.into_play();
  match.put(mate1, 3, 6.8);
  match.shoot(player1, {3, 7.3, 0.11});
  match.run(match.rules.stop_s + 0.1);
  EXPECT_EQ(match.last().law, Law::cleared);
  EXPECT_GT(norm(match.robot(mate1).position_m - match.state.spot_m), 0.8);
}

TEST(SoccerSetPieces, OpponentsWhoMoveTheBallBeforeItIsTakenCauseARepetition) {
  Match match;
  match.until_started();
  match.decisions.clear();
  match.touch(player1);
  match.step();
  EXPECT_EQ(match.laws(), Laws{"ball_moved"});
  EXPECT_EQ(match.state.phase, Phase::stopped);
  EXPECT_EQ(match.state.piece, SetPiece::kickoff);
  EXPECT_EQ(match.state.team, 0);
}

// ------------------------------------------------------------------------------------------------- the ball leaves

struct Out {
  const char* what;
  Who last;
  Vec3 to;
  Laws laws;
  SetPiece piece;
  int team;
};

TEST(SoccerBallOut, GoesOnByWhereItLeftAndWhoTouchedItLast) {
  const Out table[] = {
      {"goal of team 0", player0, {11.2, 0.5, 0.11}, {"goal"}, SetPiece::kickoff, 1},
      {"goal of team 1", player1, {-11.2, -1.1, 0.5}, {"goal"}, SetPiece::kickoff, 0},
      {"own goal", mate1, {11.3, 0, 0.11}, {"own_goal"}, SetPiece::kickoff, 1},
      {"on the line", player0, {11.1, 0, 0.11}, {}, SetPiece::none, -1},
      {"over the bar", player0, {11.2, 0, 1.3}, {"goal_kick"}, SetPiece::goal_kick, 1},
      {"beside the post", player0, {11.2, 1.3, 0.11}, {"goal_kick"}, SetPiece::goal_kick, 1},
      {"by a defender", player1, {11.2, 2, 0.11}, {"corner"}, SetPiece::corner, 0},
      {"throw-in of 1", player0, {3, 7.2, 0.11}, {"throw_in"}, SetPiece::throw_in, 1},
      {"throw-in of 0", player1, {3, -7.2, 0.11}, {"throw_in"}, SetPiece::throw_in, 0},
      {"on the touch line", player1, {3, -7.1, 0.11}, {}, SetPiece::none, -1},
      {"below", player1, {3, 0, -1}, {"lost_ball"}, SetPiece::dropped_ball, -1},
  };
  for (const Out& row : table) {
    Match match;
    match.into_play({row.to.x * 0.9, row.to.y * 0.9, 0.11});
    match.shoot(row.last, row.to);
    EXPECT_EQ(match.laws(), row.laws) << row.what;
    if (row.laws.empty()) continue;
    EXPECT_EQ(match.state.piece, row.piece) << row.what;
    EXPECT_EQ(match.state.team, row.team) << row.what;
    EXPECT_EQ(match.words.front(), "STOP") << row.what;
    const bool goal = row.piece == SetPiece::kickoff;
    EXPECT_EQ(match.state.score[0] + match.state.score[1], goal ? 1u : 0u) << row.what;
    if (goal) { EXPECT_EQ(match.state.score[row.team == 0 ? 1 : 0], 1u) << row.what; }
  }
}

TEST(SoccerBallOut, AFastBallIsJudgedWhereItPassedTheLine) {
  // From (10.5, 0) towards (12.5, 2): passes x = 11.11 at y = 0.61, between the posts, although it ends beside the goal.
  Match match;
  match.into_play({10.5, 0, 0.11});
  match.shoot(player0, {12.5, 2, 0.11});
  EXPECT_EQ(match.laws(), Laws{"goal"});
}

TEST(SoccerBallOut, SpotsLieWithinTheLines) {
  Match match;
  match.into_play({10, 3, 0.11});
  match.shoot(player0, {11.3, 3, 0.11});
  EXPECT_EQ(match.state.spot_m, (Vec3{11 - 3.6, 3.5, 0}));
  match.state.spot_m = {};
  const Scene scene{match.rules, match.field, match.state, {}};
  EXPECT_EQ(spot_of(scene, SetPiece::corner, 0, {11.2, -3, 0}), (Vec3{10.6, -6.6, 0}));
  EXPECT_EQ(spot_of(scene, SetPiece::throw_in, 0, {20, 8, 0}), (Vec3{10.6, 6.85, 0}));
  EXPECT_EQ(spot_of(scene, SetPiece::free_kick, 0, {10.5, 1, 0}), (Vec3{7.4, 3.5, 0}));
  EXPECT_EQ(spot_of(scene, SetPiece::penalty, 1, {}), (Vec3{-7.4, 0, 0}));
}

TEST(SoccerGoals, StraightFromAKickOffDoNotCount) {
  for (const bool allowed : {false, true}) {
    Match match;
    match.rules.goal_from_kickoff = allowed;
    match.until_started();
    match.touch(player0);
    match.ball_m = {1, 0, 0.11};
    match.step();
    match.decisions.clear();
    match.ball_m = {11.3, 0, 0.11};
    match.step();
    EXPECT_EQ(match.laws(), Laws{allowed ? "goal" : "no_goal"});
    EXPECT_EQ(match.state.score[0], allowed ? 1u : 0u);
    EXPECT_EQ(match.state.piece, allowed ? SetPiece::kickoff : SetPiece::goal_kick);
  }
}

TEST(SoccerBallOut, ABallThatIsGoneStopsTheGameUntilItIsBack) {
  Match match;
  match.into_play();
  match.has_ball = false;
  match.run(20);
  EXPECT_EQ(match.laws(), Laws{"lost_ball"});
  EXPECT_EQ(match.state.phase, Phase::stopped);
  match.has_ball = true;
  match.run(8);
  EXPECT_EQ(match.state.phase, Phase::running);
}

TEST(SoccerBallOut, NumbersThatAreNoneAreABallThatIsGone) {
  Match match;
  match.into_play();
  match.ball_m.x = NAN;
  match.step();
  EXPECT_EQ(match.laws(), Laws{"lost_ball"});
  match.ball_m = {};
  match.robot(player1).position_m.y = NAN;  // nobody sees it: the game goes on without it
  match.run(20);
  EXPECT_EQ(match.state.phase, Phase::running);
}

// -------------------------------------------------------------------------------------------------------------- play

TEST(SoccerPlay, TheTakerMayNotTouchTwice) {
  for (const bool by_other : {false, true}) {
    Match match;
    match.until_started();
    match.touch(player0);
    match.ball_m = {0.3, 0, 0.11};
    match.step();
    match.run(1);
    match.decisions.clear();
    if (by_other) match.touch(mate0), match.step();
    match.touch(player0);
    match.step();
    EXPECT_EQ(match.laws(), by_other ? Laws{} : Laws{"double_touch"});
    if (!by_other) { EXPECT_EQ(match.state.team, 1); }
  }
}

TEST(SoccerPlay, ARobotKeepsTheBallForThreeMetresAtMost) {
  for (const double way_m : {2.9, 3.2}) {
    Match match;
    match.into_play({-2, 0, 0.11});
    for (double x = 0; x <= way_m + 1e-9; x += 0.1) {
      match.ball_m = {-2 + x, 0, 0.11};
      match.touch(player1);
      match.step();
      if (match.state.phase != Phase::running) break;
    }
    EXPECT_EQ(match.laws(), way_m > 3 ? Laws{"dribble"} : Laws{}) << way_m;
    if (way_m > 3) { EXPECT_EQ(match.state.team, 0); }
  }
}

TEST(SoccerPlay, AHandlerThatHoldsTheBallTouchesIt) {
  Match match;
  match.into_play({-2, 0, 0.11});
  match.robot(player1).holds_ball = true;
  for (int i = 0; i < 40 && match.state.phase == Phase::running; ++i) match.ball_m.x += 0.1, match.step();
  EXPECT_EQ(match.laws(), Laws{"dribble"});
  EXPECT_EQ(match.last().robot, player1);
}

TEST(SoccerPlay, FieldPlayersLeaveGoalAreasInTime) {
  for (const Who who : {player0, keeper1, keeper0}) {
    Match match;
    match.into_play();
    match.put(who, 10.7, 0.5);
    match.run(match.rules.goal_area_s - 0.2);
    EXPECT_EQ(match.laws(), Laws{}) << who.number;
    match.run(0.5);
    EXPECT_EQ(match.laws(), who == player0 ? Laws{"goal_area"} : Laws{}) << who.number;
  }
}

TEST(SoccerPlay, PenaltyAreasAreNotCrowded) {
  for (const int many : {1, 2}) {
    Match match;
    match.into_play();
    match.put(player1, 9.5, 1.5);
    if (many > 1) match.put(mate1, 9.5, -1.5);
    match.run(match.rules.penalty_area_s + 0.3);
    EXPECT_EQ(match.laws(), many > 1 ? Laws{"penalty_area"} : Laws{});
    if (many > 1) { EXPECT_EQ(match.state.spot_m, (Vec3{7.4, 3.5, 0})); }
  }
}

TEST(SoccerPlay, PushingIsAFoulOfTheOneThatCameFaster) {
  struct Case {
    double impulse_Ns, own_mps, other_mps;
    bool foul;
  };
  for (const Case& each :
       {Case{20, 2, 0, true}, Case{14, 2, 0, false}, Case{20, 2, -1.8, false}, Case{20, 0.3, 0, false}}) {
    Match match;
    match.into_play();
    match.put(player0, 1, 1), match.put(player1, 1.5, 1);
    match.robot(player0).velocity_mps = {each.own_mps, 0, 0};
    match.robot(player1).velocity_mps = {each.other_mps, 0, 0};
    match.step();
    match.blows.push_back({player0, player1, {each.impulse_Ns, 0, 0}});
    match.step();
    EXPECT_EQ(match.laws(), each.foul ? Laws{"pushing"} : Laws{}) << each.impulse_Ns << " " << each.own_mps;
    if (each.foul) { EXPECT_EQ(match.state.team, 1); }
  }
}

TEST(SoccerPlay, PushingInTheOwnPenaltyAreaIsAPenaltyKickAndThreeTimesACard) {
  Match match;
  for (int i = 0; i < 3; ++i) {
    match.put(player1, 3, 3), match.put(player0, -3, 3);
    match.into_play();
    match.put(player1, 9.5, 2), match.put(player0, 9, 2);
    match.robot(player1).velocity_mps = {-2, 0, 0};
    match.step();
    match.blows.push_back({player0, player1, {-20, 0, 0}});
    match.step();
    match.robot(player1).velocity_mps = {};
    EXPECT_EQ(match.state.piece, SetPiece::penalty);
    EXPECT_EQ(match.state.team, 0);
    match.state.piece = SetPiece::kickoff, match.state.team = 0, match.state.spot_m = {}, match.ball_m = {};
  }
  EXPECT_EQ(match.laws(), (Laws{"pushing", "yellow_card"}));
}

TEST(SoccerPlay, ABlockedBallIsDropped) {
  Match match;
  match.into_play();
  match.put(player0, -0.4, 0), match.put(player1, 0.4, 0);
  match.run(match.rules.scrum_s - 0.5);
  EXPECT_EQ(match.laws(), Laws{});
  match.run(1);
  EXPECT_EQ(match.laws(), Laws{"scrum"});
  EXPECT_EQ(match.state.piece, SetPiece::dropped_ball);
  Match alone;
  alone.into_play();
  alone.run(alone.rules.stuck_s + 0.5);
  EXPECT_EQ(alone.laws(), Laws{"stuck_ball"});
}

}  // namespace
}  // namespace sandlot::soccer::test
