#include "physics/rigid/surface.h"

#include <gtest/gtest.h>

namespace sandlot::rigid {
namespace {

TEST(Surface, FrictionIsTheSmallerBounceTheLarger) {
  model::Surface a, b;
  a.mu = 0.3, b.mu = 0.7;
  a.mu2 = 0.1;  // means nothing without a direction
  a.restitution = 0.2, b.restitution = 0.6;
  a.restitution_threshold_mps = 1, b.restitution_threshold_mps = 2;
  for (const auto& pair : {combine(a, b, 1e-6, false), combine(b, a, 1e-6, false)}) {
    EXPECT_DOUBLE_EQ(pair.parameters.mu, 0.3);
    EXPECT_DOUBLE_EQ(pair.parameters.mu2, 0.3);
    EXPECT_EQ(pair.directed, nullptr);
    EXPECT_TRUE(pair.parameters.mode & dContactBounce);
    EXPECT_DOUBLE_EQ(pair.parameters.bounce, 0.6);
    EXPECT_DOUBLE_EQ(pair.parameters.bounce_vel, 2);
    EXPECT_FALSE(pair.parameters.mode & (dContactSlip1 | dContactSlip2 | dContactSoftERP | dContactSoftCFM));
  }
  EXPECT_EQ(combine(a, b, 1e-6, true).parameters.mu, 0);
  EXPECT_EQ(combine(a, b, 1e-6, true).parameters.mu2, 0);
}

TEST(Surface, ADirectionBelongsToOneOfThem) {
  model::Surface wheel, floor;
  wheel.mu = 1, wheel.mu2 = 0.2, wheel.fdir1 = {1, 0, 0};
  floor.mu = 0.5;
  const SurfacePair pair = combine(floor, wheel, 1e-6, false);
  EXPECT_EQ(pair.directed, &wheel);
  EXPECT_DOUBLE_EQ(pair.parameters.mu, 0.5);
  EXPECT_DOUBLE_EQ(pair.parameters.mu2, 0.2);
  EXPECT_TRUE(pair.parameters.mode & dContactMu2);
  model::Surface ice = wheel;
  ice.mu = 0.05;
  EXPECT_EQ(combine(wheel, ice, 1e-6, false).directed, &ice);
  EXPECT_EQ(combine(ice, wheel, 1e-6, false).directed, &ice);
}

TEST(Surface, CompliancesAdd) {
  model::Surface a, b;
  a.slip1 = 0.01, b.slip1 = 0.02;
  a.soft_cfm = 1e-3, b.soft_cfm = 2e-3;
  a.soft_erp = 0.5, b.soft_erp = 0.1;
  const dSurfaceParameters p = combine(a, b, 1e-6, false).parameters;
  EXPECT_DOUBLE_EQ(p.slip1, 0.030001);
  EXPECT_DOUBLE_EQ(p.slip2, 0.030001);
  EXPECT_DOUBLE_EQ(p.soft_cfm, 3e-3);
  EXPECT_DOUBLE_EQ(p.soft_erp, 0.1);
}

TEST(Surface, TheDirectionLiesAcrossTheNormal) {
  const Vec3 normal = normalised(Vec3{1, 2, 3});
  const Vec3 d = friction_direction(normal, {1, 0, 0});
  EXPECT_NEAR(dot(d, normal), 0, 1e-15);
  EXPECT_NEAR(norm(d), 1, 1e-15);
  EXPECT_GT(d.x, 0);
  for (const Vec3 n : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 fallback = friction_direction(n, 5.0 * n);  // nothing across
    EXPECT_NEAR(dot(fallback, n), 0, 1e-15);
    EXPECT_NEAR(norm(fallback), 1, 1e-15);
  }
}

}  // namespace
}  // namespace sandlot::rigid
