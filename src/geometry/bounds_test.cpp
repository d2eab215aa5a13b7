/// Boxes around shapes, against corners worked out by hand and against tessellated surfaces.
#include "geometry/bounds.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Bounds, OfALeaningBoxAndCylinderByHand) {
  // Turned by 45 degrees about z, a box of 2 x 1 reaches (2 + 1) / (2 sqrt 2) both ways.
  const Pose turned{{1, 2, 3}, quat_from_rpy(0, 0, math::pi / 4)};
  const double reach = 3 / (2 * std::sqrt(2.0));
  const Bounds box = bounds_of(Box{{2, 1, 4}}, turned);
  expect_near(box.low, {1 - reach, 2 - reach, 1}, 1e-12);
  expect_near(box.high, {1 + reach, 2 + reach, 5}, 1e-12);
  // A cylinder on its side along y.
  const Bounds lying = bounds_of(Cylinder{0.5, 3}, {{0, 0, 0}, quat_from_rpy(math::pi / 2, 0, 0)});
  expect_near(lying.high, {0.5, 1.5, 0.5}, 1e-12);
  EXPECT_TRUE(bounds_of(Plane{{0, 0, 1}}).empty());
  EXPECT_NEAR(box.distance_m({1, 2, 7}), 2, 1e-12);
  EXPECT_EQ(box.distance_m({1, 2, 3}), 0);
}

TEST(Bounds, HoldTheTessellatedShapeAndNoMore) {
  const Pose X{{0.3, -1, 2}, quat_from_rpy(0.4, 0.9, -2)};
  const Shape shapes[] = {Box{{1, 2, 3}},        Sphere{0.7},          Cylinder{0.4, 2},
                          Capsule{0.3, 1.2},     Cone{0.8, 1.5},       Ellipsoid{{1, 2, 0.5}},
                          Barrel{0.3, 0.9, 1.2}, Barrel{0.6, 0.2, 0.3}};
  for (const Shape& shape : shapes) {
    SCOPED_TRACE(shape_name(shape));
    constexpr int segments = 512;
    Bounds points;
    for (const Vec3& v : tessellate(shape, segments).vertices) points.include(X * v);
    const Bounds exact = bounds_of(shape, X);
    // Inscribed corners fall short of a circle of radius r by at most r (1 - cos(pi / n)) along each of two
    // angles.
    const double tolerance = 2 * bounding_radius_m(shape) * (1 - math::cos(math::pi / (segments / 2)));
    expect_near(points.low, exact.low, tolerance + 1e-12);
    expect_near(points.high, exact.high, tolerance + 1e-12);
    const Bounds mesh = bounds_of(Mesh{std::make_shared<TriangleMesh>(tessellate(shape, segments))}, X);
    EXPECT_EQ(mesh.low, points.low);
  }
}

TEST(Bounds, OfTerrainReachFromItsLowestToItsHighestSample) {
  auto grid = std::make_shared<HeightGrid>();
  grid->columns = grid->rows = 2, grid->size_x_m = 10, grid->size_y_m = 4;
  grid->height_m = {0, 1, -2, 0.5f};
  const Bounds b = bounds_of(Heightfield{grid}, {{100, 0, 0}, {}});
  expect_near(b.low, {95, -2, -2}, 1e-12);
  expect_near(b.high, {105, 2, 1}, 1e-12);
}

}  // namespace
}  // namespace sandlot
