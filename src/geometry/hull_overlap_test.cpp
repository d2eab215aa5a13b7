#include "geometry/hull_overlap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/math.h"
#include "base/random.h"
#include "geometry/bounds.h"

namespace sandlot {
namespace {

std::vector<Vec3> box_of(Vec3 low, Vec3 high) {
  std::vector<Vec3> out;
  for (int i = 0; i < 8; ++i)
    out.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  return out;
}

/// The unit cube about the origin against shapes at x: they meet up to the sum of both extents.
TEST(HullOverlap, MeetsUpToTheSumOfBothExtents) {
  const auto cube = box_of({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  const struct {
    Shape shape;
    Pose X;  ///< its rotation
    double extent_m;
  } cases[] = {
      {Box{{0.4, 0.4, 0.4}}, {}, 0.2},
      {Box{{0.4, 0.4, 0.4}}, {{}, quat_from_rpy(0, 0, math::pi / 4)}, 0.2 * std::sqrt(2.0)},
      {Sphere{0.3}, {}, 0.3},
      {Cylinder{0.3, 2}, {}, 0.3},
      {Cylinder{0.3, 2}, {{}, quat_from_rpy(0, math::pi / 2, 0)}, 1},
      {Capsule{0.1, 1}, {{}, quat_from_rpy(0, math::pi / 2, 0)}, 0.6},
      {Ellipsoid{{0.7, 0.1, 0.2}}, {}, 0.7},
      {Barrel{0.25, 1, 0.2}, {}, 0.25},
  };
  for (const auto& each : cases) {
    Pose X = each.X;
    X.p = {0.5 + each.extent_m - 1e-6, 0.1, -0.2};
    EXPECT_TRUE(meets(each.shape, X, cube)) << shape_name(each.shape) << each.extent_m;
    X.p.x += 2e-6;
    EXPECT_FALSE(meets(each.shape, X, cube)) << shape_name(each.shape) << each.extent_m;
    X.p = {0.1, 0.2, 0.05};
    EXPECT_TRUE(meets(each.shape, X, cube)) << "within";
  }
}

/// Corner to corner: the bounds overlap, the shapes do not. A ball at (1, 1, 1) is sqrt(3) / 2 from the cube's corner.
TEST(HullOverlap, IsNotThatOfTheBoxesAround) {
  const auto cube = box_of({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  const double reach = 0.5 * std::sqrt(3.0);
  EXPECT_FALSE(meets(Sphere{reach - 1e-6}, {{1, 1, 1}, {}}, cube));
  EXPECT_TRUE(meets(Sphere{reach + 1e-6}, {{1, 1, 1}, {}}, cube));
}

TEST(HullOverlap, PlanesAreSolidBelow) {
  const Plane ground{{0, 0, 1}};
  EXPECT_FALSE(meets(ground, {}, box_of({0, 0, 0.1}, {1, 1, 1})));
  EXPECT_TRUE(meets(ground, {}, box_of({0, 0, -0.1}, {1, 1, 1})));
  EXPECT_TRUE(meets(ground, {}, box_of({0, 0, -2}, {1, 1, -1})));
}

TEST(HullOverlap, PointsLinesAndPolygonsAreHullsToo) {
  const Sphere ball{1};
  const auto at = [](std::vector<Vec3> points) { return points; };
  EXPECT_TRUE(meets(ball, {}, at({{0.99, 0, 0}})));
  EXPECT_FALSE(meets(ball, {}, at({{1.01, 0, 0}})));
  EXPECT_TRUE(meets(ball, {}, at({{-5, 0.99, 0}, {5, 0.99, 0}}))) << "a line across";
  EXPECT_FALSE(meets(ball, {}, at({{-5, 1.01, 0}, {5, 1.01, 0}})));
  EXPECT_TRUE(meets(ball, {}, at({{-5, -5, 0.99}, {5, -5, 0.99}, {0, 9, 0.99}})));
  EXPECT_FALSE(meets(ball, {}, at({{-5, -5, 1.01}, {5, -5, 1.01}, {0, 9, 1.01}})));
}

/// A ball and a box at random: the distance of the box from the centre says it in closed form.
TEST(HullOverlap, AgreesWithTheDistanceFromABox) {
  Stream random(1, 2, Purpose::experiment, 0);
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto draw = [&](double most) { return random.uniform(-most, most); };
    Bounds box;
    box.include(Vec3{draw(1), draw(1), draw(1)});
    box.include(Vec3{draw(1), draw(1), draw(1)});
    const Vec3 centre{draw(2), draw(2), draw(2)};
    const double radius = random.uniform(0.05, 1), distance = box.distance_m(centre);
    if (std::abs(distance - radius) < 1e-6) continue;
    met += distance < radius;
    EXPECT_EQ(meets(Sphere{radius}, {centre, {}}, box_of(box.low, box.high)), distance < radius) << i;
  }
  EXPECT_GT(met, 100);
  EXPECT_LT(met, 1800);
}

}  // namespace
}  // namespace sandlot
