#include "controllers/odometry_estimator/odometry_estimator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::odometry_estimator {
namespace {

/// The estimator with topics that a test fills.
struct Trial {
  OdometryEstimator estimator;
  Outputs outputs{"rover/estimator"};
  Topic<msg::Odometry> odometry{"/rover/drive/ideal"};
  Topic<msg::Imu> imu{"/rover/imu/imu"};
  std::vector<std::uint64_t> seen{0, 0};
  Time now;
  bool with_imu;

  explicit Trial(const Spec& spec = {}, bool has_imu = false, Quat q_BS = {}) : with_imu(has_imu) {
    estimator.spec = spec;
    Description robot;
    robot.robot = "rover";
    robot.readings = {{"drive", "ideal", msg::Odometry::ros_type, 0, {}}};
    if (with_imu) robot.readings.push_back({"imu", "", msg::Imu::ros_type, 1, {{}, q_BS}});
    const Status ready = estimator.init(robot, outputs);
    EXPECT_TRUE(ready);
  }
  void put_odometry(double x, double y, double yaw) {
    odometry.message.header.frame_id = "rover/odom";
    odometry.message.pose.pose = {{x, y, 0}, quat_from_axis_angle({0, 0, 1}, yaw)};
    odometry.publish(now);
  }
  void put_rate(Vec3 radps_S) {
    imu.message.angular_velocity = radps_S;
    imu.publish(now);
  }
  /// One step, and on in time.
  void step(double dt_s) {
    std::vector<const TopicBase*> topics{&odometry};
    if (with_imu) topics.push_back(&imu);
    Command cmd;
    cmd.bind(&outputs);
    estimator.step(Observation(now, topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
    outputs.commit(now);
    seen = {odometry.count, imu.count};
    now = now + Time::from_s(dt_s);
  }
  const Topic<msg::Odometry>& estimate() const {
    return *topic_cast<msg::Odometry>(outputs.all()[0].topic.get());
  }
};

TEST(OdometryEstimator, AStraightWayHasTheCovarianceOfItsFormula) {
  // n steps of d: var_d and var_a per step are k d and h d. Of the recurrence P' = F P F^T + G Q G^T with phi = 0 remain
  //   tt = h L,  yt = h L^2 / 2,  yy = h L (L^2 / 3 - d^2 / 12),  xx = k L,  L = n d.
  constexpr double k = 2e-4, h = 3e-4, d = 0.05;
  constexpr int n = 200;
  Trial t({.distance_variance = k, .heading_variance = h});
  for (int i = 0; i <= n; ++i) {
    t.put_odometry(i * d, 0, 0);
    t.step(0.1);
  }
  const double L = n * d;
  const auto& at = t.estimate().message;
  EXPECT_EQ(t.estimate().count, static_cast<std::uint64_t>(n + 1));
  EXPECT_EQ(t.estimate().name(), "/rover/estimator/estimate");
  EXPECT_EQ(at.header.frame_id, "rover/odom");
  EXPECT_NEAR(at.pose.pose.p.x, L, 1e-12);
  EXPECT_NEAR(at.pose.covariance[0], k * L, 1e-12);
  EXPECT_NEAR(at.pose.covariance[35], h * L, 1e-12);
  EXPECT_NEAR(at.pose.covariance[11], h * L * L / 2, 1e-10);
  EXPECT_NEAR(at.pose.covariance[7], h * L * (L * L / 3 - d * d / 12), 1e-10);
  EXPECT_NEAR(at.pose.covariance[1], 0, 1e-15);
}

TEST(OdometryEstimator, WithoutAGyroscopeThePoseIsThatOfTheOdometry) {
  Trial t;
  double x = 1, y = -2, yaw = 3;
  for (int i = 0; i < 500; ++i) {
    t.put_odometry(x, y, yaw);
    t.step(0.02);
    EXPECT_NEAR(t.estimate().message.pose.pose.p.x, x, 1e-11);
    EXPECT_NEAR(t.estimate().message.pose.pose.p.y, y, 1e-11);
    EXPECT_NEAR(math::wrap_angle(yaw_of(t.estimate().message.pose.pose.q) - yaw), 0, 1e-11);
    x += 0.01 * math::cos(yaw + 0.01);
    y += 0.01 * math::sin(yaw + 0.01);
    yaw += 0.02;
  }
}

TEST(OdometryEstimator, TheGyroscopeCorrectsAWrongSeparationOfTheWheels) {
  // A circle of radius r, once round. The wheels report a turn that is a tenth too large, and so a chord of a circle that
  // is too small; the gyroscope, mounted upside down, has the true rate.
  constexpr double r = 2, w = 0.5, dt = 0.02;
  const Quat upside_down = quat_from_axis_angle({1, 0, 0}, math::pi);
  Trial t({.gyro_density = 1e-3}, true, upside_down);
  double x = 0, y = 0, yaw = 0;
  const int n = static_cast<int>(std::round(2 * math::pi / (w * dt)));
  for (int i = 0; i <= n; ++i) {
    t.put_odometry(x, y, yaw);
    t.put_rate({0, 0, -w});
    t.step(dt);
    const double turn = 1.1 * w * dt, chord = 2 * r * math::sin(0.5 * w * dt);
    x += chord * math::cos(yaw + 0.5 * turn);
    y += chord * math::sin(yaw + 0.5 * turn);
    yaw += turn;
  }
  const auto& at = t.estimate().message;
  const double angle = w * dt * n;  // one round to within half a step
  EXPECT_NEAR(math::wrap_angle(yaw_of(at.pose.pose.q) - angle), 0, 1e-9);
  EXPECT_NEAR(at.pose.pose.p.x, r * math::sin(angle), 1e-9);
  EXPECT_NEAR(at.pose.pose.p.y, r * (1 - math::cos(angle)), 1e-9);
  EXPECT_NEAR(at.pose.covariance[35], 1e-6 * n * dt, 1e-12);
  EXPECT_NEAR(at.twist.twist.angular.z, w, 1e-12);
}

TEST(OdometryEstimator, AGyroscopeThatFallsSilentIsLeftOut) {
  Trial t({}, true);
  t.put_rate({0, 0, 0});
  for (int i = 0; i <= 20; ++i) {  // 0.1 s each: from 0.6 s on the wheels turn the estimate
    t.put_odometry(0, 0, 0.01 * i);
    t.step(0.1);
  }
  EXPECT_NEAR(yaw_of(t.estimate().message.pose.pose.q), 0.01 * 15, 1e-12);
}

TEST(OdometryEstimator, PublishesForFreshOdometryOnly) {
  Trial t;
  t.step(0.1);
  EXPECT_EQ(t.estimate().count, 0u);
  t.put_odometry(1, 0, 0);
  t.step(0.1);
  t.step(0.1);
  EXPECT_EQ(t.estimate().count, 1u);
  EXPECT_EQ(t.estimate().stamp, Time::from_s(0.1));
}

TEST(OdometryEstimator, NamesWhatIsMissing) {
  OdometryEstimator estimator;
  Description robot;
  robot.robot = "rover";
  Outputs out("rover/estimator");
  EXPECT_FALSE(estimator.init(robot, out));
  robot.readings = {{"drive", "ideal", msg::Odometry::ros_type, 0, {}}};
  EXPECT_TRUE(estimator.init(robot, out));
  estimator.spec.imu = "gyro";
  const Status status = estimator.init(robot, out);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "robot 'rover' has no reading 'gyro' of type sensor_msgs/msg/Imu");
}

TEST(OdometryEstimator, RefusesAStateThatCannotBe) {
  OdometryEstimator estimator;
  EXPECT_TRUE(estimator.fits());
  estimator.state.seen_at = {std::numeric_limits<std::int64_t>::min()};
  EXPECT_FALSE(estimator.fits());
  estimator.state = {};
  estimator.state.covariance[2] = NAN;
  EXPECT_FALSE(estimator.fits());
}

}  // namespace
}  // namespace sandlot::controllers::odometry_estimator
