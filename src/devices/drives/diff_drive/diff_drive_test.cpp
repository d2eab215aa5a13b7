#include "devices/drives/diff_drive/diff_drive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::diff_drive {
namespace {

using test::config;
using test::Rig;

constexpr std::uint32_t ideal_bit = 1u << ideal, contact_bit = 1u << contact;

/// wheel radius 0.1, separation 0.5, as in test::two_wheels; limits out of the way unless a test sets them.
Node drive(std::initializer_list<std::pair<const char*, const char*>> more = {}) {
  Node node = config({{"left_joint", "left"},
                      {"right_joint", "right"},
                      {"wheel_radius", "0.1"},
                      {"wheel_separation", "0.5"},
                      {"max_linear_speed", "100"},
                      {"max_angular_speed", "100"},
                      {"max_linear_acceleration", "1e9"},
                      {"max_angular_acceleration", "1e9"}});
  for (const auto& [key, value] : more) node.set(key, Node::scalar(value, node.place()));
  return node;
}
msg::Twist twist(double v, double omega) {
  msg::Twist m;
  m.linear.x = v;
  m.angular.z = omega;
  return m;
}
const msg::Odometry& odometry(Rig& rig, const char* level) {
  rig.sense();
  return rig.topic<msg::Odometry>(std::string("drive/") + level).message;
}
void expect_pose(const Pose& pose, double x, double y, double theta, double tolerance) {
  EXPECT_NEAR(pose.p.x, x, tolerance);
  EXPECT_NEAR(pose.p.y, y, tolerance);
  EXPECT_NEAR(math::wrap_angle(yaw_of(pose.q) - theta), 0, tolerance);
}

TEST(DiffDrive, OnContactTheWheelsGetTheSpeedsOfTheInverseKinematics) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", drive({{"max_wheel_effort", "4"}}), contact_bit));
  rig.command("drive/contact", twist(0.5, 1.0));
  rig.act();
  // (0.5 -+ 1.0 * 0.25) / 0.1
  EXPECT_NEAR(rig.engine->target[0].velocity, 2.5, 1e-12);
  EXPECT_NEAR(rig.engine->target[1].velocity, 7.5, 1e-12);
  EXPECT_EQ(rig.engine->target[0].max_effort, 4);
  EXPECT_FALSE(rig.engine->drive.active);
}

TEST(DiffDrive, AnEngineThatRollsWheelsIsToldHow) {
  // The axle's centre lies 0.05 m to the left: with the hubs at y = 0.05 +- 0.25 m, wheel speed = (vx - wz y)
  // / 0.1 m.
  Rig rig(kind, test::two_wheels(0, 0.05));
  rig.engine->what.rolls = true;
  ASSERT_TRUE(rig.add("drive", drive(), ideal_bit));
  rig.pool->actuate(rig.context(rig.tick), rig.due());
  ASSERT_EQ(rig.actuation.rolls.size(), 2u);
  for (const RollTarget& roll : rig.actuation.rolls) {
    const double y = roll.wheel == rig.engine->joint_ids[0] ? 0.3 : -0.2;
    EXPECT_EQ(roll.base, rig.engine->body_ids[0]);
    EXPECT_NEAR(roll.per_vx, 10, 1e-12);
    EXPECT_EQ(roll.per_vy, 0);
    EXPECT_NEAR(roll.per_wz, -10 * y, 1e-12);
  }
  rig.pool->pre_substep(rig.context(rig.tick), rig.due(), 0.001);
  EXPECT_TRUE(rig.actuation.joints.empty());
}

TEST(DiffDrive, WithoutOdometryItDrivesAndTellsNothing) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", drive({{"odometry", "false"}}), ideal_bit));
  EXPECT_FALSE(rig.topics.contains("/robot1/drive/ideal"));
  rig.command("drive/ideal", twist(0.5, 0));
  for (int i = 0; i < 100; ++i) rig.act();
  rig.sense();
  EXPECT_NEAR(rig.engine->body[0].X_WB.p.x, 0.5, 1e-9);
}

