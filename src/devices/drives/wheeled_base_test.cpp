/// All drives of devices/drives/wheeled_base.h, in an engine whose joints follow their targets exactly.
/// long file: the same few models and configurations serve all of them.
#include "devices/drives/wheeled_base.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/drives/ackermann_drive/ackermann_drive.h"
#include "devices/drives/mecanum_drive/mecanum_drive.h"
#include "devices/drives/omni_drive/omni_drive.h"
#include "devices/drives/skid_drive/skid_drive.h"
#include "devices/drives/swerve_drive/swerve_drive.h"
#include "devices/drives/track_drive/track_drive.h"
#include "devices/test_rig.h"

namespace sandlot::wheeled {
namespace {

using test::config;
using test::Rig;

constexpr std::uint32_t ideal_bit = 1u << ideal, contact_bit = 1u << contact, rollers_bit = 1u << rollers;

struct Corner {
  const char* name;
  double x, y;
};
constexpr Corner corners[] = {{"fl", 0.3, 0.2}, {"fr", 0.3, -0.2}, {"bl", -0.3, 0.2}, {"br", -0.3, -0.2}};

std::uint32_t add_link(model::Model& m, const std::string& name, Vec3 at, double radius = 0) {
  m.links.push_back({.name = name});
  m.links.back().X_ML.p = at;
  if (radius > 0) m.links.back().collisions.push_back({.shape = Sphere{radius}});
  return static_cast<std::uint32_t>(m.links.size() - 1);
}
void add_joint(model::Model& m, const std::string& name, std::uint32_t parent, std::uint32_t child,
               Vec3 axis) {
  m.joints.push_back(
      {.name = name, .type = model::JointType::continuous, .parent = parent, .child = child, .axis_J = axis});
}

/// Four wheels of radius 0.1 at the corners; with `steered`, each on an upright joint "s<name>".
model::Model four_wheels(bool steered_front = false, bool steered_back = false) {
  model::Model m;
  m.name = "rover";
  add_link(m, "chassis", {});
  for (const Corner& c : corners) {
    std::uint32_t parent = 0;
    if (c.x > 0 ? steered_front : steered_back) {
      parent = add_link(m, std::string("fork_") + c.name, {c.x, c.y, 0.1});
      add_joint(m, std::string("s") + c.name, 0, parent, {0, 0, 1});
    }
    add_joint(m, c.name, parent, add_link(m, std::string("wheel_") + c.name, {c.x, c.y, 0.1}, 0.1),
              {0, 1, 0});
  }
  return m;
}

/// Three omni wheels at 60, 180 and 300 degrees, 0.2 m from the middle, radius 0.05, axes pointing outwards.
model::Model omni_model() {
  model::Model m;
  m.name = "omni";
  add_link(m, "chassis", {});
  for (int i = 0; i < 3; ++i) {
    const auto [s, c] = math::sincos((60 + 120 * i) * math::pi / 180);
    const std::string name = "w" + std::to_string(i);
    add_joint(m, name, 0, add_link(m, "wheel_" + name, {0.2 * c, 0.2 * s, 0.05}, 0.05), {c, s, 0});
  }
  return m;
}

Node with(Node node, std::initializer_list<std::pair<const char*, const char*>> more) {
  for (const auto& [key, value] : more) node.set(key, Node::scalar(value, node.place()));
  return node;
}
Node list(std::initializer_list<const char*> names) {
  Node node = Node::sequence({std::make_shared<const std::string>("robot.yaml"), 7, 3});
  for (const char* name : names) node.push(Node::scalar(name));
  return node;
}
/// Limits out of the way unless a test sets them.
Node free_of_limits() {
  return config({{"max_linear_speed", "100"},
                 {"max_angular_speed", "100"},
                 {"max_linear_acceleration", "1e9"},
                 {"max_angular_acceleration", "1e9"}});
}
Node mecanum() {
  return with(free_of_limits(), {{"front_left_joint", "fl"},
                                 {"front_right_joint", "fr"},
                                 {"back_left_joint", "bl"},
                                 {"back_right_joint", "br"}});
}
Node skid() {
  Node node = free_of_limits();
  node.set("left_joint", list({"fl", "bl"}));
  node.set("right_joint", list({"fr", "br"}));
  return node;
}
Node omni() {
  Node node = free_of_limits();
  node.set("wheel_joint", list({"w0", "w1", "w2"}));
  return node;
}
Node swerve() {
  Node node = with(free_of_limits(), {{"max_steering_speed", "1e4"}});
  node.set("wheel_joint", list({"fl", "fr", "bl", "br"}));
  node.set("steering_joint", list({"sfl", "sfr", "sbl", "sbr"}));
  return node;
}
Node car() {
  return with(free_of_limits(), {{"max_steering_speed", "1e4"},
                                 {"left_joint", "bl"},
                                 {"right_joint", "br"},
                                 {"left_steering_joint", "sfl"},
                                 {"right_steering_joint", "sfr"}});
}

msg::Twist twist(double x, double y, double turn) {
  msg::Twist m;
  m.linear = {x, y, 0};
  m.angular.z = turn;
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
double state_value(Rig& rig, const char* name) {
  double found = std::nan("");
  rig.pool->list_values(0, ValuePart::state, [&](const ValueEntry& v) {
    if (v.path == name) found = v.value;
  });
  return found;
}
double told(const Rig& rig, std::size_t joint) { return rig.engine->target[joint].velocity; }

TEST(Drives, MecanumWheelsTurnAsTheClosedFormSaysAndASpinSpins) {
  Rig rig(mecanum_drive::kind, four_wheels());
  ASSERT_TRUE(rig.add("drive", mecanum(), contact_bit));
  rig.command("drive/contact", twist(0.4, 0.2, 1));
  rig.act();
  // (0.4 -+ 0.2 -+ (0.3 + 0.2) * 1) / 0.1
  const double want[] = {-3, 11, 1, 7};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(told(rig, i), want[i], 1e-12);
  rig.command("drive/contact", twist(0, 0, 1));
  rig.act();
  const double spin[] = {-5, 5, -5, 5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(told(rig, i), spin[i], 1e-12);
}

TEST(Drives, RollersOfTheModelDecideOverTheKeys) {
  model::Model m = four_wheels();
  for (std::size_t i = 0; i < 4; ++i)
    m.joints[i].rollers = model::RollerWheel{.radius_m = 0.08,
                                             .angle_rad = (i == 0 || i == 3 ? 1 : -1) * 0.25 * math::pi};
  Rig rig(mecanum_drive::kind, m);
  rig.engine->what.rollers = true;
  ASSERT_TRUE(rig.add("drive", mecanum(), contact_bit));
  rig.command("drive/contact", twist(0, 0.2, 1));
  rig.act();
  // The other way round: FL + vy, and the turn by half the wheelbase less half the track; radius 0.08.
  EXPECT_NEAR(told(rig, 0), (0.2 + (0.3 - 0.2)) / 0.08, 1e-12);
  EXPECT_NEAR(told(rig, 1), (-0.2 - (0.3 - 0.2)) / 0.08, 1e-12);
}

/// A drive that moves as commanded ends where the exact arc of its velocity does; on rails its odometry
/// agrees.
struct Course {
  const char* name;
  const Kind* kind;
  model::Model model;
  Node node;
  double x, y, turn;       ///< commanded
  double dx, dy;           ///< D in B
  double got_y, got_turn;  ///< what it can do of it
};
std::vector<Course> courses() {
  std::vector<Course> all;
  all.push_back({"skid", &skid_drive::kind, four_wheels(), skid(), 0.5, 0.3, 0.8, 0, 0, 0, 0.8});
  all.push_back({"mecanum", &mecanum_drive::kind, four_wheels(), mecanum(), 0.5, 0.3, 0.8, 0, 0, 0.3, 0.8});
  all.push_back({"omni", &omni_drive::kind, omni_model(), omni(), 0.5, 0.3, 0.8, 0, 0, 0.3, 0.8});
  all.push_back(
      {"swerve", &swerve_drive::kind, four_wheels(true, true), swerve(), 0.5, 0.3, 0.8, 0, 0, 0.3, 0.8});
  Node kabsch = swerve();
  kabsch.set("odometry", Node::scalar("kabsch"));
  all.push_back(
      {"kabsch", &swerve_drive::kind, four_wheels(true, true), kabsch, 0.5, 0.3, 0.8, 0, 0, 0.3, 0.8});
  // D of a car is on the back axle, 0.3 m behind the middle.
  all.push_back({"car", &ackermann_drive::kind, four_wheels(true), car(), 0.5, 0.3, 0.4, -0.3, 0, 0, 0.4});
  Node track = with(free_of_limits(), {{"track", "0.5"}, {"track_ratio", "1.5"}});
  all.push_back({"track", &track_drive::kind, four_wheels(), track, 0.5, 0.3, 0.8, 0, 0, 0, 0.8});
  return all;
}

TEST(Drives, EachRunsItsArcOnRailsAndOnWheels) {
  for (Course& c : courses())
    for (const std::uint32_t level : {ideal_bit, contact_bit}) {
      if (level == contact_bit && c.kind == &track_drive::kind) continue;  // in thought alone
      const char* const name = level == ideal_bit ? "ideal" : "contact";
      SCOPED_TRACE(std::string(c.name) + " " + name);
      Rig rig(*c.kind, c.model);
      const Status added = rig.add("drive", c.node, level);
      ASSERT_TRUE(added) << added.error().text();
      // Wheels that are steered turn there first; what they roll meanwhile is along their headings.
      rig.command(std::string("drive/") + name, twist(c.x, c.y, c.turn));
      const int first = level == contact_bit ? 100 : 10;
      for (int i = 0; i < first; ++i) rig.act();
      const Pose start = odometry(rig, name).pose.pose;
      const Pose truth_start = rig.engine->body[0].X_WB;
      for (int i = 0; i < 200; ++i) rig.act();
      const Pose end = odometry(rig, name).pose.pose;
      // D runs on the exact arc of 2 s; B hangs on it.
      const kinematics::PlanarPose arc = kinematics::integrate({}, {2 * c.x, 2 * c.got_y, 2 * c.got_turn});
      const Pose X_BD{{c.dx, c.dy, 0}, {}};
      const Pose want = X_BD * kinematics::to_pose(arc) * inverse(X_BD);
      const Pose got = inverse(start) * end;
      // The steering approaches its end exponentially (50/s, for 1 s: e^-50); the ideal wheels lag by the
      // same sub-step at both ends. Kabsch: 200 steps of 8 mrad to the seventh.
      expect_pose(got, want.p.x, want.p.y, yaw_of(want.q), 1e-9);
      if (level == ideal_bit) {
        const Pose moved = inverse(truth_start) * rig.engine->body[0].X_WB;
        expect_pose(moved, want.p.x, want.p.y, yaw_of(want.q), 1e-9);
      }
      EXPECT_LT(state_value(rig, "residual"), 1e-9);
      EXPECT_NEAR(odometry(rig, name).twist.twist.angular.z, c.got_turn, 1e-9);
      EXPECT_NEAR(odometry(rig, name).twist.twist.linear.x, c.x + c.got_turn * c.dy, 1e-9);
      EXPECT_NEAR(odometry(rig, name).twist.twist.linear.y, c.got_y - c.got_turn * c.dx, 1e-9);
    }
}

TEST(Drives, ASkidDriveTurnsItsWheelsByTheTrackRatio) {
  Rig rig(skid_drive::kind, four_wheels());
  ASSERT_TRUE(rig.add("drive", skid(), contact_bit));
  rig.command("drive/contact", twist(0, 0, 1));
  rig.act();
  // 1 + (0.6 / 0.4)^2 = 3.25: rims at 3.25 * 0.2 m/s.
  EXPECT_NEAR(told(rig, 1), 6.5, 1e-9);
  EXPECT_NEAR(told(rig, 0), -6.5, 1e-9);
  EXPECT_EQ(rig.engine->target[0].max_effort, 5);
}

TEST(Drives, ACarSteersInnerAndOuterWheelAndKeepsItsLimits) {
  Rig rig(ackermann_drive::kind, four_wheels(true));
  ASSERT_TRUE(rig.add("drive", with(car(), {{"max_linear_acceleration", "1"}}), contact_bit));
  // joints: 0 sfl, 1 fl, 2 sfr, 3 fr, 4 bl, 5 br. A turning rate alone moves nothing.
  rig.command("drive/contact", twist(0, 0, 1));
  rig.act();
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(told(rig, i), 0);
  // Curvature 0.5: centre at (0, 2) of the back axle; wheelbase 0.6, pins at +-0.2.
  rig.command("drive/contact", twist(1, 0, 0.5));
  for (int i = 0; i < 150; ++i) rig.act();
  EXPECT_NEAR(math::tan(rig.engine->joint[0].position), 0.6 / 1.8, 1e-9);
  EXPECT_NEAR(math::tan(rig.engine->joint[2].position), 0.6 / 2.2, 1e-9);
  EXPECT_NEAR(told(rig, 4), (1 - 0.5 * 0.2) / 0.1, 1e-9);
  EXPECT_NEAR(told(rig, 5), (1 + 0.5 * 0.2) / 0.1, 1e-9);
  // Standing still it keeps its steering; backward on the same curve the angles are the same.
  rig.command("drive/contact", twist(0, 0, 0));
  for (int i = 0; i < 150; ++i) rig.act();
  EXPECT_NEAR(math::tan(rig.engine->joint[0].position), 0.6 / 1.8, 1e-9);
  EXPECT_EQ(told(rig, 4), 0);
  rig.command("drive/contact", twist(-1, 0, -0.5));
  for (int i = 0; i < 150; ++i) rig.act();
  EXPECT_NEAR(math::tan(rig.engine->joint[0].position), 0.6 / 1.8, 1e-9);
  EXPECT_NEAR(told(rig, 4), -9, 1e-9);
  // Sharper than it can: the inner wheel stops at 0.6 rad.
  rig.command("drive/contact", twist(0.5, 0, 50));
  for (int i = 0; i < 150; ++i) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].position, 0.6, 1e-9);
}

TEST(Drives, ASwerveDriveGoesThroughItsFourModes) {
  Rig rig(swerve_drive::kind, four_wheels(true, true));
  ASSERT_TRUE(rig.add("drive", swerve(), contact_bit));
  const auto& joint = rig.engine->joint;  // 0 sfl, 1 fl, 2 sfr, 3 fr, 4 sbl, 5 bl, 6 sbr, 7 br
  const auto run = [&](double x, double y, double turn) {
    rig.command("drive/contact", twist(x, y, turn));
    for (int i = 0; i < 100; ++i) rig.act();
  };
  run(0.3, 0.3, 0);  // crab
  for (const std::size_t i : {0u, 2u, 4u, 6u}) EXPECT_NEAR(joint[i].position, math::pi / 4, 1e-9);
  for (const std::size_t i : {1u, 3u, 5u, 7u}) EXPECT_NEAR(told(rig, i), 0.3 * std::sqrt(2.0) / 0.1, 1e-9);
  run(0, 0, 0);  // stop: the wheels stay
  for (const std::size_t i : {0u, 2u, 4u, 6u}) EXPECT_NEAR(joint[i].position, math::pi / 4, 1e-9);
  for (const std::size_t i : {1u, 3u, 5u, 7u}) EXPECT_EQ(told(rig, i), 0);
  run(0, 0, 1);  // spin: along the tangents, the short way, some backward
  for (std::size_t k = 0; k < 4; ++k) {
    const double angle = joint[2 * k].position, speed = told(rig, 2 * k + 1) * 0.1;
    EXPECT_NEAR(speed * math::cos(angle), -corners[k].y, 1e-9);
    EXPECT_NEAR(speed * math::sin(angle), corners[k].x, 1e-9);
    EXPECT_LT(std::abs(angle - math::pi / 4), math::pi / 2 + 0.1);
  }
  run(0.3, 0, 1);  // turn about (0, 0.3)
  for (std::size_t k = 0; k < 4; ++k) {
    const double angle = joint[2 * k].position, speed = told(rig, 2 * k + 1) * 0.1;
    EXPECT_NEAR(speed * math::cos(angle), 0.3 - corners[k].y, 1e-9);
    EXPECT_NEAR(speed * math::sin(angle), corners[k].x, 1e-9);
  }
}

TEST(Drives, SingleWheelsTakeSpeedsTorquesAndAnglesByNameOrInOrder) {
  Rig rig(swerve_drive::kind, four_wheels(true, true));
  ASSERT_TRUE(
      rig.add("drive", with(swerve(), {{"command_timeout", "0.5"}, {"max_wheel_effort", "2"}}), contact_bit));
  msg::JointState m;
  m.name = {"br", "nobody", "sfl", "fr"};
  m.velocity = {3, 9, 9, std::nan("")};
  m.effort = {std::nan(""), 9, 9, 7};
  m.position = {9, 9, 0.5};
  rig.command("drive/contact/wheels", m);
  rig.command("drive/contact", twist(5, 0, 0));  // in the same tick: the wheels' counts
  rig.act();
  EXPECT_EQ(told(rig, 7), 3);
  EXPECT_EQ(rig.engine->target[3].mode, JointTarget::Mode::effort);
  EXPECT_EQ(rig.engine->target[3].effort, 2);  // at most max_wheel_effort
  EXPECT_EQ(told(rig, 1), 0);
  for (int i = 0; i < 40; ++i) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].position, 0.5, 1e-6);
  // Without names: fl fr bl br, then the steering joints.
  m = {};
  m.velocity = {1, 2, 3, 4};
  m.position = {0, 0, 0, 0, 0.1, 0.2, 0.3, 0.4};
  rig.command("drive/contact/wheels", m);
  for (int i = 0; i < 40; ++i) rig.act();
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(told(rig, 2 * k + 1), static_cast<double>(k + 1));
    EXPECT_NEAR(rig.engine->joint[2 * k].position, 0.1 * static_cast<double>(k + 1), 1e-6);
  }
  for (int i = 0; i < 20; ++i) rig.act();  // 0.5 s are over
  EXPECT_EQ(told(rig, 1), 0);
  rig.command("drive/contact", twist(0.5, 0, 0));  // the velocity counts again
  for (int i = 0; i < 40; ++i) rig.act();
  EXPECT_NEAR(told(rig, 1), 5, 1e-9);
  EXPECT_NEAR(rig.engine->joint[6].position, 0, 1e-6);
}

