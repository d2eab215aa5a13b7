#include "devices/joints/joint_motor/joint_motor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::joint_motor {
namespace {

using test::config;
using test::Rig;

constexpr std::uint32_t velocity_bit = 1, position_bit = 2, effort_bit = 4;

Node gains(const char* which, std::initializer_list<std::pair<const char*, const char*>> values,
           const char* joint = "left") {
  Node node = config({{"joint", joint}});
  node.set(which, config(values));
  return node;
}

TEST(JointMotor, APositionStepFollowsTheSecondOrderSystem) {
  // Inertia 1, u = p (r - y) - d y': w = sqrt(p) = 4, zeta = d / (2 w) = 0.5. Closed form of the step
  // response: y = 1 - exp(-zeta w t) (cos(wd t) + zeta/sqrt(1-zeta^2) sin(wd t)), wd = w sqrt(1 - zeta^2).
  // Holding u over h delays it by h/2 on average: an error of about w h / 2 = 0.002 in phase at the steepest
  // slope.
  const double w = 4, zeta = 0.5, wd = w * std::sqrt(1 - zeta * zeta);
  Rig rig(kind, test::two_wheels(), 0.001);
  ASSERT_TRUE(rig.add("motor", gains("position", {{"p", "16"}, {"d", "4"}}), position_bit));
  rig.command("motor/position", msg::Float64{1.0});
  double worst = 0, highest = 0;
  for (int k = 1; k <= 3000; ++k) {
    rig.act();
    const double t = 0.001 * k;
    const double exact = 1 - math::exp(-zeta * w * t) *
                                 (math::cos(wd * t) + zeta / std::sqrt(1 - zeta * zeta) * math::sin(wd * t));
    worst = std::max(worst, std::abs(rig.engine->joint[0].position - exact));
    highest = std::max(highest, rig.engine->joint[0].position);
  }
  EXPECT_LT(worst, 0.002);
  EXPECT_NEAR(highest, 1 + math::exp(-math::pi * zeta / std::sqrt(1 - zeta * zeta)),
              0.002);  // overshoot 16.3 %
}

TEST(JointMotor, AVelocityStepFollowsTheFirstOrderSystem) {
  // u = p (r - v), inertia J: v = r (1 - exp(-p t / J)); with u held over h, exactly v_k = r (1 - (1 - p h /
  // J)^k).
  Rig rig(kind, test::two_wheels());
  rig.engine->inertia[0] = 0.5;
  ASSERT_TRUE(rig.add("motor", gains("velocity", {{"p", "2"}}), velocity_bit));
  rig.command("motor/velocity", msg::Float64{3.0});
  for (int k = 1; k <= 200; ++k) {
    rig.act();
    EXPECT_NEAR(rig.engine->joint[0].velocity, 3 * (1 - math::pow(1 - 2 * 0.01 / 0.5, k)), 1e-12);
  }
}

TEST(JointMotor, TheIntegralRemovesALastingError) {
  // A constant load of 2 N on the slider: without I the error stays at load / p = 0.02 m.
  for (const bool with_integral : {false, true}) {
    Rig rig(kind, test::two_wheels(), 0.001);
    Node node = gains("position", {{"p", "100"}, {"d", "20"}, {"i", with_integral ? "100" : "0"}}, "lift");
    ASSERT_TRUE(rig.add("motor", std::move(node), position_bit));
    rig.command("motor/position", msg::Float64{0.3});
    rig.engine->outside[2] = -2.0;
    for (int k = 0; k < 10'000; ++k) rig.act();
    EXPECT_NEAR(rig.engine->joint[2].position, with_integral ? 0.3 : 0.28, 1e-4);
  }
}

TEST(JointMotor, AntiWindupForgetsWhatTheLimitPrevented) {
  // Held by a limit of 1 Nm the joint turns for 2 s; without unwinding the integral would grow to i * error *
  // 2 s. It may not exceed what makes the output just reach its limit: |I| <= limit + p |e| + d |v|.
  Pid pid;
  const Gains g{.p = 1, .i = 10, .d = 0, .anti_windup_s = 0.05};
  for (int k = 0; k < 2000; ++k) EXPECT_LE(pid.step(g, 5.0, 0.0, 1.0, 0.001), 1.0);
  // Steady state of I' = i e + (limit - (p e + I)) / T: I = limit - p e + i e T.
  EXPECT_NEAR(pid.integral, 1.0 - 5.0 + 10 * 5.0 * 0.05, 1e-9);
  // The error changes sign: the output leaves its limit in a few T, not in 2 s * 5 / 5.
  int steps = 0;
  while (pid.step(g, -0.5, 0.0, 1.0, 0.001) > -0.4 && steps < 2000) ++steps;
  EXPECT_LT(steps, 100);
}

TEST(JointMotor, AntiWindupIsStableForAnyStep) {
  Pid pid;
  const Gains g{.p = 1, .i = 10, .d = 0, .anti_windup_s = 1e-6};
  for (int k = 0; k < 100; ++k) pid.step(g, 5.0, 0.0, 1.0, 0.1);
  EXPECT_NEAR(pid.integral, 1.0 - 5.0 + 10 * 5.0 * 0.1, 1e-9);  // one step's worth beyond the limit
}

TEST(JointMotor, LimitsHold) {
  model::Model model = test::two_wheels();
  model.joints[0].max_effort = 3;
  model.joints[0].max_velocity = 2;
  Rig rig(kind, model);
  Node node = gains("position", {{"p", "1000"}, {"d", "50"}});
  ASSERT_TRUE(rig.add("motor", std::move(node), position_bit));
  rig.command("motor/position", msg::Float64{10.0});
  double fastest = 0;
  for (int k = 0; k < 300; ++k) {
    rig.act();
    EXPECT_LE(std::abs(rig.engine->joint[0].effort), 3.0);
    fastest = std::max(fastest, rig.engine->joint[0].velocity);
  }
  // The reference runs at 2 rad/s; the joint follows it, catching up once after the start.
  EXPECT_NEAR(rig.engine->joint[0].velocity, 2.0, 0.02);
  EXPECT_LT(fastest, 2.6);
  EXPECT_TRUE(rig.pool->set_parameter(0, "max_effort", Node::scalar("0.5")));
  rig.command("motor/position", msg::Float64{-10.0});
  for (int k = 0; k < 10; ++k) {
    rig.act();
    EXPECT_LE(std::abs(rig.engine->joint[0].effort), 0.5);
  }
  EXPECT_FALSE(rig.pool->set_parameter(0, "joint", Node::scalar("right")));
  EXPECT_TRUE(rig.pool->set_parameter(0, "position/p", Node::scalar("5")));
  EXPECT_FALSE(rig.pool->set_parameter(0, "position/p", Node::scalar("-5")));
}

/// Joint 0 with soft limits of -8 and 0.5 rad: its speed may be 4 (0.5 - x) towards the upper one, its torque 10 (highest - v).
model::Model with_soft_limits() {
  model::Model model = test::two_wheels();
  model.joints[0].max_velocity = 2;
  model.joints[0].safety = model::SafetyLimits{
      .soft_lower = -8, .soft_upper = 0.5, .k_position = 4, .k_velocity = 10};
  return model;
}

TEST(JointMotor, AnEffortIsHeldBackByTheSafetyLimits) {
  // 5 Nm against a damping of 1 Nm s/rad would give 5 rad/s. Far from the limit 10 (2 - v) = v holds at v = 20/11; near it
  // x'' = -10 (v - 4 (0.5 - x)) - v comes to rest at 0.5 exactly, w = sqrt(40) and damping 11 / (2 w) = 0.87: beyond it by less
  // than exp(-pi 0.87 / sqrt(1 - 0.87^2)) = 0.4 % of what is left when it begins to brake.
  Rig rig(kind, with_soft_limits(), 0.001);
  ASSERT_TRUE(rig.add("motor", config({{"joint", "left"}}), effort_bit));
  rig.engine->joint[0].position = -6;
  rig.command("motor/effort", msg::Float64{5});
  double highest = -6;
  for (int k = 0; k < 8000; ++k) {
    rig.engine->outside[0] = -rig.engine->joint[0].velocity;
    rig.act();
    highest = std::max(highest, rig.engine->joint[0].position);
    if (k == 1500) { EXPECT_NEAR(rig.engine->joint[0].velocity, 20.0 / 11, 0.01); }
  }
  EXPECT_NEAR(rig.engine->joint[0].position, 0.5, 1e-6);
  EXPECT_LT(highest, 0.505);
  rig.command("motor/effort", msg::Float64{-5});
  for (int k = 0; k < 8000; ++k) {
    rig.engine->outside[0] = -rig.engine->joint[0].velocity;
    rig.act();
  }
  EXPECT_NEAR(rig.engine->joint[0].position, -8, 1e-6) << "and at the other end";
}

TEST(JointMotor, SpeedsAndPositionsAreCutToTheSafetyLimits) {
  // An exact servo has the speed that its position allows: x' = 4 (0.5 - x) below 0 rad, so e^-4t from there on.
  Rig rig(kind, with_soft_limits(), 0.001);
  Node exact = config({{"joint", "left"}, {"servo", "exact"}});
  ASSERT_TRUE(rig.add("motor", std::move(exact), velocity_bit));
  rig.command("motor/velocity", msg::Float64{100});
  for (int k = 0; k < 1000; ++k) {
    rig.act();
    EXPECT_LE(rig.engine->joint[0].velocity, std::min(2.0, 4 * (0.5 - rig.engine->joint[0].position)) + 0.01);
  }
  EXPECT_NEAR(rig.engine->joint[0].position, 0.5 - 0.5 * math::exp(-4.0), 1e-4);

  Rig angle(kind, with_soft_limits(), 0.001);
  Node servo = config({{"joint", "left"}, {"servo", "exact"}});
  ASSERT_TRUE(angle.add("motor", std::move(servo), position_bit));
  angle.command("motor/position", msg::Float64{0.9});
  for (int k = 0; k < 1000; ++k) angle.act();
  EXPECT_NEAR(angle.engine->joint[0].position, 0.5 - 0.5 * math::exp(-4.0), 1e-3) << "with the same speeds";
  for (int k = 0; k < 4000; ++k) angle.act();
  EXPECT_NEAR(angle.engine->joint[0].position, 0.5, 1e-6) << "the command is cut to the soft limit";
}

TEST(JointMotor, PositionsStayWithinTheJointsRange) {
  Rig rig(kind, test::two_wheels(), 0.001);
  ASSERT_TRUE(rig.add("motor", gains("position", {{"p", "100"}, {"d", "20"}}, "lift"), position_bit));
  rig.command("motor/position", msg::Float64{7.0});
  for (int k = 0; k < 5000; ++k) rig.act();
  EXPECT_NEAR(rig.engine->joint[2].position, 0.5, 1e-6);  // the joint's upper end
}

TEST(JointMotor, IsFreeUntilItsFirstCommandAndIgnoresNonsense) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("motor", config({{"joint", "left"}}), effort_bit));
  rig.act();
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::free);
  rig.command("motor/effort", msg::Float64{NAN});
  rig.act();
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::free);
  rig.command("motor/effort", msg::Float64{2.5});
  rig.act();
  EXPECT_EQ(rig.engine->joint[0].effort, 2.5);
  rig.command("motor/effort", msg::Float64{INFINITY});
  rig.act();
  EXPECT_EQ(rig.engine->joint[0].effort, 2.5);
}

