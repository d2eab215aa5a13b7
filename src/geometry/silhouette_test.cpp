#include "geometry/silhouette.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/math.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

std::vector<SilhouetteDisc> silhouette(const Shape& shape, const Pose& X_WC) {
  std::vector<SilhouetteDisc> discs;
  add_silhouette(shape, X_WC, discs);
  return discs;
}

/// Largest extent of discs along a direction.
double silhouette_reach_m(const std::vector<SilhouetteDisc>& discs, Vec2 direction) {
  double reach = -1e9;
  for (const SilhouetteDisc& disc : discs)
    reach = std::max(reach, dot(disc.centre, direction) + disc.radius_m);
  return reach;
}

TEST(Silhouette, StandingRoundShapesAreDiscsWithOneCentre) {
  for (const Shape& shape : {Shape(Sphere{0.3}), Shape(Cylinder{0.3, 0.6}), Shape(Capsule{0.3, 0.4}),
                             Shape(Ellipsoid{{0.3, 0.3, 1}})}) {
    double largest = 0;
    for (const SilhouetteDisc& disc : silhouette(shape, {{1, 2, 3}, {}})) {
      EXPECT_NEAR(disc.centre.x, 1, 1e-15);
      EXPECT_NEAR(disc.centre.y, 2, 1e-15);
      largest = std::max(largest, disc.radius_m);
    }
    EXPECT_NEAR(largest, 0.3, 1e-15);
  }
}

TEST(Silhouette, ALeaningDiscIsEnclosedByTangents) {
  // A cylinder of no length that leans by a about y: an ellipse with the half axes r cos a and r. The 32-gon
  // of tangents lies outside it by at most 1 / cos(pi / 32) - 1 = 0.48 %.
  const double a = 0.7, r = 0.5;
  const auto discs = silhouette(Cylinder{r, 0}, pose_from_rpy({}, {0, a, 0}));
  for (int i = 0; i < 100; ++i) {
    const auto [s, c] = math::sincos(math::tau * i / 100);
    const double exact = r * std::sqrt(c * c * math::cos(a) * math::cos(a) + s * s);
    EXPECT_GE(silhouette_reach_m(discs, {c, s}), exact * (1 - 1e-12));
    EXPECT_LE(silhouette_reach_m(discs, {c, s}), exact * 1.0049);
  }
}

TEST(Silhouette, ALyingCapsuleIsADiscAtEachEnd) {
  const auto discs = silhouette(Capsule{0.2, 1.5}, pose_from_rpy({0, 0, 0.2}, {0, math::pi / 2, 0}));
  ASSERT_EQ(discs.size(), 2u);
  EXPECT_NEAR(std::abs(discs[0].centre.x), 0.75, 1e-12);
  EXPECT_NEAR(discs[0].centre.x + discs[1].centre.x, 0, 1e-12);
  EXPECT_EQ(discs[0].radius_m, 0.2);
}

TEST(Silhouette, HeightsOfLeaningShapes) {
  // Leaning by a about y, a box is as high as x sin a + z cos a, a cylinder as length cos a + 2 r sin a.
  const double a = 0.4, s = math::sin(a), c = math::cos(a);
  const Pose X = pose_from_rpy({0, 0, 2}, {0, a, 0});
  const Heights box = heights_of(Box{{2, 1, 0.5}}, X);
  EXPECT_NEAR(box.max_m - box.min_m, 2 * s + 0.5 * c, 1e-12);
  EXPECT_NEAR(0.5 * (box.max_m + box.min_m), 2, 1e-12);
  const Heights can = heights_of(Cylinder{0.3, 1}, X);
  EXPECT_NEAR(can.max_m - can.min_m, c + 2 * 0.3 * s, 1e-12);
  EXPECT_TRUE(heights_of(Plane{{0, 0, 1}}, {}).empty());
}

TEST(Silhouette, OfPlanesIsNothing) { EXPECT_TRUE(silhouette(Plane{{0, 0, 1}}, {}).empty()); }

TEST(ConvexHull2d, GoesCounterClockwiseWithoutPointsOnEdges) {
  const auto hull = convex_hull_2d({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 1}, {0, 2}, {0, 1}});
  ASSERT_EQ(hull.size(), 4u);
  double twice = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 p = hull[i], q = hull[(i + 1) % hull.size()];
    twice += p.x * q.y - p.y * q.x;
  }
  EXPECT_EQ(twice, 8);
  EXPECT_LT(convex_hull_2d({{0, 0}, {1, 1}, {2, 2}}).size(), 3u);
  EXPECT_TRUE(convex_hull_2d({}).empty());
}

}  // namespace
}  // namespace sandlot
