#include "devices/inertial/ground_truth/ground_truth.h"

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

/// [{name: {key: value}}]
Node chain(const char* name, std::initializer_list<std::pair<const char*, const char*>> keys) {
  Node stage = Node::map(), list = Node::sequence();
  stage.set(name, config(keys));
  list.push(std::move(stage));
  return list;
}

TEST(GroundTruth, WithErrorsItIsACameraAboveTheField) {
  // Each component has its own error; the orientation errs in roll, pitch and yaw. Bounds: 4.5 deviations.
  Rig rig(kind, test::two_wheels());
  Node noise = Node::map(), node = Node::map();
  noise.set("position", chain("gaussian", {{"std", "2 cm"}}));
  noise.set("orientation", chain("gaussian", {{"std", "0.01"}}));
  node.set("noise", std::move(noise));
  ASSERT_TRUE(rig.add("camera", node));
  ASSERT_TRUE(rig.add("exact", Node()));
  rig.engine->body[0].X_WB = {{1, 2, 3}, quat_from_rpy(0.1, -0.2, 2.0)};
  constexpr int n = 4000;
  Vec3 squares_p, squares_r;
  double cross = 0;
  for (int k = 0; k < n; ++k) {
    rig.sense();
    const Pose shown = rig.topic<msg::Odometry>("camera/pose").message.pose.pose;
    const Vec3 p = shown.p - Vec3{1, 2, 3}, r = rpy_from_quat(shown.q) - Vec3{0.1, -0.2, 2.0};
    squares_p += Vec3{p.x * p.x, p.y * p.y, p.z * p.z} / n;
    squares_r += Vec3{r.x * r.x, r.y * r.y, r.z * r.z} / n;
    cross += p.x * p.y / n;
  }
  for (const double v : {squares_p.x, squares_p.y, squares_p.z})
    EXPECT_NEAR(v, 4e-4, 4.5 * 4e-4 * std::sqrt(2.0 / n));
  for (const double v : {squares_r.x, squares_r.y, squares_r.z})
    EXPECT_NEAR(v, 1e-4, 4.5 * 1e-4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(cross, 0, 4.5 * 4e-4 / std::sqrt(n));
  EXPECT_EQ(rig.topic<msg::Odometry>("exact/pose").message.pose.pose.p, (Vec3{1, 2, 3}));
  ASSERT_TRUE(rig.pool->set_parameter(0, "errors", Node::scalar("0")));
  rig.sense();
  EXPECT_EQ(rig.topic<msg::Odometry>("camera/pose").message.pose.pose.p, (Vec3{1, 2, 3}));
  ASSERT_TRUE(rig.pool->set_parameter(0, "noise/position/0/gaussian/std", Node::scalar("5 cm")));
}

TEST(GroundTruth, ACameraThatLosesItsRobotLosesAllOfIt) {
  Rig rig(kind, test::two_wheels());
  Node noise = Node::map(), node = Node::map();
  noise.set("position", chain("dropouts", {{"rate", "0.3"}, {"whole", "true"}}));
  noise.set("orientation", chain("dropouts", {{"rate", "0.3"}, {"whole", "true"}}));
  node.set("noise", std::move(noise));
  ASSERT_TRUE(rig.add("camera", node));
  int lost = 0;
  for (int k = 0; k < 200; ++k) {
    rig.sense();
    const Pose shown = rig.topic<msg::Odometry>("camera/pose").message.pose.pose;
    EXPECT_EQ(std::isnan(shown.p.x), std::isnan(shown.p.y));
    EXPECT_EQ(std::isnan(shown.p.x), std::isnan(shown.q.w));
    lost += std::isnan(shown.p.x);
  }
  EXPECT_NEAR(lost / 200.0, 0.3, 4.5 * std::sqrt(0.21 / 200));
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
  // Gazebo's publishers put their noise on the velocities.
  const auto spec = read_spec<NoiseSpec>(*node->find("noise"));
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_TRUE(spec->position.stages.empty() && spec->orientation.stages.empty());
  EXPECT_EQ(std::get<GaussianSpec>(spec->velocity.stages.at(0).stage).std, 0.01);
  EXPECT_EQ(std::get<GaussianSpec>(spec->angular_velocity.stages.at(0).stage).std, 0.01);
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_EQ(diagnostics.warnings[0].what,
            "<frame_name> of a publisher of exact poses is not supported and has no effect");
}

}  // namespace
}  // namespace sandlot::ground_truth
