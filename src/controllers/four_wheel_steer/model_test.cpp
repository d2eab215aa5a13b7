/// The paper's equations by hand, and the odometry against exact arcs and Eigen's singular value decomposition.
#include "controllers/four_wheel_steer/model.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "base/math.h"
#include "base/random.h"

namespace sandlot::controllers::four_wheel_steer {
namespace {

constexpr Wheel front_left{0.3, 0.4, 0.1};
/// v_c = (0.6, 0.15), w = 0.5: the wheel's point moves with (0.6 - 0.4 * 0.5, 0.15 + 0.3 * 0.5) = (0.4, 0.3).
constexpr Motion on_a_curve{0.6, 0.15, 0.5};

std::vector<Wheel> square(double half_m, double radius_m) {
  return {{half_m, half_m, radius_m},
          {half_m, -half_m, radius_m},
          {-half_m, half_m, radius_m},
          {-half_m, -half_m, radius_m}};
}

/// Pose after the time t at a constant velocity in the moving frame.
Fit arc(const Motion& v, double t) {
  const double a = v.turn * t;
  if (a == 0) return {v.x * t, v.y * t, 0};
  const double s = math::sin(a) / v.turn, c = (1 - math::cos(a)) / v.turn;
  return {s * v.x - c * v.y, c * v.x + s * v.y, a};
}

TEST(FourWheelModel, VelocityOfAWheelHasTheSignsOfEquationThree) {
  const Vec2 u = wheel_velocity(on_a_curve, front_left);
  EXPECT_NEAR(u.x, 0.4, 1e-15);
  EXPECT_NEAR(u.y, 0.3, 1e-15) << "the paper's equation 5 as printed gives 0";
}

TEST(FourWheelModel, InverseKinematicsByHand) {
  const WheelMotion m = inverse(on_a_curve, front_left);
  EXPECT_NEAR(m.rate_radps, 0.5 / 0.1, 1e-14);
  EXPECT_NEAR(m.steering_rad, 0.6435011087932844, 1e-15);  // atan2(3, 4)
  EXPECT_NEAR(m.slip_rad, 0.6435011087932844, 1e-15);      // acos(0.8)
  // To the right and backward: (-0.4, -0.3). The slip angle has no sign.
  const WheelMotion back = inverse(-1.0 * on_a_curve, front_left);
  EXPECT_NEAR(back.rate_radps, 5, 1e-14);
  EXPECT_NEAR(back.steering_rad, 0.6435011087932844 - math::pi, 1e-15);
  EXPECT_NEAR(back.slip_rad, math::pi - 0.6435011087932844, 1e-15);
  EXPECT_EQ(inverse({}, front_left).rate_radps, 0);
  EXPECT_EQ(inverse({}, front_left).slip_rad, 0);
}

TEST(FourWheelModel, CentreOfRotationIsAcrossEachWheelAtItsSpeed) {
  const auto c = centre_of_rotation(on_a_curve);
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->x, -0.3, 1e-15);
  EXPECT_NEAR(c->y, 1.2, 1e-15);
  for (const Wheel& wheel : square(0.21, 0.075)) {
    const Vec2 u = wheel_velocity(on_a_curve, wheel), arm = Vec2{wheel.x_m, wheel.y_m} - *c;
    EXPECT_NEAR(dot(u, arm), 0, 1e-15);
    EXPECT_NEAR(std::sqrt(dot(u, u)), on_a_curve.turn * std::sqrt(dot(arm, arm)), 1e-15);
  }
  EXPECT_FALSE(centre_of_rotation({1, 2, 0}));
}

TEST(FourWheelModel, AccelerationsByHand) {
  // v' = (0.2, -0.3), w' = 0.4:
  //   a_ix = 0.2 - 0.5 * 0.15 - 0.3 * 0.25 - 0.4 * 0.4 = -0.11
  //   a_iy = -0.3 + 0.5 * 0.6 - 0.4 * 0.25 + 0.3 * 0.4 = 0.02
  const Vec2 a = wheel_acceleration(on_a_curve, {0.2, -0.3, 0.4}, front_left);
  EXPECT_NEAR(a.x, -0.11, 1e-15);
  EXPECT_NEAR(a.y, 0.02, 1e-15);
}

TEST(FourWheelModel, FourModes) {
  EXPECT_EQ(mode_of({}), Mode::stop);
  EXPECT_EQ(mode_of({0, -0.1, 0}), Mode::crab);
  EXPECT_EQ(mode_of({0, 0, -0.1}), Mode::spin);
  EXPECT_EQ(mode_of({0.1, 0, 0.1}), Mode::turn);
  // Crab: all alike. Spin: tangential to the centroid, front left of a square at 135 degrees.
  for (const Wheel& wheel : square(0.21, 0.075))
    EXPECT_NEAR(inverse({0.3, 0.3, 0}, wheel).steering_rad, math::pi / 4, 1e-15);
  EXPECT_NEAR(inverse({0, 0, 1}, square(0.21, 0.075)[0]).steering_rad, 0.75 * math::pi, 1e-15);
  EXPECT_NEAR(inverse({0, 0, 1}, square(0.21, 0.075)[0]).rate_radps, 0.21 * std::sqrt(2.0) / 0.075, 1e-14);
}

TEST(FourWheelOdometry, TurnsAndMovesPointsByHand) {
  // A quarter turn, then (1, 2): (1, 0) -> (1, 3), (0, 1) -> (0, 2), (-1, 0) -> (1, 1).
  const std::vector<Vec2> before{{1, 0}, {0, 1}, {-1, 0}}, after{{1, 3}, {0, 2}, {1, 1}};
  const Fit fit = kabsch(before, after);
  EXPECT_NEAR(fit.turn_rad, math::pi / 2, 1e-15);
  EXPECT_NEAR(fit.x_m, 1, 1e-15);
  EXPECT_NEAR(fit.y_m, 2, 1e-15);
  EXPECT_NEAR(fit.rmsd_m, 0, 1e-15);
}

TEST(FourWheelOdometry, IsThatOfTheSingularValueDecomposition) {
  Stream random(1, 2, Purpose::experiment, 0);
  for (int round = 0; round < 200; ++round) {
    const auto n = static_cast<std::size_t>(3 + random.below(6));
    std::vector<Vec2> before(n), after(n);
    for (std::size_t i = 0; i < n; ++i) {
      before[i] = {random.uniform(-1, 1), random.uniform(-1, 1)};
      after[i] = {random.uniform(-1, 1), random.uniform(-1, 1)};  // nothing rigid about it
    }
    // Equations 12 and 13 in the plane: the third axis of the paper's matrices is that of the sign d.
    Eigen::MatrixXd P(static_cast<Eigen::Index>(n), 2), Q = P;
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      P(row, 0) = before[i].x, P(row, 1) = before[i].y, Q(row, 0) = after[i].x, Q(row, 1) = after[i].y;
    }
    const Eigen::RowVector2d p = P.colwise().mean(), q = Q.colwise().mean();
    P.rowwise() -= p;
    Q.rowwise() -= q;
    const Eigen::Matrix2d A = P.transpose().lazyProduct(Q);
    const Eigen::JacobiSVD<Eigen::Matrix2d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix2d &V = svd.matrixU(), &W = svd.matrixV();
    const double d = (W * V.transpose()).determinant() > 0 ? 1 : -1;
    const Eigen::Matrix2d R = W * Eigen::Vector2d(1, d).asDiagonal() * V.transpose();
    const Fit fit = kabsch(before, after);
    const auto [s, c] = math::sincos(fit.turn_rad);
    // Where the two singular values agree under a mirror image, any turn is as good as any other.
    if (d < 0 && svd.singularValues()[0] - svd.singularValues()[1] < 1e-3) continue;
    EXPECT_NEAR(c, R(0, 0), 1e-9);
    EXPECT_NEAR(s, R(1, 0), 1e-9);
    EXPECT_NEAR(s, -R(0, 1), 1e-9);
    const Eigen::Vector2d t = q.transpose() - R * p.transpose();
    EXPECT_NEAR(fit.x_m, t.x(), 1e-9);
    EXPECT_NEAR(fit.y_m, t.y(), 1e-9);
    const double squares = (Q - P.lazyProduct(R.transpose())).squaredNorm() / static_cast<double>(n);
    EXPECT_NEAR(fit.rmsd_m, std::sqrt(squares), 1e-9);
  }
}

