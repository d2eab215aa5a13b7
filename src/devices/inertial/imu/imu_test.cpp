#include "devices/inertial/imu/imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "devices/test_rig.h"

namespace sandlot::imu {
namespace {

using test::config;
using test::Rig;

constexpr double g = 9.81;

/// Moves link 0 along a path given in closed form, `substeps` per tick.
struct Path {
  std::function<BodyState(double t_s)> at;
};

void drive(Rig& rig, const Path& path, int substeps, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) {
    const double h_s = rig.tick.s() / substeps;
    for (int i = 0; i < substeps; ++i) {
      rig.engine->body[0] = path.at(rig.now.s() + i * h_s);
      rig.pool->pre_substep(rig.context(rig.now + rig.tick), rig.due(), h_s);
    }
    rig.now = rig.now + rig.tick;
    rig.engine->body[0] = path.at(rig.now.s());
    rig.sense();
  }
}

const msg::Imu& reading(Rig& rig) { return rig.topic<msg::Imu>("imu/imu").message; }

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Imu, AtRestItShowsGravityUpwards) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("imu", config({})));
  rig.sense();  // before anything moved
  expect_near(reading(rig).linear_acceleration, {0, 0, g}, 1e-12);
  drive(rig, {[](double) { return BodyState{}; }}, 4, 3);
  expect_near(reading(rig).linear_acceleration, {0, 0, g}, 1e-12);
  expect_near(reading(rig).angular_velocity, {}, 1e-15);
  EXPECT_EQ(reading(rig).header.frame_id, "robot1/imu");
}

TEST(Imu, IsCalibratedAtRestOnly) {
  Rig rig(kind, test::two_wheels());
  Node gyro = Node::map();
  Node axis = config({{"mean", "0.02"}, {"mean_std", "0.01"}});
  Node bias = config({{"bias_std", "0.01"}, {"correlation", "1e8"}});
  axis.set("bias", bias);
  for (const char* name : {"x", "y", "z"}) gyro.set(name, axis);
  Node keys = Node::map();
  keys.set("gyro", gyro);
  ASSERT_TRUE(rig.add("imu", keys));
  const Path rest{[](double) { return BodyState{}; }};
  drive(rig, rest, 1, 2);
  EXPECT_GT(norm(reading(rig).angular_velocity), 0.01);
  const auto calibrate = [&] {
    using Trigger = msg::std_srvs::Trigger;
    Trigger::Request nothing;
    std::vector<std::byte> asked, answer;
    write_cdr(message_info<Trigger::Request>(), &nothing, asked);
    Trigger::Response response;
    EXPECT_TRUE(rig.pool->call(0, **service_of(kind, "robot1/imu", "calibrate"), asked, answer,
                               rig.context(rig.now)));
    EXPECT_TRUE(read_cdr(message_info<Trigger::Response>(), answer, &response));
    return response;
  };
  rig.engine->body[0].V_WB.angular = {0, 0, 0.5};
  const auto turning = calibrate();
  EXPECT_FALSE(turning.success);
  EXPECT_EQ(turning.message, "the unit turns at 0.5 rad/s; hold it still");
  drive(rig, rest, 1, 1);
  EXPECT_GT(norm(reading(rig).angular_velocity), 0.01) << "nothing has changed";
  EXPECT_TRUE(calibrate().success);
  // What is left is the drift from here on: std sqrt(2 dt / tau) * 0.01 = 1.4e-7 for a tick of 10 ms.
  drive(rig, rest, 1, 1);
  EXPECT_LT(norm(reading(rig).angular_velocity), 1e-6);
}

TEST(Imu, ATiltedMountTurnsWhatItShows) {
  // Rolled by 90 degrees, the sensor's y points up; pitched by 30, x points down by sin 30.
  for (const auto& [rpy, force] :
       {std::pair{Vec3{math::pi / 2, 0, 0}, Vec3{0, g, 0}},
        std::pair{Vec3{0, math::pi / 6, 0}, Vec3{-g * 0.5, 0, g * std::sqrt(0.75)}}}) {
    Rig rig(kind, test::two_wheels());
    ASSERT_TRUE(rig.add("imu", config({}), 1, 0, pose_from_rpy({}, rpy)));
    drive(rig, {[](double) { return BodyState{}; }}, 1, 2);
    expect_near(reading(rig).linear_acceleration, force, 1e-12);
  }
}

TEST(Imu, FallingFreelyItShowsNothing) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("imu", config({})));
  drive(rig, {[](double t) {
          return BodyState{{{0, 0, -0.5 * g * t * t}, {}}, {{0, 0, -g * t}, {}}};
        }},
        2, 5);
  expect_near(reading(rig).linear_acceleration, {}, 1e-11);
}