TEST(Drives, OnRailsTheWheelsSpeedsMoveTheBase) {
  Rig rig(mecanum_drive::kind, four_wheels());
  ASSERT_TRUE(rig.add("drive", mecanum(), ideal_bit));
  msg::JointState m;
  m.velocity = {-5, 5, 5, -5};  // sideways: vy = 0.5
  rig.command("drive/ideal/wheels", m);
  rig.act();
  EXPECT_NEAR(rig.engine->drive.vx_mps, 0, 1e-12);
  EXPECT_NEAR(rig.engine->drive.vy_mps, 0.5, 1e-12);
  EXPECT_NEAR(rig.engine->drive.wz_radps, 0, 1e-12);
}

TEST(Drives, NonsenseInCommandsMovesNothing) {
  Rig rig(mecanum_drive::kind, four_wheels());
  ASSERT_TRUE(rig.add("drive", mecanum(), contact_bit));
  rig.command("drive/contact", twist(NAN, INFINITY, NAN));
  rig.act();
  msg::JointState m;
  m.velocity = {NAN, INFINITY};
  m.effort = {NAN};
  m.name = {"fl", "fl", "", "x"};
  rig.command("drive/contact/wheels", m);
  rig.act();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(told(rig, i), 0);
}

TEST(Drives, SpeedsAndAccelerationsAreLimitedAlongTheDirection) {
  model::Model m = four_wheels();
  m.joints[0].max_velocity = 5;
  Rig rig(mecanum_drive::kind, m);
  ASSERT_TRUE(rig.add("drive",
                      with(mecanum(), {{"max_linear_speed", "0.5"}, {"max_linear_acceleration", "1"}}),
                      contact_bit));
  rig.command("drive/contact", twist(3, 4, 0));
  for (int i = 1; i <= 60; ++i) {
    rig.act(2);
    const auto& v = odometry(rig, "contact").twist.twist.linear;
    EXPECT_NEAR(v.x, 0.6 * std::min(0.5, 0.01 * i), 1e-12);
    EXPECT_NEAR(v.y, 0.8 * std::min(0.5, 0.01 * i), 1e-12);
  }
  rig.command("drive/contact", twist(0, -0.5, 2));  // FL would need (0.5 - 0.5 * 2) / 0.1 = -5: just in reach
  for (int i = 1; i <= 200; ++i) rig.act();
  EXPECT_NEAR(told(rig, 0), -5, 1e-9);
  rig.command("drive/contact", twist(0, 0, 2));  // -10: everything at half
  for (int i = 1; i <= 200; ++i) rig.act();
  EXPECT_NEAR(told(rig, 0), -5, 1e-9);
  EXPECT_NEAR(told(rig, 3), 5, 1e-9);
}

