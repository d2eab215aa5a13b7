#include "sim/watch/topic_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/load/load.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsSupersetOf;

std::unique_ptr<Simulation> rover_with(const std::string& controllers) {
  Diagnostics diagnostics;
  LoadOptions options;
  const std::string text = R"(version: 1
name: graph
physics: rigid
time: {step: 10 ms, substeps: 2, stop: 1 min}
robots:
  - name: rover
    model: ../models/rover/model.sdf
    devices:
      odometry: {kind: wheel_odometry, left_joint: left_wheel_joint, right_joint: right_wheel_joint,
                 wheel_radius: 0.05, wheel_separation: 0.23, rate: 50}
      gyro: {kind: imu, rate: 50}
      truth: {rate: 50}
    controllers:
)" + controllers;
  options.text = text;
  auto setup = load("scenarios/graph.yaml", options, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  return setup ? build(std::move(*setup)) : nullptr;
}

using Paths = std::vector<std::string>;
Paths paths(const TopicGraph& graph, const std::vector<std::size_t>& nodes) {
  Paths out;
  for (const std::size_t node : nodes) out.push_back(graph.nodes.at(node).path);
  return out;
}
/// Publishers and readers of a topic.
std::pair<Paths, Paths> ends(const TopicGraph& graph, const std::string& name) {
  for (const TopicGraph::Topic& topic : graph.topics)
    if (topic.name == name) return {paths(graph, topic.publishers), paths(graph, topic.readers)};
  return {{"no topic " + name}, {}};
}

TEST(TopicGraph, LeadsFromSensorsThroughProgramsToActuators) {
  const auto simulation = rover_with(
      "      - {name: driver, kind: sequence, steps: [{at: 0 s, orders: {drive: [0.3, 0, 0.5]}}]}\n"
      "      - {name: estimator, kind: odometry_estimator, odometry: odometry}\n"
      "      - {name: watcher, kind: waypoints, odometry: estimator/estimate, points: [[1, 0]], publish: "
      "cmd_vel}\n");
  ASSERT_TRUE(simulation);
  const TopicGraph graph = topic_graph(*simulation);
  std::vector<std::string> programs, nodes;
  for (const TopicGraph::Node& node : graph.nodes) (node.program ? programs : nodes).push_back(node.path);
  EXPECT_THAT(programs, ElementsAre("rover/driver", "rover/estimator", "rover/watcher"));
  EXPECT_THAT(nodes, IsSupersetOf({"rover/drive", "rover/odometry", "rover/gyro", "rover/truth"}));

  const auto odometry = ends(graph, "/rover/odometry/odometry");
  EXPECT_THAT(odometry.first, ElementsAre("rover/odometry"));
  EXPECT_THAT(odometry.second, ElementsAre("rover/estimator"));
  const auto estimate = ends(graph, "/rover/estimator/estimate");
  EXPECT_THAT(estimate.first, ElementsAre("rover/estimator"));
  EXPECT_THAT(estimate.second, ElementsAre("rover/watcher"));
  EXPECT_THAT(ends(graph, "/rover/watcher/cmd_vel").second, IsEmpty());
  EXPECT_THAT(ends(graph, "/rover/truth/odometry").second, IsEmpty());
  // An order is a topic from the program to the device.
  std::vector<std::string> ordered;
  for (const TopicGraph::Topic& topic : graph.topics)
    if (paths(graph, topic.readers) == Paths{"rover/drive"}) {
      ordered.push_back(topic.type);
      EXPECT_THAT(paths(graph, topic.publishers), ElementsAre("rover/driver"));
    }
  EXPECT_THAT(ordered, ElementsAre("geometry_msgs/msg/Twist"));
}

TEST(TopicGraph, ListsEachTopicOnce) {
  const auto simulation = build(arena("planar", 2));
  const TopicGraph graph = topic_graph(*simulation);
  std::map<std::string, int> count;
  for (const TopicGraph::Topic& topic : graph.topics) ++count[topic.name];
  for (const auto& [name, n] : count) EXPECT_EQ(n, 1) << name;
  // A controller reads its own robot's laser.
  EXPECT_THAT(ends(graph, "/rover2/laser/ranges").second, ElementsAre("rover2/controller"));
}

}  // namespace
}  // namespace sandlot::test
