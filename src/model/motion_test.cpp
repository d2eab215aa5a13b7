#include "model/motion.h"

#include <gtest/gtest.h>

#include "base/math.h"

namespace sandlot::model {
namespace {

Quat yaw(double rad) { return quat_from_rpy(0, 0, rad); }

/// 2 m ahead in 4 s while turning by 3 rad (the short way for a half turn is less than pi), then back in 1 s.
Motion there_and_back() {
  return {.keys = {{0, {{1, 0, 0}, yaw(0)}}, {4, {{3, 0, 0}, yaw(3)}}, {5, {{1, 0, 0}, yaw(0)}}},
          .delay_s = 2};
}

TEST(Motion, RunsEvenlyBetweenKeys) {
  const Motion m = there_and_back();
  EXPECT_EQ(pose_at(m, 0).p.x, 1);
  EXPECT_EQ(pose_at(m, 2).p.x, 1);
  EXPECT_NEAR(pose_at(m, 3).p.x, 1.5, 1e-12);
  EXPECT_NEAR(yaw_of(pose_at(m, 3).q), 0.75, 1e-12);
  EXPECT_NEAR(pose_at(m, 6.5).p.x, 2, 1e-12);
  EXPECT_NEAR(yaw_of(pose_at(m, 6.5).q), 1.5, 1e-12);
  EXPECT_NEAR(pose_at(m, 8).p.x, 1.5, 1e-12);  // the second round
  Motion once = m;
  once.loop = false;
  EXPECT_EQ(pose_at(once, 100).p.x, 1);
  once.keys.pop_back();
  EXPECT_EQ(pose_at(once, 100).p.x, 3);
}

TEST(Motion, TakesTheShortWayRound) {
  const Motion m{.keys = {{0, {{}, yaw(3)}}, {1, {{}, yaw(-3)}}}, .loop = false};
  // From 3 over pi to -3 = 2 pi - 3: the middle is pi.
  EXPECT_NEAR(std::abs(yaw_of(pose_at(m, 0.5).q)), math::pi, 1e-12);
}

TEST(Motion, VelocityIsTheMeanOfTheInterval) {
  const Motion m = there_and_back();
  const Moved a = moved(m, 3, 3.1);
  EXPECT_NEAR(a.V_WM.linear.x, 0.5, 1e-12);
  EXPECT_NEAR(a.V_WM.angular.z, 0.75, 1e-12);
  EXPECT_NEAR(a.X_WM.p.x, 1.55, 1e-12);
  EXPECT_EQ(moved(m, 1, 1.1).V_WM.linear, Vec3{});
  // Closed: from one round into the next it goes on, 0.1 s back at 2 m/s and 0.1 s ahead at 0.5 m/s.
  EXPECT_NEAR(moved(m, 6.9, 7.1).V_WM.linear.x, (-0.2 + 0.05) / 0.2, 1e-9);
  Motion open = m;
  open.keys.pop_back();
  const Moved jump = moved(open, 5.9, 6.1);
  EXPECT_EQ(jump.V_WM.linear, Vec3{});
  EXPECT_NEAR(jump.X_WM.p.x, 1.05, 1e-9);
}

TEST(Motion, OneKeyStands) {
  const Motion m{.keys = {{0, {{1, 2, 3}, {}}}}};
  EXPECT_EQ(pose_at(m, 17).p, (Vec3{1, 2, 3}));
  EXPECT_EQ(moved(m, 17, 18).V_WM.linear, Vec3{});
}

}  // namespace
}  // namespace sandlot::model