TEST(DiffDrive, OdometryRunsOnExactArcs) {
  // Wheels that turn as commanded: a straight of 2 m, a quarter circle of radius 1 m, a half turn on the
  // spot.
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", drive(), contact_bit));
  const auto run = [&](double v, double omega, int ticks) {
    rig.command("drive/contact", twist(v, omega));
    for (int i = 0; i < ticks; ++i) rig.act();
  };
  // The sums of a few hundred ticks, each rounded: 300 * 2e-16 of metres.
  run(1.0, 0, 200);
  expect_pose(odometry(rig, "contact").pose.pose, 2, 0, 0, 1e-12);
  run(math::pi / 4, math::pi / 4, 200);
  expect_pose(odometry(rig, "contact").pose.pose, 3, 1, math::pi / 2, 1e-12);
  EXPECT_NEAR(odometry(rig, "contact").twist.twist.linear.x, math::pi / 4, 1e-12);
  EXPECT_NEAR(odometry(rig, "contact").twist.twist.angular.z, math::pi / 4, 1e-12);
  run(0, math::pi, 100);
  expect_pose(odometry(rig, "contact").pose.pose, 3, 1, 1.5 * math::pi, 1e-12);
  run(-1.0, 0, 100);  // backward while looking along -y
  expect_pose(odometry(rig, "contact").pose.pose, 3, 2, 1.5 * math::pi, 1e-12);
  EXPECT_EQ(odometry(rig, "contact").header.frame_id, "robot1/odom");
  EXPECT_EQ(odometry(rig, "contact").child_frame_id, "robot1/chassis");
}

TEST(DiffDrive, OdometryIsOfTheBaseEvenWhenTheAxleIsElsewhere) {
  // The axle 0.4 m ahead of the base: turning on the spot, the base runs on a circle of 0.4 m about the
  // axle's centre.
  Rig rig(kind, test::two_wheels(0.4));
  ASSERT_TRUE(rig.add("drive", drive(), contact_bit));
  rig.command("drive/contact", twist(0, math::pi / 2));
  for (int i = 0; i < 100; ++i) rig.act();
  const msg::Odometry& m = odometry(rig, "contact");
  expect_pose(m.pose.pose, 0.4, -0.4, math::pi / 2, 1e-12);
  EXPECT_NEAR(m.twist.twist.linear.x, 0, 1e-12);
  EXPECT_NEAR(m.twist.twist.linear.y, -0.4 * math::pi / 2, 1e-12);
}

TEST(DiffDrive, IdealMovesTheBaseAndItsOdometryFollowsTheTruth) {
  for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, std::pair{0.4, 0.0}, std::pair{0.4, -0.1}}) {
    Rig rig(kind, test::two_wheels(dx, dy));
    ASSERT_TRUE(rig.add("drive", drive(), ideal_bit));
    rig.command("drive/ideal", twist(0.5, 0.8));
    for (int i = 0; i < 300; ++i) rig.act();
    rig.command("drive/ideal", twist(0, 0));
    rig.act();
    rig.act();  // the wheels lag by one sub-step: now they have made up for it
    // D runs on a circle of radius r = 0.5/0.8 from its start at (dx, dy); the base is at R(angle) (-dx, -dy)
    // from it.
    const double angle = 0.8 * 3, r = 0.5 / 0.8, sine = math::sin(angle), cosine = math::cos(angle);
    const double x = dx + r * sine - (dx * cosine - dy * sine);
    const double y = dy + r * (1 - cosine) - (dx * sine + dy * cosine);
    expect_pose(rig.engine->body[0].X_WB, x, y, angle, 1e-11);
    expect_pose(odometry(rig, "ideal").pose.pose, x, y, angle, 1e-11);
  }
}

TEST(DiffDrive, IdealWheelsDoNotTurnWhenTheBaseIsHeld) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", drive(), ideal_bit));
  rig.engine->blocked = true;
  rig.command("drive/ideal", twist(0.5, 0));
  for (int i = 0; i < 100; ++i) rig.act();
  EXPECT_EQ(rig.engine->joint[0].position, 0);
  expect_pose(odometry(rig, "ideal").pose.pose, 0, 0, 0, 0);
}

TEST(DiffDrive, SpeedsAndAccelerationsAreLimited) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive",
                      drive({{"max_linear_speed", "0.8"},
                             {"max_angular_speed", "2"},
                             {"max_linear_acceleration", "2"},
                             {"max_angular_acceleration", "10"}}),
                      contact_bit));
  rig.command("drive/contact", twist(5, 0));
  for (int i = 1; i <= 60; ++i) {
    rig.act(4);
    EXPECT_NEAR(odometry(rig, "contact").twist.twist.linear.x, std::min(0.8, 2 * 0.01 * i), 1e-12);
  }
  rig.command("drive/contact", twist(0.8, -9));
  for (int i = 1; i <= 40; ++i) {
    rig.act();
    EXPECT_NEAR(odometry(rig, "contact").twist.twist.angular.z, -std::min(2.0, 10 * 0.01 * i), 1e-12);
  }
  // The same limits are what the ideal level hands to the engine.
  ASSERT_TRUE(rig.switch_level(ideal_bit));
  rig.command("drive/ideal", twist(5, -9));
  rig.act();
  EXPECT_EQ(rig.engine->drive.vx_mps, 0.8);
  EXPECT_EQ(rig.engine->drive.wz_radps, -2);
  EXPECT_EQ(rig.engine->drive.max_accel_mps2, 2);
  EXPECT_EQ(rig.engine->drive.max_angular_accel_radps2, 10);
}

