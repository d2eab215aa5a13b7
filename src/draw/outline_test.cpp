#include "draw/outline.h"

#include <gtest/gtest.h>

#include "base/math.h"

namespace sandlot::draw {
namespace {

double area_m2(const std::vector<Vec3>& corners) {
  double twice = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = corners[i], b = corners[(i + 1) % corners.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

TEST(Outline, OfAStandingBoxIsItsFootprint) {
  const auto o = outline_from_above(Box{{2, 1, 0.5}}, {{3, 4, 1}, quat_from_rpy(0, 0, math::pi / 2)});
  ASSERT_TRUE(o);
  ASSERT_EQ(o->corners.size(), 4u);
  EXPECT_NEAR(area_m2(o->corners), 2, 1e-12);  // positive: counter-clockwise
  double x = 0, y = 0;
  for (const Vec3& c : o->corners) x = std::max(x, c.x), y = std::max(y, c.y);
  EXPECT_NEAR(x, 3.5, 1e-12);
  EXPECT_NEAR(y, 5, 1e-12);
  EXPECT_NEAR(o->bottom_m, 0.75, 1e-12);
  EXPECT_NEAR(o->top_m, 1.25, 1e-12);
}

TEST(Outline, OfALeaningBoxShowsItsSide) {
  // Leaning by a about y: the shadow is 2 cos a + 0.5 sin a long, and as high as 2 sin a + 0.5 cos a.
  const double a = 0.4;
  const auto o = outline_from_above(Box{{2, 1, 0.5}}, {{0, 0, 0}, quat_from_rpy(0, a, 0)});
  ASSERT_TRUE(o);
  EXPECT_NEAR(area_m2(o->corners), 2 * math::cos(a) + 0.5 * math::sin(a), 1e-12);
  EXPECT_NEAR(o->top_m - o->bottom_m, 2 * math::sin(a) + 0.5 * math::cos(a), 1e-12);
}

TEST(Outline, OfStandingRoundThingsIsACircle) {
  for (const Shape& shape : {Shape(Sphere{0.3}), Shape(Cylinder{0.3, 0.6}), Shape(Capsule{0.3, 0.0})}) {
    const auto o = outline_from_above(shape, {{1, 2, 3}, {}});
    ASSERT_TRUE(o);
    EXPECT_TRUE(o->corners.empty());
    EXPECT_EQ(o->radius_m, 0.3);
    EXPECT_EQ(o->centre_m, (Vec3{1, 2, 0}));
    EXPECT_NEAR(o->top_m, 3.3, 1e-12);
  }
}

TEST(Outline, OfACylinderThatLeansByNothingVisibleIsACircle) {
  for (const double lean : {1e-6, math::pi - 1e-6}) {
    const auto o = outline_from_above(Cylinder{0.3, 0.6}, {{1, 2, 3}, quat_from_rpy(0, lean, 0)});
    ASSERT_TRUE(o);
    EXPECT_TRUE(o->corners.empty());
    EXPECT_NEAR(o->radius_m, 0.3, 1e-6);
  }
}

TEST(Outline, OfAStandingBarrelIsTheCircleOfItsMiddle) {
  const Barrel barrel{.radius_m = 0.3, .profile_m = 0.5, .length_m = 0.4};
  const auto o = outline_from_above(barrel, {{1, 2, 3}, {}});
  ASSERT_TRUE(o);
  EXPECT_TRUE(o->corners.empty());
  EXPECT_NEAR(o->radius_m, 0.3, 1e-15);
  EXPECT_NEAR(o->top_m, 3.2, 1e-12);
}

TEST(Outline, OfALyingCylinderIsARectangle) {
  // Lying along x, its silhouette is length x diameter; 32 corners put one exactly at the widest place.
  const auto o = outline_from_above(Cylinder{0.2, 1.5}, {{0, 0, 0.2}, quat_from_rpy(0, math::pi / 2, 0)});
  ASSERT_TRUE(o);
  EXPECT_NEAR(area_m2(o->corners), 0.4 * 1.5, 1e-9);
  EXPECT_NEAR(o->bottom_m, 0, 1e-12);
}

TEST(Outline, OfALyingCapsuleHasRoundEnds) {
  const auto o = outline_from_above(Capsule{0.2, 1.5}, {{0, 0, 0.2}, quat_from_rpy(0, math::pi / 2, 0)});
  ASSERT_TRUE(o);
  // The round ends are a polygon of 32 corners: n/2 r^2 sin(2 pi / n) instead of pi r^2.
  EXPECT_NEAR(area_m2(o->corners), 0.4 * 1.5 + 16 * 0.04 * math::sin(math::tau / 32), 1e-12);
}

TEST(Outline, PlanesHaveNone) { EXPECT_FALSE(outline_from_above(Plane{{0, 0, 1}}, {})); }

TEST(Simplified, KeepsCornersAndDropsWhatLiesOnALine) {
  std::vector<Vec3> path;
  for (int i = 0; i <= 100; ++i) path.push_back({0.01 * i, 0, 0});
  for (int i = 1; i <= 100; ++i) path.push_back({1, 0.01 * i, 0});
  const auto kept = simplified(path, 0.001);
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[1], (Vec3{1, 0, 0}));
}

TEST(Simplified, StaysWithinTheTolerance) {
  // An arc of radius 1 from chords with a rise of at most e: 1 - cos(a/2) <= e, so that a chord spans at most
  // a = 2 acos(1 - e); splitting in the middle needs at most twice the fewest chords.
  std::vector<Vec3> path;
  for (int i = 0; i <= 1000; ++i) path.push_back({math::cos(0.003 * i), math::sin(0.003 * i), 0});
  const double e = 0.005;
  const auto kept = simplified(path, e);
  const double fewest = 3.0 / (2 * math::acos(1 - e));
  EXPECT_GE(static_cast<double>(kept.size()) - 1, fewest - 1e-9);
  EXPECT_LE(static_cast<double>(kept.size()) - 1, 2 * fewest + 1);
  EXPECT_EQ(kept.front(), path.front());
  EXPECT_EQ(kept.back(), path.back());
}

TEST(Simplified, AClosedPathKeepsItsFarthestPoint) {
  const std::vector<Vec3> path{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(simplified(path, 0.01).size(), 3u);
}

}  // namespace
}  // namespace sandlot::draw