TEST(FourWheelOdometry, WheelsThatRollGiveTheExactArcInAllModes) {
  const auto wheels = square(0.21, 0.075);
  constexpr double dt = 0.02;
  for (const Motion& v :
       {Motion{0.8, -0.3, 0}, Motion{0, 0, 1.5}, Motion{0.6, 0.15, 0.5}, Motion{-0.4, 0.2, -2}}) {
    std::vector<double> turns, steering;
    for (const Wheel& wheel : wheels) {
      turns.push_back(inverse(v, wheel).rate_radps * dt);
      steering.push_back(inverse(v, wheel).steering_rad);
    }
    const Fit fit = rolled(wheels, turns, steering), want = arc(v, dt);
    // Three passes leave the sixth order of the turn of up to 0.04: 4e-9 of the way of 0.01 m; two the fourth, 2e-8 m.
    EXPECT_NEAR(fit.x_m, want.x_m, 1e-10);
    EXPECT_NEAR(fit.y_m, want.y_m, 1e-10);
    EXPECT_NEAR(fit.turn_rad, want.turn_rad, 1e-10);
    EXPECT_NEAR(fit.rmsd_m, 0, 1e-10);
    const Motion back = velocity_of(want, dt);
    EXPECT_NEAR(back.x, v.x, 1e-12);
    EXPECT_NEAR(back.y, v.y, 1e-12);
    EXPECT_NEAR(back.turn, v.turn, 1e-12);
  }
}

