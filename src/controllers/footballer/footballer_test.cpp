#include "controllers/footballer/footballer.h"

#include <cmath>

#include "base/math.h"
#include "controllers/test_rig.h"

namespace sandlot::controllers::footballer {
namespace {

using Rig = FieldRig<Footballer>;

TEST(Footballer, TheNearestToThePlaceBehindTheBallAttacks) {
  Rig rig({});  // goal at (3, 0), place behind the ball at (-0.3, 0)
  rig.put("ball", "ball", 0, 0);
  rig.put("me", "red", -1, 0);
  rig.put("mate", "red", 0.5, 0);   // nearer to the ball: 0.5 m, from the place behind it 0.8 m
  rig.put("foe", "blue", -0.5, 0);  // does not count
  rig.step(0);
  EXPECT_TRUE(rig.controller.state.attacks);
  EXPECT_NEAR(rig.twist().linear.x, 0.6, 1e-9);
  rig.put("mate", "red", -0.5, 0.2);
  rig.step(0.1);
  EXPECT_FALSE(rig.controller.state.attacks);
  // Both alike: the name that precedes.
  rig.put("mate", "red", -0.3, 0.7);
  rig.put("me", "red", -0.3, -0.7);
  rig.step(0.2);
  EXPECT_FALSE(rig.controller.state.attacks);  // "mate" precedes "me"
}

TEST(Footballer, CoversOnTheLineFromItsGoalToTheBall) {
  Rig rig({.own_goal_m = {-3, 0}, .cover = 0.5});
  rig.put("ball", "ball", 1, 2);
  rig.put("mate", "red", 1, 1.5);
  // In its place, (-1, 1), it turns to the ball.
  rig.put("me", "red", -1, 1, 0);
  rig.step(0);
  EXPECT_EQ(rig.twist().linear.x, 0);
  EXPECT_NEAR(rig.twist().angular.z, 3 * math::atan2(1, 2), 1e-9);
  // From elsewhere it drives there.
  rig.put("me", "red", -2, 1, 0);
  rig.step(0.1);
  EXPECT_NEAR(rig.twist().linear.x, 0.6, 1e-9);
}

TEST(Footballer, KicksWhenTheBallIsInFrontAndItsLineCrossesTheGoal) {
  Rig rig({.kicker = "kicker", .goal_m = {3, 0}, .goal_width_m = 1, .kick_reach_m = 0.25, .impulse_Ns = 0.7});
  rig.kicker.message.ready = true;
  double now = 0;
  const auto kicks_from = [&](double x, double y, double yaw) {
    rig.put("me", "red", x, y, yaw);
    rig.step(now += 0.1);
    return rig.order<msg::Float64>(2).has_value();
  };
  rig.put("ball", "ball", 0, 0);
  ASSERT_TRUE(kicks_from(-0.2, 0, 0));
  EXPECT_EQ(rig.order<msg::Float64>(2)->data, 0.7);
  EXPECT_EQ(rig.controller.state.kicks, 1u);
  // At the goal, 3 m away, the line is 3 tan(yaw) beside its middle; the post is at 0.5 m.
  for (const double side : {1.0, -1.0}) {
    EXPECT_TRUE(kicks_from(-0.2, 0, side * math::atan2(0.49, 3)));
    EXPECT_FALSE(kicks_from(-0.2, 0, side * math::atan2(0.51, 3)));
  }
  EXPECT_FALSE(kicks_from(-0.26, 0, 0)) << "not in reach";
  EXPECT_FALSE(kicks_from(-0.2, 0.09, 0)) << "beside the foot";
  EXPECT_FALSE(kicks_from(0.2, 0, math::pi)) << "away from the goal";
  rig.kicker.message.ready = false;
  EXPECT_FALSE(kicks_from(-0.2, 0, 0)) << "the store is filling";
  Rig without({});
  without.put("ball", "ball", 0, 0);
  without.put("me", "red", -0.2, 0, 0);
  without.step(0);
  EXPECT_FALSE(without.order<msg::Float64>(2));
  EXPECT_NEAR(without.twist().linear.x, 0.6, 1e-9);  // it pushes
}

TEST(Footballer, KicksABallAtTheWallAwayButNotToTheOwnGoal) {
  Rig rig({.kicker = "kicker", .goal_m = {3, 0}, .own_goal_m = {-3, 0}, .field_m = {6, 4}});
  rig.kicker.message.ready = true;
  double now = 0;
  const auto kicks_along = [&](double yaw) {
    rig.put("me", "red", -0.2 * math::cos(yaw), -1.9 - 0.2 * math::sin(yaw), yaw);
    rig.step(now += 0.1);
    return rig.order<msg::Float64>(2).has_value();
  };
  // Its back, 0.3 m behind it as seen from the goal, is less than 0.15 m from the wall at y = -2.
  rig.put("ball", "ball", 0, -1.9);
  EXPECT_TRUE(kicks_along(-math::pi / 2));
  EXPECT_TRUE(kicks_along(0));
  const double home = math::pi - math::atan2(1.9, 3);
  EXPECT_FALSE(kicks_along(home));
  EXPECT_FALSE(kicks_along(home - 1.04));  // 59.6 degrees
  EXPECT_TRUE(kicks_along(home - 1.06));   // 60.7 degrees
}

TEST(Footballer, AimsWhereOpponentsLeaveTheMostRoom) {
  Rig rig({.goal_m = {3, 0}, .own_goal_m = {-3, 0}, .goal_width_m = 1});
  rig.put("me", "red", -1, 0);
  const msg::ObjectPose self = rig.camera.message.objects[0];
  const auto aim = [&] { return rig.controller.aim(rig.camera.message, self, {}); };
  EXPECT_EQ(aim(), (Vec3{3, 0, 0}));
  rig.put("mate", "red", 1.5, 0);  // makes way
  rig.put("foe", "blue", -1.5, 0);
  rig.put("foe2", "blue", 3.1, 0);  // both not on the way
  EXPECT_EQ(aim(), (Vec3{3, 0, 0}));
  // In the middle of the way: the lines to 0, +-0.175 and +-0.35 pass it at about half of these distances.
  rig.put("foe", "blue", 1.5, 0.01);
  EXPECT_NEAR(norm(aim() - Vec3{3, -0.35, 0}), 0, 1e-12);
  rig.put("foe", "blue", 1.5, -0.01);
  EXPECT_NEAR(norm(aim() - Vec3{3, 0.35, 0}), 0, 1e-12);
  // 0.31 m beside the middle: the straight line has room enough.
  rig.put("foe", "blue", 1.5, 0.31);
  EXPECT_EQ(aim(), (Vec3{3, 0, 0}));
  // Of the other team left is right.
  Rig other({.goal_m = {-3, 0}, .own_goal_m = {3, 0}, .goal_width_m = 1});
  other.put("me", "blue", 1, 0);
  other.put("foe", "red", -1.5, -0.01);
  EXPECT_NEAR(norm(other.controller.aim(other.camera.message, other.camera.message.objects[0], {}) -
                   Vec3{-3, 0.35, 0}),
              0, 1e-12);
}

TEST(Footballer, HitsABallWhoseBackIsAtTheWall) {
  Rig rig({.goal_m = {3, 0}, .field_m = {6, 4}});
  rig.put("ball", "ball", -2.9, 0);
  rig.put("me", "red", -2, 0, math::pi);
  rig.step(0);
  EXPECT_NEAR(rig.twist().linear.x, 0.6, 1e-9);
  EXPECT_NEAR(rig.twist().angular.z, 0, 1e-9);
}

}  // namespace
}  // namespace sandlot::controllers::footballer
