// Kinds of sources in the filter: differences, relative poses, fixes, accelerometers.
#include <gtest/gtest.h>

#include "navigation/estimation/test_messages.h"

namespace sandlot::navigation::ekf {
namespace {

using namespace test;

TEST(EkfSources, DifferencesDriveTheVelocity) {
  std::vector<Sensor> sensors = {sensor("vo", SensorKind::pose, {X, Y, Yaw})};
  sensors[0].differential = true;
  Rig rig(sensors);
  // Along a circle of radius 2 at 0.5 rad/s, seen from a frame that is elsewhere.
  const auto pose = [&](double t) {
    const double yaw = 0.7 + 0.5 * t;
    return pose_at(t, {30 + 2 * math::sin(yaw), -2 * math::cos(yaw), 0}, {0, 0, yaw}, 1e-6, 1e-6);
  };
  EXPECT_EQ(rig.give(0, pose(0.1)), Outcome::started);
  EXPECT_FALSE(rig.state.core.known);
  for (int i = 2; i <= 100; ++i) EXPECT_EQ(rig.give(0, pose(0.1 * i)), Outcome::used);
  EXPECT_NEAR(rig.x(Vx), 1, 0.01);
  // The model goes straight for the tenth of a second between two poses, along the chord: v w dt / 2 of it is sideways.
  EXPECT_NEAR(rig.x(Vy), 0.025, 0.01);
  EXPECT_NEAR(rig.x(Vyaw), 0.5, 0.01);
  // It goes through its own frame from 0: the same circle, by 0.5 * 9.8 rad from where it began.
  EXPECT_NEAR(rig.x(X), 2 * math::sin(4.9), 0.1);
  EXPECT_NEAR(rig.x(Y), 2 - 2 * math::cos(4.9), 0.1);
  // After a gap the first one starts again.
  EXPECT_EQ(rig.give(0, pose(12)), Outcome::started);
  EXPECT_EQ(rig.give(0, pose(12.1)), Outcome::used);
}

TEST(EkfSources, AccumulatedErrorsThatDoNotGrow) {
  std::vector<Sensor> sensors = {sensor("wheels", SensorKind::pose, {X})};
  sensors[0].differential = true;
  sensors[0].pose_errors = PoseErrors::accumulated;
  Rig rig(sensors);
  rig.give(0, pose_at(0.1, {}, {}, 0, 0.01));  // odometry begins with no error at all
  EXPECT_EQ(rig.give(0, pose_at(0.2, {0.1, 0, 0}, {}, 0.0001, 0.01)), Outcome::used);
  EXPECT_NEAR(rig.x(Vx), 1, 1e-9);
  EXPECT_NEAR(rig.variance(Vx), 0.0001 / 0.01, 1e-12);
  EXPECT_EQ(rig.give(0, pose_at(0.3, {0.2, 0, 0}, {}, 0.0001, 0.01)), Outcome::bad_covariance);
  rig.spec.sensors[0].deviation.assign(states, 0);
  rig.spec.sensors[0].deviation[Vx] = 0.2;
  EXPECT_EQ(rig.give(0, pose_at(0.4, {0.3, 0, 0}, {}, 0.0001, 0.01)), Outcome::used);
}

// An outlier of a source with independent errors leaves the pose before it: the next difference goes past it. One whose errors
// accumulate has really jumped: its next difference begins there.
TEST(EkfSources, WhatCountsAfterARejectedDifference) {
  for (const PoseErrors errors : {PoseErrors::independent, PoseErrors::accumulated}) {
    std::vector<Sensor> sensors = {sensor("vo", SensorKind::pose, {X})};
    sensors[0].differential = true;
    sensors[0].pose_errors = errors;
    sensors[0].pose_rejection_threshold = 5;
    Rig rig(sensors);
    rig.spec.initial_covariance.fill(1e-6);
    rig.start();
    double variance = 0.01;
    const auto give = [&](double t, double x) {
      return rig.give(0, pose_at(t, {x, 0, 0}, {}, variance += 0.01, 0.01));
    };
    give(1, 0);
    EXPECT_EQ(give(1.1, 0), Outcome::used);
    EXPECT_EQ(give(1.2, 50), Outcome::gated);
    const bool jumps = errors == PoseErrors::accumulated;
    EXPECT_EQ(give(1.3, jumps ? 50 : 0), Outcome::used);
    EXPECT_EQ(give(1.4, jumps ? 0 : 50), Outcome::gated);
    EXPECT_NEAR(rig.x(X), 0, 0.1);
  }
}

// As deviations of the mean velocity, over a second: 0.1 m.
TEST(EkfSources, DeviationsOfDifferences) {
  std::vector<Sensor> sensors = {sensor("vo", SensorKind::odometry, {X, Vy})};
  sensors[0].differential = true;
  sensors[0].pose_errors = PoseErrors::as_twist;
  sensors[0].deviation.assign(states, 0);
  sensors[0].deviation[Vx] = 0.1;
  Rig rig(sensors);
  rig.spec.process_noise.fill(0);
  rig.spec.initial_covariance.fill(1e-12);
  rig.spec.initial_covariance[Vx] = 0.04;
  rig.start();
  const auto give = [&](double t, double x) {
    return rig.give(
        0, msg::Odometry{
               {Time::from_s(t), ""}, "", pose_at(t, {x, 0, 0}).pose, twist_at(t, {}, {}, 1e-6).twist});
  };
  EXPECT_EQ(give(1, 0), Outcome::used);  // Vy, which makes the filter known
  EXPECT_EQ(give(2, 7), Outcome::used);  // the pose only begins: it came before the filter was known
  ASSERT_EQ(rig.x(X), 0);
  EXPECT_EQ(give(3, 8), Outcome::used);
  // Of the way of 1 m, 0.04 / (0.04 + 0.01) is believed.
  EXPECT_NEAR(rig.x(Vx), 0.8, 1e-6);
  // The velocity was the same in the second before: where the way began is corrected with where it ended.
  EXPECT_NEAR(rig.state.core.extra.x[X], 1.6, 1e-6);
  EXPECT_NEAR(rig.x(X), 1.6, 1e-6);
}

TEST(EkfSources, RelativePosesCountFromTheFirst) {
  std::vector<Sensor> sensors = {sensor("vo", SensorKind::pose, {X, Y, Yaw})};
  sensors[0].relative = true;
  Rig rig(sensors);
  for (int i = 0; i < 100; ++i)  // north, from (7, 8), looking north
    EXPECT_EQ(rig.give(0, pose_at(1 + 0.1 * i, {7, 8 + 0.1 * i, 0}, {0, 0, math::pi / 2}, 1e-4, 1e-4)),
              Outcome::used);
  EXPECT_NEAR(rig.x(X), 9.9, 0.02);  // ahead
  EXPECT_NEAR(rig.x(Y), 0, 0.02);
  EXPECT_NEAR(rig.x(Yaw), 0, 0.02);
}

TEST(EkfSources, FirstFixIsWhereTheRobotIs) {
  const Datum truth{.latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300};
  std::vector<Sensor> sensors = {sensor("imu", SensorKind::imu, {Yaw}),
                                 sensor("gps", SensorKind::gps, {X, Y})};
  sensors[1].mount.p = {1, 0, 0.5};  // antenna ahead
  Rig rig(sensors);
  rig.spec.initial_state[X] = 3;
  rig.spec.initial_covariance.fill(1e-9);
  rig.start();
  rig.give(0, imu_at(1, {0, 0, math::pi / 2}, {}, {}, 1e-6));
  // Looking north, B at (3, 0): the antenna is at (3, 1). The robot stays; then it turns to the east.
  EXPECT_EQ(rig.give(1, fix_at(1.1, truth, {20, 30, 0}, 1e-4)), Outcome::started);
  ASSERT_TRUE(rig.state.datum);
  EXPECT_LT(norm(to_world(*rig.state.datum, to_geodetic(truth, {20, 30, 0})) - Vec3{3, 1, 0.5}), 1e-6);
  EXPECT_NEAR(rig.x(X), 3, 1e-6);
  EXPECT_NEAR(rig.x(Y), 0, 1e-6);
  for (int i = 0; i <= 50; ++i) {
    const double yaw = math::pi / 2 * (1 - i / 50.0);
    rig.give(0, imu_at(2 + 0.1 * i, {0, 0, yaw}, {}, {}, 1e-6));
    EXPECT_EQ(rig.give(1, fix_at(2.05 + 0.1 * i, truth, {20 + math::cos(yaw), 29 + math::sin(yaw), 0}, 1e-4)),
              Outcome::used);
  }
  EXPECT_NEAR(rig.x(X), 3, 0.03);
  EXPECT_NEAR(rig.x(Y), 0, 0.03);
}

// Robot on a slope that the filter does not know at first, with the antenna h above B: by the first fix the filter thinks the antenna is
// above B, while it is h sin(pitch) beside. When the slope is known, it is the datum that has to move, not the robot. By hand: the
// datum's place e and the pitch share h s^2, and e has the variance of B, N of the fix and h^2 s^2, so a pitch that is
// measured exactly moves e by h pitch and leaves the first two.
TEST(EkfSources, ATiltThatIsKnownLaterMovesTheDatumNotTheRobot) {
  constexpr double h = 2, pitch = 0.16, N = 1e-4;
  const Datum truth{.latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300};
  std::vector<Sensor> sensors = {sensor("imu", SensorKind::imu, {Pitch}),
                                 sensor("gps", SensorKind::gps, {X, Y})};
  sensors[1].mount.p = {0, 0, h};
  Rig rig(sensors);
  rig.spec.process_noise.fill(0);
  rig.spec.initial_covariance.fill(1e-12);
  rig.spec.initial_covariance[Pitch] = 0.2 * 0.2;
  rig.spec.initial_covariance[X] = 1e-4;
  rig.start();
  const Vec3 antenna{7 + h * math::sin(pitch), 8, 0};
  EXPECT_EQ(rig.give(1, fix_at(1, truth, antenna, N)), Outcome::started);
  const ExtraStates& extra = rig.state.core.extra;
  EXPECT_NEAR(extra.variance(0, 0), 1e-4 + N + h * h * 0.2 * 0.2, 1e-9);
  EXPECT_EQ(rig.give(0, imu_at(1.1, {0, pitch, 0}, {}, {}, 1e-12)), Outcome::used);
  EXPECT_NEAR(rig.x(Pitch), pitch, 1e-6);
  EXPECT_NEAR(extra.x[0], h * pitch, 1e-6);
  EXPECT_NEAR(extra.variance(0, 0), 1e-4 + N, 1e-8);
  EXPECT_NEAR(rig.x(X), 0, 1e-9);
  EXPECT_NEAR(rig.variance(X), 1e-4, 1e-9);
  // B and the datum are wrong together: the second fix says nothing new about B but that it still is there.
  EXPECT_EQ(rig.give(1, fix_at(1.2, truth, antenna, N)), Outcome::used);
  EXPECT_NEAR(rig.x(X), 0, 1e-9);
  EXPECT_NEAR(rig.variance(X), 1e-4, 1e-9);
  // Two fixes leave N / 2 of the datum's own error.
  EXPECT_NEAR(extra.variance(0, 0), 1e-4 + N / 2, 1e-8);
}

TEST(EkfSources, BadFixes) {
  const Datum datum{.latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300};
  Rig rig({sensor("gps", SensorKind::gps, {X, Y}), sensor("gps3", SensorKind::gps, {X, Y, Z})});
  const auto answer = [&](std::size_t index, auto&& change) {
    msg::NavSatFix fix = fix_at(1, datum, {1, 2, 3});
    change(fix);
    State state = rig.state;
    return add(rig.spec, state, index, fix);
  };
  EXPECT_EQ(answer(0, [](auto& f) { f.status.status = -1; }), Outcome::unmeasured);
  EXPECT_EQ(answer(0, [](auto& f) { f.latitude = 90.1; }), Outcome::bad_value);
  EXPECT_EQ(answer(0, [](auto& f) { f.longitude = NAN; }), Outcome::bad_value);
  EXPECT_EQ(answer(0, [](auto& f) { f.altitude = INFINITY; }), Outcome::bad_value);
  EXPECT_EQ(answer(0, [](auto& f) { f.altitude = NAN; }), Outcome::queued);
  EXPECT_EQ(answer(1, [](auto& f) { f.altitude = NAN; }), Outcome::bad_value);
  EXPECT_EQ(answer(0, [](auto& f) { f.position_covariance_type = 0; }), Outcome::bad_covariance);
  EXPECT_EQ(answer(0, [](auto& f) { f.position_covariance = {}; }), Outcome::bad_covariance);
  EXPECT_EQ(answer(0, [](auto& f) { f.position_covariance[0] = -1; }), Outcome::bad_covariance);
  msg::NavSatFix bad = fix_at(1, datum, {});
  bad.latitude = NAN;
  EXPECT_EQ(add(rig.spec, rig.state, 0, bad), Outcome::bad_value);
  EXPECT_FALSE(rig.state.datum);  // a bad one sets no datum
}

TEST(EkfSources, GravityByTheEstimateWhenTheImuHasNoOrientation) {
  std::vector<Sensor> sensors = {sensor("pose", SensorKind::pose, {Roll, Pitch, Yaw}),
                                 sensor("imu", SensorKind::imu, {Ax, Ay, Az})};
  sensors[1].remove_gravitational_acceleration = true;
  Rig rig(sensors);
  rig.spec.initial_covariance.fill(1e-9);
  rig.start();
  rig.give(0, pose_at(1, {}, {0.3, 0, 0}, 0.01, 1e-9));
  const double g = rig.spec.gravity_mps2;
  msg::Imu imu = imu_at(1, {}, {}, {0, g * math::sin(0.3), g * math::cos(0.3)}, 1e-9);
  imu.orientation_covariance[0] = -1;
  EXPECT_EQ(rig.give(1, imu), Outcome::used);
  EXPECT_LT(rig.state.sensors[1].squared_distance, 1e-6);
}

}  // namespace
}  // namespace sandlot::navigation::ekf