TEST(Imu, AKnownAccelerationComesThroughInTheSensorsFrame) {
  // 2 m/s^2 along the world's x while the robot looks along y: along the sensor's -y.
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("imu", config({})));
  const Quat q = quat_from_rpy(0, 0, math::pi / 2);
  drive(rig, {[&](double t) { return BodyState{{{t * t, 0, 0}, q}, {{2 * t, 0, 0}, {}}}; }}, 2, 5);
  expect_near(reading(rig).linear_acceleration, {0, -2, g}, 1e-11);
}

TEST(Imu, OffTheCentreOfATurntableItShowsTheCentripetalForce) {
  // At radius r the velocity turns by w h per sub-step: |dv| = 2 w r sin(w h / 2), towards the centre half
  // way. So the mean is -w^2 r sinc(w h / 2) along x, exactly.
  const double w = 3, r = 0.4;
  constexpr int substeps = 4;
  Rig rig(kind, test::two_wheels(), 0.02);
  ASSERT_TRUE(rig.add("imu", config({}), 1, 0, {{r, 0, 0}, {}}));
  drive(rig, {[&](double t) {
          return BodyState{{{}, quat_from_rpy(0, 0, w * t)}, {{}, {0, 0, w}}};
        }},
        substeps, 150);
  const double half = 0.5 * w * 0.02 / substeps;
  expect_near(reading(rig).linear_acceleration, {-w * w * r * math::sin(half) / half, 0, g}, 1e-10);
  EXPECT_NEAR(reading(rig).linear_acceleration.x, -w * w * r, w * w * r * half * half / 6 * 1.01);
  expect_near(reading(rig).angular_velocity, {0, 0, w}, 1e-10);
}

TEST(Imu, SpinningUpShowsTheTangentialForce) {
  // Angular acceleration a about z: -a r along x for a sensor at y = r; centripetal force along -y.
  const double a = 2, r = 0.3;
  Rig rig(kind, test::two_wheels(), 0.002);
  ASSERT_TRUE(rig.add("imu", config({}), 1, 0, {{0, r, 0}, {}}));
  drive(rig, {[&](double t) {
          return BodyState{{{}, quat_from_rpy(0, 0, 0.5 * a * t * t)}, {{}, {0, 0, a * t}}};
        }},
        2, 500);
  // The mean over the last interval belongs to its middle, t = 0.999 s; errors are of order (w h)^2 = 4e-6.
  expect_near(reading(rig).linear_acceleration, {-a * r, -a * a * 0.999 * 0.999 * r, g}, 1e-5);
  EXPECT_NEAR(reading(rig).angular_velocity.z, a * 0.999, 1e-9);
}

TEST(Imu, ItAveragesOverTheWholeIntervalAndNotTheLastTick) {
  // A blow in the second of five ticks: 0.1 m/s in 50 ms is 2 m/s^2.
  Rig rig(kind, test::two_wheels(), 0.01);
  ASSERT_TRUE(rig.add("imu", config({{"rate", "20"}})));
  for (int tick = 0; tick < 5; ++tick) {
    rig.pool->pre_substep(rig.context(rig.now + rig.tick), rig.due(), 0.01);
    rig.engine->body[0].V_WB.linear.x = tick >= 1 ? 0.1 : 0;
    rig.now = rig.now + rig.tick;
  }
  rig.sense();
  expect_near(reading(rig).linear_acceleration, {2, 0, g}, 1e-11);
  // The next interval begins there.
  rig.pool->pre_substep(rig.context(rig.now + rig.tick), rig.due(), 0.01);
  rig.sense();
  expect_near(reading(rig).linear_acceleration, {0, 0, g}, 1e-11);
}

TEST(Imu, TheOrientationIsThatInItsReferenceFrame) {
  const auto orientation = [](std::initializer_list<std::pair<const char*, const char*>> keys) {
    model::Model model = test::two_wheels();
    Rig rig(kind, model);
    rig.instance.X_WM = pose_from_rpy({}, {0, 0, 1.0});
    Node node = config(keys);
    if (Node* const rpy = node.find("reference_rpy")) {
      Node list = Node::sequence();
      for (const char* x : {"0", "0", "0.4"}) list.push(Node::scalar(x));
      *rpy = std::move(list);
    }
    EXPECT_TRUE(rig.add("imu", std::move(node)));
    rig.engine->body[0].X_WB.q = quat_from_rpy(0, 0, 1.5);
    rig.sense();
    return yaw_of(reading(rig).orientation);
  };
  EXPECT_NEAR(orientation({}), 1.5, 1e-12);
  EXPECT_NEAR(orientation({{"reference", "world"}}), 1.5, 1e-12);
  EXPECT_NEAR(orientation({{"reference", "start"}}), 0.5, 1e-12);
  EXPECT_NEAR(orientation({{"reference", "custom"}, {"reference_rpy", ""}}), 1.1, 1e-12);
}

