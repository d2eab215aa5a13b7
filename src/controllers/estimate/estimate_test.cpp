#include "controllers/estimate/estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::estimate {
namespace {

namespace ekf = navigation::ekf;

std::array<double, 36> diagonal(double variance) {
  std::array<double, 36> out{};
  for (std::size_t i = 0; i < 6; ++i) out[7 * i] = variance;
  return out;
}

/// Velocities from wheels, turns from an inertial unit that sits upside down.
Spec fused() {
  Spec spec;
  ekf::Sensor wheels, imu;
  wheels.name = "drive";
  wheels.config[ekf::Vx] = wheels.config[ekf::Vy] = true;
  imu.name = "imu";
  imu.kind = ekf::SensorKind::imu;
  imu.config[ekf::Vyaw] = true;
  spec.sensors = {wheels, imu};
  return spec;
}

/// The estimator with topics that a test fills.
struct Trial {
  Estimator estimator;
  Outputs outputs{"rover/estimator"};
  Topic<msg::Odometry> odometry{"/rover/drive/ideal"}, other{"/rover/continuous/odometry"};
  Topic<msg::Imu> imu{"/rover/imu/imu"};
  std::vector<std::uint64_t> seen{0, 0, 0};
  Status ready;
  Time now;

  explicit Trial(Spec spec, Quat q_BI = {}) {
    estimator.spec = std::move(spec);
    Description robot;
    robot.robot = "rover";
    robot.readings = {{"drive", "ideal", msg::Odometry::ros_type, 0, {}},
                      {"imu", "", msg::Imu::ros_type, 1, {{0.1, 0, 0.2}, q_BI}},
                      {"continuous/odometry", "", msg::Odometry::ros_type, 2, {}, true}};
    ready = estimator.init(robot, outputs);
  }
  void put_velocity(double vx, double vy) {
    odometry.message.twist.twist.linear = {vx, vy, 0};
    odometry.message.twist.covariance = diagonal(1e-4);
    odometry.publish(now);
  }
  void put_rate(Vec3 radps_I) {
    imu.message.angular_velocity = radps_I;
    imu.message.angular_velocity_covariance = {1e-6, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6};
    imu.publish(now);
  }
  void step(double dt_s) {
    const std::vector<const TopicBase*> topics{&odometry, &imu, &other};
    Command cmd;
    cmd.bind(&outputs);
    estimator.step(Observation(now, topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
    outputs.commit(now);
    seen = {odometry.count, imu.count, other.count};
    now = now + Time::from_s(dt_s);
  }
  const Topic<msg::Odometry>& estimate() const {
    return *topic_cast<msg::Odometry>(outputs.all().back().topic.get());
  }
};

/// A circle of radius v / w: the unit turns the robot, the wheels move it.
TEST(Estimate, FollowsACircleFromWheelsAndGyroscope) {
  Trial t(fused(), quat_from_axis_angle({1, 0, 0}, math::pi));
  ASSERT_TRUE(t.ready) << t.ready.error().text();
  constexpr double v = 0.5, w = 0.25, dt = 0.02;
  for (int i = 0; i <= 600; ++i) {
    t.put_velocity(v, 0);
    t.put_rate({0, 0, -w});
    t.step(dt);
  }
  const auto& at = t.estimate().message;
  const double angle = w * dt * 600;
  // The filter begins at rest and believes the first samples at once: a twentieth of a second is lost at the most.
  EXPECT_NEAR(math::wrap_angle(yaw_of(at.pose.pose.q) - angle), 0, 0.02);
  EXPECT_NEAR(at.pose.pose.p.x, v / w * math::sin(angle), 0.03);
  EXPECT_NEAR(at.pose.pose.p.y, v / w * (1 - math::cos(angle)), 0.03);
  EXPECT_NEAR(at.twist.twist.linear.x, v, 1e-3);
  EXPECT_NEAR(at.twist.twist.angular.z, w, 1e-3);
  EXPECT_GT(at.pose.covariance[0], 0);
  EXPECT_EQ(at.header.frame_id, "rover/odom");
  EXPECT_EQ(at.child_frame_id, "rover/base_link");
  EXPECT_EQ(t.estimate().name(), "/rover/estimator/odometry");
}

/// It adds nothing to the library: what that gives of the same messages is the same to the bit.
TEST(Estimate, IsWhatTheLibraryGives) {
  Trial t(fused());
  auto alone = ekf::begin(t.estimator.spec);
  ASSERT_TRUE(alone);
  Stream random(3, 0, Purpose::experiment, 0);
  for (int i = 0; i < 200; ++i) {
    if (i % 3 != 0) t.put_velocity(random.normal(), random.normal());
    if (i % 2 != 0) t.put_rate({random.normal(), random.normal(), random.normal()});
    if (t.odometry.count > t.seen[0]) ekf::add(t.estimator.spec, *alone, 0, t.odometry.message);
    if (t.imu.count > t.seen[1]) ekf::add(t.estimator.spec, *alone, 1, t.imu.message);
    const Time now = t.now;
    ekf::advance(t.estimator.spec, *alone, now);
    t.step(0.02);
    const ekf::Estimate expected = ekf::estimate(t.estimator.spec, *alone, now);
    ASSERT_TRUE(i == 0 || expected.known);
    if (expected.known) { ASSERT_EQ(t.estimate().message.pose.pose, expected.pose()) << i; }
  }
}

TEST(Estimate, PlacesTheFrameOfAnotherOdometry) {
  Spec spec = fused();
  spec.frame = "map";
  spec.odometry = "continuous/odometry";
  Trial t(spec);
  ASSERT_TRUE(t.ready) << t.ready.error().text();
  for (int i = 0; i <= 99; ++i) {
    t.put_velocity(1, 0);
    t.put_rate({});
    t.step(0.02);
    if (i >= 98) continue;  // its last message is a step old in the end
    // The other one says 10 cm per second less, and that it is elsewhere.
    t.other.message.header.frame_id = "rover/odom";
    t.other.message.pose.pose = {{3 + 0.9 * (i + 1) * 0.02, 4, 0}, {}};
    t.other.message.twist.twist.linear = {0.9, 0, 0};
    t.other.publish(t.now);
  }
  const auto& placed = topic_cast<msg::TransformStamped>(t.outputs.all().front().topic.get())->message;
  EXPECT_EQ(placed.header.frame_id, "rover/map");
  EXPECT_EQ(placed.child_frame_id, "rover/odom");
  const Vec3 p = t.estimate().message.pose.pose.p;
  EXPECT_NEAR(placed.transform.translation.x, p.x - (3 + 0.9 * 99 * 0.02), 1e-9);
  EXPECT_NEAR(placed.transform.translation.y, p.y - 4, 1e-9);
}

TEST(Estimate, NamesWhatIsMissing) {
  Spec nothing;
  EXPECT_FALSE(Trial(nothing).ready);
  Spec spec = fused();
  spec.sensors[0].name = "wheels";
  const Trial missing(spec);
  ASSERT_FALSE(missing.ready);
  EXPECT_NE(missing.ready.error().what.find("'wheels' of type nav_msgs/msg/Odometry"), std::string::npos);
}

TEST(Estimate, RefusesAStateThatCannotBe) {
  Trial t(fused());
  t.put_velocity(1, 0);
  t.step(0.02);
  EXPECT_TRUE(t.estimator.fits());
  t.estimator.state.core.x[0] = NAN;
  EXPECT_FALSE(t.estimator.fits());
  t.estimator.state.core.x[0] = 0;
  t.estimator.state.sensors.clear();
  EXPECT_FALSE(t.estimator.fits());
}

}  // namespace
}  // namespace sandlot::controllers::estimate