TEST(Drives, EncodersCountTicksAndTheOdometrySeesNothingElse) {
  Rig rig(skid_drive::kind, four_wheels());
  ASSERT_TRUE(rig.add("drive", with(skid(), {{"encoder_ticks", "10"}}), contact_bit));
  rig.command("drive/contact", twist(0.1, 0, 0));  // 1 rad/s: 10 / 2 pi ticks per second
  for (int i = 0; i < 100; ++i) rig.act();
  // After 1 rad: one tick of 0.628 rad, 0.0628 m.
  expect_pose(odometry(rig, "contact").pose.pose, 0.1 * math::tau / 10, 0, 0, 1e-12);
  EXPECT_EQ(rig.topic<msg::Int64MultiArray>("drive/contact/ticks").message.data,
            (std::vector<std::int64_t>{1, 1, 1, 1}));
  const auto& wheels = rig.topic<msg::JointState>("drive/contact/wheels").message;
  EXPECT_EQ(wheels.name, (std::vector<std::string>{"fl", "bl", "fr", "br"}));
  EXPECT_NEAR(wheels.position[0], math::tau / 10, 1e-12);
  EXPECT_NEAR(wheels.velocity[0], 1, 1e-12);
  rig.command("drive/contact", twist(-0.1, 0, 0));
  for (int i = 0; i < 150; ++i) rig.act();
  rig.sense();
  EXPECT_EQ(rig.topic<msg::Int64MultiArray>("drive/contact/ticks").message.data[0], -1);
}

