#include "controllers/carrying.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "controllers/carrier/carrier.h"
#include "controllers/carriers/carriers.h"
#include "controllers/test_rig.h"

namespace sandlot::controllers::carrying {
namespace {

Pose at(double x, double y, double yaw = 0) { return {{x, y, 0}, quat_from_axis_angle({0, 0, 1}, yaw)}; }
Keys keys() { return {.destination_m = {2, 0}, .posts_m = {0.5, -0.5}, .standoff_m = 0.25}; }

TEST(Carrying, PostsLieBehindTheLoadAsSeenFromTheDestination) {
  const Keys k = keys();
  const Load load = look_at(k, at(0, 0));
  EXPECT_NEAR(norm(place(k, load, 0) - Vec3{-0.25, 0.5, 0}), 0, 1e-12);
  EXPECT_NEAR(norm(place(k, load, 1) - Vec3{-0.25, -0.5, 0}), 0, 1e-12);
  EXPECT_EQ(load.error_rad, 0);
  // Turned by half a turn it is the same beam.
  EXPECT_NEAR(norm(place(k, look_at(k, at(0, 0, math::pi)), 0) - Vec3{-0.25, 0.5, 0}), 0, 1e-12);
  EXPECT_NEAR(look_at(k, at(0, 0, 0.3)).error_rad, -0.3, 1e-12);
  EXPECT_TRUE(look_at(k, at(1.9, 0)).arrived);
}

TEST(Carrying, ABidIsTheWayOverChargeAndHealth) {
  const Keys k = keys();
  const Load load = look_at(k, at(0, 0));
  Member member{.charge = 0.5, .health = 0.8, .load = 0.25};
  bid(k, load, at(-1.25, 0.5), member);
  EXPECT_NEAR(member.bids[0], 1.0 / 0.4 * 1.25, 1e-12);
  EXPECT_NEAR(member.bids[1], std::sqrt(2.0) / 0.4 * 1.25, 1e-12);
  member.post = 1;  // it has this one
  bid(k, load, at(-1.25, 0.5), member);
  EXPECT_NEAR(member.bids[1], 0.5 * std::sqrt(2.0) / 0.4 * 1.25, 1e-12);
  member.charge = 0.1;  // below least_charge
  bid(k, load, at(-1.25, 0.5), member);
  EXPECT_EQ(member.bids[0], no_bid);
  member.charge = 1, member.health = 0.14;  // below least_health
  bid(k, load, at(-1.25, 0.5), member);
  EXPECT_EQ(member.bids[0], no_bid);
  member.health = 0.16;
  bid(k, load, at(-1.25, 0.5), member);
  EXPECT_NEAR(member.bids[0], 1.0 / 0.16 * 1.25, 1e-12);
}

TEST(Carrying, TheSmallestBidOfAllWinsThenTheSmallestOfThoseLeft) {
  const Member a{.robot = "a", .bids = {3, 1}}, b{.robot = "b", .bids = {4, 2}},
      c{.robot = "c", .bids = {5, 9}};
  std::vector<std::int32_t> posts;
  const Member* const members[] = {&a, &b, &c};
  settle(members, 2, posts);
  EXPECT_EQ(posts, (std::vector<std::int32_t>{1, 0, no_post}));
  // Ties go to the name that precedes, whatever the order.
  const Member d{.robot = "d", .bids = {1, 1}}, e{.robot = "e", .bids = {1, 1}};
  const Member* const tied[] = {&e, &d};
  settle(tied, 1, posts);
  EXPECT_EQ(posts, (std::vector<std::int32_t>{no_post, 0}));
  // Who bids for nothing gets nothing.
  const Member f{.robot = "f", .bids = {no_bid, no_bid}};
  const Member* const alone[] = {&f};
  settle(alone, 2, posts);
  EXPECT_EQ(posts, (std::vector<std::int32_t>{no_post}));
}

TEST(Carrying, TheFartherSideDrivesFasterSoThatTheLoadTurns) {
  const Keys k = keys();
  // The load points 0.2 to the left of the destination: it must turn right, so the left post is the faster one.
  const Load load = look_at(k, at(0, 0, 0.2));
  msg::ObjectPoseArray world;
  std::vector<steering::Disc> scratch;
  const auto speed = [&](std::int32_t post) {
    msg::ObjectPose self;
    self.pose = at(0, 0, 0.2);
    self.pose.p = place(k, load, static_cast<std::size_t>(post));
    return drive(k, load, world, self, post, true, scratch).linear.x;
  };
  EXPECT_NEAR(speed(0), k.push_speed_mps * (1 + 2 * 0.2), 1e-12);
  EXPECT_NEAR(speed(1), k.push_speed_mps * (1 - 2 * 0.2), 1e-12);
}

TEST(Carrying, TheLoadOfARobotIsTheSpeedThatItDoesNotReach) {
  Effort effort;
  effort.ordered_mps = 0.2;
  for (int i = 1; i <= 200; ++i) effort.follow({0.01 * i, 0, 0}, Time::from_s(0.1 * i));  // 0.1 m/s
  EXPECT_NEAR(effort.load, 0.5, 1e-6);
}

using Rig = FieldRig<carrier::Carrier>;
carrier::Spec spec() { return {.keys = keys()}; }

TEST(Carrier, SendsWhatItHasAndBids) {
  Rig rig(spec());
  rig.put("beam", "beam", 0, 0);
  rig.put("me", "hauler", -1.25, 0.5);
  rig.step(0.1);
  EXPECT_EQ(rig.sent(), "100 100 0 0 0 1000 1414");
  rig.step(0.15);  // at most ten times a second
  EXPECT_EQ(rig.sent(), "nothing");
}

TEST(Carrier, LeavesAPostToASmallerBidAndPushesWhenAllPostsAreManned) {
  Rig rig(spec());
  rig.put("beam", "beam", 0, 0);
  rig.put("me", "hauler", -0.25, 0.5);
  rig.hear("mate", "100 100 0 -1 0 0 9000");
  rig.step(0.1);
  // 0 against 0 for post 0: "mate" precedes "me"; post 1 is left.
  EXPECT_EQ(rig.controller.state.own.post, 1);
  EXPECT_FALSE(rig.controller.state.pushing);
  rig.put("me", "hauler", -0.25, -0.5);
  rig.hear("mate", "100 100 0 0 1 0 9000");
  rig.step(0.2);
  EXPECT_TRUE(rig.controller.state.own.ready);
  EXPECT_TRUE(rig.controller.state.pushing);
  EXPECT_NEAR(rig.twist().linear.x, 0.15, 1e-12);
  // Not heard for a second: post 0 is not manned any more.
  rig.step(1.3);
  EXPECT_FALSE(rig.controller.state.pushing);
}

TEST(Carrier, AnEmptyBatteryHandsTheRoleOver) {
  carrier::Spec s = spec();
  s.keys.battery = "battery";
  Rig rig(s);
  rig.put("beam", "beam", 0, 0);
  rig.put("me", "hauler", -0.25, 0.5);
  rig.battery.message.percentage = 0.9f;
  rig.step(0.1);
  EXPECT_EQ(rig.controller.state.own.post, 0);
  rig.battery.message.percentage = 0.1f;
  rig.step(0.4);
  EXPECT_EQ(rig.controller.state.own.post, no_post);
  EXPECT_EQ(rig.sent(), "10 100 0 -1 0 1000000000000 1000000000000");
}

TEST(Carrier, BidsWithTheHealthOfItsRobot) {
  carrier::Spec s = spec();
  s.keys.battery = "battery", s.keys.health = "health";
  Rig rig(s);
  rig.put("beam", "beam", 0, 0);
  rig.put("me", "hauler", -1.25, 0.5, math::pi);  // turns first, so that nothing counts as load
  rig.battery.message.percentage = 0.8f;
  rig.health.message.property = {.name = "health", .value = 70, .min = 20, .max = 120};
  rig.step(0.1);
  // 50 % of its range: 1 m / (0.8 * 0.5) and sqrt(2) m / (0.8 * 0.5).
  EXPECT_EQ(rig.sent(), "80 50 0 0 0 2500 3536");
  rig.health.message.property.value = 120;
  rig.step(0.5);
  EXPECT_EQ(rig.sent(), "80 100 0 0 0 625 1768");  // of the post that it has, half
  rig.health.message.property.value = 0;           // below its range, as only a forged message can say
  rig.step(0.9);
  EXPECT_EQ(rig.controller.state.own.health, 0);
}

TEST(Carrier, ADamagedRobotLeavesItsPostToASoundOne) {
  carrier::Spec s = spec();
  s.keys.health = "health";
  Rig rig(s);
  rig.put("beam", "beam", 0, 0);
  rig.put("me", "hauler", -1.25, 0.5, math::pi);  // turns first, so that nothing counts as load
  rig.health.message.property = {.name = "health", .value = 100, .min = 0, .max = 100};
  rig.hear("mate", "100 100 0 -1 0 1500 9000");
  rig.step(0.1);
  EXPECT_EQ(rig.controller.state.own.post, 0);  // 1 against 1.5
  rig.health.message.property.value = 40;
  rig.hear("mate", "100 100 0 1 0 1500 9000");
  rig.step(0.2);
  EXPECT_EQ(rig.controller.state.own.post, 0);  // 0.5 * 1 / 0.4 = 1.25 against 1.5
  rig.health.message.property.value = 25;
  rig.step(0.3);
  EXPECT_EQ(rig.controller.state.own.post, 1);  // 0.5 * 1 / 0.25 = 2 against 1.5
}

TEST(Carrier, IgnoresPacketsThatCannotBeRead) {
  Rig rig(spec());
  rig.put("beam", "beam", 0, 0);
  rig.put("me", "hauler", -0.25, 0.5);
  for (const char* const text : {"", "100 100 0", "100 100 0 5 0 1 1", "100 300 0 0 0 1 1", "100 100 0 0 0 1",
                                 "100 100 0 0 0 1 1 1", "100 100 0 0 0 -1 1", "x"})
    rig.hear("mate", text);
  rig.step(0.1);
  EXPECT_TRUE(rig.controller.state.others.empty());
  EXPECT_TRUE(rig.controller.fits());
  rig.controller.state.own.post = 7;
  EXPECT_FALSE(rig.controller.fits());
}

TEST(Carriers, DriveAllRobotsAndFollowWhoComesAndGoes) {
  carriers::Carriers program;
  program.spec = keys();
  Description team;
  team.robot = "haulers";
  for (std::uint32_t i = 0; i < 3; ++i) {
    Description& robot = team.members.emplace_back();
    robot.robot = std::string(1, static_cast<char>('a' + i));
    robot.readings = {{"camera", "world", msg::ObjectPoseArray::ros_type, 0, {}}};
    robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, i, {}}};
  }
  Outputs outputs("haulers/coach");
  ASSERT_TRUE(program.init(team, outputs));
  Topic<msg::ObjectPoseArray> camera("/a/camera/world");
  const auto put = [&](const char* name, const Pose& pose) {
    msg::ObjectPose& object = camera.message.objects.emplace_back();
    object.name = name, object.pose = pose;
  };
  put("beam", at(0, 0));
  put("a", at(-2, 0));
  put("b", at(-0.25, -0.5));
  put("c", at(-0.25, 0.5));
  camera.publish(Time::from_s(1));
  const TopicBase* const topics[] = {&camera};
  const std::vector<std::uint64_t> seen{0};
  Command cmd;
  cmd.bind(&outputs);
  program.step(Observation(Time::from_s(1), topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
  ASSERT_EQ(program.state.members.size(), 3u);
  EXPECT_EQ(program.state.members[0].post, no_post);
  EXPECT_EQ(program.state.members[1].post, 1);
  EXPECT_EQ(program.state.members[2].post, 0);
  EXPECT_TRUE(program.state.pushing);
  EXPECT_EQ(cmd.orders().size(), 3u);
  EXPECT_TRUE(program.fits());
  // b is gone: c keeps what is known of it.
  team.members.erase(team.members.begin() + 1);
  Outputs again("haulers/coach");
  ASSERT_TRUE(program.init(team, again));
  cmd.clear();
  cmd.bind(&again);
  camera.message.objects.erase(camera.message.objects.begin() + 2);
  program.step(Observation(Time::from_s(2), topics, seen, Stream(1, 2, Purpose::controller, 1)), cmd);
  ASSERT_EQ(program.state.members.size(), 2u);
  EXPECT_EQ(program.state.members[1].robot, "c");
  EXPECT_EQ(program.state.members[1].post, 0);
  EXPECT_FALSE(program.state.pushing);
}

TEST(Carriers, CountTheHealthOfEach) {
  carriers::Carriers program;
  program.spec = keys();
  program.spec.posts_m = {0};
  program.spec.health = "health";
  Description team;
  team.robot = "haulers";
  Topic<msg::ObjectPoseArray> camera("/a/camera/world");
  Topic<msg::PropertyStamped> of_a("/a/health/property"), of_b("/b/health/property");
  for (std::uint32_t i = 0; i < 2; ++i) {
    Description& robot = team.members.emplace_back();
    robot.robot = i == 0 ? "a" : "b";
    robot.readings = {{"camera", "world", msg::ObjectPoseArray::ros_type, 0, {}},
                      {"health", "property", msg::PropertyStamped::ros_type, 1 + i, {}}};
    robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, i, {}}};
  }
  Outputs outputs("haulers/coach");
  ASSERT_TRUE(program.init(team, outputs));
  for (const auto& [name, x] : {std::pair("beam", 0.0), std::pair("a", -1.25), std::pair("b", -2.25)}) {
    msg::ObjectPose& object = camera.message.objects.emplace_back();
    object.name = name, object.pose = at(x, 0);
  }
  of_a.message.property = {.name = "health", .value = 40, .min = 0, .max = 100};
  of_b.message.property = {.name = "health", .value = 100, .min = 0, .max = 100};
  camera.publish(Time::from_s(1));
  of_a.publish(Time::from_s(1));
  of_b.publish(Time::from_s(1));
  const TopicBase* const topics[] = {&camera, &of_a, &of_b};
  const std::vector<std::uint64_t> seen{0, 0, 0};
  Command cmd;
  cmd.bind(&outputs);
  program.step(Observation(Time::from_s(1), topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
  // 1 m / 0.4 = 2.5 m against 2 m.
  EXPECT_NEAR(program.state.members[0].bids[0], 2.5, 1e-12);
  EXPECT_EQ(program.state.members[0].post, no_post);
  EXPECT_EQ(program.state.members[1].post, 0);
}

TEST(Carriers, RefusesASingleRobot) {
  Description robot;
  robot.robot = "rover";
  robot.readings = {{"camera", "", msg::ObjectPoseArray::ros_type, 0, {}}};
  carriers::Carriers program;
  Outputs outputs("rover/controller");
  const Status status = program.init(robot, outputs);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, "'rover' is a robot, and carriers drives a team");
}

}  // namespace
}  // namespace sandlot::controllers::carrying