TEST(JointMotor, ASwitchOfLevelGoesOnWithoutAJump) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("motor", gains("position", {{"p", "10"}, {"d", "6"}, {"i", "5"}}), effort_bit));
  rig.command("motor/effort", msg::Float64{2.0});
  for (int k = 0; k < 10; ++k) rig.act();
  ASSERT_TRUE(rig.switch_level(position_bit));
  const double here = rig.engine->joint[0].position;
  rig.act();
  EXPECT_NEAR(rig.engine->joint[0].effort, 2.0, 1e-12);
  for (int k = 0; k < 3000; ++k) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].position, here, 1e-3);  // where it was, once the integral has settled
  EXPECT_EQ(rig.switch_level(3).error().what, "a joint motor runs at exactly one level");
}

TEST(JointMotor, StateAndTunablesSurviveSaving) {
  Rig a(kind, test::two_wheels()), b(kind, test::two_wheels());
  for (Rig* rig : {&a, &b}) {
    ASSERT_TRUE(rig->add("motor", gains("velocity", {{"p", "2"}, {"i", "3"}}), velocity_bit));
  }
  a.command("motor/velocity", msg::Float64{1.0});
  ASSERT_TRUE(a.pool->set_parameter(0, "velocity/i", Node::scalar("4")));
  for (int k = 0; k < 20; ++k) a.act();
  b.load(a.saved());
  EXPECT_EQ(b.saved(), a.saved());
  b.engine->joint = a.engine->joint;
  b.topic<msg::Float64>("motor/velocity/command").count = 1;
  a.act();
  b.act();
  EXPECT_EQ(b.saved(), a.saved());
  EXPECT_EQ(b.engine->joint[0].velocity, a.engine->joint[0].velocity);
}