Node motor(std::initializer_list<std::pair<const char*, const char*>> more = {}) {
  return with(
      config(
          {{"supply_voltage", "12"}, {"resistance", "2"}, {"torque_constant", "0.05"}, {"gear_ratio", "10"}}),
      more);
}

TEST(Drives, PwmThroughTheMotorSettlesWhereBackEmfMeetsTheVoltage) {
  Rig rig(mecanum_drive::kind, four_wheels());
  Node node = mecanum();
  node.set("motor", motor());
  ASSERT_TRUE(rig.add("drive", node, contact_bit));
  msg::JointState m;
  m.effort = {0.5, 0.5, 0.5, 0.5};  // half of 12 V
  rig.command("drive/contact/wheels", m);
  rig.act();
  // First step, implicit: (I + h N^2 k^2 / R) w = h N k V / R with I = 1, N k = 0.5.
  const double h = 0.01, damping = 0.25 / 2, w1 = h * 0.5 * 6 / 2 / (1 + h * damping);
  EXPECT_NEAR(rig.engine->joint[0].velocity, w1, 1e-12);
  // i = (6 - 0.5 w1) / 2; four motors draw i times 6 V.
  EXPECT_NEAR(state_value(rig, "power"), 4 * 6 * (6 - 0.5 * w1) / 2, 1e-9);
  EXPECT_NEAR(state_value(rig, "energy"), h * state_value(rig, "power"), 1e-12);
  // Time constant I R / (N k)^2 = 8 s; after 40 of them it turns at 6 / 0.5 rad/s and draws nothing.
  for (int i = 0; i < 32000; ++i) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].velocity, 12, 1e-9);
  EXPECT_NEAR(state_value(rig, "power"), 0, 1e-7);
  // More than the battery has is the battery's voltage.
  m.effort = {9, 9, 9, 9};
  rig.command("drive/contact/wheels", m);
  for (int i = 0; i < 32000; ++i) rig.act();
  EXPECT_NEAR(rig.engine->joint[0].velocity, 24, 1e-9);
}

