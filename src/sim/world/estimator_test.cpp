/// The estimator that publishes, in a world: against the truth and the odometry that it reads.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/load/load.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

/// A rover on circles with an odometry that takes its wheels to be 10 % too near each other, and a good gyroscope.
constexpr const char* circles = R"(version: 1
name: circles
physics: rigid
time: {step: 10 ms, substeps: 2, control_interval: 2, stop: 1 min}
robots:
  - name: rover
    model: ../models/rover/model.sdf
    devices:
      odometry: {kind: wheel_odometry, left_joint: left_wheel_joint, right_joint: right_wheel_joint,
                 wheel_radius: 0.05, wheel_separation: 0.23, separation_error: -0.1, rate: 50}
      gyro: {kind: imu, rate: 50}
      truth: {rate: 50}
    controllers:
      - {name: driver, kind: sequence, steps: [{at: 0 s, orders: {drive: [0.3, 0, 0.5]}}]}
      - {name: estimator, kind: odometry_estimator, odometry: odometry, gyro_density: 1e-3}
)";

TEST(OdometryEstimatorInAWorld, IsNearerToTheTruthThanTheWheelsAlone) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.text = circles;
  auto setup = load("scenarios/circles.yaml", options, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_TRUE(made) << made.error().text();
  Simulation& simulation = **made;
  const auto pose = [&](const char* topic) {
    const auto* const at = topic_cast<msg::Odometry>(simulation.find_topic(topic));
    EXPECT_NE(at, nullptr) << topic;
    return at->message.pose.pose;
  };
  advance(simulation, 2000);
  const Pose truth = pose("rover/truth"), wheels = pose("rover/odometry"),
             estimate = pose("/rover/estimator/estimate");
  const auto heading_error = [&](const Pose& X) {
    return std::abs(math::wrap_angle(yaw_of(X.q) - yaw_of(truth.q)));
  };
  const auto distance = [&](const Pose& X) { return math::hypot(X.p.x - truth.p.x, X.p.y - truth.p.y); };
  // 20 s at about 0.5 rad/s are 10 rad: 10 % of the separation make 1.1 rad.
  EXPECT_GT(heading_error(wheels), 0.8);
  EXPECT_LT(heading_error(estimate), 0.02);
  EXPECT_LT(distance(estimate), 0.05);
  EXPECT_GT(distance(wheels), 0.2);
}

}  // namespace
}  // namespace sandlot::test
