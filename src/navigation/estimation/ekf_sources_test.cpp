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
  EXPECT_NEAR(rig.x(Vy), 0, 0.01);
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
  rig.start();
  rig.give(0, imu_at(1, {0, 0, math::pi / 2}, {}, {}, 1e-6));
  // Looking north, B at (3, 0): the antenna is at (3, 1). The robot stays; then it turns to the east.
  EXPECT_EQ(rig.give(1, fix_at(1.1, truth, {20, 30, 0})), Outcome::used);
  ASSERT_TRUE(rig.state.datum);
  EXPECT_LT(norm(to_world(*rig.state.datum, to_geodetic(truth, {20, 30, 0})) - Vec3{3, 1, 0.5}), 1e-6);
  EXPECT_NEAR(rig.x(X), 3, 1e-6);
  EXPECT_NEAR(rig.x(Y), 0, 1e-6);
  for (int i = 0; i < 50; ++i) {
    rig.give(0, imu_at(2 + 0.1 * i, {0, 0, 0}, {}, {}, 1e-6));
    rig.give(1, fix_at(2.05 + 0.1 * i, truth, {21, 29, 0}, 1e-4));  // the antenna one ahead in the east
  }
  EXPECT_NEAR(rig.x(X), 3, 0.02);
  EXPECT_NEAR(rig.x(Y), 0, 0.02);
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