TEST(Drives, AMotorLimitsTheEffortOfItsSpeedServo) {
  Rig rig(mecanum_drive::kind, four_wheels());
  Node node = with(mecanum(), {{"max_wheel_effort", "1000"}});
  node.set("motor", motor({{"max_current", "4"}}));
  ASSERT_TRUE(rig.add("drive", node, contact_bit));
  rig.command("drive/contact", twist(1, 0, 0));
  rig.act();
  EXPECT_NEAR(rig.engine->target[0].max_effort, 4 * 0.5, 1e-12);  // at rest the current limit
  rig.act();  // now at 10 rad/s: back-EMF 5 V, (12 - 5) / 2 A are left
  EXPECT_NEAR(rig.engine->target[0].max_effort, 3.5 * 0.5, 1e-12);
  rig.engine->joint[0].effort = -1;  // brakes with 2 A at 10 rad/s: R i^2 = 8 W, the shaft gives 10 W back
  rig.pool->post_substep(rig.context(rig.now), rig.due(), 0.01);
  EXPECT_NEAR(state_value(rig, "power"), 8 - 10, 1e-9);
}

TEST(Drives, RobiosLoopsPutOutSharesOfTheFullEffort) {
  Rig rig(skid_drive::kind, four_wheels());
  Node node = with(skid(), {{"track_ratio", "1"}, {"max_wheel_effort", "2"}});
  node.set("control", config({{"vv", "2"}, {"tv", "0.5"}, {"vw", "0.5"}, {"tw", "1"}}));
  ASSERT_TRUE(rig.add("drive", node, contact_bit));
  rig.command("drive/contact", twist(0.1, 0, 0.4));
  rig.act();
  // Shares: v 2 * 0.1 = 0.2, w 0.5 * 0.4 = 0.2; left 0, right 0.4 of 2 Nm.
  EXPECT_NEAR(rig.engine->target[0].effort, 0, 1e-12);
  EXPECT_NEAR(rig.engine->target[1].effort, 0.8, 1e-12);
  EXPECT_EQ(rig.engine->target[1].mode, JointTarget::Mode::effort);
  // Second step: it moves at v = r (w_l + w_r) / 2 with w = torque h / I, I = 1.
  const double v = 0.1 * 0.008 / 2, w = 0.1 * 0.008 / 0.4;
  rig.act();
  const double share_v = 2 * (0.1 - v) + 2 / 0.5 * 0.01 * 0.1,
               share_w = 0.5 * (0.4 - w) + 0.5 / 1 * 0.01 * 0.4;
  EXPECT_NEAR(rig.engine->target[1].effort, 2 * (share_v + share_w), 1e-12);
  for (int i = 0; i < 20000; ++i) rig.act();  // the integral takes the error away
  EXPECT_NEAR(odometry(rig, "contact").twist.twist.linear.x, 0.1, 1e-9);
  EXPECT_NEAR(odometry(rig, "contact").twist.twist.angular.z, 0.4, 1e-9);
}

