#include "kinematics/differential.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "base/random.h"

namespace sandlot::kinematics {
namespace {

const Differential drive{.wheel_radius_m = 0.1, .wheel_separation_m = 0.5};

TEST(Differential, WheelSpeedsByHand) {
  // Straight at 1 m/s: 10 rad/s. On the spot at 2 rad/s: the rims run at 2 * 0.25 = 0.5 m/s. About the left
  // wheel: v = omega d / 2.
  EXPECT_NEAR(drive.inverse({1, 0}).left_radps, 10, 1e-14);
  EXPECT_NEAR(drive.inverse({1, 0}).right_radps, 10, 1e-14);
  EXPECT_NEAR(drive.inverse({0, 2}).left_radps, -5, 1e-14);
  EXPECT_NEAR(drive.inverse({0, 2}).right_radps, 5, 1e-14);
  EXPECT_NEAR(drive.inverse({0.25, 1}).left_radps, 0, 1e-14);
  EXPECT_NEAR(drive.inverse({0.25, 1}).right_radps, 5, 1e-14);
}

TEST(Differential, ForwardUndoesInverse) {
  Stream random(1, 1, Purpose::experiment, 0);
  for (int i = 0; i < 1000; ++i) {
    const double v = random.uniform(-3, 3), omega = random.uniform(-5, 5);
    const DriveVelocity back = drive.forward(drive.inverse({v, omega}));
    EXPECT_NEAR(back.v_mps, v, 1e-14);
    EXPECT_NEAR(back.omega_radps, omega, 1e-14);
  }
}

TEST(Differential, LimitingKeepsTheArc) {
  const WheelSpeeds cut = limited(drive.inverse({1, -2}), 6);  // 15 and 5 rad/s
  EXPECT_NEAR(cut.left_radps, 6, 1e-14);
  EXPECT_NEAR(cut.right_radps, 2, 1e-14);
  EXPECT_NEAR(drive.forward(cut).omega_radps / drive.forward(cut).v_mps, -2, 1e-14);
  EXPECT_EQ(limited({3, -4}, 4).right_radps, -4);
  EXPECT_EQ(limited({-8, 0}, 4).left_radps, -4);
  EXPECT_EQ(limited({0, 0}, 0).left_radps, 0);
  EXPECT_EQ(limited({1, 1}, 0).left_radps, 0);
}

TEST(Odometry, StraightArcAndSpinAreExactInOneStep) {
  const PlanarPose straight = integrate(drive, {1, 2, math::pi / 2}, 10, 10);
  EXPECT_NEAR(straight.x_m, 1, 1e-15);
  EXPECT_NEAR(straight.y_m, 3, 1e-15);
  // A quarter circle of radius 2: the centre runs pi, the wheels (2 -+ 0.25) pi/2.
  const PlanarPose arc = integrate(drive, {}, 1.75 * math::pi / 2 / 0.1, 2.25 * math::pi / 2 / 0.1);
  EXPECT_NEAR(arc.x_m, 2, 1e-14);
  EXPECT_NEAR(arc.y_m, 2, 1e-14);
  EXPECT_NEAR(arc.theta_rad, math::pi / 2, 1e-14);
  // A whole turn on the spot: each wheel runs pi d.
  const PlanarPose spin = integrate(drive, {1, 1, 0.5}, -math::pi * 0.5 / 0.1, math::pi * 0.5 / 0.1);
  EXPECT_NEAR(spin.x_m, 1, 1e-15);
  EXPECT_NEAR(spin.y_m, 1, 1e-15);
  EXPECT_NEAR(spin.theta_rad, 0.5 + math::tau, 1e-14);
}

TEST(Odometry, DoesNotDependOnHowAnArcIsCut) {
  const PlanarPose once = along_arc({}, 3.0, 2.0);
  for (const int parts : {2, 7, 1000}) {
    PlanarPose pose;
    for (int i = 0; i < parts; ++i) pose = along_arc(pose, 3.0 / parts, 2.0 / parts);
    EXPECT_NEAR(pose.x_m, once.x_m, parts * 1e-15);
    EXPECT_NEAR(pose.y_m, once.y_m, parts * 1e-15);
    EXPECT_NEAR(pose.theta_rad, once.theta_rad, parts * 1e-15);
  }
}

TEST(Odometry, TheSeriesMeetsTheClosedForm) {
  // On both sides of the change at a turn of 2e-4 the chord agrees with the closed form to rounding.
  for (const double turn : {1e-12, 1.9999e-4, 2.0001e-4, -1.9999e-4}) {
    const PlanarPose pose = along_arc({}, 1.0, turn);
    EXPECT_NEAR(pose.x_m, math::sin(turn) / turn, 1e-15);
    // (1 - cos a) / a = 2 sin^2(a/2) / a, which does not cancel
    EXPECT_NEAR(pose.y_m, 2 * math::sin(turn / 2) * math::sin(turn / 2) / turn, 1e-15);
  }
  EXPECT_EQ(along_arc({}, 1.0, 0.0).x_m, 1.0);
}

TEST(Odometry, BecomesAPose) {
  const Pose pose = to_pose({1, 2, math::pi / 3 + math::tau});
  EXPECT_EQ(pose.p, (Vec3{1, 2, 0}));
  EXPECT_NEAR(yaw_of(pose.q), math::pi / 3, 1e-15);
}

}  // namespace
}  // namespace sandlot::kinematics
