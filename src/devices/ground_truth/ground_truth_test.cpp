#include "devices/ground_truth/ground_truth.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::ground_truth {
namespace {

using test::config;
using test::Rig;

void expect_near(Vec3 a, Vec3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-14);
  EXPECT_NEAR(a.y, b.y, 1e-14);
  EXPECT_NEAR(a.z, b.z, 1e-14);
}

TEST(GroundTruth, IsThePoseAndVelocityOfThePointItStandsFor) {
  Rig rig(kind, test::two_wheels());
  // On the mast, 1 m ahead and turned left by 90 degrees: x of S is y of the link.
  const Pose X_LS = pose_from_rpy({1, 0, 0}, {0, 0, math::pi / 2});
  ASSERT_TRUE(rig.add("truth", config({{"rate", "100"}}), 1, 3, X_LS));
  // The link at (2, 3, 0), turned left by 90 degrees, drives at 0.5 m/s along world x and turns at 2 rad/s.
  rig.engine->body[3] = {pose_from_rpy({2, 3, 0}, {0, 0, math::pi / 2}), {{0.5, 0, 0}, {0, 0, 2}}};
  rig.now = Time::from_s(4);
  rig.sense();
  const Topic<msg::Odometry>& topic = rig.topic<msg::Odometry>("truth/pose");
  EXPECT_EQ(topic.message.header.frame_id, "world");
  EXPECT_EQ(topic.message.child_frame_id, "robot1/truth");
  EXPECT_EQ(topic.stamp, Time::from_s(4));
  // S lies at (2, 4) and looks along -x of the world.
  expect_near(topic.message.pose.pose.p, {2, 4, 0});
  expect_near(rotate(topic.message.pose.pose.q, {1, 0, 0}), {-1, 0, 0});
  // v_S = (0.5, 0) + 2 z x (0, 1) = (-1.5, 0) in the world, which is 1.5 ahead in S.
  expect_near(topic.message.twist.twist.linear, {1.5, 0, 0});
  expect_near(topic.message.twist.twist.angular, {0, 0, 2});
}

TEST(GroundTruth, ServesOnlyThoseThatAreDue) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("a", Node()));
  ASSERT_TRUE(rig.add("b", Node()));
  const std::vector<std::uint32_t> second{1};
  rig.pool->sense(rig.context(rig.now), {second, rig.sample, rig.levels, rig.since});
  EXPECT_EQ(rig.topic<msg::Odometry>("a/pose").count, 0u);
  EXPECT_EQ(rig.topic<msg::Odometry>("b/pose").count, 1u);
}

TEST(GroundTruthFromSdf, TakesRateAndLinkAndNamesTheRest) {
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(
      config(
          {{"update_rate", "25"}, {"body_name", "mast"}, {"frame_name", "map"}, {"gaussian_noise", "0.01"}}),
      diagnostics);
  ASSERT_TRUE(node);
  EXPECT_EQ(node->find("rate")->text(), "25");
  EXPECT_EQ(node->find("link")->text(), "mast");  // the loader's
  ASSERT_EQ(diagnostics.warnings.size(), 2u);
  EXPECT_EQ(diagnostics.warnings[0].what, "noise of an exact pose is not supported and has no effect");
  EXPECT_EQ(diagnostics.warnings[1].what,
            "<frame_name> of a publisher of exact poses is not supported and has no effect");
}

}  // namespace
}  // namespace sandlot::ground_truth