TEST(Drives, ASwitchOfLevelKeepsOdometryCommandAndSpeedAndTellsTheWheels) {
  model::Model m = four_wheels();
  for (std::size_t i = 0; i < 4; ++i)
    m.joints[i].rollers = model::RollerWheel{.radius_m = 0.1,
                                             .angle_rad = (i == 0 || i == 3 ? -1 : 1) * 0.25 * math::pi};
  Rig rig(mecanum_drive::kind, m);
  rig.engine->what.rollers = true;
  ASSERT_TRUE(rig.add("drive", with(mecanum(), {{"max_linear_acceleration", "1"}}), ideal_bit));
  rig.command("drive/ideal", twist(0.3, 0.4, 0));
  for (int i = 0; i < 200; ++i) rig.act();
  const Vec3 before = odometry(rig, "ideal").pose.pose.p;
  EXPECT_TRUE(rig.engine->wheel_targets.empty());
  const auto expect_wheels = [&](bool on_rollers) {
    ASSERT_EQ(rig.engine->wheel_targets.size(), 4u);
    for (const WheelTarget& target : rig.engine->wheel_targets) EXPECT_EQ(target.rollers, on_rollers);
    rig.engine->wheel_targets.clear();
  };
  ASSERT_TRUE(rig.switch_level(rollers_bit));
  rig.act();
  EXPECT_FALSE(rig.engine->drive.active);  // released, once
  expect_wheels(true);
  // At speed, with no new command: (0.3 -+ 0.4) / 0.1.
  EXPECT_NEAR(told(rig, 0), -1, 1e-9);
  EXPECT_NEAR(told(rig, 1), 7, 1e-9);
  const std::size_t given = rig.engine->drive_targets_given;
  rig.act();
  EXPECT_EQ(rig.engine->drive_targets_given, given);
  EXPECT_TRUE(rig.engine->wheel_targets.empty());
  EXPECT_NEAR(odometry(rig, "rollers").pose.pose.p.x, before.x + 0.3 * 0.02, 1e-9);
  EXPECT_NEAR(odometry(rig, "rollers").pose.pose.p.y, before.y + 0.4 * 0.02, 1e-9);
  ASSERT_TRUE(rig.switch_level(contact_bit));
  rig.act();
  expect_wheels(false);
  EXPECT_NEAR(told(rig, 1), 7, 1e-9);
  // Two switches between two ticks leave nothing out.
  ASSERT_TRUE(rig.switch_level(rollers_bit));
  rig.act();
  expect_wheels(true);
  ASSERT_TRUE(rig.switch_level(contact_bit));
  ASSERT_TRUE(rig.switch_level(ideal_bit));
  rig.act();
  expect_wheels(false);
  EXPECT_TRUE(rig.engine->drive.active);
  EXPECT_NEAR(rig.engine->drive.vy_mps, 0.4, 1e-12);
  EXPECT_FALSE(rig.switch_level(ideal_bit | contact_bit));
  EXPECT_FALSE(rig.switch_level(0));
}