TEST(DiffDrive, TheSlowestWheelLimitsBothAndKeepsTheArc) {
  model::Model model = test::two_wheels();
  model.joints[1].max_velocity = 3;
  Rig rig(kind, model);
  ASSERT_TRUE(rig.add("drive", drive(), contact_bit));
  rig.command("drive/contact", twist(0.5, 1.0));  // wheels 2.5 and 7.5
  rig.act();
  EXPECT_NEAR(rig.engine->target[0].velocity, 1.0, 1e-12);
  EXPECT_NEAR(rig.engine->target[1].velocity, 3.0, 1e-12);
}

TEST(DiffDrive, StopsWhenCommandsStopComing) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", drive({{"command_timeout", "0.05"}}), contact_bit));
  rig.command("drive/contact", twist(1, 0));  // at 0
  for (int tick = 0; tick <= 5; ++tick) {     // ticks that begin at 0 .. 0.05
    rig.act();
    EXPECT_NEAR(rig.engine->target[0].velocity, 10, 1e-12);
  }
  rig.act();
  EXPECT_EQ(rig.engine->target[0].velocity, 0);
  ASSERT_TRUE(rig.pool->set_parameter(0, "command_timeout", Node::scalar("0")));
  rig.act();
  EXPECT_NEAR(rig.engine->target[0].velocity, 10, 1e-12);
}

TEST(DiffDrive, NonsenseInACommandMovesNothing) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", drive(), contact_bit));
  rig.command("drive/contact", twist(NAN, INFINITY));
  rig.act();
  EXPECT_EQ(rig.engine->target[0].velocity, 0);
  EXPECT_EQ(rig.engine->target[1].velocity, 0);
}

TEST(DiffDrive, ASwitchOfLevelKeepsOdometryCommandAndSpeed) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", drive({{"max_linear_acceleration", "1"}}), ideal_bit));
  rig.command("drive/ideal", twist(0.5, 0));
  for (int i = 0; i < 200; ++i) rig.act();
  const Pose before = odometry(rig, "ideal").pose.pose;
  EXPECT_NEAR(before.p.x, 0.5 * 2 - 0.125, 0.02);

  ASSERT_TRUE(rig.switch_level(contact_bit));
  const std::size_t given = rig.engine->drive_targets_given;
  rig.act();
  EXPECT_FALSE(rig.engine->drive.active);  // the base is released to its wheels, once
  EXPECT_EQ(rig.engine->drive_targets_given, given + 1);
  EXPECT_NEAR(rig.engine->target[0].velocity, 5, 1e-9);  // at speed, with no new command
  rig.act();
  EXPECT_EQ(rig.engine->drive_targets_given, given + 1);
  EXPECT_NEAR(odometry(rig, "contact").pose.pose.p.x, before.p.x + 0.01, 1e-9);

  ASSERT_TRUE(rig.switch_level(ideal_bit));
  rig.act();
  EXPECT_TRUE(rig.engine->drive.active);
  EXPECT_NEAR(rig.engine->drive.vx_mps, 0.5, 1e-12);
  EXPECT_FALSE(rig.switch_level(3));
  EXPECT_FALSE(rig.switch_level(0));
}

TEST(DiffDrive, ALevelTheEngineLacksIsAnError) {
  Rig rig(kind, test::two_wheels());
  rig.engine->what.contact_drives = false;
  EXPECT_EQ(rig.add("drive", drive(), contact_bit).error().text(),
            "robot.yaml:12:5: the engine 'hand' has no wheels that drive by contact; use the level 'ideal' "
            "or the engine 'rigid'");
  EXPECT_EQ(rig.add("drive", drive(), 3).error().what, "a differential drive runs at exactly one level");
  ASSERT_TRUE(rig.add("drive", drive(), ideal_bit));
  EXPECT_FALSE(rig.switch_level(contact_bit));
}

