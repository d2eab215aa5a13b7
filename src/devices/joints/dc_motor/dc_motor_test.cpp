#include "devices/joints/dc_motor/dc_motor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::dc_motor {
namespace {

using test::config;
using test::Rig;
using test::two_wheels;

constexpr double h = 0.001;

/// 12 V, 2 Ohm, 0.05 Nm/A, gear 10: 3 Nm at rest and 24 rad/s without load.
Node keys(std::initializer_list<std::pair<const char*, const char*>> more = {}) {
  Node node = config({{"joint", "left"},
                      {"supply_voltage", "12"},
                      {"resistance", "2"},
                      {"torque_constant", "0.05"},
                      {"gear_ratio", "10"}});
  for (const auto& [key, value] : more) node.set(key, Node::scalar(value));
  return node;
}

struct Bench : Rig {
  explicit Bench(Node node, Level level = voltage) : Rig(kind, two_wheels(), h), level_(level) {
    const Status added = add("m", std::move(node), 1u << level);
    EXPECT_TRUE(added) << (added ? "" : added.error().text());
    engine->inertia[0] = 0.1;
  }
  void order(double x) { command<msg::Float64>(std::string("m/") + kind.levels[level_].name, {x}); }
  const msg::MotorState& reading() {
    sense();
    return topic<msg::MotorState>(std::string("m/") + kind.levels[level_].name).message;
  }
  JointState& joint() { return engine->joint[0]; }