TEST(Drives, StateSurvivesASnapshotAndForgedSizesDoNot) {
  Rig a(swerve_drive::kind, four_wheels(true, true)), b(swerve_drive::kind, four_wheels(true, true));
  ASSERT_TRUE(a.add("drive", swerve(), contact_bit));
  ASSERT_TRUE(b.add("drive", swerve(), contact_bit));
  a.command("drive/contact", twist(-0.3, 0.1, 0.5));
  for (int i = 0; i < 50; ++i) a.act();
  b.load(a.saved());
  EXPECT_EQ(a.saved(), b.saved());
  Rig small(skid_drive::kind, four_wheels());
  ASSERT_TRUE(small.add("drive", skid(), contact_bit));
  Rig other(omni_drive::kind, omni_model());  // three wheels, the same tunables
  ASSERT_TRUE(other.add("drive", omni(), contact_bit));
  const auto bytes = small.saved();
  ByteReader r(bytes);
  other.pool->load(0, r);
  EXPECT_FALSE(r.ok());
}

TEST(Drives, WhatCannotBeIsRefusedWithItsPlace) {
  const auto refused = [](const Kind& kind, model::Model m, Node node, std::uint32_t level = ideal_bit) {
    Rig rig(kind, std::move(m));
    const Status status = rig.add("drive", std::move(node), level);
    return status ? std::string("fine") : status.error().text();
  };
  using namespace std::string_literals;
  EXPECT_EQ(
      refused(mecanum_drive::kind, four_wheels(), with(mecanum(), {{"wheel_radius", "0"}})).substr(0, 17),
      "robot.yaml:1:1: /");
  model::Model bare = four_wheels();
  for (model::Link& link : bare.links) link.collisions.clear();
  EXPECT_EQ(
      refused(skid_drive::kind, bare, skid()),
      "robot.yaml:7:3: /left_joint: the wheel of joint 'fl' has no round collision shape; give wheel_radius");
  model::Model twice = four_wheels();
  twice.links[3].X_ML.p = twice.links[1].X_ML.p;
  EXPECT_NE(refused(skid_drive::kind, twice, skid()).find("'fl' and 'bl' stand on the same point"),
            std::string::npos);
  model::Model narrow = four_wheels();
  for (model::Link& link : narrow.links) link.X_ML.p.y = 0;
  EXPECT_NE(refused(skid_drive::kind, narrow, skid()).find("no distance between them; move them apart"),
            std::string::npos);
  EXPECT_EQ(
      refused(mecanum_drive::kind, four_wheels(), with(mecanum(), {{"back_left_joint", "bk"}})).substr(0, 55),
      "robot.yaml:1:1: /back_left_joint: model 'rover' has no ");
  EXPECT_NE(refused(mecanum_drive::kind, four_wheels(), with(mecanum(), {{"back_left_joint", "fl"}}))
                .find("joint 'fl' is named twice"),
            std::string::npos);
  EXPECT_NE(
      refused(mecanum_drive::kind, four_wheels(),
              with(mecanum(), {{"front_left_joint", "fr"}, {"front_right_joint", "fl"}}))
          .find("/front_left_joint: the wheel of joint 'fr' does not stand in that corner; x is forward"),
      std::string::npos);
  model::Model square = four_wheels();
  for (std::size_t i = 1; i < 5; ++i) square.links[i].X_ML.p.x *= 2.0 / 3;
  EXPECT_NE(refused(mecanum_drive::kind, square, with(mecanum(), {{"roller_angle", "-45 deg"}}))
                .find("cannot turn the drive"),
            std::string::npos);
  model::Model upright = four_wheels();
  upright.joints[0].axis_J = {0, 0, 1};
  EXPECT_NE(refused(skid_drive::kind, upright, skid()).find("does not lie across the robot"),
            std::string::npos);
  EXPECT_NE(refused(swerve_drive::kind, four_wheels(true, false), swerve()).find("no joint 'sbl'"),
            std::string::npos);
  Node loose = swerve();
  loose.set("steering_joint", list({"sfl", "sfr"}));
  EXPECT_NE(refused(swerve_drive::kind, four_wheels(true, false), loose)
                .find("the wheel of joint 'bl' hangs on none of the steering joints"),
            std::string::npos);
  Node crooked = car();
  crooked.set("right_joint", list({"br", "fr"}));
  EXPECT_EQ(refused(ackermann_drive::kind, four_wheels(true), crooked), "fine");
  EXPECT_NE(refused(ackermann_drive::kind, four_wheels(true), with(car(), {{"left_steering_joint", "fl"}}))
                .find("does not stand upright"),
            std::string::npos);
  EXPECT_NE(refused(mecanum_drive::kind, four_wheels(), with(mecanum(), {{"odometry", "kabsch"}}))
                .find("/odometry: Kabsch needs wheels that hold across"),
            std::string::npos);
  EXPECT_EQ(
      refused(track_drive::kind, four_wheels(), with(free_of_limits(), {{"track", "0.5"}}), contact_bit),
      "robot.yaml:12:5: a tracked drive without joints moves on the level 'ideal' alone; name the wheels' "
      "joints "
      "in left_joint and right_joint");
  // Levels.
  EXPECT_EQ(
      refused(mecanum_drive::kind, four_wheels(), mecanum(), rollers_bit),
      "robot.yaml:12:5: the engine 'hand' has no rollers under the wheels of a Mecanum drive; use the level "
      "'contact' or 'ideal', or the engine 'rigid'");
  EXPECT_EQ(refused(mecanum_drive::kind, four_wheels(), mecanum(), 3),
            "robot.yaml:12:5: a Mecanum drive runs at exactly one level; give one of its levels");
  Rig rig(mecanum_drive::kind, four_wheels());
  rig.engine->what.rollers = true;
  EXPECT_EQ(rig.add("drive", mecanum(), rollers_bit).error().what, "the wheel of joint 'fl' has no rollers");
  rig.engine->what.contact_drives = false;
  EXPECT_EQ(
      rig.add("drive", mecanum(), contact_bit).error().text(),
      "robot.yaml:12:5: the engine 'hand' has no wheels that drive by contact; use the level 'ideal' or the "
      "engine 'rigid'");
}