Node noisy() {
  Node gyro_x = config({{"white", "0.02"}, {"mean", "0.3"}});
  Node accel_z = config({{"mean_std", "0.5"}});
  accel_z.set("bias", config({{"bias_std", "0.2"}, {"correlation", "0.001"}}));
  Node gyro = Node::map(), accel = Node::map(), node = config({});
  gyro.set("x", std::move(gyro_x));
  accel.set("z", std::move(accel_z));
  node.set("gyro", std::move(gyro));
  node.set("accel", std::move(accel));
  return node;
}

TEST(Imu, EachAxisHasItsOwnNoise) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("imu", noisy()));
  double sum = 0, squares = 0, accel = 0, accel_squares = 0;
  constexpr int n = 10'000;
  for (int i = 0; i < n; ++i) {
    rig.sense();
    const msg::Imu& m = reading(rig);
    sum += m.angular_velocity.x;
    squares += (m.angular_velocity.x - 0.3) * (m.angular_velocity.x - 0.3);
    EXPECT_EQ(m.angular_velocity.y, 0);
    EXPECT_EQ(m.linear_acceleration.x, 0);
    accel += m.linear_acceleration.z - g;
    accel_squares += (m.linear_acceleration.z - g) * (m.linear_acceleration.z - g);
  }
  EXPECT_NEAR(sum / n, 0.3, 5 * 0.02 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.02, 5 * 0.02 / std::sqrt(2.0 * n));
  // Samples 10 ms apart at a correlation of 1 ms are independent: about the drawn constant with a deviation
  // of 0.2.
  const double constant = accel / n;
  EXPECT_NE(constant, 0);
  EXPECT_LT(std::abs(constant), 5 * 0.5);
  EXPECT_NEAR(std::sqrt(accel_squares / n - constant * constant), 0.2, 5 * 0.2 / std::sqrt(2.0 * n));
  EXPECT_NEAR(reading(rig).angular_velocity_covariance[0], 0.02 * 0.02, 1e-15);
  EXPECT_NEAR(reading(rig).linear_acceleration_covariance[8], 0.2 * 0.2, 1e-15);
  EXPECT_EQ(reading(rig).linear_acceleration_covariance[0], 0);
}

// Turns of 0.2 rad about the reference's z and then of 0.1 rad of the sensor about its own x: the error is about the reference's axes.
TEST(Imu, TheOrientationsErrorIsATurnAboutTheReferencesAxes) {
  Rig rig(kind, test::two_wheels());
  Node errors = Node::map();
  errors.set("z", config({{"mean", "0.2"}}));
  Node keys = Node::map();
  keys.set("orientation", errors);
  ASSERT_TRUE(rig.add("imu", keys));
  const BodyState rolled{.X_WB = {{}, quat_from_axis_angle({1, 0, 0}, 0.1)}};
  drive(rig, {[&](double) { return rolled; }}, 1, 1);
  const Quat expected = quat_from_axis_angle({0, 0, 1}, 0.2) * rolled.X_WB.q, q = reading(rig).orientation;
  EXPECT_NEAR(std::abs(q.w * expected.w + q.x * expected.x + q.y * expected.y + q.z * expected.z), 1, 1e-12);
  for (const double each : reading(rig).orientation_covariance) EXPECT_EQ(each, 0);
}

// White noise about z, drift about x. 4000 samples: the rms of white noise within 5 / sqrt(2 * 4000) = 5.6 %.
TEST(Imu, TheOrientationsCovarianceIsThatOfItsErrors) {
  Rig rig(kind, test::two_wheels());
  Node errors = Node::map();
  errors.set("z", config({{"white", "0.01"}}));
  Node drift = Node::map();
  drift.set("bias", config({{"bias_std", "0.02"}, {"correlation", "30"}}));
  errors.set("x", drift);
  Node keys = Node::map();
  keys.set("orientation", errors);
  ASSERT_TRUE(rig.add("imu", keys));
  double squares = 0, most_step = 0, before = 0;
  constexpr int samples = 4000;
  for (int i = 0; i < samples; ++i) {
    drive(rig, {[](double) { return BodyState{}; }}, 1, 1);
    const Quat q = reading(rig).orientation;
    squares += 4 * q.z * q.z;
    if (i > 0) most_step = std::max(most_step, std::abs(2 * q.x - before));
    before = 2 * q.x;
  }
  EXPECT_NEAR(std::sqrt(squares / samples), 0.01, 0.01 * 0.056);
  // A step of the drift has the deviation 0.02 sqrt(2 dt / tau) = 5.2e-4 at 10 ms.
  EXPECT_GT(most_step, 5e-4);
  EXPECT_LT(most_step, 6 * 5.2e-4);
  const auto& C = reading(rig).orientation_covariance;
  EXPECT_NEAR(C[8], 1e-4, 1e-12);
  EXPECT_NEAR(C[0], 4e-4, 1e-12);
  EXPECT_EQ(C[4], 0);
}