TEST(JointMotor, StoppedItLeavesTheJointFreeAndStartedItHoldsWhatItFinds) {
  Rig rig(kind, test::two_wheels(), 0.001);
  ASSERT_TRUE(rig.add("motor", gains("position", {{"p", "100"}, {"d", "20"}}), position_bit));
  rig.command("motor/position", msg::Float64{1.0});
  for (int k = 0; k < 3000; ++k) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].position, 1, 1e-6);
  ASSERT_TRUE(rig.pool->set_parameter(0, "active", Node::scalar("false")));
  rig.act();
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::free);
  rig.engine->joint[0] = {2.0, 0.3, 0};  // pushed by hand
  rig.command("motor/position", msg::Float64{-1.0});
  rig.act();
  EXPECT_EQ(rig.engine->joint[0].velocity, 0.3);  // free: nothing brakes it
  ASSERT_TRUE(rig.pool->set_parameter(0, "active", Node::scalar("true")));
  const double found = rig.engine->joint[0].position;
  for (int k = 0; k < 3000; ++k) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].position, found,
              1e-6);  // not the command of the meantime, nor the one before
  rig.command("motor/position", msg::Float64{0.5});
  for (int k = 0; k < 3000; ++k) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].position, 0.5, 1e-6);
}

TEST(JointMotor, BuiltStoppedItWaitsForItsStart) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("motor", config({{"joint", "left"}, {"active", "false"}, {"initial_command", "3"}})));
  rig.command("motor/velocity", msg::Float64{1.0});
  rig.act();
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::free);
  ASSERT_TRUE(rig.pool->set_parameter(0, "active", Node::scalar("true")));
  rig.act();
  EXPECT_EQ(rig.engine->target[0].mode, JointTarget::Mode::effort);
  EXPECT_EQ(rig.engine->joint[0].velocity, 0);  // a command given while it was stopped is dropped
}