 private:
  Level level_;
};

TEST(DcMotor, SpeedsUpAsItsEquationSays) {
  Bench bench(keys({{"rotor_inertia", "2e-4"}, {"viscous_friction", "1e-4"}}));
  bench.order(12);
  // 0.1 + 100 * 2e-4 = 0.12 kg m^2; 3 Nm - (0.25 / 2 + 100 * 1e-4) w
  double w = 0;
  for (int i = 0; i < 400; ++i) {
    bench.act();
    w = (0.12 / h * w + 3) / (0.12 / h + 0.135);
    ASSERT_NEAR(bench.joint().velocity, w, 1e-12 * (1 + w)) << i;
  }
  // The continuous solution, at 0.45 time constants; backward Euler is off by about h / T = 1e-3.
  const double T = 0.12 / 0.135;
  EXPECT_NEAR(w, 3 / 0.135 * (1 - math::exp(-0.4 / T)), 3e-3 * w);
}

TEST(DcMotor, TheTorqueSpeedLineGoesFromStallToNoLoad) {
  Bench bench(keys());
  bench.engine->inertia[0] = 1e12;
  bench.order(12);
  bench.act();
  EXPECT_NEAR(bench.reading().torque, 3, 1e-9);
  EXPECT_NEAR(bench.reading().current, 6, 1e-9);
  EXPECT_NEAR(bench.reading().voltage, 12, 1e-9);
  bench.joint().velocity = 12;
  bench.act();
  EXPECT_NEAR(bench.reading().torque, 1.5, 1e-9);
  bench.engine->inertia[0] = 1e-3;
  for (int i = 0; i < 500; ++i) bench.act();
  EXPECT_NEAR(bench.joint().velocity, 24, 1e-9);
  EXPECT_NEAR(bench.reading().current, 0, 1e-9);
}

TEST(DcMotor, FrictionMakesTheNoLoadCurrent) {
  Bench bench(keys({{"friction", "0.01"}}));
  bench.order(12);
  for (int i = 0; i < 20000; ++i) bench.act();
  // k i = 0.01 Nm: 0.2 A; the back-EMF lacks 2 * 0.2 V.
  EXPECT_NEAR(bench.reading().current, 0.2, 1e-6);
  EXPECT_NEAR(bench.joint().velocity, (12 - 0.4) / 0.5, 1e-5);
  // Below 0.4 V it does not start.
  Bench weak(keys({{"friction", "0.01"}}));
  weak.order(0.39);
  for (int i = 0; i < 100; ++i) weak.act();
  EXPECT_EQ(weak.joint().velocity, 0);
}

TEST(DcMotor, TheCurrentRisesWithItsTimeConstant) {
  Bench bench(keys({{"inductance", "0.004"}}));
  bench.engine->inertia[0] = 1e12;
  bench.order(12);
  for (int i = 1; i <= 10; ++i) {
    bench.act();
    // T = L / R = 2 ms. The mean over (i-1, i) ms is 6 (1 - T/h (e^-(i-1)h/T - e^-ih/T)).
    const double before = math::exp(-0.5 * (i - 1)), after = math::exp(-0.5 * i);
    EXPECT_NEAR(bench.reading().current, 6 * (1 - 2 * (before - after)), 1e-9) << i;
    EXPECT_NEAR(bench.reading().torque, 0.5 * 6 * (1 - 2 * (before - after)), 1e-9) << i;
  }
}

TEST(DcMotor, TheDerivativeGainBrakesWhatSpeedsUp) {
  Node node = keys();
  node.set("velocity", config({{"p", "0"}, {"i", "0"}, {"d", "0.5"}}));
  Bench bench(std::move(node), velocity);
  bench.engine->inertia[0] = 1e12;
  bench.joint().velocity = 3;
  bench.order(3);
  bench.act();
  EXPECT_NEAR(bench.reading().voltage, 0, 1e-9) << "the first run has nothing to compare with";
  bench.joint().velocity = 3.02;
  bench.act();
  EXPECT_NEAR(bench.reading().voltage, -0.5 * 0.02 / h, 1e-9);
  bench.act();
  EXPECT_NEAR(bench.reading().voltage, 0, 1e-9);
}

TEST(DcMotor, GearLossesWorkBothWays) {
  Bench bench(keys({{"gear_efficiency", "0.8"}}));
  bench.engine->inertia[0] = 1e12;
  bench.order(12);
  bench.act();
  EXPECT_NEAR(bench.reading().torque, 0.8 * 3, 1e-9);
  // Driven faster than no-load, the motor brakes, and the gear brakes with it.
  bench.joint().velocity = 36;
  bench.act();
  EXPECT_NEAR(bench.reading().torque, -1.5 / 0.8, 1e-9);
}

TEST(DcMotor, CurrentAndSupplyLimit) {
  Bench limited(keys({{"max_current", "4"}}));
  limited.engine->inertia[0] = 1e12;
  limited.order(12);
  limited.act();
  EXPECT_NEAR(limited.reading().current, 4, 1e-12);
  EXPECT_NEAR(limited.reading().torque, 2, 1e-12);
  EXPECT_NEAR(limited.reading().voltage, 8, 1e-12);
  // Half the duty: 6 V behind 2 + 0.25 * 2 Ohm; the motor's share of it is 2 / 2.5.
  Bench soft(keys({{"supply_resistance", "2"}}), pwm);
  soft.engine->inertia[0] = 1e12;
  soft.order(0.5);
  soft.act();
  EXPECT_NEAR(soft.reading().current, 6 / 2.5, 1e-9);
  EXPECT_NEAR(soft.reading().voltage, 6 * 2 / 2.5, 1e-9);
  soft.order(7);
  soft.act();
  EXPECT_NEAR(soft.reading().current, 12.0 / 4, 1e-9);
}

TEST(DcMotor, LevelEffortGivesItsTorqueAsFarAsTheSupplyReaches) {
  Bench bench(keys({{"gear_efficiency", "0.8"}}), effort);
  bench.engine->inertia[0] = 1e12;
  bench.order(1);
  bench.act();
  EXPECT_NEAR(bench.reading().torque, 1, 1e-12);
  EXPECT_NEAR(bench.reading().current, 2.5, 1e-12);
  // At 20 rad/s the back-EMF is 10 V: 1 A is all that 12 V can drive.
  bench.joint().velocity = 20;
  bench.act();
  EXPECT_NEAR(bench.reading().torque, 0.4, 1e-9);
  EXPECT_NEAR(bench.reading().voltage, 12, 1e-9);
}

TEST(DcMotor, WithoutACommandItCoastsAgainstItsFriction) {
  Bench bench(keys({{"friction", "0.002"}, {"rotor_inertia", "1e-3"}}));
  bench.joint().velocity = 5;
  for (int i = 0; i < 100; ++i) bench.act();
  // 0.02 Nm on 0.1 + 0.1 kg m^2 for 0.1 s
  EXPECT_NEAR(bench.joint().velocity, 5 - 0.1 * 0.1, 1e-9);
  EXPECT_EQ(bench.reading().current, 0);
}

TEST(DcMotor, TheLoopRunsAtItsRateOnWhatTheEncoderShows) {
  // 100 counts per turn of the motor: 1000 per turn of the joint, so 0.628 rad/s per count at 100 Hz.
  Bench bench(keys({{"encoder_counts", "100"}, {"loop_rate", "100"}}), velocity);
  Bench fresh(keys(), velocity);
  bench.engine->inertia[0] = 1e12;
  bench.joint().velocity = 5;
  bench.order(8);
  std::vector<double> volts;
  for (int i = 0; i < 40; ++i) {
    bench.act();
    volts.push_back(bench.reading().voltage);
  }
  for (std::size_t i = 1; i < volts.size(); ++i) {
    if (i % 10 == 0) continue;
    EXPECT_EQ(volts[i], volts[i - 1]) << i;
  }
  // p = 1, i = 10 per second. First run: no count yet, so rate 0: 8 V; the integral grows by 0.01 * 10 * 8.
  // After 10 ms the joint turned by 0.05 rad: 7 counts (7.96) are 4.398 rad/s.
  const double count = math::tau / 1000;
  EXPECT_NEAR(volts[0], 8, 1e-9);
  EXPECT_NEAR(volts[10], 8 - 7 * count / 0.01 + 0.8, 1e-9);
}

TEST(DcMotor, TheSpeedLoopFollowsARampAndHoldsItsSpeedUnderLoad) {
  Bench bench(keys({{"max_acceleration", "20"}}), velocity);
  bench.order(10);
  for (int i = 0; i < 250; ++i) bench.act();
  EXPECT_NEAR(bench.reading().target, 5, 1e-9);
  // 0.4 s^2 + 1.5 s + 10 = 0: it settles with 1.9 per second.
  for (int i = 0; i < 10000; ++i) bench.act();
  EXPECT_NEAR(bench.joint().velocity, 10, 1e-4);
  bench.engine->outside[0] = -0.5;
  for (int i = 0; i < 10000; ++i) bench.act();
  EXPECT_NEAR(bench.joint().velocity, 10, 1e-4);  // the integral of the loop
  EXPECT_NEAR(bench.reading().current, 1, 1e-4);  // 0.5 Nm / (10 * 0.05)
}

TEST(DcMotor, LevelPositionHoldsAnAngle) {
  Bench bench(keys(), position);
  bench.order(0.5);
  // 0.4 s^2 + 0.5 s + 10 = 0: it settles with 0.6 per second.
  for (int i = 0; i < 30000; ++i) bench.act();
  EXPECT_NEAR(bench.joint().position, 0.5, 1e-6);
}

TEST(DcMotor, ASavedMotorGoesOnWithTheSameBits) {
  const Node node = keys({{"inductance", "0.004"}, {"encoder_counts", "100"}, {"loop_rate", "300"}});
  Bench one(node, velocity), two(node, velocity);
  one.order(10);
  for (int i = 0; i < 57; ++i) one.act();
  two.order(10);  // the slot is State too, and would come back with the same count
  two.load(one.saved());
  two.joint() = one.joint();
  for (int i = 0; i < 50; ++i) {
    one.act();
    two.act();
    ASSERT_EQ(one.saved(), two.saved()) << i;
    ASSERT_EQ(one.joint().velocity, two.joint().velocity) << i;
  }
}

TEST(DcMotor, ASwitchKeepsTheVoltage) {
  Bench bench(keys());
  bench.order(6);
  for (int i = 0; i < 100; ++i) bench.act();
  const double effort_before = bench.joint().effort;
  ASSERT_TRUE(bench.switch_level(1u << pwm));
  bench.act();
  // Half the supply, as before: the torque goes on along its line.
  EXPECT_NEAR(bench.joint().effort, effort_before, 0.02);
  EXPECT_FALSE(bench.switch_level(3));
}

TEST(DcMotor, ASwitchToPositionTakesOverWhatItsDerivativeGainWillTakeAway) {
  Node node = keys();
  node.set("position", config({{"p", "10"}, {"i", "1"}, {"d", "0.5"}}));
  Bench bench(node);
  bench.order(6);
  for (int i = 0; i < 100; ++i) bench.act();
  const double effort_before = bench.joint().effort;
  EXPECT_GT(bench.joint().velocity, 1);
  ASSERT_TRUE(bench.switch_level(1u << position));
  bench.act();
  // The error is 0 and the voltage still 6 V: it does not fall by 0.5 V s/rad times the speed, which would
  // cost 0.25 Nm/V * 0.5 V.
  EXPECT_NEAR(bench.joint().effort, effort_before, 0.02);
}

TEST(DcMotor, RefusesWhatItCannotTurn) {
  Rig rig(kind, two_wheels());
  const Status slider = rig.add("m", config({{"joint", "lift"}}));
  ASSERT_FALSE(slider);
  EXPECT_EQ(slider.error().place.line, 1);
  const Status unknown = rig.add("m", config({{"joint", "lefd"}}));
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().text().find("left"), std::string::npos);
  rig.engine->what.joints = false;
  EXPECT_FALSE(rig.add("m", config({{"joint", "left"}})));
  rig.engine->what.joints = true;
  EXPECT_FALSE(rig.add("m", config({{"joint", "left"}}), 3));
  EXPECT_TRUE(rig.add("m", config({{"joint", "left"}})));
}

TEST(DcMotor, ACommandThatIsNoNumberChangesNothing) {
  Bench bench(keys());
  bench.order(std::nan(""));
  bench.act();
  EXPECT_EQ(bench.joint().effort, 0);
}

}  // namespace
}  // namespace sandlot::dc_motor
