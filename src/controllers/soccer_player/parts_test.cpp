/// Parts of a player by themselves, against closed forms: motion, tracking, localisation, roles, the game, choices with the ball.
#include <gtest/gtest.h>

#include <array>

#include "base/math.h"
#include "controllers/soccer_player/aims.h"
#include "controllers/soccer_player/game.h"
#include "controllers/soccer_player/localisation.h"
#include "controllers/soccer_player/motion.h"
#include "controllers/soccer_player/play.h"
#include "controllers/soccer_player/roles.h"
#include "controllers/soccer_player/tracking.h"

namespace sandlot::controllers::soccer_player {
namespace {

constexpr double exact = 1e-12;

void expect_place(Vec3 is, double x, double y, double tolerance = exact) {
  EXPECT_NEAR(is.x, x, tolerance);
  EXPECT_NEAR(is.y, y, tolerance);
}

// ---------------------------------------------------------------------------------------------------------- motion

TEST(PlayerMotion, BrakesSoThatItStopsAtItsPlace) {
  const Limits limits{3, 5, 2};
  expect_place(velocity_to({}, {10, 0, 0}, {}, limits), 3, 0);
  expect_place(velocity_to({}, {0, -1, 0}, {}, limits), 0, -2);  // v^2 = 2 * 2 * 1
  expect_place(velocity_to({}, {0.1, 0, 0}, {}, limits), 0.35, 0);
  // What moves on is followed, at no more than the largest speed.
  expect_place(velocity_to({}, {1, 0, 0}, {0.5, 0.5, 0}, limits), 2.5, 0.5);
  EXPECT_NEAR(norm(velocity_to({}, {10, 0, 0}, {0, 2, 0}, limits)), 3, exact);
}

TEST(PlayerMotion, DrivesInItsOwnFrame) {
  Self self;
  self.yaw_rad = math::pi / 2;
  const msg::Twist aside = drive(self, {1, 0, 0}, math::pi / 2, {3, 5, 2}, true);
  EXPECT_NEAR(aside.linear.x, 0, exact);
  EXPECT_NEAR(aside.linear.y, -1, exact);
  EXPECT_EQ(aside.angular.z, 0);
  // 5 of an error of 0.1; of a large one no more than leaves it time to stop: sqrt(2 * 4 * 1).
  EXPECT_NEAR(drive(self, {}, math::pi / 2 - 0.1, {3, 5, 2}, true).angular.z, -0.5, exact);
  EXPECT_NEAR(drive(self, {}, math::pi / 2 + 1, {3, 5, 2}, true).angular.z, std::sqrt(8.0), exact);
}

TEST(PlayerMotion, ADriveWithoutSidewaysMotionDrivesTheShareOfItsWayThatLiesAhead) {
  const Self self;
  const Vec3 way{math::cos(0.6), math::sin(0.6), 0};
  const msg::Twist twist = drive(self, way, 0, {3, 5, 2}, false);
  EXPECT_NEAR(twist.linear.x, math::cos(0.6), exact);
  EXPECT_EQ(twist.linear.y, 0);
  EXPECT_GT(twist.angular.z, 1);
  EXPECT_EQ(drive(self, {-1, 0.1, 0}, 0, {3, 5, 2}, false).linear.x, 0) << "it turns first";
}

// -------------------------------------------------------------------------------------------------------- tracking

TEST(PlayerTracking, ABallRollsOnAndSlowsDown) {
  Ball ball;
  hold_ball(ball, {1, 2, 0}, {1, 0, 0}, 5);
  predict_ball(ball, 1);
  expect_place(ball.at, 2 - 0.5 * 0.25, 2);
  expect_place(ball.velocity, 0.75, 0);
}

TEST(PlayerTracking, ASightingFiveDeviationsOffIsBelievedOnlyWhenAnotherOneAgrees) {
  Ball ball;
  see_ball(ball, {}, 0.1, 1);
  see_ball(ball, {}, 0.1, 1);  // variance 0.005 now; five deviations of the difference: 0.61 m
  EXPECT_NEAR(ball.var_p, 0.005, exact);
  Ball other = ball;
  see_ball(other, {0.6, 0, 0}, 0.1, 1);
  EXPECT_NEAR(other.at.x, 0.6 * 0.005 / 0.015, exact);
  see_ball(ball, {0.7, 0, 0}, 0.1, 1);
  EXPECT_EQ(ball.at.x, 0);
  see_ball(ball, {0.7, 0, 0}, 0.1, 1);
  EXPECT_EQ(ball.at.x, 0.7);
}

TEST(PlayerTracking, ARobotIsForgottenAfterItsTime) {
  std::vector<Obstacle> robots;
  see_robot(robots, {1, 0, 0}, 0.1, 5);
  predict_robots(robots, 0.79, 5.79);
  EXPECT_EQ(robots.size(), 1u);
  predict_robots(robots, 0.02, 5.81);
  EXPECT_TRUE(robots.empty());
}

TEST(PlayerTracking, TheTeamBelievesFreshSightingsMoreThanOldOnes) {
  Ball own;
  hold_ball(own, {1, 0, 0}, {}, 9);
  own.var_p = 0.0025;
  std::vector<Mate> mates(1);
  mates[0].ball_known = true;
  mates[0].ball_std_m = 0.3;
  mates[0].ball_seen_s = 10;
  // A second at 0.5 m/s makes 0.25 m^2 of the own sighting; the mate's has 0.09 and 0.01 for its own place.
  const double mine = 0.0025 + 0.25 + 1e-4, its = 0.09 + 1e-4 + 0.01;
  const Ball team = team_ball(own, mates, 10);
  EXPECT_EQ(team.seen_s, 10);
  EXPECT_NEAR(team.at.x, (1 / mine) / (1 / mine + 1 / its), exact);
  // Those that do not agree within 1.2 m with the best are left out.
  own.at = {1.3, 0, 0};
  EXPECT_EQ(team_ball(own, mates, 10).at.x, 0);
  EXPECT_FALSE(team_ball(own, {}, 10.6).known);
}

// ---------------------------------------------------------------------------------------------------- localisation

TEST(PlayerPlace, OdometryIsTurnedByTheBelievedHeading) {
  Self self;
  self.yaw_rad = 1;
  const Vec3 first{1, 1, 0};
  move_by_odometry(self, first, 0.5, {}, 0);
  EXPECT_EQ(self.at, (Vec3{}));
  // A metre ahead as the odometry has it, and a turn by 0.2.
  move_by_odometry(self, first + Vec3{math::cos(0.5), math::sin(0.5), 0}, 0.7, {1, 0, 0}, 0.3);
  expect_place(self.at, math::cos(1.0), math::sin(1.0));
  EXPECT_NEAR(self.yaw_rad, 1.2, exact);
  expect_place(self.velocity, math::cos(1.2), math::sin(1.2));
  EXPECT_EQ(self.rate_radps, 0.3);
}

TEST(PlayerPlace, HeadingsWeighByTheirVariances) {
  Self self;
  fix_heading(self, 0, 0.2);
  fix_heading(self, 0.1, 0.1);
  EXPECT_NEAR(self.yaw_rad, 0.08, exact);
  EXPECT_NEAR(self.var_yaw, 0.008, exact);
  // Across the seam the short way.
  Self back;
  fix_heading(back, math::pi - 0.02, 0.1);
  fix_heading(back, -math::pi + 0.02, 0.1);
  EXPECT_NEAR(std::abs(back.yaw_rad), math::pi, 1e-9);
}

/// By the sum of information matrices, which is another way to the same.
TEST(PlayerPlace, TwoFixesWithCovariancesMakeTheirMostLikelyPlace) {
  const Fix a{{1, 2, 0}, 0.04, 0.01, 0.09}, b{{1.1, 1.9, 0}, 0.02, -0.005, 0.03};
  const auto inverse = [](const Fix& f) {
    const double det = f.var_xx * f.var_yy - f.var_xy * f.var_xy;
    return std::array{f.var_yy / det, -f.var_xy / det, f.var_xx / det};
  };
  const auto [axx, axy, ayy] = inverse(a);
  const auto [bxx, bxy, byy] = inverse(b);
  const double jxx = axx + bxx, jxy = axy + bxy, jyy = ayy + byy, det = jxx * jyy - jxy * jxy;
  const double x = axx * a.at.x + axy * a.at.y + bxx * b.at.x + bxy * b.at.y;
  const double y = axy * a.at.x + ayy * a.at.y + bxy * b.at.x + byy * b.at.y;
  Self self;
  fix_place(self, a);
  fix_place(self, b);
  expect_place(self.at, (jyy * x - jxy * y) / det, (jxx * y - jxy * x) / det, 1e-10);
  EXPECT_NEAR(self.var_xx, jyy / det, 1e-10);
  EXPECT_NEAR(self.var_xy, -jxy / det, 1e-10);
  EXPECT_NEAR(self.var_yy, jxx / det, 1e-10);
}

TEST(PlayerPlace, AGoalSeenAslantIsSurerAcrossTheSightThanAlongIt) {
  Self self;
  self.yaw_known = true;
  const soccer::Dimensions field;
  const auto fix = place_from_goal(self, field, {3, 3, 0});
  ASSERT_TRUE(fix);
  expect_place(fix->at, 11.3 - 3, -3);
  const double range = 3 * std::sqrt(2.0), along = 0.1 + 0.05 * range, across = 0.05 + 0.015 * range;
  EXPECT_NEAR(fix->var_xx, (along * along + across * across) / 2, exact);
  EXPECT_NEAR(fix->var_xy, (along * along - across * across) / 2, exact);
}

// ----------------------------------------------------------------------------------------------------------- roles

/// A game that runs on a field of 22 m x 14 m; the own player is number 2.
struct OnField {
  Keys keys;
  Scene scene;
  Memory memory;
  OnField() {
    scene.keys = &keys;
    scene.style = style_of(Play::passing);
    scene.number = 2;
    scene.ball_known = true;
  }
  Mate& mate(std::int32_t number, Vec3 at, double cost_s, Role role = Role::none) {
    Mate& each = scene.mates.emplace_back();
    each.number = number;
    each.at = at;
    each.cost_s = cost_s;
    each.role = role;
    return each;
  }
};

TEST(PlayerRoles, WhoStandsBehindTheBallGetsItSooner) {
  OnField one;
  one.scene.me = {-1, 0, 0};
  const double behind = cost_of(one.scene, one.memory);
  one.scene.me = {1, 0, 0};
  // The ball lies as near, but all the way round: 0.5 (1 - cos) s more.
  EXPECT_NEAR(cost_of(one.scene, one.memory) - behind, 1, exact);
  // From a standing start at 2.2 m/s^2, to where the ball is in front.
  EXPECT_NEAR(behind, std::sqrt(2 * (1 - one.keys.front_m) / one.keys.acceleration_mps2), 1e-9);
}

TEST(PlayerRoles, TheTimeForAWayIsThatOfConstantAcceleration) {
  Keys keys;
  keys.speed_mps = 2, keys.acceleration_mps2 = 1;
  EXPECT_NEAR(time_for(keys, 0.5, 0), 1, exact);    // s = t^2 / 2
  EXPECT_NEAR(time_for(keys, 4, 0), 2 + 1, exact);  // 2 m up to 2 m/s, the rest at that
  EXPECT_NEAR(time_for(keys, 1.5, 1), 1, exact);    // t + t^2 / 2
  EXPECT_NEAR(time_for(keys, 1.5, -1), 3, exact);   // -t + t^2 / 2: it turns round first
  EXPECT_NEAR(time_for(keys, 4, 2), 2, exact);
  EXPECT_EQ(time_for(keys, -0.1, 1), 0) << "it is there";
}

TEST(PlayerRoles, ABallThatComesIsMetWhereThePlayerIsTwoTenthsEarly) {
  OnField one;
  one.scene.ball = {0, 0, 0};
  one.scene.ball_velocity = {2, 0, 0};
  one.scene.me = {3, 1, 0};
  const Meeting meeting = meet(one.scene);
  expect_place(meeting.at, 2 * meeting.after_s - 0.125 * meeting.after_s * meeting.after_s, 0);
  const auto late = [&](double t) {
    const Vec3 at{2 * t - 0.125 * t * t, 0, 0};
    return time_for(one.keys, norm(at - one.scene.me) - one.keys.front_m, 0) - (t - 0.2);
  };
  EXPECT_LE(late(meeting.after_s), 0);
  EXPECT_GT(late(meeting.after_s - 0.125), 0) << "the earliest of the moments that it looks at";
}

TEST(PlayerRoles, WhoHasPassedLeavesTheBallToTheReceiver) {
  OnField one;
  one.scene.me = {-1, 0, 0};
  const double before = cost_of(one.scene, one.memory);
  one.scene.now_s = 10;
  one.memory.passed_s = 9;
  EXPECT_NEAR(cost_of(one.scene, one.memory) - before, 1.5, exact);
  one.memory.passed_s = 8;
  EXPECT_EQ(cost_of(one.scene, one.memory), before);
}

TEST(PlayerRoles, WhoHasTakenASetPieceLeavesTheBallToOthers) {
  OnField one;
  one.scene.me = {-1, 0, 0};
  OnField two = one;
  two.scene.keys = &two.keys;
  two.memory.taken = true;
  EXPECT_NEAR(cost_of(two.scene, two.memory) - cost_of(one.scene, one.memory), 8, exact);
  for (OnField* each : {&one, &two}) {
    each->scene.game.piece = Piece::free_kick;
    each->scene.open = false;
  }
  EXPECT_NEAR(cost_of(two.scene, two.memory) - cost_of(one.scene, one.memory), 8, exact);
}

TEST(PlayerRoles, TwoAtOnePlaceKeepTheRolesThatTheyHave) {
  for (const bool defends : {true, false}) {
    OnField one;
    one.scene.me = {-3, 0, 0};
    one.memory.role = defends ? Role::defender : Role::supporter;
    one.mate(3, one.scene.me, 9, defends ? Role::supporter : Role::defender);
    one.mate(4, {}, 0.1, Role::attacker);
    const Task task = task_of(one.scene, one.memory, 5);
    EXPECT_EQ(task.role, one.memory.role);
    EXPECT_EQ(task.place, defends ? 2 : 1);
  }
}

TEST(PlayerRoles, StaysOutOfAreasOnBothSides) {
  OnField one;
  one.scene.ball = {0, 5, 0};
  const Task supporter{Role::supporter, 1, {}}, defender{Role::defender, 2, {}},
      attacker{Role::attacker, 0, {}};
  const auto x_of = [&](double x, const Task& task) { return legal(one.scene, {x, 0, 0}, task, 0).x; };
  // 0.4 m before areas of 2.25 m and 0.75 m.
  EXPECT_NEAR(x_of(-10.5, supporter), -(11 - 2.25 - 0.4), exact);
  EXPECT_NEAR(x_of(10.5, supporter), 11 - 2.25 - 0.4, exact);
  EXPECT_NEAR(x_of(-10.5, defender), -(11 - 0.75 - 0.4), exact);
  EXPECT_NEAR(x_of(10.5, defender), 11 - 2.25 - 0.4, exact);
  EXPECT_NEAR(x_of(10.5, attacker), 11 - 0.75 - 0.4, exact);
  EXPECT_EQ(x_of(-3, supporter), -3);
  // And away from the ball of a set piece.
  EXPECT_NEAR(norm(legal(one.scene, {0.5, 5, 0}, supporter, 2) - one.scene.ball), 2, exact);
}

// ------------------------------------------------------------------------------------------------------------ game

TEST(PlayerGame, TheBreakIsNoPlayWhateverThePhaseSays) {
  for (const char* const stage : {"half_time", "ended"}) {
    Game game;
    msg::RefereeState state;
    state.stage = stage;
    state.phase = "running";
    hear_state(game, state, "cyan", {}, 1);
    EXPECT_EQ(game.phase, Phase::stopped) << stage;
  }
}

TEST(PlayerGame, ACommandHeardTwiceActsOnce) {
  Game game;
  msg::RefereeCommand start, late;
  start.sequence = late.sequence = 5;
  start.command = "START";
  late.command = "STOP";
  hear_command(game, start, "cyan", 2, {}, 1);
  hear_command(game, late, "cyan", 2, {}, 2);
  EXPECT_EQ(game.phase, Phase::running);
  late.sequence = 6;
  hear_command(game, late, "cyan", 2, {}, 2);
  EXPECT_EQ(game.phase, Phase::stopped);
}

// ------------------------------------------------------------------------------------------------ with the ball

TEST(PlayerAims, AShotKeepsOffThePost) {
  OnField one;
  one.scene.opponents.push_back({{11, 0, 0}, {}, 2 * robot_radius_m});
  // From 4 m the keeper in the middle reaches 0.36 + 1.43 (3.93 / 7.7 - 0.15)^2 = 0.55 m to each side, and a ball towards
  // 0.79 m passes it at 0.74 m: 0.195 m of room for a scatter of 0.2 m and 0.15 m that
  // it may reach farther. Towards 1.06 m only 0.03 m are left to the post.
  const Shot shot = best_shot(one.scene, {7, 0, 0});
  EXPECT_NEAR(std::abs(shot.at.y), 0.792, exact);
  EXPECT_NEAR(shot.chance, 0.5 + 0.5 * 0.1953 / (0.1996 + 0.15), 2e-3);
}

TEST(PlayerAims, APassArrivesAsFastAsTheHandlerTakesIt) {
  OnField one;
  for (const double way : {4.0, 9.0}) {
    // Kicked, it slides until it rolls with three fifths of its speed; then 0.25 m/s^2 slow it down.
    const double rolls = 0.6 * pass_speed(one.scene, way);
    const Vec3 half_way = ball_after({}, {rolls, 0, 0}, 1), after{rolls - 0.25, 0, 0};
    const double left = way - half_way.x;
    EXPECT_NEAR(dot(after, after) - 2 * 0.25 * left, 1.6 * 1.6, 1e-9) << way;
  }
  EXPECT_EQ(pass_speed(one.scene, 0.5), one.keys.pass_speed_mps) << "so soft a kick would not be worth it";
}

TEST(PlayerAims, APassGoesToWhereTheTeamMateStopsAndNotBeyond) {
  for (const double left : {3.0, 0.5}) {
    OnField one;
    one.keys.shot_range_m = 1;
    one.scene.ball = {3, 0, 0};
    Mate& mate = one.mate(3, {7, 3, 0}, 9);
    one.scene.style.pushes = 0;
    mate.velocity = {0, -2, 0};  // 0.8 m in 0.4 s
    mate.target = mate.at + Vec3{0, -left, 0};
    choose_aim(one.scene, one.memory);
    EXPECT_EQ(one.memory.aim, Aim::pass);
    expect_place(one.memory.at, 7, left > 0.8 ? 2.2 : 2.5);
  }
}

TEST(PlayerAims, OfTwoPlacesAsGoodThePassGoesToWhoStands) {
  for (const std::int32_t stands : {3, 4}) {
    OnField one;
    one.scene.ball = {3, 0, 0};
    one.keys.shot_range_m = 1;
    one.mate(3, {6, -3, 0}, 9).velocity = {0, stands == 3 ? 0.0 : 2.0, 0};
    one.mate(4, {6, 3, 0}, 9).velocity = {0, stands == 4 ? 0.0 : -2.0, 0};
    for (Mate& each : one.scene.mates) each.target = each.at;
    choose_aim(one.scene, one.memory);
    EXPECT_EQ(one.memory.aim, Aim::pass);
    expect_place(one.memory.at, 6, stands == 3 ? -3 : 3);
  }
}

TEST(PlayerAims, AReceiverFacesTheBallAndGivesWayShortlyBeforeItComes) {
  OnField one;
  one.scene.has_handler = true;
  one.scene.ball_velocity = {2, 0, 0};
  one.scene.me = {4, 0, 0};
  Task task;
  task.role = Role::attacker;
  for (const double x : {2.0, 3.0}) {
    one.scene.ball = {x, 0, 0};
    const Intent intent = decide(one.scene, task, one.memory);
    EXPECT_NEAR(intent.yaw_rad, math::pi, 1e-9) << "not where it will play the ball";
    EXPECT_TRUE(intent.handler == (x > 2.9));
    // 0.665 m from its front a ball with 2 m/s is there in 0.33 s: it goes with it at what is above 1.6 m/s.
    expect_place(intent.moves_on, x > 2.9 ? 0.4 : 0, 0, 1e-9);
    // The ball is where it touches the front when they meet.
    expect_place(intent.target - meet(one.scene).at, one.keys.front_m, 0, 1e-9);
  }
}

TEST(PlayerAims, TheSupporterOffersItselfBesideWhoStandsInTheLane) {
  OnField one;
  one.scene.ball = {-2, 0, 0};
  one.scene.me = {-2, 3, 0};
  const Vec3 usual{1, 0, 0};
  EXPECT_GT(free_place(one.scene, usual).x, 3.9) << "nobody there: straight ahead, as far as it looks";
  one.scene.opponents.push_back({{0.5, 0, 0}, {}, 2 * robot_radius_m});
  const Vec3 place = free_place(one.scene, usual);
  const Vec3 off = place - one.scene.ball;
  // The opponent is 2.5 m ahead of the ball: of a lane at 0.7 rad it keeps off by 2.5 sin(0.7) = 1.6 m.
  EXPECT_NEAR(std::abs(math::atan2(off.y, off.x)), 0.7, 1e-9);
  EXPECT_GT(place.y, 0) << "on the side where it is";
  EXPECT_NEAR(room_beside(one.scene, one.scene.ball, place, 1e9, 0, 0), 2.5 * math::sin(0.7), 1e-9);
}

TEST(PlayerAims, TurnsTheLessTheNearerAnOpponentIs) {
  OnField one;
  one.scene.holds = true;
  one.scene.yaw_rad = math::pi;  // to the own goal, where a team-mate stands
  one.mate(3, {-3.9, 0, 0}, 9);
  choose_aim(one.scene, one.memory);
  EXPECT_EQ(one.memory.aim, Aim::push) << "alone it turns round and goes on";
  EXPECT_GT(one.memory.at.x, 2);
  // Beside an opponent it would lose the ball in four of five turns.
  one.scene.opponents.push_back({{0, 0.7, 0}, {}, 2 * robot_radius_m});
  choose_aim(one.scene, one.memory);
  EXPECT_EQ(one.memory.aim, Aim::pass);
  expect_place(one.memory.at, -3.9, 0);
}

TEST(PlayerAims, CarriesTheBallOnlyAsFarAsItCanStop) {
  OnField one;
  one.scene.holds = one.scene.has_handler = true;
  one.scene.style.pushes = 0;
  one.scene.ball = {-3, 0, 0};
  one.memory.held_at = {-3.7, 0, 0};
  choose_aim(one.scene, one.memory);
  EXPECT_EQ(one.memory.aim, Aim::dribble);
  // 0.7 m of 2.1 m are behind it; from 2.8 m/s it needs 2.8^2 / (2 * 2.6) = 1.5 m.
  one.scene.velocity = {2.8, 0, 0};
  choose_aim(one.scene, one.memory);
  EXPECT_NE(one.memory.aim, Aim::dribble);
}

TEST(PlayerAims, OfTwoPlacesAsGoodThePassGoesToTheNearer) {
  OnField one;
  one.scene.ball = {3, 4, 0};
  one.mate(3, {8, -3, 0}, 9);
  one.mate(4, {8, 3, 0}, 9);
  one.keys.shot_range_m = 1;
  choose_aim(one.scene, one.memory);
  EXPECT_EQ(one.memory.aim, Aim::pass);
  expect_place(one.memory.at, 8, 3);
}

TEST(PlayerAims, TheKeeperClearsToTheSideOfTheBall) {
  for (const double y : {2.0, -2.0}) {
    OnField one;
    one.scene.ball = {-10.5, y, 0};
    aim_of_keeper(one.scene, one.memory);
    EXPECT_EQ(one.memory.aim, Aim::clearance);
    expect_place(one.memory.at, -0.2 * 11, std::copysign(5, y));
  }
}

}  // namespace
}  // namespace sandlot::controllers::soccer_player