TEST(DiffDrive, GeometryComesFromTheModelWhenItIsNotGiven) {
  model::Model model = test::two_wheels();
  // A joint that turns the other way round: its axis points to the right.
  model.joints[1].axis_J = {0, 0, -1};
  Rig rig(kind, model);
  ASSERT_TRUE(rig.add(
      "drive", config({{"left_joint", "left"}, {"right_joint", "right"}, {"max_linear_acceleration", "1e9"}}),
      contact_bit));
  rig.command("drive/contact", twist(0.5, 0));
  rig.act();
  EXPECT_NEAR(rig.engine->target[0].velocity, 5, 1e-12);
  EXPECT_NEAR(rig.engine->target[1].velocity, -5, 1e-12);
  EXPECT_NEAR(odometry(rig, "contact").twist.twist.linear.x, 0.5, 1e-12);
}

TEST(DiffDrive, SeveralWheelsPerSideShareTheirSpeedAndCountTheirMean) {
  model::Model model = test::two_wheels();
  for (const std::size_t i : {1u, 2u}) {
    model.links.push_back(model.links[i]);
    model.links.back().X_ML.p.x = -0.6;
    model.joints.push_back(model.joints[i - 1]);
    model.joints.back().name += "_rear";
    model.joints.back().child = static_cast<std::uint32_t>(model.links.size() - 1);
  }
  Rig rig(kind, model);
  Node node = drive();
  for (const auto& [key, front, rear] :
       {std::tuple{"left_joint", "left", "left_rear"}, std::tuple{"right_joint", "right", "right_rear"}}) {
    Node& list = node.set(key, Node::sequence());
    list.push(Node::scalar(front));
    list.push(Node::scalar(rear));
  }
  ASSERT_TRUE(rig.add("drive", std::move(node), contact_bit));
  rig.command("drive/contact", twist(0.5, 0));
  rig.act();
  for (const std::size_t joint : {0u, 1u, 3u, 4u}) EXPECT_NEAR(rig.engine->target[joint].velocity, 5, 1e-12);
  rig.engine->joint[3].position += 0.2;  // a rear wheel slips: half of it counts
  rig.engine->joint[4].position += 0.2;
  EXPECT_NEAR(odometry(rig, "contact").pose.pose.p.x, 0.005 + 0.1 * 0.1, 1e-12);
}

TEST(DiffDrive, WhatIsWrongIsSaidAtItsPlace) {
  model::Model model = test::two_wheels();
  Rig rig(kind, model);
  const auto complaint = [&](Node node) {
    const Status status = rig.add("drive", std::move(node));
    return status ? "" : status.error().text();
  };
  EXPECT_EQ(complaint(config({{"left_joint", "left"}, {"right_joint", "rigth"}})),
            "robot.yaml:2:9: /right_joint: model 'rover' has no joint 'rigth'; did you mean 'right'?");
  EXPECT_EQ(complaint(config({{"left_joint", "left"}, {"right_joint", "lift"}})),
            "robot.yaml:2:9: /right_joint: joint 'lift' does not turn; a wheel needs a revolute or "
            "continuous joint");
  EXPECT_EQ(complaint(config({{"left_joint", "left"}, {"right_joint", "left"}})),
            "robot.yaml:12:5: /right_joint: a joint cannot be on both sides");
  EXPECT_EQ(complaint(config({{"left_joint", "right"}, {"right_joint", "left"}})),
            "robot.yaml:12:5: the left wheels are not to the left of the right ones; exchange left_joint and "
            "right_joint, or "
            "give wheel_separation");
  EXPECT_EQ(
      complaint(config({{"left_joint", "left"}})),
      "robot.yaml:1:1: key 'right_joint' is missing; Wheel joint on the right side, or a list of them.");
  model::Model narrow = test::two_wheels();
  for (model::Link& link : narrow.links) link.X_ML.p.y = 0;
  Rig none(kind, narrow);
  EXPECT_EQ(none.add("drive", config({{"left_joint", "left"}, {"right_joint", "right"}})).error().text(),
            "robot.yaml:12:5: the left and the right wheels have no distance between them; move them apart, "
            "left to +y "
            "and right to -y, or give wheel_separation");
  model.joints[0].axis_J = {1, 0, 0};
  Rig skew(kind, model);
  EXPECT_EQ(skew.add("drive", drive()).error().text(),
            "robot.yaml:1:9: /left_joint: the axis of joint 'left' does not lie across the robot; wheels "
            "turn about the y axis of "
            "the base");
}

