#include "controllers/prey/prey.h"

#include <cmath>

#include "base/math.h"
#include "controllers/test_rig.h"

namespace sandlot::controllers::prey {
namespace {

using Rig = FieldRig<Prey>;

TEST(Prey, FleesStraightAwayFromTheNearestPredator) {
  Rig rig({.strategy = Strategy::flee, .speed_mps = 0.5});
  rig.put("me", "prey", 0, 0, -3 * math::pi / 4);
  rig.put("a", "predator", 1, 1);
  rig.put("b", "predator", -1.5, 1.5);
  rig.step(0);
  EXPECT_NEAR(rig.twist().linear.x, 0.5, 1e-12);
  EXPECT_NEAR(rig.twist().angular.z, 0, 1e-9);
}

TEST(Prey, StandsWhileNoPredatorIsNear) {
  Rig rig({.strategy = Strategy::flee, .alarm_m = 2});
  rig.put("me", "prey", 0, 0);
  rig.put("a", "predator", 2.1, 0);
  rig.step(0);
  EXPECT_EQ(rig.twist().linear.x, 0);
  rig.put("a", "predator", 1.9, 0);
  rig.step(0.1);
  EXPECT_NE(rig.twist().angular.z, 0);
}

TEST(Prey, FollowsAWallAndLeavesACorner) {
  Prey prey;
  prey.spec = {.yard_m = {4, 4}};
  // 0.2 m from the east wall, heading north-east: north.
  EXPECT_NEAR(prey.along_walls({1.8, 0, 0}, math::pi / 4), math::pi / 2, 1e-12);
  EXPECT_NEAR(prey.along_walls({1.8, 0, 0}, 3 * math::pi / 4), 3 * math::pi / 4, 1e-12);  // away from it
  EXPECT_NEAR(prey.along_walls({1.0, 0, 0}, math::pi / 4), math::pi / 4, 1e-12);          // far from it
  // Straight at the wall, in its northern half: south, where there is more room.
  EXPECT_NEAR(prey.along_walls({1.8, 0.5, 0}, 0), -math::pi / 2, 1e-12);
  // In the corner, nearer to the north wall: along it, west.
  EXPECT_NEAR(std::abs(prey.along_walls({1.8, 1.9, 0}, math::pi / 4)), math::pi, 1e-12);
}

TEST(Prey, ZigzagSwervesToOneSideAndTheOther) {
  Rig rig({.strategy = Strategy::zigzag, .swerve_rad = 0.8, .period_s = 2});
  rig.put("me", "prey", 0, 0, 0);
  rig.put("a", "predator", -1, 0);
  rig.step(0.5);  // first half of the period
  EXPECT_NEAR(rig.twist().angular.z, 3 * 0.8, 1e-9);
  rig.step(1.5);
  EXPECT_NEAR(rig.twist().angular.z, -3 * 0.8, 1e-9);
}

TEST(Prey, HidesBetweenTwoPredatorsWhereThereIsRoom) {
  Rig rig({.strategy = Strategy::hide, .yard_m = {0, 6}});
  rig.put("a", "predator", 1, 0);
  rig.put("b", "predator", -1, 0);
  // Between two predators, above the middle of the yard: away along y, to the side with more room.
  EXPECT_GT(rig.controller.danger(rig.camera.message, {0, 0, 0}, 0),
            rig.controller.danger(rig.camera.message, {0, 0, 0}, math::pi / 2));
  // Near a wall along it rather than into it: 0.3 / 0.5^2 per point against 0.3 / 1e-4 at the wall.
  EXPECT_GT(rig.controller.danger(rig.camera.message, {0, 2.5, 0}, math::pi / 2),
            rig.controller.danger(rig.camera.message, {0, 2.5, 0}, 0));
  rig.put("me", "prey", 0, 0, math::pi / 2);
  rig.step(0);
  EXPECT_NEAR(rig.twist().linear.x, 0.5, 1e-9);
}

}  // namespace
}  // namespace sandlot::controllers::prey
