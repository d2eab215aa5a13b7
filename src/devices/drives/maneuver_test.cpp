/// Maneuvers: the profile against closed forms, then every drive in an engine that follows its targets exactly.
#include "devices/drives/maneuver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "devices/drives/diff_drive/diff_drive.h"
#include "devices/test_rig.h"
#include "messages/command.h"

namespace sandlot::maneuver {
namespace {

using msg::DriveManeuver;
using test::config;
using test::Rig;

constexpr double tick_s = 0.01;
/// The goal is reached within these (see the header).
constexpr double near_m = 1e-3, near_rad = 1e-3;

/// A drive that follows its setpoint exactly: within a tick its velocity changes evenly from the last one to the new one.
struct Plant {
  Limits limits{
      .speed_mps = 1, .turning_rate_radps = 2, .acceleration_mps2 = 1, .angular_acceleration_radps2 = 4};
  State state;
  PlanarPose at;
  PlanarMotion moving;
  double seconds = 0, fastest_mps = 0, fastest_radps = 0, hardest_mps2 = 0;

  void tick() {
    step(state, limits, at, tick_s);
    const PlanarMotion next = state.setpoint;
    hardest_mps2 = std::max(hardest_mps2, std::abs(next.x - moving.x) / tick_s);
    at = kinematics::integrate(
        at, {0.5 * (moving.x + next.x) * tick_s, 0, 0.5 * (moving.turn + next.turn) * tick_s});
    moving = next;
    fastest_mps = std::max(fastest_mps, std::abs(moving.x));
    fastest_radps = std::max(fastest_radps, std::abs(moving.turn));
    seconds += tick_s;
  }
  /// Drives until it is done. @return the time
  double drive(const DriveManeuver& command) {
    begin(state, command, limits, at, moving);
    const double from = seconds;
    while (!state.done && seconds < from + 100) tick();
    EXPECT_TRUE(state.done);
    return seconds - from;
  }
};

/// Near the goal the profile slows down by less than its acceleration: with t of two ticks that costs t/2 ln(v / (a t)), here
/// below 4 ticks, and what is slower than a t another few.
constexpr double end_s = 10 * tick_s;

TEST(Maneuver, AStraightTakesTheTimeOfItsTrapezoid) {
  Plant plant;
  const double took_s = plant.drive({.kind = DriveManeuver::straight, .distance = 2, .speed = 0.5});
  EXPECT_NEAR(took_s, 2 / 0.5 + 0.5 / 1, end_s);
  EXPECT_NEAR(plant.at.x_m, 2, near_m);
  EXPECT_NEAR(plant.fastest_mps, 0.5, 1e-12);
  EXPECT_LE(plant.hardest_mps2, 1 + 1e-9);
}

TEST(Maneuver, AShortStraightIsATriangle) {
  Plant plant;
  EXPECT_NEAR(plant.drive({.kind = DriveManeuver::straight, .distance = -0.09}), 2 * std::sqrt(0.09), end_s);
  EXPECT_NEAR(plant.at.x_m, -0.09, near_m);
  EXPECT_NEAR(plant.fastest_mps, 0.3, 0.02);  // sqrt(a s)
}

TEST(Maneuver, ATurnCountsWholeTurns) {
  Plant plant;
  EXPECT_NEAR(plant.drive({.kind = DriveManeuver::turn, .angle = -4 * math::pi, .turning_rate = 1}),
              4 * math::pi + 0.25, end_s);
  EXPECT_NEAR(plant.at.theta_rad, -4 * math::pi, near_rad);
  EXPECT_EQ(plant.at.x_m, 0);
}

TEST(Maneuver, ACurveKeepsTheLimitOfTheTurningRate) {
  Plant plant;
  plant.limits.turning_rate_radps = 0.5;
  // A quarter of a circle of 1 m radius: curvature 1, speed 0.5.
  const double took_s = plant.drive(
      {.kind = DriveManeuver::curve, .distance = 0.5 * math::pi, .angle = 0.5 * math::pi});
  EXPECT_NEAR(took_s, 0.5 * math::pi / 0.5 + 0.5, end_s);
  EXPECT_NEAR(plant.at.x_m, 1, 2 * near_m);
  EXPECT_NEAR(plant.at.y_m, 1, 2 * near_m);
  EXPECT_NEAR(plant.at.theta_rad, 0.5 * math::pi, near_rad);
  EXPECT_LE(plant.fastest_radps, 0.5 + 1e-3);
}

TEST(Maneuver, APointAheadIsReachedOnAnArcAnotherAfterATurn) {
  Plant arc;
  arc.drive({.kind = DriveManeuver::to_point, .x = 2, .y = 1});
  EXPECT_NEAR(arc.at.x_m, 2, 2 * near_m);
  EXPECT_NEAR(arc.at.y_m, 1, 2 * near_m);
  EXPECT_NEAR(arc.at.theta_rad, 2 * math::atan2(1, 2), near_rad);
  Plant behind;
  behind.drive({.kind = DriveManeuver::to_point, .x = -1, .y = 1});
  EXPECT_NEAR(behind.at.x_m, -1, 2 * near_m);
  EXPECT_NEAR(behind.at.y_m, 1, 2 * near_m);
  EXPECT_NEAR(behind.at.theta_rad, 0.75 * math::pi, near_rad);
  // From where it is now, not from where it began.
  behind.drive({.kind = DriveManeuver::to_point, .x = 0, .y = -1});
  EXPECT_NEAR(behind.at.x_m, -1 + std::sqrt(0.5), 3 * near_m);
  EXPECT_NEAR(behind.at.y_m, 1 + std::sqrt(0.5), 3 * near_m);
}

TEST(Maneuver, StopSlowsDownAtTheLimit) {
  Plant plant;
  begin(plant.state, {.kind = DriveManeuver::straight, .distance = 9, .speed = 0.5}, plant.limits, {}, {});
  for (int i = 0; i < 100; ++i) plant.tick();
  const double from_m = plant.at.x_m;
  EXPECT_NEAR(plant.drive({.kind = DriveManeuver::stop}), 0.5, 3 * tick_s);
  EXPECT_NEAR(plant.at.x_m - from_m, 0.5 * 0.5 / 2, 1e-6);
  EXPECT_LE(plant.hardest_mps2, 1 + 1e-9);
}

TEST(Maneuver, ADriveWithoutLimitsTakesTheUsualOnes) {
  Plant plant;
  plant.limits = {.speed_mps = 1e9,
                  .turning_rate_radps = 1e9,
                  .acceleration_mps2 = 1e9,
                  .angular_acceleration_radps2 = 1e9};
  EXPECT_NEAR(plant.drive({.kind = DriveManeuver::straight, .distance = 1}), 1 / 0.5 + 0.5 / 1, end_s);
  EXPECT_NEAR(plant.drive({.kind = DriveManeuver::turn, .angle = 1}), 1 / 1.0 + 1 / 2.0, end_s);
  EXPECT_NEAR(plant.drive({.kind = DriveManeuver::straight, .distance = 4, .speed = 2}), 4 / 2.0 + 2 / 1.0,
              end_s);
}

TEST(Maneuver, ACarRefusesWhatItsSteeringCannot) {
  const std::optional<double> bends = 0.5;  // 2 m of radius
  EXPECT_EQ(check({.kind = DriveManeuver::turn, .angle = 1}, bends).error().text(),
            "a car does not turn on the spot; the tightest turn has a radius of 2 m");
  EXPECT_TRUE(check({.kind = DriveManeuver::turn, .angle = 1}, std::nullopt));
  EXPECT_TRUE(check({.kind = DriveManeuver::curve, .distance = -1, .angle = 0.5}, bends));
  EXPECT_EQ(check({.kind = DriveManeuver::curve, .distance = 1, .angle = 0.51}, bends).error().what,
            "the curve is too tight for this car");
  // Through (2, 2) and tangent to x is the circle of 2 m about (0, 2); a point nearer to the left is out of reach.
  EXPECT_TRUE(check({.kind = DriveManeuver::to_point, .x = 2, .y = 2}, bends));
  EXPECT_FALSE(check({.kind = DriveManeuver::to_point, .x = 1.9, .y = 2}, bends));
  EXPECT_EQ(check({.kind = 5}, std::nullopt).error().what, "there is no maneuver of kind 5");

  Slot slot("/car/drive/maneuver/command", bends);
  EXPECT_FALSE(slot.assign(command_bytes(DriveManeuver{.kind = DriveManeuver::turn, .angle = 1})));
  EXPECT_FALSE(slot.check(command_bytes(DriveManeuver{.kind = DriveManeuver::straight, .distance = NAN})));
  EXPECT_TRUE(slot.assign(command_bytes(DriveManeuver{.kind = DriveManeuver::straight, .distance = 1})));
}

TEST(Maneuver, ACarGoesBackToAPointBehind) {
  Plant plant;
  plant.limits.max_curvature_pm = 1;
  plant.drive({.kind = DriveManeuver::to_point, .x = -2, .y = 1});
  EXPECT_NEAR(plant.at.x_m, -2, 2 * near_m);
  EXPECT_NEAR(plant.at.y_m, 1, 2 * near_m);
  EXPECT_NEAR(plant.at.theta_rad, -2 * math::atan2(1, 2), 0.01);
}

TEST(Maneuver, AMotorThatIsDrivenAndStandsIsNamed) {
  Boxed<Late> late;
  Slot slot("/r/d/maneuver/command", std::nullopt);
  slot.count = 1;
  begin(late, slot, {}, {}, {}, 2);
  Topic<msg::DriveProgress> topic("/r/d/maneuver");
  const auto stalled_after = [&](int ticks, double wanted, double right) {
    for (int i = 0; i < ticks; ++i) {
      watch_motor(late->maneuver, 0, wanted, wanted, tick_s);
      watch_motor(late->maneuver, 1, wanted, right, tick_s);
    }
    publish(topic, late->maneuver, {});
    return topic.message.stalled;
  };
  EXPECT_TRUE(stalled_after(24, 0.2, 0.005).empty());
  EXPECT_EQ(stalled_after(2, 0.2, -0.005), std::vector<std::uint32_t>{2});
  EXPECT_TRUE(stalled_after(1, 0.2, 0.1).empty());
  EXPECT_TRUE(stalled_after(100, 0, 0).empty());  // it is not driven
}

// --- drives ---

constexpr std::uint32_t ideal_bit = 1, contact_bit = 2;

Node diff(std::initializer_list<std::pair<const char*, const char*>> more = {}) {
  Node node = config({{"left_joint", "left"}, {"right_joint", "right"}, {"max_linear_acceleration", "1"}});
  for (const auto& [key, value] : more) node.set(key, Node::scalar(value));
  return node;
}
const msg::DriveProgress& progress(Rig& rig) {
  rig.sense();
  return rig.topic<msg::DriveProgress>("drive/maneuver").message;
}
/// @return the ticks it took
int until_done(Rig& rig, int most = 3000) {
  int n = 0;
  do rig.act();
  while (++n < most && !progress(rig).done);
  return n;
}

TEST(DiffDriveManeuver, CoversItsWayAtBothLevels) {
  for (const std::uint32_t level : {ideal_bit, contact_bit}) {
    for (const char* counts : {"true", "false"}) {
      Rig rig(diff_drive::kind, test::two_wheels());
      ASSERT_TRUE(rig.add("drive", diff({{"odometry", counts}}), level));
      rig.command("drive/maneuver",
                  DriveManeuver{.kind = DriveManeuver::straight, .distance = 1, .speed = 0.5});
      EXPECT_NEAR(until_done(rig) * tick_s, 1 / 0.5 + 0.5 / 1, end_s) << level;
      rig.command("drive/maneuver", DriveManeuver{.kind = DriveManeuver::turn, .angle = 0.5 * math::pi});
      until_done(rig);
      for (int i = 0; i < 5; ++i) rig.act();
      // Wheels of 0.1 m, 0.25 m off the middle: 1 m, then -+0.25 pi / 2 m.
      const double left = rig.engine->joint[0].position * 0.1, right = rig.engine->joint[1].position * 0.1;
      EXPECT_NEAR(0.5 * (left + right), 1, 2 * near_m);
      EXPECT_NEAR((right - left) / 0.5, 0.5 * math::pi, 2 * near_rad);
      if (level == ideal_bit) { EXPECT_NEAR(rig.engine->body[0].X_WB.p.x, 1, 2 * near_m); }
      EXPECT_EQ(progress(rig).maneuvers, 2u);
      EXPECT_EQ(progress(rig).remaining_angle, 0);
    }
  }
}

TEST(DiffDriveManeuver, BeginsInMotionWithItsFullBrakes) {
  for (const std::uint32_t level : {ideal_bit, contact_bit}) {
    Rig rig(diff_drive::kind, test::two_wheels());
    ASSERT_TRUE(rig.add("drive", diff(), level));
    rig.command(level == ideal_bit ? "drive/ideal" : "drive/contact", msg::Twist{{0.4, 0, 0}, {}});
    for (int i = 0; i < 1 / tick_s; ++i) rig.act();
    rig.command("drive/maneuver",
                DriveManeuver{.kind = DriveManeuver::straight, .distance = 0.3, .speed = 0.4});
    EXPECT_NEAR(until_done(rig) * tick_s, 0.3 / 0.4 + 0.5 * 0.4 / 1, end_s) << level;
  }
}

TEST(DiffDriveManeuver, NothingIsPublishedOrSavedBeforeTheFirst) {
  Rig rig(diff_drive::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", diff(), contact_bit));
  const std::size_t size = rig.saved().size();
  rig.command("drive/contact", msg::Twist{{0.2, 0, 0}, {}});
  rig.act();
  rig.sense();
  EXPECT_EQ(rig.saved().size(), size);
  EXPECT_EQ(rig.topic<msg::DriveProgress>("drive/maneuver").count, 0u);
  rig.command("drive/maneuver", DriveManeuver{.kind = DriveManeuver::stop});
  rig.act();
  rig.sense();
  EXPECT_GT(rig.saved().size(), size);
  EXPECT_EQ(rig.topic<msg::DriveProgress>("drive/maneuver").count, 1u);
}

TEST(DiffDriveManeuver, ATwistEndsItAndItEndsATwist) {
  Rig rig(diff_drive::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", diff({{"command_timeout", "0.05"}}), contact_bit));
  rig.command("drive/maneuver", DriveManeuver{.kind = DriveManeuver::straight, .distance = 5, .speed = 0.5});
  for (int i = 0; i < 100; ++i) rig.act();  // longer than the timeout
  EXPECT_FALSE(progress(rig).done);
  EXPECT_NEAR(rig.engine->joint[0].velocity, 5, 1e-9);
  rig.command("drive/contact", msg::Twist{{-0.25, 0, 0}, {}});
  rig.act();
  EXPECT_TRUE(progress(rig).done);
  EXPECT_EQ(progress(rig).remaining_distance, 0);
  EXPECT_EQ(progress(rig).kind, DriveManeuver::straight);
  rig.command("drive/maneuver", DriveManeuver{.kind = DriveManeuver::stop});
  EXPECT_NEAR(until_done(rig), 49, 4);  // from 0.49 m/s at 1 m/s^2
  EXPECT_NEAR(rig.engine->joint[0].velocity, 0, 1e-9);
}

TEST(DiffDriveManeuver, AMotorHeldFastIsNamedByItsNumber) {
  Rig rig(diff_drive::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("drive", diff(), contact_bit));
  rig.command("drive/maneuver", DriveManeuver{.kind = DriveManeuver::straight, .distance = 5, .speed = 0.5});
  for (int i = 0; i < 60; ++i) {
    rig.act();
    rig.engine->joint[1].position = rig.engine->joint[1].velocity = 0;
  }
  EXPECT_EQ(progress(rig).stalled, std::vector<std::uint32_t>{2});
  Rig held(diff_drive::kind, test::two_wheels());
  ASSERT_TRUE(held.add("drive", diff(), ideal_bit));
  held.engine->blocked = true;
  held.command("drive/maneuver", DriveManeuver{.kind = DriveManeuver::straight, .distance = 5, .speed = 0.5});
  for (int i = 0; i < 60; ++i) held.act();
  EXPECT_EQ(progress(held).stalled, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_NEAR(progress(held).remaining_distance, 5, 1e-9);
}

TEST(DiffDriveManeuver, GoesOnAfterASwitchOfLevelAndFromItsSavedState) {
  Rig a(diff_drive::kind, test::two_wheels()), b(diff_drive::kind, test::two_wheels());
  for (Rig* rig : {&a, &b}) ASSERT_TRUE(rig->add("drive", diff(), contact_bit));
  a.command("drive/maneuver", DriveManeuver{.kind = DriveManeuver::to_point, .x = -1, .y = 0.5});
  for (int i = 0; i < 33; ++i) a.act();
  b.load(a.saved());
  b.engine->joint = a.engine->joint;
  b.engine->target = a.engine->target;
  b.now = a.now;
  b.topic<DriveManeuver>("drive/maneuver/command").count = 1;
  for (int i = 0; i < 150; ++i) a.act(), b.act();
  EXPECT_EQ(a.saved(), b.saved());
  EXPECT_FALSE(progress(a).done);
  const std::vector<std::byte> bytes = a.saved();
  ByteReader cut(std::span<const std::byte>(bytes).first(bytes.size() - 1));
  b.pool->load(0, cut);
  EXPECT_FALSE(cut.ok());
  ASSERT_TRUE(a.switch_level(ideal_bit));
  until_done(a);
  EXPECT_EQ(progress(a).maneuvers, 1u);
  const Pose end = a.topic<msg::Odometry>("drive/ideal").message.pose.pose;
  EXPECT_NEAR(end.p.x, -1, 3 * near_m);
  EXPECT_NEAR(end.p.y, 0.5, 3 * near_m);
}

TEST(BodyVelocityManeuver, DrivesWithoutWheels) {
  for (const char* name : {"body_velocity", "heading_drive"}) {
    Rig rig(**find_device_kind(name), test::two_wheels());
    ASSERT_TRUE(rig.add("drive", config({{"max_acceleration", "1"}})));
    rig.command("drive/maneuver",
                DriveManeuver{.kind = DriveManeuver::curve, .distance = 1, .angle = 1, .speed = 0.5});
    int n = 0;
    do rig.act();
    while (!rig.topic<msg::DriveProgress>("drive/maneuver").message.done && ++n < 1000);
    EXPECT_NEAR(n * tick_s, 1 / 0.5 + 0.5, end_s) << name;
    for (int i = 0; i < 10; ++i) rig.act();
    EXPECT_NEAR(rig.engine->body[0].X_WB.p.x, math::sin(1), 2 * near_m) << name;
    EXPECT_NEAR(rig.engine->body[0].X_WB.p.y, 1 - math::cos(1), 2 * near_m) << name;
    EXPECT_TRUE(rig.topic<msg::DriveProgress>("drive/maneuver").message.stalled.empty());
  }
}

}  // namespace
}  // namespace sandlot::maneuver