TEST(DiffDrive, StateSurvivesSaving) {
  Rig a(kind, test::two_wheels()), b(kind, test::two_wheels());
  for (Rig* rig : {&a, &b})
    ASSERT_TRUE(rig->add("drive", drive({{"max_linear_acceleration", "0.5"}}), contact_bit));
  a.command("drive/contact", twist(0.5, 0.7));
  for (int i = 0; i < 33; ++i) a.act();
  ASSERT_TRUE(a.pool->set_parameter(0, "max_linear_speed", Node::scalar("0.4")));
  b.load(a.saved());
  b.engine->joint = a.engine->joint;
  b.engine->target = a.engine->target;
  b.now = a.now;
  b.topic<msg::Twist>("drive/contact/command").count = 1;
  for (int i = 0; i < 50; ++i) {
    a.act();
    b.act();
  }
  EXPECT_EQ(a.saved(), b.saved());
  EXPECT_EQ(odometry(a, "contact").pose.pose, odometry(b, "contact").pose.pose);
}

Result<Spec> read_drive_spec(const Node& plugin, Diagnostics& diagnostics) {
  SL_ASSIGN(const Node node, kind.from_sdf(plugin, diagnostics));
  return read_spec<Spec>(node);
}

TEST(DiffDriveFromSdf, TakesTheElementsOfGazebosPlugin) {
  Node plugin = config({{"@filename", "gz-sim-diff-drive-system"},
                        {"right_joint", "right"},
                        {"wheel_separation", "0.4"},
                        {"wheel_radius", "0.05"},
                        {"odom_publish_frequency", "30"},
                        {"max_linear_velocity", "0.6"},
                        {"min_linear_velocity", "-0.6"},
                        {"max_acceleration", "3"},
                        {"topic", "cmd_vel"}});
  Node& left = plugin.set("left_joint", Node::sequence());
  left.push(Node::scalar("front"));
  left.push(Node::scalar("rear"));
  Diagnostics diagnostics;
  const auto spec = read_drive_spec(plugin, diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->left_joint, (std::vector<std::string>{"front", "rear"}));
  EXPECT_EQ(spec->right_joint, std::vector<std::string>{"right"});
  EXPECT_EQ(spec->wheel_separation_m, 0.4);
  EXPECT_EQ(spec->wheel_radius_m, 0.05);
  EXPECT_EQ(spec->rate_hz, 30);
  EXPECT_EQ(spec->max_linear_speed_mps, 0.6);
  EXPECT_EQ(spec->max_angular_speed_radps, 1e9);  // unlimited, as in Gazebo
  EXPECT_EQ(spec->max_linear_acceleration_mps2, 3);
  EXPECT_EQ(spec->max_angular_acceleration_radps2, 3);
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_EQ(diagnostics.warnings[0].what,
            "<topic> of the differential drive plugin is not supported and has no effect");
}

TEST(DiffDriveFromSdf, TakesTheSpellingsOfGazeboClassic) {
  Diagnostics diagnostics;
  const auto spec = read_drive_spec(config({{"leftJoint", "l"},
                                            {"rightJoint", "r"},
                                            {"wheelDiameter", "0.2"},
                                            {"wheelSeparation", "0.3"},
                                            {"wheelTorque", "7"},
                                            {"updateRate", "20"}}),
                                    diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->wheel_radius_m, 0.1);
  EXPECT_EQ(spec->max_wheel_effort_Nm, 7);
  EXPECT_EQ(spec->rate_hz, 20);
  EXPECT_TRUE(diagnostics.warnings.empty());
  // DiffDrivePlugin gives joints and torque alone: the geometry comes from the model.
  const auto bare = read_drive_spec(config({{"left_joint", "l"}, {"right_joint", "r"}, {"torque", "20"}}),
                                    diagnostics);
  ASSERT_TRUE(bare);
  EXPECT_FALSE(bare->wheel_radius_m || bare->wheel_separation_m);
}

TEST(DiffDriveFromSdf, UnevenLimitsAreWarnedOfAndNonsenseIsAnError) {
  Diagnostics diagnostics;
  const auto spec = read_drive_spec(
      config({{"left_joint", "l"}, {"right_joint", "r"}, {"max_velocity", "0.5"}, {"min_velocity", "-1"}}),
      diagnostics);
  ASSERT_TRUE(spec);
  EXPECT_EQ(spec->max_linear_speed_mps, 1);
  EXPECT_EQ(diagnostics.warnings.size(), 2u);  // linear and angular
  EXPECT_EQ(read_drive_spec(config({{"left_joint", "l"}, {"right_joint", "r"}, {"wheel_radius", "big"}}),
                            diagnostics)
                .error()
                .text(),
            "robot.yaml:3:9: <wheel_radius> is 'big'; write a number");
  EXPECT_EQ(read_drive_spec(config({{"left_joint", "l"}, {"right_joint", "r"}, {"wheel_radius", "-1"}}),
                            diagnostics)
                .error()
                .place.line,
            3);
}

}  // namespace
}  // namespace sandlot::diff_drive
