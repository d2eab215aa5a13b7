#include "physics/rigid/surface.h"

#include <gtest/gtest.h>

namespace sandlot::rigid {
namespace {

TEST(Surface, ModesAreSetForWhatThePairHas) {
  PairSurface pair;
  pair.mu = pair.mu2 = 0.3;
  dSurfaceParameters p = parameters_of(pair, 0.01, 1e-6, false);
  EXPECT_EQ(p.mode, dContactFDir1 | dContactApprox1);
  EXPECT_EQ(p.mu, 0.3);
  pair.restitution = 0.6, pair.restitution_threshold_mps = 2;
  pair.slip1 = 0.03, pair.slip2 = 0.04;
  pair.mu2 = 0.2;
  pair.soft_erp = 0.1, pair.soft_cfm = 3e-3;
  pair.rolling_resistance_m = 0.01;
  p = parameters_of(pair, 0.01, 1e-6, false);
  EXPECT_EQ(p.mode, dContactFDir1 | dContactApprox1 | dContactMu2 | dContactBounce | dContactSlip1 |
                        dContactSlip2 | dContactSoftERP | dContactSoftCFM | dContactRolling);
  EXPECT_EQ(p.mu2, 0.2);
  EXPECT_EQ(p.bounce, 0.6);
  EXPECT_EQ(p.bounce_vel, 2);
  EXPECT_DOUBLE_EQ(p.slip1, 0.030001);
  EXPECT_DOUBLE_EQ(p.slip2, 0.040001);
  EXPECT_EQ(p.soft_cfm, 3e-3);
  EXPECT_EQ(p.soft_erp, 0.1);
  EXPECT_EQ(p.rho, 0.01);
  EXPECT_EQ(p.rho2, 0.01);
  p = parameters_of(pair, 0.01, 1e-6, true);
  EXPECT_EQ(p.mu, 0);
  EXPECT_EQ(p.mu2, 0);
  EXPECT_FALSE(p.mode & dContactRolling);
}

TEST(Surface, ASpringWithADamperIsErpAndCfmOfTheStep) {
  PairSurface pair;
  pair.stiffness_N_per_m = 2000, pair.damping_N_s_per_m = 30;
  pair.soft_erp = 0.9, pair.soft_cfm = 1;  // do not count where there is a spring
  const dSurfaceParameters p = parameters_of(pair, 0.01, 1e-6, false);
  EXPECT_DOUBLE_EQ(p.soft_erp, 20.0 / 50);
  EXPECT_DOUBLE_EQ(p.soft_cfm, 1.0 / 50);
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
