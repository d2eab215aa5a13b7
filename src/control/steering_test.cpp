#include "control/steering.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::steering {
namespace {

Pose at(double x, double y, double yaw) { return {{x, y, 0}, quat_from_axis_angle({0, 0, 1}, yaw)}; }

TEST(Steering, TurnsTheShortWayAndNoFasterThanItMay) {
  const Limits limits{1, 2};
  EXPECT_NEAR(turn_to(at(0, 0, 0), 0.1, limits).angular.z, 0.3, 1e-12);  // 3/s of the error
  EXPECT_EQ(turn_to(at(0, 0, 0), 2, limits).angular.z, 2);
  EXPECT_NEAR(turn_to(at(0, 0, 3), -3, limits).angular.z, 3 * (2 * math::pi - 6), 1e-9);
}

TEST(Steering, DrivesTheSlowerTheMoreItHasToTurn) {
  const Limits limits{0.5, 2};
  EXPECT_NEAR(drive_along(at(0, 0, 0), 0, limits).linear.x, 0.5, 1e-12);
  EXPECT_NEAR(drive_along(at(0, 0, 0), math::pi / 3, limits).linear.x, 0.25, 1e-12);
  EXPECT_EQ(drive_along(at(0, 0, 0), 2, limits).linear.x, 0);
  EXPECT_EQ(drive_to(at(0, 0, 0), {0, 1, 0}, limits).linear.x, 0);  // 90 degrees: on the spot first
  EXPECT_NEAR(drive_to(at(0, 0, 0), {0.05, 0, 7}, limits, 0.1).linear.x, 0.25, 1e-12);
  EXPECT_EQ(drive_to(at(1, 1, 0), {1, 1, 3}, limits).linear.x, 0);
}

TEST(Steering, AFreeWayLeadsStraightToItsEnd) {
  const Disc beside{{1, 0.6, 0}, 0.5}, behind{{-0.6, 0, 0}, 0.5}, beyond{{2.6, 0, 0}, 0.5};
  const Disc discs[] = {beside, behind, beyond};
  EXPECT_EQ(way_around({0, 0, 0}, {2, 0, 0}, discs), (Vec3{2, 0, 0}));
  // A disc that holds the end does not close it off.
  const Disc end[] = {{{2, 0.1, 0}, 0.5}};
  EXPECT_EQ(way_around({0, 0, 0}, {2, 0, 0}, end), (Vec3{2, 0, 0}));
}

TEST(Steering, AWayAroundADiscTouchesItOnTheShorterSide) {
  const Disc discs[] = {{{1, 0.1, 0}, 0.5}};
  const Vec3 aim = way_around({0, 0, 0}, {2, 0, 0}, discs);
  // The tangent from the origin: the distance of the centre from the line there is the radius.
  EXPECT_NEAR(std::abs(cross(normalised(aim), Vec3{1, 0.1, 0}).z), 0.5, 1e-12);
  EXPECT_NEAR(norm(aim - Vec3{1, 0.1, 0}), 0.5, 1e-12);
  EXPECT_LT(aim.y, 0);  // the end lies to the right of the centre
}

TEST(Steering, FromWithinADiscTheWayLeadsAlongItsEdge) {
  const Disc discs[] = {{{0.2, 0, 0}, 0.5}};
  const Vec3 aim = way_around({0, 0.001, 0}, {2, 0.001, 0}, discs);
  // The disc counts as 0.95 of the distance: asin(0.95) is 71.8 degrees from the centre.
  EXPECT_NEAR(math::atan2(aim.y, aim.x), math::asin(0.95), 0.02);
}

TEST(Steering, FindsObjectsByTheirNames) {
  msg::ObjectPoseArray world;
  world.objects.resize(2);
  world.objects[1].name = "ball";
  EXPECT_EQ(find(world, "ball"), &world.objects[1]);
  EXPECT_EQ(find(world, "bal"), nullptr);
}

}  // namespace
}  // namespace sandlot::steering