TEST(Imu, TheDrawnConstantSpreadsOverDevices) {
  Rig rig(kind, test::two_wheels());
  constexpr int devices = 500;
  Node axis = config({{"mean_std", "0.5"}}), accel = Node::map(), node = config({});
  accel.set("z", std::move(axis));
  node.set("accel", std::move(accel));
  for (int i = 0; i < devices; ++i) ASSERT_TRUE(rig.add("imu" + std::to_string(i), node));
  rig.sense();
  double squares = 0;
  for (int i = 0; i < devices; ++i) {
    const double e = rig.topic<msg::Imu>("imu" + std::to_string(i) + "/imu").message.linear_acceleration.z -
                     g;
    squares += e * e;
  }
  EXPECT_NEAR(std::sqrt(squares / devices), 0.5, 5 * 0.5 / std::sqrt(2.0 * devices));
}

TEST(Imu, StateSurvivesSavingInTheMiddleOfAnInterval) {
  const Path path{[](double t) {
    return BodyState{{{t, 0, 0}, quat_from_rpy(0, 0, t)}, {{1 + t, 0, 0}, {0, 0, 1}}};
  }};
  Rig a(kind, test::two_wheels()), b(kind, test::two_wheels());
  for (Rig* rig : {&a, &b}) ASSERT_TRUE(rig->add("imu", noisy()));
  drive(a, path, 2, 3);
  a.engine->body[0] = path.at(a.now.s());
  a.pool->pre_substep(a.context(a.now), a.due(), 0.005);
  b.load(a.saved());
  b.now = a.now;
  b.sample = a.sample;
  drive(a, path, 2, 2);
  drive(b, path, 2, 2);
  EXPECT_EQ(reading(a).linear_acceleration, reading(b).linear_acceleration);
  EXPECT_EQ(a.saved(), b.saved());
}

TEST(ImuFromSdf, TakesTheNoiseGroupsAndTheReferenceFrame) {
  const auto axis = [](std::initializer_list<std::pair<const char*, const char*>> keys) {
    Node out = Node::map();
    Node noise = config(keys);
    noise.set("@type", Node::scalar("gaussian"));
    out.set("noise", std::move(noise));
    return out;
  };
  Node rates = Node::map(), forces = Node::map(), frame = config({{"localization", "NED"}}),
       imu = Node::map();
  rates.set("y", axis({{"mean", "0.01"},
                       {"stddev", "2e-4"},
                       {"bias_mean", "7.5e-6"},
                       {"bias_stddev", "8e-7"},
                       {"dynamic_bias_stddev", "4e-6"},
                       {"dynamic_bias_correlation_time", "800"}}));
  forces.set("z", axis({{"stddev", "0.017"}}));
  imu.set("angular_velocity", std::move(rates));
  imu.set("linear_acceleration", std::move(forces));
  imu.set("orientation_reference_frame", std::move(frame));
  Node sensor = config({{"@type", "imu"}, {"update_rate", "200"}});
  sensor.set("imu", std::move(imu));
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(sensor, diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<Spec>(*node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->rate_hz, 200);
  EXPECT_NEAR(spec->gyro.y.mean, 0.0100075, 1e-12);
  EXPECT_EQ(spec->gyro.y.white, 2e-4);
  EXPECT_EQ(spec->gyro.y.mean_std, 8e-7);
  EXPECT_NEAR(spec->gyro.y.bias.bias_std, 4e-6 * 20, 1e-15);  // sqrt(800 / 2) = 20
  EXPECT_EQ(spec->gyro.y.bias.correlation_s, 800);
  EXPECT_EQ(spec->gyro.x.white, 0);
  EXPECT_EQ(spec->accel.z.white, 0.017);
  // North, east, down in a world of east, north, up: x to y, y to x, z to -z.
  const Vec3 rpy = spec->reference_rpy_rad;
  const Quat q = quat_from_rpy(rpy.x, rpy.y, rpy.z);
  expect_near(rotate(q, {1, 0, 0}), {0, 1, 0}, 1e-12);
  expect_near(rotate(q, {0, 1, 0}), {1, 0, 0}, 1e-12);
  EXPECT_TRUE(diagnostics.warnings.empty());
}

TEST(ImuFromSdf, TheGroupAroundABareSensorIsRelativeToTheStart) {
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(config({{"@type", "imu"}}), diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<Spec>(*node);
  ASSERT_TRUE(spec);
  EXPECT_EQ(spec->reference, Reference::start);
  EXPECT_EQ(spec->rate_hz, 0);
}

}  // namespace
}  // namespace sandlot::imu
