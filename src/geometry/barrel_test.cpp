/// Barrels against the ball, the torus and fine polygons that they are special cases of.
#include "geometry/barrel.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/math.h"
#include "base/random.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

constexpr Barrel roller{0.01, 0.05, 0.03}, tyre{0.05, 0.01, 0.016}, ball{0.2, 0.2, 0.4};

TEST(Barrel, WithTheProfileOfItsRadiusIsABall) {
  EXPECT_TRUE(is_barrel(ball));
  EXPECT_NEAR(end_radius_m(ball), 0, 1e-12);
  const double volume = 4.0 / 3 * math::pi * 0.008;
  EXPECT_NEAR(volume_m3(ball), volume, 1e-7 * volume);
  const Vec3 inertia = inertia_kg_m2(ball, 3);
  EXPECT_NEAR(inertia.x, 0.4 * 3 * 0.04, 1e-8);
  EXPECT_NEAR(inertia.z, 0.4 * 3 * 0.04, 1e-8);
  const BarrelSurface s = nearest(ball, {0.3, 0.4, 0.5});
  EXPECT_NEAR(s.distance_m, std::sqrt(0.5) - 0.2, 1e-12);
  EXPECT_NEAR(s.normal.y, 0.4 / std::sqrt(0.5), 1e-12);
}

TEST(Barrel, OfALongProfileIsACylinder) {
  const Barrel nearly{0.3, 1e6, 0.8};
  const Vec3 can = inertia_kg_m2(Cylinder{0.3, 0.8}, 2), own = inertia_kg_m2(nearly, 2);
  // The ends are 0.16 / 2e6 m thinner.
  EXPECT_NEAR(volume_m3(nearly), volume_m3(Cylinder{0.3, 0.8}), 1e-6);
  EXPECT_NEAR(own.x, can.x, 1e-6);
  EXPECT_NEAR(own.z, can.z, 1e-6);
}

TEST(Barrel, WeighsWhatItsTrianglesWeigh) {
  for (const Barrel& b : {roller, tyre}) {
    const MassProperties fine = mass_properties(tessellate(b, 512));
    // Inscribed: short by (pi / n)^2 of second order in each of two directions.
    EXPECT_NEAR(volume_m3(b), fine.volume_m3, 3e-4 * fine.volume_m3);
    const Vec3 inertia = inertia_kg_m2(b, 1);
    EXPECT_NEAR(inertia.x, fine.moments.x, 5e-4 * inertia.x);
    EXPECT_NEAR(inertia.z, fine.moments.z, 5e-4 * inertia.z);
  }
  EXPECT_TRUE(is_closed(tessellate(roller)));
}

TEST(Barrel, ReachesAsFarAsItsTriangles) {
  Stream random(1, 1, Purpose::experiment, 0);
  for (const Barrel& b : {roller, tyre, ball}) {
    const TriangleMesh mesh = tessellate(b, 256);
    for (int i = 0; i < 40; ++i) {
      const Vec3 n = normalised(
          Vec3{random.normal(), 0, random.normal()});  // a vertex lies in this half plane
      double most = -1;
      for (const Vec3& v : mesh.vertices) most = std::max(most, dot(v, n));
      EXPECT_NEAR(reach_m(b, n.z), most, 1e-3 * b.radius_m);
      EXPECT_GE(reach_m(b, n.z), most - 1e-12);
      EXPECT_NEAR(dot(farthest(b, n), n), reach_m(b, n.z), 1e-12);
    }
  }
}

TEST(Barrel, DistanceFollowsTheNormal) {
  // From any point outside, the nearest place lies on the surface and nothing is nearer.
  Stream random(2, 1, Purpose::experiment, 0);
  for (const Barrel& b : {roller, tyre, ball}) {
    const TriangleMesh mesh = tessellate(b, 128);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = 1.5 * bounding_radius_m(b) *
                     Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      const BarrelSurface s = nearest(b, p);
      EXPECT_NEAR(norm(s.normal), 1, 1e-12);
      if (s.distance_m <= 0) continue;
      const Vec3 foot = p - s.distance_m * s.normal;
      EXPECT_NEAR(nearest(b, foot).distance_m, 0, 1e-12);
      EXPECT_LE(std::abs(foot.z), 0.5 * b.length_m + 1e-12);
      for (const Vec3& v : mesh.vertices) EXPECT_GE(norm(p - v), s.distance_m - 1e-12);
    }
  }
}

TEST(Barrel, ImpossibleOnesAreKnown) {
  EXPECT_FALSE(is_barrel({0.01, 0.01, 0.03})) << "the arc ends before the ends";
  EXPECT_FALSE(is_barrel({0.01, 0.016, 0.03})) << "a radius below 0 at the ends";
  EXPECT_FALSE(is_barrel({0, 1, 0.1}));
  EXPECT_FALSE(is_barrel({std::nan(""), 1, 0.1}));
  EXPECT_TRUE(is_barrel(roller));
  EXPECT_TRUE(is_barrel(tyre));
}

}  // namespace
}  // namespace sandlot
