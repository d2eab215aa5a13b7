#include "geometry/rounded_hull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot {
namespace {

RoundedHull hull_of(const Shape& shape, const Pose& X_WC) {
  std::vector<SilhouetteDisc> discs;
  add_silhouette(shape, X_WC, discs);
  return rounded_hull(discs);
}

TEST(RoundedHull, HasTheCornersAndTheRadiusOfASolidFromAbove) {
  const RoundedHull can = hull_of(Cylinder{0.3, 1}, {{1, 2, 0.5}, {}});
  ASSERT_EQ(can.corners.size(), 1u);
  EXPECT_EQ(can.corners[0], (Vec2{1, 2}));
  EXPECT_EQ(can.radius_m, 0.3);
  const RoundedHull box = hull_of(Box{{2, 1, 1}}, {{0, 0, 0.5}, quat_from_rpy(0, 0, math::pi / 2)});
  ASSERT_EQ(box.corners.size(), 4u);
  EXPECT_EQ(box.radius_m, 0);
  for (const Vec2 corner : box.corners) {
    EXPECT_NEAR(std::abs(corner.x), 0.5, 1e-12);
    EXPECT_NEAR(std::abs(corner.y), 1, 1e-12);
  }
  const RoundedHull pill = hull_of(Capsule{0.1, 1}, {{0, 0, 0.1}, quat_from_rpy(0, math::pi / 2, 0)});
  ASSERT_EQ(pill.corners.size(), 2u);
  EXPECT_EQ(pill.radius_m, 0.1);
  EXPECT_NEAR(std::abs(pill.corners[0].x - pill.corners[1].x), 1, 1e-12);
  EXPECT_EQ(hull_of(Sphere{0.2}, {}).corners.size(), 1u);
}

TEST(RoundedHull, DistancesAreThoseOfPlaneGeometry) {
  EXPECT_EQ(distance_m(Vec2{3, 4}, {0, 0}, {0, 0}), 5);
  EXPECT_EQ(distance_m(Vec2{3, 1}, {0, 0}, {10, 0}), 1);
  EXPECT_EQ(distance_m(Vec2{13, 4}, {0, 0}, {10, 0}), 5);
  const std::vector<Vec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, point{{2, 2}}, rod{{0, 0}, {2, 0}};
  EXPECT_EQ(distance_m(square, {3, 0.5}, {4, 0.5}), 2);
  EXPECT_EQ(distance_m(square, {-1, 0.5}, {2, 0.5}), 0) << "through it";
  EXPECT_EQ(distance_m(square, {0.4, 0.4}, {0.6, 0.6}), 0) << "within it";
  EXPECT_EQ(distance_m(square, {0.5, 0.5}, {7, 7}), 0) << "out of it";
  EXPECT_NEAR(distance_m(square, {2, 1}, {1, 2}), std::sqrt(0.5), 1e-15) << "past a corner";
  EXPECT_EQ(distance_m(point, {0, 0}, {4, 0}), 2);
  EXPECT_EQ(distance_m(rod, {1, -1}, {1, 1}), 0);
  EXPECT_EQ(distance_m(rod, {1, 1}, {5, 1}), 1);
}

TEST(RoundedHull, MeetsAPolygonExactlyWhereASampledPointDoes) {
  // An L. The hull is a disc: it meets the L when the distance of its centre is at most its radius.
  const std::vector<Vec2> corner{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const auto disc = [](double x, double y, double r) { return RoundedHull{{{x, y}}, r}; };
  EXPECT_TRUE(meets(disc(0.5, 0.5, 0.01), corner)) << "inside";
  EXPECT_TRUE(meets(disc(1.5, 1.5, 0.51), corner));
  EXPECT_FALSE(meets(disc(1.5, 1.5, 0.49), corner)) << "in the notch";
  EXPECT_TRUE(meets(disc(5, 5, 6), corner)) << "the disc holds it all";
  EXPECT_FALSE(meets(disc(3, 0.5, 0.99), corner));
  EXPECT_TRUE(meets(RoundedHull{{{-1, -1}, {9, -1}, {9, 9}, {-1, 9}}, 0}, corner)) << "a square holds it all";
  EXPECT_FALSE(meets(RoundedHull{{{1.1, 1.1}, {1.9, 1.1}, {1.1, 1.9}}, 0}, corner)) << "fits into the notch";
  EXPECT_TRUE(meets(RoundedHull{{{1.5, 0.5}, {1.6, 0.5}, {1.6, 0.6}}, 0}, corner)) << "wholly inside";
}

}  // namespace
}  // namespace sandlot