TEST(JointMotor, WhenItGoesTheJointIsFree) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("motor", config({{"joint", "right"}, {"initial_command", "3"}})));
  rig.act();
  EXPECT_EQ(rig.engine->target[1].mode, JointTarget::Mode::effort);
  rig.pool->release(0, rig.context(rig.now));
  ASSERT_EQ(rig.actuation.joints.size(), 1u);
  EXPECT_EQ(rig.actuation.joints[0].mode, JointTarget::Mode::free);
  EXPECT_EQ(rig.actuation.joints[0].joint.index, 1u);
}

TEST(JointMotor, TheExactServoHoldsTheSpeedAndClosesAFifthOfTheErrorPerSubstep) {
  Rig rig(kind, test::two_wheels(), 0.01);
  ASSERT_TRUE(
      rig.add("motor", config({{"joint", "left"}, {"servo", "exact"}, {"max_effort", "7"}}), position_bit));
  rig.command("motor/position", msg::Float64{1.0});
  for (int k = 1; k <= 10; ++k) {
    rig.act(2);
    EXPECT_NEAR(rig.engine->joint[0].position, 1 - math::pow(0.8, 2 * k), 1e-12);
    EXPECT_EQ(rig.engine->target[0].max_effort, 7);
  }
  ASSERT_TRUE(rig.switch_level(velocity_bit));
  rig.command("motor/velocity", msg::Float64{-2.0});
  rig.act();
  EXPECT_EQ(rig.engine->joint[0].velocity, -2);
}

Result<Spec> read_motor_spec(const Node& plugin, std::string& level, Diagnostics& diagnostics) {
  SL_ASSIGN(Node node, kind.from_sdf(plugin, diagnostics));
  level = node.find("level")->text();
  node.erase("level");
  return read_spec<Spec>(node);
}

