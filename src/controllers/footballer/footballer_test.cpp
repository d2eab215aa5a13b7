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

TEST(Footballer, KicksWhenTheBallIsInFrontAndTheGoalAhead) {
  Rig rig({.kicker = "kicker", .kick_reach_m = 0.25, .kick_angle_rad = 0.25, .impulse_Ns = 0.7});
  rig.put("ball", "ball", 0, 0);
  rig.put("me", "red", -0.2, 0, 0);
  rig.step(0);
  ASSERT_TRUE(rig.order<msg::Float64>(2));
  EXPECT_EQ(rig.order<msg::Float64>(2)->data, 0.7);
  EXPECT_EQ(rig.controller.state.kicks, 1u);
  rig.put("me", "red", -0.2, 0, 0.3);  // not at the goal
  rig.step(0.1);
  EXPECT_FALSE(rig.order<msg::Float64>(2));
  rig.put("me", "red", -0.3, 0, 0);  // not in reach
  rig.step(0.2);
  EXPECT_FALSE(rig.order<msg::Float64>(2));
  Rig without({});
  without.put("ball", "ball", 0, 0);
  without.put("me", "red", -0.2, 0, 0);
  without.step(0);
  EXPECT_FALSE(without.order<msg::Float64>(2));
  EXPECT_NEAR(without.twist().linear.x, 0.6, 1e-9);  // it pushes
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
