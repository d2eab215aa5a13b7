#include "navigation/estimation/sensor.h"

#include <gtest/gtest.h>

#include "navigation/estimation/test_messages.h"

namespace sandlot::navigation::ekf {
namespace {

using namespace test;

Sample pose_sample(Vec3 p, Vec3 rpy, double linear, double angular) {
  Samples out;
  EXPECT_EQ(to_samples(sensor("s", SensorKind::pose, {X, Y, Z, Roll, Pitch, Yaw}),
                       pose_at(0, p, rpy, linear, angular).pose, out),
            Outcome::queued);
  return out.part[0];
}
double cov(const Sample& s, std::size_t i, std::size_t j) { return s.covariance[triangle_index(i, j)]; }

TEST(EkfSensor, DifferenceAlongAnArcIsTheConstantTwist) {
  // A circle of radius 2 at 0.5 rad/s for 0.4 s from a heading of 3 rad, which crosses pi: 1 m/s ahead. The chord is shorter than
  // the arc by (0.2)^2 / 6.
  const double r = 2, w = 0.5, dt = 0.4, a = 3.0, b = a + w * dt;
  const auto on_circle = [&](double heading) {
    return Vec3{5 + r * math::sin(heading), 7 - r * math::cos(heading), 0};
  };
  const Sample from = pose_sample(on_circle(a), {0, 0, a}, 0.01, 0.01);
  const Sample to = pose_sample(on_circle(b), {0, 0, b}, 0.01, 0.01);
  Sample twist;
  difference(from, to, PoseErrors::independent, dt, twist);
  EXPECT_EQ(twist.part, Part::twist);
  EXPECT_NEAR(twist.value[0], 2 * r * math::sin(w * dt / 2) / dt, 1e-12);
  EXPECT_NEAR(twist.value[1], 0, 1e-12);
  EXPECT_NEAR(twist.value[5], w, 1e-12);
  EXPECT_NEAR(twist.value[3], 0, 1e-12);
}

TEST(EkfSensor, DifferenceOfIndependentPoses) {
  // 3 m along y, looking along y, in 0.5 s. Along the way both variances add; across it the earlier heading's too, times
  // the way squared.
  const Sample from = pose_sample({1, 1, 0}, {0, 0, math::pi / 2}, 0.01, 0.02);
  const Sample to = pose_sample({1, 4, 0}, {0, 0, math::pi / 2}, 0.03, 0.05);
  Sample twist;
  difference(from, to, PoseErrors::independent, 0.5, twist);
  EXPECT_NEAR(twist.value[0], 6, 1e-12);
  EXPECT_NEAR(cov(twist, 0, 0), 0.04 / 0.25, 1e-12);
  EXPECT_NEAR(cov(twist, 1, 1), (0.04 + 9 * 0.02) / 0.25, 1e-12);
  EXPECT_NEAR(cov(twist, 5, 5), 0.07 / 0.25, 1e-12);
  // A heading at the start that is too great by e makes the way seem to go to the right, by 3 e, and the turn less, by e.
  EXPECT_NEAR(cov(twist, 1, 5), 3 * 0.02 / 0.25, 1e-12);
  EXPECT_NEAR(cov(twist, 0, 1), 0, 1e-12);
}

TEST(EkfSensor, DifferenceOfAccumulatedPosesIsTheStep) {
  // Dead reckoning adds a step d with the covariance D in the robot's frame: C_b = J C_a J^T + R D R^T.
  const double yaw = 0.8, way = 2;
  const auto [s, c] = math::sincos(yaw);
  const Vec3 a{1, -1, 0}, b{1 + way * c, -1 + way * s, 0};
  Sample from = pose_sample(a, {0, 0, yaw}, 0.5, 0.25), to = pose_sample(b, {0, 0, yaw}, 1, 1);
  const double along = 0.04, across = 0.01, turn = 0.003, height = 0.002;
  // In the plane: position errors move with the heading's by the way across, (-way s, way c).
  Triangle C{};
  const auto put = [&](std::size_t i, std::size_t j, double v) { C[triangle_index(i, j)] = v; };
  put(0, 0, 0.5 + 0.25 * way * way * s * s + along * c * c + across * s * s);
  put(1, 1, 0.5 + 0.25 * way * way * c * c + along * s * s + across * c * c);
  put(1, 0, -0.25 * way * way * s * c + (along - across) * s * c);
  put(5, 0, -0.25 * way * s), put(5, 1, 0.25 * way * c);
  // z moves with roll and pitch: z += (s roll - c pitch) way.
  put(2, 2, 0.5 + 0.25 * way * way + height), put(3, 2, 0.25 * way * s), put(4, 2, -0.25 * way * c);
  put(3, 3, 0.25 + turn), put(4, 4, 0.25 + turn), put(5, 5, 0.25 + turn);
  to.covariance = C;
  Sample twist;
  difference(from, to, PoseErrors::accumulated, 1, twist);
  const double expected[6] = {along, across, height, turn, turn, turn};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      EXPECT_NEAR(cov(twist, i, j), i == j ? expected[i] : 0, 1e-12) << i << j;
}

TEST(EkfSensor, TwistOfAMountThatIsTurnedAndAhead) {
  // S is 1 m ahead of B, turned by 90 degrees to the left. B turns at 0.5 rad/s and goes ahead at 2 m/s: S moves at
  // (2, 0.5) in B's axes, which are (0.5, -2) in its own.
  Sensor s = sensor("s", SensorKind::twist, {Vx, Vy, Vyaw});
  s.mount = pose_from_rpy({1, 0, 0}, {0, 0, math::pi / 2});
  Samples out;
  ASSERT_EQ(to_samples(s, twist_at(0, {0.5, -2, 0}, {0, 0, 0.5}, 0.01).twist, out), Outcome::queued);
  EXPECT_NEAR(out.part[0].value[0], 2, 1e-12);
  EXPECT_NEAR(out.part[0].value[1], 0, 1e-12);
  EXPECT_NEAR(out.part[0].value[5], 0.5, 1e-12);
  EXPECT_NEAR(cov(out.part[0], 0, 0), 0.01, 1e-12);
  EXPECT_NEAR(cov(out.part[0], 1, 1), 0.02, 1e-12);   // and the rate's, at 1 m
  EXPECT_NEAR(cov(out.part[0], 1, 5), -0.01, 1e-12);  // v_y = v_Sy - 1 m * w
}

TEST(EkfSensor, TwistOfAMountAhead) {
  Sensor s = sensor("s", SensorKind::twist, {Vx, Vy, Vyaw});
  s.mount.p = {2, 0, 0};
  Samples out;
  ASSERT_EQ(to_samples(s, twist_at(0, {1, 1, 0}, {0, 0, 0.5}, 0.01).twist, out), Outcome::queued);
  EXPECT_NEAR(out.part[0].value[0], 1, 1e-12);
  EXPECT_NEAR(out.part[0].value[1], 0, 1e-12);
  EXPECT_NEAR(cov(out.part[0], 0, 0), 0.01, 1e-12);
  EXPECT_NEAR(cov(out.part[0], 1, 1), 0.05, 1e-12);  // 0.01 (1 + 2^2)
}

TEST(EkfSensor, PoseOfAMountAhead) {
  Sensor s = sensor("s", SensorKind::pose, {X, Y, Yaw});
  s.mount = pose_from_rpy({2, 0, 0}, {0, 0, 0});
  Samples out;
  ASSERT_EQ(to_samples(s, pose_at(0, {5, 5, 0}, {0, 0, math::pi / 2}, 0.01, 0.02).pose, out),
            Outcome::queued);
  EXPECT_NEAR(out.part[0].value[0], 5, 1e-12);
  EXPECT_NEAR(out.part[0].value[1], 3, 1e-12);
  EXPECT_NEAR(cov(out.part[0], 0, 0), 0.01 + 4 * 0.02, 1e-12);
  EXPECT_NEAR(cov(out.part[0], 1, 1), 0.01, 1e-12);
  EXPECT_NEAR(cov(out.part[0], 0, 5), 2 * 0.02,
              1e-12);  // turning to the left moves B, behind, to the right: +x
}

TEST(EkfSensor, GravityAtRestOnASlope) {
  // Nose up by 0.2 rad is a pitch of -0.2: at rest the accelerometer reads g (sin 0.2, 0, cos 0.2).
  const double g = 9.80665;
  Sensor s = sensor("imu", SensorKind::imu, {Ax, Ay, Az});
  s.remove_gravitational_acceleration = true;
  const msg::Imu at_rest = imu_at(0, {0, -0.2, 1}, {}, {g * math::sin(0.2), 0, g * math::cos(0.2)});
  Samples out;
  ASSERT_EQ(to_samples(s, at_rest, g, out), Outcome::queued);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(out.part[0].value[i], 0, 1e-12);
  EXPECT_FALSE(out.part[0].holds_gravity);
  // Mounted upside down: turned by pi about x. It reads in its own axes; its orientation is its own.
  s.mount.q = {0, 1, 0, 0};
  msg::Imu below = at_rest;
  below.orientation = at_rest.orientation * s.mount.q;
  below.linear_acceleration = {g * math::sin(0.2), 0, -g * math::cos(0.2)};
  out = {};
  ASSERT_EQ(to_samples(s, below, g, out), Outcome::queued);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(out.part[0].value[i], 0, 1e-12);
  // Without an orientation it is left to the estimate's.
  below.orientation_covariance[0] = -1;
  out = {};
  ASSERT_EQ(to_samples(s, below, g, out), Outcome::queued);
  EXPECT_TRUE(out.part[0].holds_gravity);
  EXPECT_NEAR(out.part[0].value[2], g * math::cos(0.2), 1e-12);
}

TEST(EkfSensor, PartsThatAnImuHasNot) {
  const Sensor s = sensor("imu", SensorKind::imu, {Yaw, Vyaw, Ax});
  msg::Imu imu = imu_at(0, {0, 0, 1}, {0, 0, 2}, {3, 0, 0});
  imu.orientation_covariance[0] = -1;
  imu.linear_acceleration_covariance[0] = -1;
  Samples out;
  ASSERT_EQ(to_samples(s, imu, 0, out), Outcome::queued);
  ASSERT_EQ(out.count, 1u);
  EXPECT_EQ(out.part[0].part, Part::twist);
  EXPECT_EQ(out.part[0].value[5], 2);
  imu.angular_velocity_covariance[0] = -1;
  out = {};
  EXPECT_EQ(to_samples(s, imu, 0, out), Outcome::unmeasured);
}

TEST(EkfSensor, DeviationsOfItsOwn) {
  Sensor s = sensor("s", SensorKind::twist, {Vx, Vy});
  s.deviation.assign(states, 0);
  s.deviation[Vx] = 0.3;
  msg::TwistWithCovarianceStamped twist = twist_at(0, {1, 2, 3});
  twist.twist.covariance[0] = 0;  // which would be refused
  Samples out;
  ASSERT_EQ(to_samples(s, twist.twist, out), Outcome::queued);
  EXPECT_NEAR(cov(out.part[0], 0, 0), 0.09, 1e-15);
  EXPECT_NEAR(cov(out.part[0], 1, 1), 0.01, 1e-15);
}

TEST(EkfSensor, NumbersThatAreNotUsedMayBeAnything) {
  const Sensor s = sensor("s", SensorKind::pose, {X, Y});
  msg::PoseWithCovarianceStamped pose = pose_at(0, {1, 2, NAN});
  pose.pose.pose.q = {NAN, 0, 0, 0};
  for (std::size_t i = 12; i < 36; ++i) pose.pose.covariance[i] = NAN;
  pose.pose.covariance[2] = NAN;
  Samples out;
  ASSERT_EQ(to_samples(s, pose.pose, out), Outcome::queued);
  for (const double each : out.part[0].covariance) EXPECT_TRUE(std::isfinite(each));
  for (const double each : out.part[0].value) EXPECT_TRUE(std::isfinite(each));
}

TEST(EkfSensor, BadValuesAndCovariances) {
  const Sensor s = sensor("s", SensorKind::pose, {X, Y, Yaw});
  const auto answer = [&](auto&& change) {
    msg::PoseWithCovariance pose = pose_at(0, {1, 2, 0}).pose;
    change(pose);
    Samples out;
    return to_samples(s, pose, out);
  };
  EXPECT_EQ(answer([](auto&) {}), Outcome::queued);
  EXPECT_EQ(answer([](auto& p) { p.pose.p.x = NAN; }), Outcome::bad_value);
  EXPECT_EQ(answer([](auto& p) { p.pose.p.y = -INFINITY; }), Outcome::bad_value);
  EXPECT_EQ(answer([](auto& p) { p.pose.p.x = 1.1e9; }), Outcome::bad_value);
  EXPECT_EQ(answer([](auto& p) { p.pose.q = {0, 0, 0, 0}; }), Outcome::bad_value);
  EXPECT_EQ(answer([](auto& p) { p.pose.q.z = NAN; }), Outcome::bad_value);
  EXPECT_EQ(answer([](auto& p) { p.covariance[0] = 0; }), Outcome::bad_covariance);
  EXPECT_EQ(answer([](auto& p) { p.covariance[0] = -0.01; }), Outcome::bad_covariance);
  EXPECT_EQ(answer([](auto& p) { p.covariance[35] = NAN; }), Outcome::bad_covariance);
  EXPECT_EQ(answer([](auto& p) { p.covariance[7] = INFINITY; }), Outcome::bad_covariance);
  EXPECT_EQ(answer([](auto& p) { p.covariance[1] = 0.001; }), Outcome::bad_covariance);  // without [6]
  EXPECT_EQ(answer([](auto& p) { p.covariance[1] = p.covariance[6] = 0.001; }), Outcome::queued);
  EXPECT_EQ(answer([](auto& p) { p.covariance[1] = p.covariance[6] = 0.011; }), Outcome::bad_covariance);
  EXPECT_EQ(answer([](auto& p) { p.covariance[1] = p.covariance[6] = 0.01; }), Outcome::bad_covariance);
  // All pairs agree, yet the whole is not positive definite: 1, -1, -1 can't be.
  EXPECT_EQ(answer([](auto& p) {
              p.covariance[1] = p.covariance[6] = 0.009;
              p.covariance[5] = p.covariance[30] = 0.009;
              p.covariance[11] = p.covariance[31] = -0.009;
            }),
            Outcome::bad_covariance);
}

TEST(EkfSensor, SpecsThatAreRefused) {
  const auto error = [](auto&& change) {
    Sensor s = sensor("s", SensorKind::pose, {X, Yaw});
    change(s);
    const Status status = s.check(Node{}, "/sensors/0");
    return status ? std::string() : status.error().path;
  };
  EXPECT_EQ(error([](Sensor&) {}), "");
  EXPECT_EQ(error([](Sensor& s) { s.config = {}; }), "/sensors/0/config");
  EXPECT_EQ(error([](Sensor& s) { s.config[Vx] = true; }), "/sensors/0/config");
  EXPECT_EQ(error([](Sensor& s) { s.kind = SensorKind::gps; }), "/sensors/0/config");
  EXPECT_EQ(error([](Sensor& s) { s.kind = SensorKind::imu; }), "/sensors/0/config");
  EXPECT_EQ(error([](Sensor& s) { s.differential = s.relative = true; }), "/sensors/0/relative");
  EXPECT_EQ(error([](Sensor& s) { s.deviation = {1, 2}; }), "/sensors/0/deviation");
  EXPECT_EQ(error([](Sensor& s) { s.mount.q = {0, 0, 0, 0}; }), "/sensors/0/mount");
  EXPECT_EQ(error([](Sensor& s) {
              s = sensor("s", SensorKind::twist, {Vx});
              s.differential = true;
            }),
            "/sensors/0/differential");
  EXPECT_EQ(error([](Sensor& s) {
              s.kind = SensorKind::pose;
              s.differential = true;
              s.pose_errors = PoseErrors::as_twist;
            }),
            "/sensors/0/pose_errors");
}

}  // namespace
}  // namespace sandlot::navigation::ekf