TEST(FourWheelOdometry, AWheelThatSpinsLeavesAResidual) {
  // Front left alone turns by d along x. Of d^2, the shift of d / 4 takes d^2 / 4, the turn of -d / (8 a) takes
  // 8 a^2 (d / 8 a)^2 = d^2 / 8; 5/8 d^2 remain, over four wheels. Next order: d / a = 5e-4 of it.
  constexpr double a = 0.2, d = 1e-4;
  const auto wheels = square(a, 0.1);
  const Fit fit = rolled(wheels, std::vector<double>{d / 0.1, 0, 0, 0}, std::vector<double>{0, 0, 0, 0});
  EXPECT_NEAR(fit.x_m, d / 4, 1e-3 * d);
  EXPECT_NEAR(fit.turn_rad, -d / (8 * a), 1e-3 * d / a);
  EXPECT_NEAR(fit.rmsd_m, std::sqrt(5.0 / 32) * d, 1e-3 * d);
}

TEST(FourWheelOdometry, SlipIsTheAngleBetweenHeadingAndMotionAsLines) {
  EXPECT_NEAR(slip_of({1, 0, 0}, front_left, 0.1), -0.1, 1e-15);
  EXPECT_NEAR(slip_of({1, 0, 0}, front_left, 0.1 + math::pi), -0.1, 1e-14);
  EXPECT_NEAR(slip_of({-1, 0, 0}, front_left, -0.2), 0.2, 1e-14);
  EXPECT_NEAR(slip_of(on_a_curve, front_left, 0.6435011087932844), 0, 1e-15);
  EXPECT_EQ(slip_of({}, front_left, 0.1), 0);
}

}  // namespace
}  // namespace sandlot::controllers::four_wheel_steer
