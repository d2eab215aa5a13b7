/// Corners of the laws: what nearly is a breach, and what is one for another reason than the usual.
#include "soccer/judge.h"
#include "soccer/last_touch.h"
#include "soccer/set_pieces.h"
#include "soccer/test_match.h"

namespace sandlot::soccer::test {
namespace {

TEST(SoccerLaws, AGoalCountsOnceAnotherRobotHasTouchedTheSetPiece) {
  Match match;
  match.until_started();
  match.touch(player0);
  match.ball_m = {0.3, 0, 0.11};
  match.step();
  match.touch(mate0);
  match.ball_m = {11.3, 0, 0.11};  // within the same tick, while the set piece is still known
  match.step();
  EXPECT_EQ(match.last().law, Law::goal);
}

/// A ball that leaves over both lines in one tick is judged by the line that it passed first.
TEST(SoccerLaws, ABallThatLeavesAtTheCornerPassesOneLineFirst) {
  struct Case {
    Vec3 from, to;
    Law law;
  };
  // At x = 11.11 the first one is at y = 6.5 and leaves beside the goal; the second one passes y = 7.11 at x = 10.5.
  for (const Case& each : {Case{{10.5, 5.89, 0.11}, {12.5, 7.89, 0.11}, Law::goal_kick},
                           Case{{9.89, 6.5, 0.11}, {11.89, 8.5, 0.11}, Law::throw_in}}) {
    Match match;
    match.into_play(each.from);
    match.shoot(player0, each.to);
    EXPECT_EQ(match.last().law, each.law);
  }
}

TEST(SoccerLaws, ABallThatWasLetGoMayRollFartherThanOneMayKeepIt) {
  Match match;
  match.into_play({-4, 0, 0.11});
  match.touch(player1);
  match.step();
  for (int i = 0; i < 4; ++i) match.ball_m.x += 1.1, match.step();  // kicked, with 11 m/s
  EXPECT_EQ(match.laws(), Laws{});
  for (int i = 0; i < 10; ++i) match.ball_m.x += 0.1, match.step();
  // Who comes after it has not kept it.
  match.touch(player1);
  match.step();
  EXPECT_EQ(match.laws(), Laws{});
}

TEST(SoccerLaws, WhatWasPushedFadesWithinASecond) {
  // 10 Ns and, after a second, 10 Ns: 10 e^-1 + 10 = 13.7 of 15. After half a second 10 e^-0.5 + 10 = 16.1.
  for (const double pause_s : {1.0, 0.5}) {
    Match match;
    match.into_play({0, 5, 0.11});
    match.put(player0, 1, 1), match.put(player1, 1.5, 1);
    match.robot(player0).velocity_mps = {2, 0, 0};
    match.step();
    match.blows.push_back({player0, player1, {10, 0, 0}});
    match.run(pause_s);
    match.blows.push_back({player0, player1, {10, 0, 0}});
    match.step();
    EXPECT_EQ(match.laws(), pause_s < 1 ? Laws{"pushing"} : Laws{}) << pause_s;
  }
}

TEST(SoccerLaws, AlongTheLineBetweenRobotsAloneABlowPushes) {
  Match match;
  match.into_play({0, 5, 0.11});
  match.put(player0, 1, 1), match.put(player1, 1.5, 1);
  match.robot(player0).velocity_mps = {2, 0, 0};
  match.step();
  match.blows.push_back({player0, player1, {14, 30, 0}});  // the rest rubs past
  match.step();
  EXPECT_EQ(match.laws(), Laws{});
}

TEST(SoccerLaws, RobotsOfOneTeamBlockABallAsLongAsNobodyMovesIt) {
  Match match;
  match.into_play();
  match.put(player0, -0.4, 0), match.put(mate0, 0.4, 0);
  match.run(match.rules.scrum_s + 1);
  EXPECT_EQ(match.laws(), Laws{});
  match.run(match.rules.stuck_s - match.rules.scrum_s);
  EXPECT_EQ(match.laws(), Laws{"stuck_ball"});
}

TEST(SoccerLaws, EachAreaHasItsOwnNumberOfRobots) {
  // Two defenders may be at home here, one attacker with the other team.
  for (const bool at_home : {true, false}) {
    Match match;
    match.rules.defenders = 2;
    match.into_play();
    const double x = at_home ? -9.5 : 9.5;
    match.put(player0, x, 1.5), match.put(mate0, x, -1.5);
    match.run(match.rules.penalty_area_s + 0.3);
    EXPECT_EQ(match.laws(), at_home ? Laws{} : Laws{"penalty_area"});
  }
}

TEST(SoccerLaws, AGoalkeeperIsAnAttackerInTheAreaOfTheOthers) {
  Match match;
  match.into_play();
  match.put(keeper0, 9.5, 1.5), match.put(player0, 9.5, -1.5);
  match.run(match.rules.penalty_area_s + 0.3);
  EXPECT_EQ(match.laws(), Laws{"penalty_area"});
}

TEST(SoccerLaws, WhileASetPieceIsPreparedTheLastTouchIsStillKnown) {
  Touches touches;
  touches.last = touches.taker = touches.holder = player0;
  forget_touches(touches, true);
  EXPECT_EQ(touches.last, player0);
  EXPECT_FALSE(touches.taker);
  EXPECT_FALSE(touches.holder);
  forget_touches(touches, false);
  EXPECT_FALSE(touches.last);
}

TEST(SoccerLaws, WhoLetsGoOfTheBallForHalfASecondHoldsItNoMore) {
  Touches touches;
  Rules rules;
  Input input;
  input.dt_s = 0.1;
  input.touches = {{player0}};
  follow_touches(touches, rules, input, false);
  input.touches.clear();
  input.ball_m = {2, 0, 0.11};
  for (int i = 0; i < 5; ++i) follow_touches(touches, rules, input, false);
  EXPECT_EQ(touches.holder, player0);
  follow_touches(touches, rules, input, false);
  EXPECT_FALSE(touches.holder);
  // When it has it again, its way begins there.
  input.touches = {{player0}};
  follow_touches(touches, rules, input, false);
  EXPECT_EQ(touches.got_m.x, 2);
}

/// A scene of a set piece of team 0 at `spot`.
struct Piece {
  Match match;
  Input input;
  explicit Piece(SetPiece piece, Vec3 spot) {
    match.state.piece = piece;
    match.state.team = 0;
    match.state.spot_m = spot;
  }
  Violation wrong(bool started) {
    input.robots = match.robots;
    return violation(Scene{match.rules, match.field, match.state, input}, started);
  }
};

TEST(SoccerLaws, OnceItIsStartedTheOwnTeamMayRunToTheBall) {
  Piece piece(SetPiece::kickoff, {});
  piece.match.put(player0, -0.3, 0), piece.match.put(mate0, -1, 0.5);
  EXPECT_EQ(piece.wrong(false).who, mate0);
  EXPECT_FALSE(piece.wrong(true).who);
  piece.match.put(player1, 2, 0);
  EXPECT_EQ(piece.wrong(true).who, player1);
}

TEST(SoccerLaws, ADefenderInItsOwnPenaltyAreaMayBeNear) {
  Piece piece(SetPiece::free_kick, {7.4, 3.5, 0});
  piece.match.put(player0, 7.2, 3.5);
  piece.match.put(player1, 9.5, 2.5);  // 2.3 m from the ball, at home
  EXPECT_FALSE(piece.wrong(false).who);
  piece.match.put(player1, 8, 1.5);  // 2.1 m, not at home
  EXPECT_EQ(piece.wrong(false).who, player1);
}

TEST(SoccerLaws, AGoalkeeperThatIsAloneTakesSetPieces) {
  Piece piece(SetPiece::free_kick, {-5, 0, 0});
  EXPECT_EQ(piece.match.robots.front().who, keeper0);
  piece.wrong(false);
  const auto taker = [&] {
    piece.wrong(false);
    return nearest_taker(Scene{piece.match.rules, piece.match.field, piece.match.state, piece.input});
  };
  piece.match.put(keeper0, -5, 0.3);
  EXPECT_EQ(taker(), player0);
  std::erase_if(piece.match.robots,
                [](const SeenRobot& each) { return each.who == player0 || each.who == mate0; });
  EXPECT_EQ(taker(), keeper0);
}

TEST(SoccerLaws, TheTakingTeamAloneLosesItsSetPieceByViolations) {
  for (const Who who : {mate0, player1}) {
    Match match;
    match.into_play();
    match.shoot(player1, {3, 7.2, 0.11});
    ASSERT_EQ(match.state.piece, SetPiece::throw_in);
    ASSERT_EQ(match.state.team, 0);
    // Two team-mates besides the taker, or one opponent, stay too near until the time is over, three times.
    match.put(player0, 3, 6);
    for (int i = 0; i < 3; ++i) {
      match.run(3);
      if (who == mate0) {
        match.put(mate0, 2, 6.5);
        SeenRobot third = match.robot(mate0);
        third.who.number = 4;
        third.position_m = {4, 6.5, 0};
        std::erase_if(match.robots, [&](const SeenRobot& each) { return each.who == third.who; });
        match.robots.insert(match.robots.begin() + 3, third);
      } else {
        match.put(player1, 3, 5);
      }
      match.run(match.rules.prepare_max_s);
    }
    if (who == mate0) {
      EXPECT_EQ(match.state.piece, SetPiece::free_kick);
      EXPECT_EQ(match.state.team, 1);
    } else {
      EXPECT_EQ(match.state.piece, SetPiece::throw_in);
      EXPECT_EQ(match.state.team, 0);
      EXPECT_EQ(match.state.phase, Phase::running) << "it is taken all the same";
    }
  }
}

TEST(SoccerLaws, APenaltyKickHasMoreTimeThanOthers) {
  Match match;
  match.into_play();
  match.order("PENALTY", 0);
  match.order("START");
  match.until_started();
  for (SeenRobot& each : match.robots)
    if (each.who.number != 1) each.position_m = {each.who.team == 0 ? -3.0 : -2.0, each.who.number - 2.0, 0};
  match.run(match.rules.take_s + 1);
  EXPECT_EQ(match.state.piece, SetPiece::penalty);
  EXPECT_EQ(match.state.phase, Phase::running);
  match.run(match.rules.penalty_s - match.rules.take_s);
  EXPECT_EQ(match.state.piece, SetPiece::goal_kick);
  EXPECT_EQ(match.state.team, 1);
}

TEST(SoccerLaws, HowTheBallWasSetDoesNotMatterOnceAnotherRobotHasIt) {
  Match match;
  match.until_started();
  match.touch(player0);
  match.ball_m = {0.3, 0, 0.11};
  match.step();
  EXPECT_EQ(match.state.piece, SetPiece::kickoff);
  match.touch(mate0);
  match.step();
  EXPECT_EQ(match.state.piece, SetPiece::none);
  EXPECT_EQ(match.state.team, -1);
}

TEST(SoccerLaws, AGameThatIsDecidedHasNoOvertime) {
  Match match;
  match.rules.half_s = 10;
  match.rules.break_s = 1;
  match.rules.overtime_s = 10;
  match.rules.stop_clock = false;
  match.order("GOAL", 0);
  match.run(2 * 10.2 + 1.4);
  EXPECT_EQ(match.state.stage, Stage::ended);
}

TEST(SoccerLaws, AfterASecondYellowCardOneBeginsAnew) {
  Match match;
  match.into_play();
  for (int i = 0; i < 2; ++i) match.order("YELLOW_CARD", 1, 2);
  match.has_ball = false;
  match.run(match.rules.second_yellow_s + 1);
  ASSERT_EQ(match.exclusions.size(), 2u);  // out and back
  match.order("YELLOW_CARD", 1, 2);
  EXPECT_EQ(match.exclusions.size(), 2u) << "the first one of a new count";
}

TEST(SoccerLaws, ARobotThatComesLaterPlaysWhereThereIsRoom) {
  Match match;
  match.rules.players = 4;
  match.into_play();
  for (const std::int32_t number : {4, 5}) {
    SeenRobot late;
    late.who = {0, number};
    late.position_m = {-4, 2.0 - number, 0};
    match.robots.insert(match.robots.begin() + number - 1, late);
    match.step();
    EXPECT_EQ(match.laws(), number == 4 ? Laws{} : Laws{"too_many"}) << number;
  }
}

TEST(SoccerLaws, ARobotThatIsOutTouchesNothing) {
  Match match;
  match.into_play();
  match.order("RED_CARD", 0, 2);
  match.touch(player0);
  match.step();
  EXPECT_FALSE(match.state.touches.last == player0);
}

TEST(SoccerLaws, NoScoreIsTakenBelowZero) {
  Match match;
  match.into_play();
  match.order("SUBGOAL", 0);
  EXPECT_EQ(match.state.score[0], 0u);
  match.order("GOAL", 0);
  match.order("SUBGOAL", 0);
  EXPECT_EQ(match.state.score[0], 0u);
}

}  // namespace
}  // namespace sandlot::soccer::test
