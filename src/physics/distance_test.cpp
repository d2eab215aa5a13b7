#include "physics/distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

TEST(Overlap, DistancesAreThoseOfTheSolids) {
  const Box box{{2, 4, 6}};
  EXPECT_EQ(distance_m(box, {0.9, -1.9, 2.9}), 0);
  EXPECT_DOUBLE_EQ(distance_m(box, {1.5, 0, 0}), 0.5);
  EXPECT_DOUBLE_EQ(distance_m(box, {4, -6, 0}), 5);  // 3, 4, 5
  EXPECT_EQ(distance_m(Sphere{1}, {0.5, 0.5, 0.5}), 0);
  EXPECT_DOUBLE_EQ(distance_m(Sphere{1}, {0, 3, 4}), 4);
  const Cylinder can{1, 2};
  EXPECT_EQ(distance_m(can, {0.6, 0.6, -0.9}), 0);
  EXPECT_DOUBLE_EQ(distance_m(can, {0, 3, 0.5}), 2);
  EXPECT_DOUBLE_EQ(distance_m(can, {0, 0.5, 4}), 3);
  EXPECT_DOUBLE_EQ(distance_m(can, {4, 0, -5}), 5);
  const Capsule pill{1, 2};
  EXPECT_EQ(distance_m(pill, {0, 0, 1.9}), 0);
  EXPECT_DOUBLE_EQ(distance_m(pill, {0, 0, -3}), 1);
  EXPECT_DOUBLE_EQ(distance_m(pill, {3, 0, 1}), 2);
  EXPECT_DOUBLE_EQ(distance_m(pill, {3, 0, 5}), 4);
  EXPECT_DOUBLE_EQ(distance_m(Plane{{0, 0, 2}}, {7, 8, 3}), 3);
  EXPECT_EQ(distance_m(Plane{{0, 0, 1}}, {7, 8, -3}), 0);
}

TEST(Overlap, ConesAndEllipsoids) {
  const Cone cone{3, 4};  // apex at z = 2; the mantle falls 4 on 3, its normal is (4, 3) / 5
  EXPECT_EQ(distance_m(cone, {1.4, 0, 0}), 0);
  EXPECT_DOUBLE_EQ(distance_m(cone, {0, 0, 5}), 3);
  EXPECT_NEAR(distance_m(cone, {1.5 + 4, 0, 3}), 5,
              1e-12);  // 5 along the normal from the middle of the mantle
  EXPECT_NEAR(distance_m(cone, {0, 1.5 + 4, 3}), 5, 1e-12);
  EXPECT_DOUBLE_EQ(distance_m(cone, {6, 0, -6}), 5);  // the rim: 3, 4, 5
  EXPECT_DOUBLE_EQ(distance_m(cone, {1, 1, -3.5}), 1.5);
  const Ellipsoid egg{{3, 2, 1}};
  EXPECT_EQ(distance_m(egg, {1, 1, 0.5}), 0);
  EXPECT_NEAR(distance_m(egg, {5, 0, 0}), 2, 1e-12);
  EXPECT_NEAR(distance_m(egg, {0, 0, -2.5}), 1.5, 1e-12);
  // From a point of the surface along its normal (x / 9, y / 4, z).
  const Vec3 on{3 * 0.6, 2 * 0.48, 0.64};
  const Vec3 out = normalised(Vec3{on.x / 9, on.y / 4, on.z});
  EXPECT_NEAR(distance_m(egg, on + 0.7 * out), 0.7, 1e-12);
}

TEST(Overlap, AMeshOfABoxIsABoxAndTerrainIsItsTriangles) {
  const Shape box = Box{{2, 4, 6}}, mesh = Mesh{std::make_shared<const TriangleMesh>(tessellate(box))};
  const Shape grid = Heightfield{std::make_shared<const HeightGrid>(
      HeightGrid{3, 3, 4, 2, {0, 0.5f, 0.3f, 0.1f, 1.0f, 0.2f, 0.4f, 0, 0.3f}, {}})};
  const Shape same = Mesh{std::make_shared<const TriangleMesh>(tessellate(grid))};
  int inside = 0;
  for (int i = 0; i < 400; ++i) {
    // Points spread evenly enough: multiples of irrational numbers.
    const auto part = [i](double x) { return i * x - std::floor(i * x) - 0.5; };
    const Vec3 p{4 * part(0.618034), 8 * part(0.414214), 12 * part(0.732051)};
    EXPECT_NEAR(distance_m(mesh, p), distance_m(box, p), 1e-12) << i;
    inside += distance_m(box, p) == 0;
    const Vec3 q{4.5 * part(0.618034), 2.5 * part(0.414214), 2 + 1.9 * part(0.732051)};
    EXPECT_NEAR(distance_m(grid, q), distance_m(same, q), 1e-12) << i;
    // A limit changes nothing below it and never lowers the answer.
    EXPECT_EQ(distance_m(grid, q, 0.5) <= 0.5, distance_m(grid, q) <= 0.5) << i;
    EXPECT_EQ(distance_m(mesh, p, 0.5) <= 0.5, distance_m(mesh, p) <= 0.5) << i;
  }
  EXPECT_GT(inside, 20);
  EXPECT_EQ(distance_m(grid, {0.3, 0.2, -5}), 0);
}

}  // namespace
}  // namespace sandlot
