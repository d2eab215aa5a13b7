#include "controllers/clearing/exact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::clearing::exact {
namespace {

Vec towards(double angle_rad) { return {math::cos(angle_rad), math::sin(angle_rad)}; }
Place looking(double angle_rad) { return {{0, 0}, towards(angle_rad)}; }

TEST(Exact, AnglesAreThoseOfTheArcTangent) {
  for (int i = -3600; i <= 3600; ++i)
    for (const double length : {1e-200, 1.0, 1e200 / 3}) {
      const Vec v = length * towards(i * math::pi / 3601);
      // Four roundings of numbers up to pi, which is 4.4e-16 to a unit in the last place.
      EXPECT_NEAR(angle_of(v), math::atan2(v.y, v.x), 1.8e-15) << i;
    }
  EXPECT_EQ(angle_of({0, 0}), 0);
  EXPECT_EQ(angle_of({1, 0}), 0);
  EXPECT_EQ(angle_of({0, -2}), -math::pi / 2);
  EXPECT_EQ(angle_of({-1, 0}), math::pi);
}

TEST(Exact, AnglesAreTheseBits) {
  // As Python computes them with the same operations: what another compiler fuses or reorders shows here.
  EXPECT_EQ(angle_of({0.3, 0.1}), 0x1.4978fa3269ee2p-2);
  EXPECT_EQ(angle_of({-0.7, 0.4}), 0x1.4fac5404fe6dbp+1);
  EXPECT_EQ(angle_of({0.123, -4.5}), -0x1.8b20d62e4cf3ep+0);
}

TEST(Exact, TurnsTheShortWay) {
  EXPECT_NEAR(turn_between(towards(3), towards(-3)), 2 * math::pi - 6, 1e-14);
  EXPECT_NEAR(angle_between(3, -3), 2 * math::pi - 6, 1e-15);
  EXPECT_NEAR(angle_between(-3, 3), 6 - 2 * math::pi, 1e-15);
  EXPECT_EQ(angle_between(1, 1.5), 0.5);
  const Limits limits{1, 2};
  EXPECT_NEAR(turn_to(looking(0), towards(0.1), limits).turn_radps, 0.3, 1e-14);  // 3/s of the error
  EXPECT_EQ(turn_to(looking(0), towards(2), limits).turn_radps, 2);
  EXPECT_EQ(turn_to(looking(0), towards(-2), limits).turn_radps, -2);
}

TEST(Exact, HeadingsAreThoseOfQuaternions) {
  // A turn by 2 rad about z.
  const Place robot = place(1, 2, 0, 0, math::sin(1), math::cos(1));
  EXPECT_NEAR(robot.heading.x, math::cos(2), 1e-15);
  EXPECT_NEAR(robot.heading.y, math::sin(2), 1e-15);
  const Vec ahead = seen_from(robot, robot.at + 3 * robot.heading);
  EXPECT_NEAR(ahead.x, 3, 1e-14);
  EXPECT_NEAR(ahead.y, 0, 1e-14);
  EXPECT_GT(seen_from(place(0, 0, 0, 0, 0, 1), {0, 1}).y, 0);  // to the left
}

TEST(Exact, DrivesTheSlowerTheMoreItHasToTurn) {
  const Limits limits{0.5, 2};
  EXPECT_NEAR(drive_along(looking(0), towards(math::pi / 3), limits).forward_mps, 0.25, 1e-14);
  EXPECT_EQ(drive_along(looking(0), towards(2), limits).forward_mps, 0);
  EXPECT_EQ(drive_to(looking(0), {0, 1}, limits).forward_mps, 0);  // 90 degrees: on the spot first
  EXPECT_NEAR(drive_to(looking(0), {0.05, 0}, limits).forward_mps, 0.25, 1e-14);
  EXPECT_NEAR(drive_to(looking(0), {0.001, 0}, limits).forward_mps, 0.1, 1e-14);
  EXPECT_EQ(drive_to(looking(0), {0, 0}, limits).turn_radps, 0);
}

TEST(Exact, AWayAroundADiscTouchesItOnTheShorterSide) {
  const Vec aim = way_around({0, 0}, {2, 0}, {{{1, 0.1}, 0.5}});
  // The tangent from the origin: the distance of the centre from the line there is the radius.
  EXPECT_NEAR(std::abs(cross(unit(aim), {1, 0.1})), 0.5, 1e-14);
  EXPECT_NEAR(norm(aim - Vec{1, 0.1}), 0.5, 1e-14);
  EXPECT_LT(aim.y, 0);  // the end lies to the right of the centre
  for (const Disc free :
       {Disc{{1, 0.6}, 0.5}, Disc{{-0.6, 0}, 0.5}, Disc{{2.6, 0}, 0.5}, Disc{{2, 0.1}, 0.5}})
    EXPECT_EQ(way_around({0, 0}, {2, 0}, {free}).y, 0) << free.centre.x << " " << free.centre.y;
  // From within a disc, which counts as 0.95 of the distance: asin(0.95) from the direction of the centre.
  const Vec edge = way_around({0, 0.001}, {2, 0.001}, {{{0.2, 0}, 0.5}});
  EXPECT_NEAR(math::atan2(edge.y, edge.x), math::asin(0.95), 0.02);
}

TEST(Exact, DrawsAreThoseOfSplitmix64) {
  // The first two numbers of splitmix64 with the seed 1234567, as its author's program prints them.
  EXPECT_EQ(draw(1234567, 1), static_cast<double>(6457827717110365317u >> 11) * 0x1p-53);
  EXPECT_EQ(draw(1234567, 2), static_cast<double>(3203168211198807973u >> 11) * 0x1p-53);
}

}  // namespace
}  // namespace sandlot::controllers::clearing::exact
