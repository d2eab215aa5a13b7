#include "navigation/localisation/odometry_motion.h"

#include <gtest/gtest.h>

namespace sandlot::navigation {
namespace {

struct MotionMoments {
  double x = 0, y = 0, xx = 0, yy = 0, turn = 0, turn2 = 0;
};

constexpr int motion_draws = 20'000;

MotionMoments motion_moments(MotionModel model, const MotionNoise& noise, const Pose2& step,
                             const Pose2& from) {
  const MotionSampler sampler(model, noise, step);
  MotionMoments out;
  for (int i = 0; i < motion_draws; ++i) {
    Stream random(3, entity_key("motion"), Purpose::experiment, static_cast<std::uint64_t>(i));
    const Pose2 to = sampler(from, random);
    const double x = to.x - from.x, y = to.y - from.y, turn = math::wrap_angle(to.theta - from.theta);
    out.x += x / motion_draws, out.y += y / motion_draws, out.turn += turn / motion_draws;
    out.xx += x * x / motion_draws, out.yy += y * y / motion_draws, out.turn2 += turn * turn / motion_draws;
  }
  return out;
}

TEST(OdometryMotion, WithoutNoiseItIsTheStep) {
  const MotionNoise none{0, 0, 0, 0, 0};
  const Pose2 from{1, 2, 0.7};
  for (const MotionModel model : {MotionModel::differential, MotionModel::omnidirectional})
    for (const Pose2& step : {Pose2{0.3, 0.1, 0.4}, Pose2{-0.3, 0.02, -0.2}, Pose2{0, 0, 2},
                              Pose2{0.001, -0.002, 0}, Pose2{0, 0.5, 3}, Pose2{}}) {
      Stream random(1, 2, Purpose::experiment, 0);
      const Pose2 to = MotionSampler(model, none, step)(from, random), right = compose(from, step);
      EXPECT_NEAR(to.x, right.x, 1e-12);
      EXPECT_NEAR(to.y, right.y, 1e-12);
      EXPECT_NEAR(math::wrap_angle(to.theta - right.theta), 0, 1e-12);
    }
}

// x = trans cos(a + e), with e ~ N(0, r1^2), trans ~ N(t, s^2) independent:
//   E x = t cos(a) exp(-r1^2 / 2),   E x^2 = (t^2 + s^2) (1 + cos(2 a) exp(-2 r1^2)) / 2
TEST(OdometryMotion, DifferentialMoments) {
  const MotionNoise noise{0.1, 0.05, 0.005, 0.3, 0};
  // An arc: bearing 0.3, chord 0.8, turn 0.6: rot1 = rot2 = 0.3.
  const double t = 0.8, rot1 = 0.3, rot2 = 0.3, heading = 0.5, a = heading + rot1;
  const auto [s, c] = math::sincos(rot1);
  const MotionMoments m = motion_moments(MotionModel::differential, noise, {t * c, t * s, rot1 + rot2},
                                         {4, -2, heading});
  const double r1 = 0.1 * rot1 * rot1 + 0.05 * t * t, r2 = 0.1 * rot2 * rot2 + 0.05 * t * t,
               d = 0.005 * t * t + 0.3 * (rot1 * rot1 + rot2 * rot2);
  const double shrink = math::exp(-r1 / 2);
  // Standard deviations of a mean of 20000: about 0.17 / 141 = 0.0012; five of them.
  EXPECT_NEAR(m.x, t * math::cos(a) * shrink, 0.006);
  EXPECT_NEAR(m.y, t * math::sin(a) * shrink, 0.006);
  EXPECT_NEAR(m.turn, rot1 + rot2, 5 * std::sqrt((r1 + r2) / motion_draws));
  const double square = t * t + d, twice = math::exp(-2 * r1);
  EXPECT_NEAR(m.xx, square * (1 + math::cos(2 * a) * twice) / 2, 0.01);
  EXPECT_NEAR(m.yy, square * (1 - math::cos(2 * a) * twice) / 2, 0.01);
  // A variance's relative standard deviation is sqrt(2 / n) = 1 %.
  EXPECT_NEAR(m.turn2 - m.turn * m.turn, r1 + r2, 0.05 * (r1 + r2));
  EXPECT_NEAR(m.xx + m.yy - square, 0, 5 * 2 * t * std::sqrt(d) / 141);
}

TEST(OdometryMotion, BackwardsIsAsNoisyAsForwards) {
  const MotionNoise noise{0.5, 0.01, 0.02, 0.03, 0};
  const MotionMoments ahead = motion_moments(MotionModel::differential, noise, {0.5, 0, 0}, {}),
                      back = motion_moments(MotionModel::differential, noise, {-0.5, 0, 0}, {});
  // rot1 = 0 for both: alpha1 adds nothing. Were it pi, the turn's variance would be 0.5 pi^2 * 2 = 10.
  const double turn = 2 * 0.01 * 0.25;
  EXPECT_NEAR(ahead.turn2, turn, 0.05 * turn);
  EXPECT_NEAR(back.turn2, turn, 0.05 * turn);
  EXPECT_NEAR(back.x, -0.5 * math::exp(-0.0025 / 2), 5 * 0.071 / 141);
}

TEST(OdometryMotion, TinyStepsDoNotTurnTheHeading) {
  // Two millimetres aside while it stands: a bearing of 90 degrees, which is no turn.
  const MotionNoise noise{0.2, 0, 0, 0.2, 0};
  const MotionMoments m = motion_moments(MotionModel::differential, noise, {0, 0.002, 0}, {});
  EXPECT_NEAR(m.turn2, 0, 1e-12);
  EXPECT_NEAR(m.y, 0.002, 1e-12);
}

TEST(OdometryMotion, OmnidirectionalMoments) {
  const MotionNoise noise{0.1, 0.05, 0.02, 0.03, 0.04};
  // Sideways in the robot's frame, which heads along y: the drive is along -x.
  const Pose2 step{0, 0.6, 0.4};
  const MotionMoments m = motion_moments(MotionModel::omnidirectional, noise, step, {0, 0, math::pi / 2});
  const double along = 0.02 * 0.36 + 0.03 * 0.16, across = 0.04 * 0.36 + 0.03 * 0.16,
               turn = 0.1 * 0.16 + 0.05 * 0.36;
  EXPECT_NEAR(m.x, -0.6, 5 * std::sqrt(along) / 141);
  EXPECT_NEAR(m.y, 0, 5 * std::sqrt(across) / 141);
  EXPECT_NEAR(m.turn, 0.4, 5 * std::sqrt(turn) / 141);
  EXPECT_NEAR(m.xx - m.x * m.x, along, 0.05 * along);
  EXPECT_NEAR(m.yy - m.y * m.y, across, 0.05 * across);
  EXPECT_NEAR(m.turn2 - m.turn * m.turn, turn, 0.05 * turn);
}

}  // namespace
}  // namespace sandlot::navigation