TEST(JointMotorFromSdf, TakesTheThreePluginsOfGazebo) {
  Diagnostics diagnostics;
  std::string level;
  auto spec = read_motor_spec(config({{"@name", "gz::sim::systems::JointController"},
                                      {"joint_name", "left"},
                                      {"initial_velocity", "5"}}),
                              level, diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(level, "velocity");
  EXPECT_EQ(spec->servo, Servo::exact);
  EXPECT_EQ(spec->initial_command, 5);

  spec = read_motor_spec(config({{"@filename", "libignition-gazebo-joint-controller-system.so"},
                                 {"joint_name", "left"},
                                 {"use_force_commands", "true"},
                                 {"p_gain", "0.2"},
                                 {"cmd_max", "8"}}),
                         level, diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->servo, Servo::pid);
  EXPECT_EQ(spec->velocity.p, 0.2);
  EXPECT_EQ(spec->max_effort, 8);

  spec = read_motor_spec(config({{"@name", "gz::sim::systems::JointPositionController"},
                                 {"joint_name", "left"},
                                 {"p_gain", "20"},
                                 {"d_gain", "2"}}),
                         level, diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(level, "position");
  EXPECT_EQ(spec->position.p, 20);
  EXPECT_EQ(spec->position.i, 0.1);
  EXPECT_EQ(spec->position.d, 2);
  EXPECT_EQ(spec->initial_command, 0);

  spec = read_motor_spec(config({{"@name", "gz::sim::systems::ApplyJointForce"}, {"joint_name", "left"}}),
                         level, diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(level, "effort");
  EXPECT_FALSE(spec->initial_command);
  EXPECT_TRUE(diagnostics.warnings.empty());
  EXPECT_EQ(read_motor_spec(config({{"@name", "JointController"}}), level, diagnostics).error().what,
            "this plugin names no joint");
}

TEST(JointMotor, RefusesWhatItCannotDrive) {
  model::Model model = test::two_wheels();
  model.joints[1].type = model::JointType::fixed;
  Rig rig(kind, model);
  EXPECT_EQ(rig.add("m", config({{"joint", "right"}})).error().text(),
            "robot.yaml:1:9: /joint: joint 'right' cannot be driven; a motor needs a revolute, continuous or "
            "prismatic joint");
  EXPECT_EQ(
      rig.add("m", config({{"joint", "left"}}), 3).error().text(),
      "robot.yaml:12:5: a joint motor runs at exactly one level; give 'velocity', 'position' or 'effort'");
  rig.engine->what.joints = false;
  EXPECT_EQ(rig.add("m", config({{"joint", "left"}})).error().text(),
            "robot.yaml:12:5: the engine 'hand' does not simulate joints; use the engine 'rigid'");
}

TEST(JointMotor, CommandsCanBeSharesOfTheLimits) {
  // Limits of -0.3 and 0.5 m. Servo `exact` closes a fifth of the error in each step: after 200 there is
  // none.
  model::Model model = test::two_wheels();
  model.joints[2].lower = -0.3;
  const auto reached_m = [&](const char* commands, const char* given) {
    Rig rig(kind, model);
    EXPECT_TRUE(rig.add(
        "motor",
        config({{"joint", "lift"}, {"commands", commands}, {"servo", "exact"}, {"initial_command", given}}),
        position_bit));
    for (int i = 0; i < 200; ++i) rig.act();
    const double at_first = rig.engine->joint[2].position;
    double number = 0;
    EXPECT_TRUE(parse_number(given, number));
    rig.command("motor/position", msg::Float64{number});
    for (int i = 0; i < 200; ++i) rig.act();
    EXPECT_NEAR(rig.engine->joint[2].position, at_first, 1e-12)
        << "an initial command is one like the others";
    return at_first;
  };
  EXPECT_NEAR(reached_m("si", "0.2"), 0.2, 1e-12);
  EXPECT_NEAR(reached_m("share", "0.5"), 0.25, 1e-12);
  EXPECT_NEAR(reached_m("share", "-1"), -0.3, 1e-12);
  EXPECT_NEAR(reached_m("share", "7"), 0.5, 1e-12);
  EXPECT_NEAR(reached_m("centred", "0"), 0.1, 1e-12);
  EXPECT_NEAR(reached_m("centred", "-0.5"), -0.1, 1e-12);
}

TEST(JointMotor, SharesNeedALimit) {
  Rig rig(kind, test::two_wheels());
  const Status endless = rig.add("a", config({{"joint", "left"}, {"commands", "share"}}), position_bit);
  ASSERT_FALSE(endless);
  EXPECT_NE(endless.error().what.find("a limit that it does not have"), std::string::npos);
  EXPECT_FALSE(rig.add("b", config({{"joint", "left"}, {"commands", "share"}}), velocity_bit));
  EXPECT_TRUE(
      rig.add("c", config({{"joint", "left"}, {"commands", "share"}, {"max_velocity", "3"}}), velocity_bit));
}

}  // namespace
}  // namespace sandlot::joint_motor
