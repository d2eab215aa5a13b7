#include "controllers/four_wheel_steer/four_wheel_steer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/math.h"

namespace sandlot::controllers::four_wheel_steer {
namespace {

constexpr double tick_s = 0.01, wheel_radius_m = 0.075;

/// A robot with perfect servos and motors on perfect ground: joints do what was ordered, a step later.
struct Robot {
  FourWheelSteer controller;
  Outputs outputs{"mario/base"};
  Topic<msg::Twist> velocity{"/mario/joystick/cmd_vel"};
  Topic<msg::JointState> joints{"/mario/joint_state_controller/joints"};
  std::vector<std::uint64_t> seen{0, 0};
  std::int64_t tick = 0;
  Command cmd;
  Fit truth;  ///< pose of C in the world
  bool commanded = true, sensed = true;

  static Description description() {
    Description robot;
    robot.robot = "mario";
    robot.control_period_s = tick_s;
    robot.readings = {
        {"joystick/cmd_vel", "", msg::Twist::ros_type, 0, {}, true},
        {"joint_state_controller", "joints", msg::JointState::ros_type, 1, {}},
    };
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::string number = std::to_string(i + 1);
      robot.actuators.push_back(
          {"servo" + number + "_position_controller", "position", msg::Float64::ros_type, i, {}});
      robot.actuators.push_back(
          {"motor" + number + "_velocity_controller", "velocity", msg::Float64::ros_type, 4 + i, {}});
    }
    return robot;
  }
  explicit Robot(const Spec& spec = {}) {
    controller.spec = spec;
    const Status ready = controller.init(description(), outputs);
    EXPECT_TRUE(ready) << (ready ? "" : ready.error().text());
    // The model's order of joints: each steering joint, then its wheel.
    for (const char* name :
         {"servo1", "motor1", "servo2", "motor2", "servo3", "motor3", "servo4", "motor4"}) {
      joints.message.name.emplace_back(name);
      joints.message.position.push_back(0);
      joints.message.velocity.push_back(0);
    }
  }
  Time now() const { return Time::from_ns(tick * 10'000'000); }
  const msg::Odometry& odometry() const {
    return topic_cast<msg::Odometry>(outputs.all()[0].topic.get())->message;
  }
  std::uint64_t odometries() const { return outputs.all()[0].topic->count; }
  const msg::FourWheelSteerState& state() const {
    return topic_cast<msg::FourWheelSteerState>(outputs.all()[1].topic.get())->message;
  }
  std::vector<double> ordered() const {
    std::vector<double> out(8, std::nan(""));
    for (const Command::Order& order : cmd.orders()) {
      msg::Float64 number;
      ByteReader r(cmd.bytes(order));
      read(r, number);
      out[order.slot] = number.data;
    }
    return out;
  }
  void step(const Motion& command) {
    velocity.message = {{command.x, command.y, 0}, {0, 0, command.turn}};
    if (commanded) velocity.publish(now());
    if (sensed) joints.publish(now());
    cmd.clear();
    cmd.bind(&outputs);
    const TopicBase* const topics[] = {&velocity, &joints};
    controller.step(Observation(now(), topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
    outputs.commit(now());
    seen = {velocity.count, joints.count};
    ++tick;
    if (cmd.orders().empty()) return;
    const std::vector<double> set = ordered();
    for (std::size_t i = 0; i < 4; ++i) {
      joints.message.position[2 * i] = set[i];
      joints.message.velocity[2 * i + 1] = set[4 + i];
      joints.message.position[2 * i + 1] += set[4 + i] * tick_s;
    }
    const msg::Twist& v = state().target;
    move({v.linear.x, v.linear.y, v.angular.z});
  }
  /// The exact arc of a tick.
  void move(const Motion& v) {
    const double a = v.turn * tick_s, half = 0.5 * a;
    const double chord = std::abs(half) < 1e-9 ? tick_s : tick_s * math::sin(half) / half;
    const auto [s, c] = math::sincos(truth.turn_rad + half);
    truth.x_m += chord * (c * v.x - s * v.y);
    truth.y_m += chord * (s * v.x + c * v.y);
    truth.turn_rad += a;
  }
  void run(const Motion& command, double time_s) {
    for (long k = 0; k < std::lround(time_s / tick_s); ++k) step(command);
  }
};

TEST(FourWheelSteer, OrdersServosAndMotorsByTheInverseKinematics) {
  // 0.5 m/s on a circle of 1.1 m: atan(0.21 / 0.89) and atan(0.21 / 1.31); 0.9144 and 1.3267 m from the centre.
  Robot robot;
  robot.run({0.5, 0, 0.5 / 1.1}, 3);
  const std::vector<double> set = robot.ordered();
  const double want[] = {0.231717, 0.158953, -0.231717, -0.158953, 5.542, 8.041, 5.542, 8.041};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(set[i], want[i], i < 4 ? 1e-6 : 5e-4) << i;
  const msg::FourWheelSteerState& state = robot.state();
  EXPECT_EQ(state.mode, msg::FourWheelSteerState::turn);
  EXPECT_EQ(state.phase, msg::FourWheelSteerState::driving);
  EXPECT_TRUE(state.turns);
  EXPECT_NEAR(state.centre.y, 1.1, 1e-12);
  EXPECT_EQ(state.header.frame_id, "mario/base_link");
  ASSERT_EQ(state.wheels.size(), 4u);
  EXPECT_EQ(state.wheels[1].rate_target, set[5]);
  EXPECT_NEAR(state.wheels[1].slip_angle, 0.158953, 1e-6) << "of the measured motion";
  EXPECT_NEAR(state.wheels[1].lateral_slip, 0, 1e-9);
  // Steady: centripetal alone, w |v_i| towards the centre, which lies across the wheel.
  const double a = 0.5 / 1.1 * 8.041 * wheel_radius_m;
  EXPECT_NEAR(state.wheels[1].acceleration.x, -a * math::sin(0.159), 1e-4);
  EXPECT_NEAR(state.wheels[1].acceleration.y, a * math::cos(0.159), 1e-4);
}

TEST(FourWheelSteer, OdometryFollowsThePathOfRollingWheels) {
  // Crab, a whole circle, a spin, a stop: all constant, so that no wheel is steered while it rolls but for 0.05 rad when it starts.
  Robot robot;
  for (const Motion& v :
       {Motion{0.4, 0.3, 0}, Motion{}, Motion{0.5, 0, 0.5}, Motion{}, Motion{0, 0, -1}, Motion{}})
    robot.run(v, v == Motion{} ? 1 : 4);
  robot.run({}, 0.02);
  const auto& at = robot.odometry().pose.pose;
  // Six starts, each with at most 3 steps of at most 0.025 m/s * 0.01 s on angles that are up to 0.05 rad off.
  EXPECT_NEAR(at.p.x, robot.truth.x_m, 2e-4);
  EXPECT_NEAR(at.p.y, robot.truth.y_m, 2e-4);
  EXPECT_NEAR(math::wrap_angle(yaw_of(at.q) - robot.truth.turn_rad), 0, 5e-4);
  EXPECT_GT(std::abs(robot.truth.x_m), 1);
  EXPECT_EQ(robot.odometries(), static_cast<std::uint64_t>(robot.tick - 1));
  EXPECT_EQ(robot.odometry().header.frame_id, "mario/odom");
  EXPECT_EQ(robot.odometry().child_frame_id, "mario/base_link");
  EXPECT_NEAR(robot.state().residual, 0, 1e-9);
}

TEST(FourWheelSteer, TheTwistIsTheMeasuredVelocityAndTheResidualShowsSlip) {
  Robot robot;
  robot.run({0.4, 0.1, 0.6}, 3);
  EXPECT_NEAR(robot.odometry().twist.twist.linear.x, 0.4, 1e-9);
  EXPECT_NEAR(robot.odometry().twist.twist.linear.y, 0.1, 1e-9);
  EXPECT_NEAR(robot.odometry().twist.twist.angular.z, 0.6, 1e-9);
  robot.run({0.4, 0, 0}, 3);
  const double calm = robot.odometry().twist.covariance[0];
  robot.joints.message.position[1] += 0.02;  // wheel 1 spins by 1.5 mm more: sqrt(5/32) of it remains
  robot.step({0.4, 0, 0});
  EXPECT_NEAR(robot.state().residual, std::sqrt(5.0 / 32) * 0.02 * wheel_radius_m, 2e-5);
  EXPECT_GT(robot.odometry().twist.covariance[0], calm + 1e-3) << "e^2 / dt^2 = 3.5e-3";
}

TEST(FourWheelSteer, CovarianceOfAStraightWayIsThatOfItsFormula) {
  // n steps of d: tt = h d n, xx = k d n, yy = k d n + h d^3 sum_{j<n} j^2, yt = h d^2 n (n - 1) / 2.
  constexpr double k = 2e-4, h = 3e-4;
  Robot robot({.distance_variance = k, .heading_variance = h, .turn_variance = 0});
  robot.run({0.5, 0, 0}, 1);
  const auto before = robot.controller.state.covariance;
  robot.controller.state.covariance = {};
  robot.run({0.5, 0, 0}, 2);
  const double n = 200, d = 0.5 * tick_s;
  const auto& P = robot.odometry().pose.covariance;
  EXPECT_GT(before[0], 0);
  EXPECT_NEAR(P[0], k * d * n, 1e-12);
  EXPECT_NEAR(P[35], h * d * n, 1e-12);
  EXPECT_NEAR(P[7], k * d * n + h * d * d * d * (n - 1) * n * (2 * n - 1) / 6, 1e-12);
  EXPECT_NEAR(P[11], h * d * d * n * (n - 1) / 2, 1e-12);
  EXPECT_NEAR(P[1], 0, 1e-15);
}

// A robot that stands for a second, with encoders of 4096 steps: of each reading the error is q / sqrt(12), of four wheels' way in a
// step r q / sqrt(6 * 4).
TEST(FourWheelSteer, EncodersAreNotExact) {
  const double q = 2 * math::pi / 4096, floor = wheel_radius_m * wheel_radius_m * q * q / 24;
  Robot robot({.encoder_resolution_rad = q});
  robot.run({}, 0.1);
  robot.controller.state.covariance = {};
  robot.run({}, 1);
  const double arm_squared = 2 * 0.21 * 0.21;
  const auto& message = robot.odometry();
  EXPECT_NEAR(message.twist.covariance[0], floor / (tick_s * tick_s), 1e-12);
  EXPECT_NEAR(message.twist.covariance[35], floor / (tick_s * tick_s) / arm_squared, 1e-12);
  EXPECT_NEAR(message.pose.covariance[0], 100 * floor, 1e-12);
  Robot exact;
  exact.run({}, 0.1);
  EXPECT_EQ(exact.odometry().twist.covariance[0], 0);
}

TEST(FourWheelSteer, StopsWhenCommandsOrJointStatesCeaseOrAreNoNumbers) {
  const auto rate = [](const Robot& robot) { return robot.ordered()[4]; };
  Robot robot;
  robot.run({0.5, 0, 0}, 1);
  robot.commanded = false;
  robot.run({0.5, 0, 0}, 0.5);  // timeout 0.5 s: the command of 0.99 s counts until 1.49 s
  EXPECT_GT(rate(robot), 6);
  robot.run({0.5, 0, 0}, 1);
  EXPECT_EQ(rate(robot), 0);
  robot.commanded = true;
  robot.run({0.5, 0, 0}, 1);
  EXPECT_GT(rate(robot), 6);
  robot.sensed = false;
  robot.run({0.5, 0, 0}, 1.5);
  EXPECT_EQ(rate(robot), 0);
  robot.sensed = true;
  robot.run({0.5, 0, 0}, 1);
  EXPECT_GT(rate(robot), 6);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    robot.run({0.5, 0, 0}, 1);
    robot.run({bad, 0, 0}, 1);
    EXPECT_EQ(rate(robot), 0);
    EXPECT_EQ(robot.state().mode, msg::FourWheelSteerState::stop);
  }
}

TEST(FourWheelSteer, WaitsForJointStatesThatHaveAllJoints) {
  Robot robot;
  robot.sensed = false;
  robot.step({0.5, 0, 0});
  EXPECT_TRUE(robot.cmd.orders().empty());
  robot.sensed = true;
  robot.joints.message.name[7] = "motor5";
  robot.step({0.5, 0, 0});
  EXPECT_TRUE(robot.cmd.orders().empty());
  robot.joints.message.name[7] = "motor4";
  robot.joints.message.position.pop_back();
  robot.step({0.5, 0, 0});
  EXPECT_TRUE(robot.cmd.orders().empty());
  robot.joints.message.position.push_back(std::nan(""));
  robot.step({0.5, 0, 0});
  EXPECT_TRUE(robot.cmd.orders().empty());
  robot.joints.message.position.back() = 100;
  robot.step({0.5, 0, 0});
  EXPECT_EQ(robot.cmd.orders().size(), 8u);
  EXPECT_EQ(robot.odometries(), 0u) << "the first one is where it begins";
}

TEST(FourWheelSteer, EncodersThatStartAnewMoveNothing) {
  Robot robot;
  robot.run({0.5, 0, 0}, 1);
  const double x = robot.odometry().pose.pose.p.x;
  for (std::size_t i = 1; i < 8; i += 2) robot.joints.message.position[i] = -1000;
  robot.step({0.5, 0, 0});
  EXPECT_EQ(robot.odometry().pose.pose.p.x, x);
  robot.step({0.5, 0, 0});
  EXPECT_NEAR(robot.odometry().pose.pose.p.x, x + 0.005, 1e-9);
  // Stamps that stand or run backward are no step either.
  const std::uint64_t count = robot.odometries();
  robot.tick -= 50;
  robot.step({0.5, 0, 0});
  EXPECT_EQ(robot.odometries(), count);
  EXPECT_NEAR(robot.odometry().pose.pose.p.x, x + 0.005, 1e-9);
}

TEST(FourWheelSteer, RefusesWhatDoesNotFitTogether) {
  const auto complaint = [](Spec spec) {
    FourWheelSteer controller;
    controller.spec = std::move(spec);
    Outputs outputs("mario/base");
    const Status ready = controller.init(Robot::description(), outputs);
    return ready ? "" : ready.error().what;
  };
  EXPECT_EQ(complaint({}), "");
  EXPECT_EQ(complaint({.drive = {"motor1_velocity_controller"}}), "there are 4 wheels and 1 names in drive");
  EXPECT_EQ(complaint({.wheels_m = {{1, 1}, {1, -1}, {1, 1}, {0, 0}}}), "two wheels are at one place");
  EXPECT_EQ(complaint({.limits = {.steering_lower_rad = 1, .steering_upper_rad = 1}}),
            "the range of steering is empty");
  EXPECT_EQ(complaint({.limits = {.steer_first_rad = 0.1, .aligned_rad = 0.2}}),
            "aligned is larger than steer_first");
  EXPECT_NE(complaint({.steering = {"servo1", "servo2", "servo3", "servo4"}}).find("'servo1'"),
            std::string::npos);
  EXPECT_NE(complaint({.velocity = "stick"}).find("'stick'"), std::string::npos);
}

TEST(FourWheelSteer, ARestoredStateGoesOnAndAForgedOneIsRefused) {
  Robot one, other;
  one.run({0.3, 0.2, 0.5}, 1);
  ByteWriter w;
  write(w, one.controller.state);
  ByteReader r(w.bytes());
  read(r, other.controller.state);
  ASSERT_TRUE(r.ok());
  EXPECT_TRUE(other.controller.fits());
  other.joints = one.joints;
  other.velocity = one.velocity;
  other.seen = one.seen;
  other.tick = one.tick;
  one.step({-0.3, 0.2, 0.1});
  other.step({-0.3, 0.2, 0.1});
  EXPECT_EQ(one.ordered(), other.ordered());
  EXPECT_EQ(one.odometry().pose.pose.p.x, other.odometry().pose.pose.p.x);
  other.controller.state.steering_rad.push_back(0);
  EXPECT_FALSE(other.controller.fits());
  other.controller.state = one.controller.state;
  other.controller.state.wheel_rad[2] = std::nan("");
  EXPECT_FALSE(other.controller.fits());
}

}  // namespace
}  // namespace sandlot::controllers::four_wheel_steer