TEST(DrivesFromSdf, AckermannMecanumAndTracksOfGazebo) {
  Diagnostics diagnostics;
  Node plugin = config({{"left_joint", "bl"},
                        {"right_joint", "br"},
                        {"left_steering_joint", "sfl"},
                        {"right_steering_joint", "sfr"},
                        {"kingpin_width", "0.4"},
                        {"wheel_separation", "0.45"},
                        {"wheel_base", "0.6"},
                        {"steering_limit", "0.5"},
                        {"min_velocity", "-1"},
                        {"max_velocity", "1"},
                        {"wheel_radius", "0.1"},
                        {"topic", "t"}});
  auto node = ackermann_drive::from_sdf(plugin, diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<ackermann_drive::Spec>(*node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->track_m, 0.4);
  EXPECT_EQ(spec->wheelbase_m, 0.6);
  EXPECT_EQ(spec->max_steering_rad, 0.5);
  EXPECT_EQ(spec->max_linear_speed_mps, 1);
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_EQ(diagnostics.warnings[0].text(),
            "robot.yaml:12:9: <topic> of the Ackermann plugin is not supported and has no effect");

  diagnostics = {};
  node = mecanum_drive::from_sdf(config({{"front_left_joint", "fl"},
                                         {"front_right_joint", "fr"},
                                         {"back_left_joint", "bl"},
                                         {"back_right_joint", "br"},
                                         {"wheel_separation", "0.5"},
                                         {"wheelbase", "0.7"},
                                         {"wheel_radius", "0.2"},
                                         {"max_acceleration", "5"}}),
                                 diagnostics);
  ASSERT_TRUE(node);
  const auto wheels = read_spec<mecanum_drive::Spec>(*node);
  ASSERT_TRUE(wheels) << wheels.error().text();
  EXPECT_EQ(wheels->track_m, 0.5);
  EXPECT_EQ(wheels->wheelbase_m, 0.7);
  EXPECT_EQ(wheels->max_linear_acceleration_mps2, 5);
  EXPECT_TRUE(diagnostics.warnings.empty());

  Node tracked = config(
      {{"tracks_separation", "0.4"}, {"track_height", "0.2"}, {"steering_efficiency", "0.4"}});
  tracked.set("left_track", config({{"link", "left"}}));
  node = track_drive::from_sdf(tracked, diagnostics);
  ASSERT_TRUE(node);
  const auto tracks = read_spec<track_drive::Spec>(*node);
  ASSERT_TRUE(tracks) << tracks.error().text();
  EXPECT_EQ(tracks->track_m, 0.4);
  EXPECT_EQ(tracks->track_ratio, 2.5);
  EXPECT_EQ(tracks->wheel_radius_m, 0.1);
  EXPECT_TRUE(diagnostics.warnings.empty());
  tracked.set("steering_efficiency", Node::scalar("0"));
  EXPECT_FALSE(track_drive::from_sdf(tracked, diagnostics));
}

}  // namespace
}  // namespace sandlot::wheeled
