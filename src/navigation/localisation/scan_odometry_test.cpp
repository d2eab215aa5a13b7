#include "navigation/localisation/scan_odometry.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "navigation/localisation/test_rooms.h"

namespace sandlot::navigation::laser {
namespace {

using namespace test;

Stream laser_stream(std::uint64_t sample) {
  return Stream(21, entity_key("laser odometry"), Purpose::experiment, sample);
}

msg::LaserScan laser_scan(const Room& room, const Laser& laser, const Pose2& X, double t_s, Stream& random) {
  return scan_at(room, laser, X, Time::from_s(t_s), random);
}

Outcome laser_update(const Spec& spec, State& state, const msg::LaserScan& scan, const Pose& X_BL,
                     const Pose2* motion = nullptr) {
  Workspace work;
  return update(spec, state, work, scan, X_BL, motion);
}

TEST(LaserOdometry, OneStepByHand) {
  const Room room = furnished_room();
  Laser laser;
  laser.deviation_m = 0;
  Stream random = laser_stream(0);
  const Spec spec;
  State state = *begin(spec);
  const Pose2 from{3.2, 2.6, 0.4}, step{0.12, 0.05, -0.1};
  EXPECT_EQ(laser_update(spec, state, laser_scan(room, laser, from, 1, random), laser.X_BL),
            Outcome::started);
  EXPECT_EQ(laser_update(spec, state, laser_scan(room, laser, compose(from, step), 1.1, random), laser.X_BL),
            Outcome::matched);
  // Without noise what is left are pairs at corners.
  EXPECT_NEAR(state.pose.x, step.x, 2e-3);
  EXPECT_NEAR(state.pose.y, step.y, 2e-3);
  EXPECT_NEAR(state.pose.theta, step.theta, 1e-3);
  EXPECT_EQ(state.observable, 3);
  EXPECT_EQ(state.keys, 1u);
  // Its covariance: the deviation of 1 cm over the square root of the number of pairs, about; of a turn at 3 m.
  EXPECT_GT(std::sqrt(state.covariance[0]), 0.01 / std::sqrt(181));
  EXPECT_LT(std::sqrt(state.covariance[0]), 0.01 * 3 / std::sqrt(181));
  EXPECT_LT(std::sqrt(state.covariance[8]), 0.003);
}

TEST(LaserOdometry, DriftsLittleOnALoop) {
  const Room room = furnished_room();
  const Laser laser;
  Stream random = laser_stream(1);
  const Spec spec;
  State state = *begin(spec);
  Wanderer robot{room, {3.2, 2.6, 0.4}, {}};
  const Pose2 start = robot.X_MB;
  double driven_m = 0;
  for (int k = 0; k < 100; ++k) {
    const Pose2 before = robot.X_MB;
    const Outcome outcome = laser_update(
        spec, state, laser_scan(room, laser, robot.X_MB, 1 + 0.1 * k, random), laser.X_BL);
    ASSERT_EQ(outcome, k == 0 ? Outcome::started : Outcome::matched) << k;
    if (k == 99) break;
    robot.go(random);
    driven_m += distance(robot.X_MB, before);
  }
  const Pose2 truth = relative(start, robot.X_MB);
  EXPECT_GT(driven_m, 4);
  EXPECT_LT(distance(state.pose, truth), 0.01 * driven_m);
  EXPECT_LT(turn(state.pose, truth), 0.01);
  EXPECT_GT(state.keys, 5u);
}

// Past the end of a partition of 4 cm: one face in the key scan, the other one in the next.
TEST(LaserOdometry, DoesNotTakeTheBackOfAWallForItsFront) {
  const Room room{6, 4, {{{3, 0.6}, 0.02, 0.6, 0}}};
  Laser laser;
  laser.deviation_m = 0;
  Stream random = laser_stream(9);
  const Spec spec;
  State state = *begin(spec);
  const Pose2 from{2.7, 2.1, -math::pi / 2}, to{3.35, 2.1, -math::pi / 2};
  const Pose2 step = relative(from, to);
  ASSERT_EQ(laser_update(spec, state, laser_scan(room, laser, from, 1, random), laser.X_BL),
            Outcome::started);
  ASSERT_EQ(laser_update(spec, state, laser_scan(room, laser, to, 1.1, random), laser.X_BL, &step),
            Outcome::matched);
  EXPECT_NEAR(state.pose.x, step.x, 2e-3);
  EXPECT_NEAR(state.pose.y, step.y, 2e-3);
}

TEST(LaserOdometry, ACorridorKeepsTheGuess) {
  const Room corridor{60, 2, {}};
  Laser laser;
  laser.range_max_m = 8;
  Stream random = laser_stream(2);
  const Spec spec;
  State state = *begin(spec);
  const Pose2 from{20, 0.9, 0.1}, to{20.2, 1.0, 0.05};
  ASSERT_EQ(laser_update(spec, state, laser_scan(corridor, laser, from, 1, random), laser.X_BL),
            Outcome::started);
  const Pose2 wheels = compose(relative(from, to), {0.05, 0, 0});
  ASSERT_EQ(laser_update(spec, state, laser_scan(corridor, laser, to, 1.1, random), laser.X_BL, &wheels),
            Outcome::matched);
  EXPECT_EQ(state.observable, 2);
  const Pose2 X_MB = compose(from, state.pose);
  EXPECT_NEAR(X_MB.x, 20.25, 0.01) << "as the wheels say";
  EXPECT_NEAR(X_MB.y, 1.0, 0.01);
  EXPECT_NEAR(X_MB.theta, 0.05, 0.005);
  // Unknown along the corridor, which runs at -0.1 rad in the frame of the first scan, and known across it.
  Eigen::Matrix3d P;
  for (int i = 0; i < 9; ++i) P(i / 3, i % 3) = state.covariance[static_cast<std::size_t>(i)];
  const Eigen::Vector3d along(math::cos(-0.1), math::sin(-0.1), 0), across(-along.y(), along.x(), 0);
  EXPECT_GT(along.dot(P * along), 0.9 * unknown_variance);
  EXPECT_LT(across.dot(P * across), 1e-3 * unknown_variance);
  EXPECT_LT(P(2, 2), 1e-3 * unknown_variance);
  // Without wheels the last motion goes on.
  ASSERT_EQ(laser_update(spec, state, laser_scan(corridor, laser, compose(to, {0.2, 0, 0}), 1.2, random),
                         laser.X_BL),
            Outcome::matched);
  EXPECT_NEAR(compose(from, state.pose).x, 20.25 + 0.25, 0.03);
}

TEST(LaserOdometry, LostWhenNothingFits) {
  const Room room = furnished_room(), small{2, 1.5, {}};
  const Laser laser;
  Stream random = laser_stream(3);
  const Spec spec;
  State state = *begin(spec);
  laser_update(spec, state, laser_scan(room, laser, {3.2, 2.6, 0.4}, 1, random), laser.X_BL);
  const Pose2 wheels{0.1, 0, 0};
  EXPECT_EQ(
      laser_update(spec, state, laser_scan(small, laser, {1, 0.7, 0}, 1.1, random), laser.X_BL, &wheels),
      Outcome::lost);
  EXPECT_NEAR(state.pose.x, 0.1, 1e-12);
  EXPECT_EQ(state.observable, 0);
  EXPECT_GE(state.covariance[0], unknown_variance);
  EXPECT_EQ(state.keys, 2u);
  // From there it goes on.
  EXPECT_EQ(laser_update(spec, state, laser_scan(small, laser, {1.05, 0.7, 0}, 1.2, random), laser.X_BL),
            Outcome::matched);
  EXPECT_NEAR(state.pose.x, 0.15, 0.01);
  EXPECT_GE(state.covariance[0], unknown_variance) << "what was lost stays unknown";
}

TEST(LaserOdometry, BadInputIsAnswered) {
  const Room room = furnished_room();
  const Laser laser;
  Stream random = laser_stream(4);
  const Spec spec;
  State state = *begin(spec);
  const Pose2 at{3.2, 2.6, 0.4};
  ASSERT_EQ(laser_update(spec, state, laser_scan(room, laser, at, 5, random), laser.X_BL), Outcome::started);
  const msg::LaserScan good = laser_scan(room, laser, at, 5.1, random);
  const auto answer = [&](auto&& change, const Pose2* motion = nullptr) {
    State copy = state;
    msg::LaserScan scan = good;
    Pose mount = laser.X_BL;
    change(scan, mount);
    const Outcome outcome = laser_update(spec, copy, scan, mount, motion);
    EXPECT_EQ(copy.count(outcome), state.count(outcome) + 1);
    if (outcome != Outcome::matched && outcome != Outcome::rewound) {
      EXPECT_EQ(copy.at, state.at);
      EXPECT_EQ(copy.keys, state.keys);
    }
    return outcome;
  };
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(answer([](auto&, auto&) {}), Outcome::matched);
  EXPECT_EQ(answer([](auto& s, auto&) { s.ranges.clear(); }), Outcome::no_beams);
  for (const float bad : {nan, inf, -inf, -1.0f, 1e30f})
    EXPECT_EQ(answer([&](auto& s, auto&) { s.ranges.assign(181, bad); }), Outcome::no_beams);
  EXPECT_EQ(answer([](auto& s, auto&) { s.ranges.resize(6); }), Outcome::no_beams);
  EXPECT_EQ(answer([&](auto& s, auto&) { s.angle_min = nan; }), Outcome::bad_scan);
  EXPECT_EQ(answer([](auto&, auto& m) { m.q = {0, 0, 0, 0}; }), Outcome::bad_mount);
  EXPECT_EQ(answer([](auto& s, auto&) { s.header.stamp = Time{-5}; }), Outcome::bad_stamp);
  EXPECT_EQ(answer([](auto& s, auto&) { s.header.stamp = Time::from_s(5); }), Outcome::late);
  EXPECT_EQ(answer([](auto& s, auto&) { s.header.stamp = Time::from_s(4.5); }), Outcome::late);
  EXPECT_EQ(answer([](auto& s, auto&) { s.header.stamp = Time::from_s(3); }), Outcome::rewound);
  const Pose2 wrong{std::nan(""), 0, 0}, huge{1e9, 0, 0};
  EXPECT_EQ(answer([](auto&, auto&) {}, &wrong), Outcome::bad_guess);
  EXPECT_EQ(answer([](auto&, auto&) {}, &huge), Outcome::bad_guess);
  EXPECT_EQ(answer([](auto& s, auto&) { s.ranges.assign(200'000, 3.0f); }), Outcome::no_beams)
      << "of a ring so full the chosen points are no neighbours";

  const auto refusal = [](auto&& change) {
    Spec bad;
    change(bad);
    const auto begun = begin(bad);
    return begun ? "" : begun.error().text();
  };
  EXPECT_EQ(refusal([](Spec&) {}), "");
  EXPECT_NE(refusal([](Spec& s) { s.reach_m = -1; }).find("reach"), std::string::npos);
  EXPECT_NE(refusal([](Spec& s) { s.max_points = 0; }).find("max_points"), std::string::npos);
  EXPECT_NE(refusal([](Spec& s) { s.key_distance_m = std::nan(""); }).find("key_distance"),
            std::string::npos);
  EXPECT_NE(refusal([](Spec& s) { s.min_share = 0.9; }).find("key_share"), std::string::npos);
  EXPECT_NE(refusal([](Spec& s) { s.min_range_m = 100; }).find("min_range"), std::string::npos);
}

TEST(LaserOdometry, GoesOnFromACopyToTheBit) {
  const Room room = furnished_room();
  const Laser laser;
  Stream random = laser_stream(5);
  const Spec spec;
  State state = *begin(spec);
  Wanderer robot{room, {3.2, 2.6, 0.4}, {}};
  State copy;
  for (int k = 0; k < 12; ++k) {
    if (k == 6) {
      ByteWriter bytes;
      write(bytes, state);
      ByteReader reader(bytes.bytes());
      read(reader, copy);
      ASSERT_TRUE(reader.ok() && copy.fits(spec));
    }
    const msg::LaserScan scan = laser_scan(room, laser, robot.X_MB, 1 + 0.1 * k, random);
    laser_update(spec, state, scan, laser.X_BL);
    if (k >= 6) laser_update(spec, copy, scan, laser.X_BL);
    robot.go(random);
  }
  ByteWriter a, b;
  write(a, state);
  write(b, copy);
  EXPECT_TRUE(std::equal(a.bytes().begin(), a.bytes().end(), b.bytes().begin(), b.bytes().end()));
  std::swap(copy.key.front(), copy.key.back());
  EXPECT_FALSE(copy.fits(spec)) << "the key's points are sorted";
  copy = state;
  copy.pose.x = std::nan("");
  EXPECT_FALSE(copy.fits(spec));
}

TEST(SlowLaserOdometry, CovarianceOfOneStepIsThatOfItsErrors) {
  const Room room = furnished_room();
  Laser laser;
  laser.deviation_m = 0.015;
  const Spec spec;
  double nees = 0;
  int matched = 0;
  for (std::uint64_t k = 0; k < 300; ++k) {
    Stream random = laser_stream(100 + k);
    const Pose2 from = placed(room, random),
                step{random.uniform(-0.2, 0.2), random.uniform(-0.1, 0.1), random.uniform(-0.2, 0.2)};
    State state = *begin(spec);
    laser_update(spec, state, laser_scan(room, laser, from, 1, random), laser.X_BL);
    if (laser_update(spec, state, laser_scan(room, laser, compose(from, step), 1.1, random), laser.X_BL) !=
            Outcome::matched ||
        state.observable < 3)
      continue;
    ++matched;
    Eigen::Matrix3d P;
    for (int i = 0; i < 9; ++i) P(i / 3, i % 3) = state.covariance[static_cast<std::size_t>(i)];
    const Eigen::Vector3d e(state.pose.x - step.x, state.pose.y - step.y,
                            math::wrap_angle(state.pose.theta - step.theta));
    nees += e.dot(P.inverse() * e);
  }
  std::printf("%d of 300 matched, NEES %.2f of 3\n", matched, nees / matched);
  EXPECT_GE(matched, 295);
  EXPECT_LT(nees / matched, 6);
  EXPECT_GT(nees / matched, 1);
}

TEST(SlowLaserOdometry, DriftIsBelowOnePercent) {
  const Room room = furnished_room();
  const Laser laser;
  const Spec spec;
  double worst = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Stream random = laser_stream(5000 + seed);
    State state = *begin(spec);
    Wanderer robot{room, placed(room, random), {}};
    const Pose2 start = robot.X_MB;
    double driven_m = 0;
    for (int k = 0; k < 400; ++k) {
      const Pose2 before = robot.X_MB;
      ASSERT_NE(
          laser_update(spec, state, laser_scan(room, laser, robot.X_MB, 1 + 0.1 * k, random), laser.X_BL),
          Outcome::lost);
      if (k == 399) break;
      robot.go(random);
      driven_m += distance(robot.X_MB, before);
    }
    worst = std::max(worst, distance(state.pose, relative(start, robot.X_MB)) / driven_m);
  }
  std::printf("worst drift %.2f %% of the path\n", 100 * worst);
  EXPECT_LT(worst, 0.01);
}

}  // namespace
}  // namespace sandlot::navigation::laser
