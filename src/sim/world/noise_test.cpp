/// Errors of devices in a whole simulation: nobody's numbers depend on anybody else's noise.
#include <gtest/gtest.h>

#include "messages/messages.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

/// [{name: keys}]
Node stages(std::initializer_list<std::pair<const char*, Node>> all) {
  Node list = Node::sequence();
  for (const auto& [name, keys] : all) list.push(Node::map()).set(name, keys);
  return list;
}

/// Two rovers on a round of their own, whatever they see, with five devices each that err.
model::Setup errant() {
  model::Setup setup = arena("planar", 2, "sequence");
  for (model::Instance& robot : setup.instances) {
    if (!robot.is_robot) continue;
    Node orders = Node::map(), twist = Node::sequence(), step = Node::map(), steps = Node::sequence();
    for (const char* each : {"0.3", "0", "0.5"}) twist.push(Node::scalar(each));
    orders.set("drive", twist);
    step.set("at", Node::scalar("0"));
    step.set("orders", orders);
    steps.push(step);
    robot.controllers.front().config.set("steps", steps);
    const auto add = [&](const char* name, const char* kind, Node config) {
      model::DeviceDecl decl;
      decl.name = name;
      decl.kind = kind;
      decl.config = std::move(config);
      robot.devices.push_back(std::move(decl));
    };
    Node imu = map({{"rate", "50"}}), axes = Node::map();
    axes.set("x", stages({{"gaussian", map({{"std", "0.1"}})},
                          {"drift", map({{"std", "0.1"}, {"correlation", "1"}})}}));
    axes.set("y", map({{"white", "0.1"}}));
    imu.set("gyro", axes);
    add("imu", "imu", imu);
    Node encoder = map({{"joint", "left_wheel_joint"}});
    encoder.set("noise", stages({{"gaussian", map({{"std", "0.1"}})}, {"dropouts", map({{"rate", "0.2"}})}}));
    add("encoder", "wheel_encoder", encoder);
    Node camera = map({{"rate", "20"}}), parts = Node::map();
    parts.set("position",
              stages({{"gaussian", map({{"std", "0.02"}})}, {"latency", map({{"delay", "0.1"}})}}));
    camera.set("noise", parts);
    add("camera", "ground_truth", camera);
    Node scanner = map({{"beams", "31"}, {"rate", "20"}});
    scanner.set("noise", stages({{"gaussian", map({{"std", "0.02"}})},
                                 {"outliers", map({{"rate", "0.1"}, {"std", "1"}})}}));
    add("scanner", "laser_scanner", scanner);
  }
  return setup;
}

TEST(Noise, ChangingOneDevicesErrorsLeavesEverythingElseAsItWas) {
  const auto plain = build(errant());
  const auto with = [](const char* name, Node noise) {
    model::Setup setup = errant();
    device_of(setup, "rover1", name).config.set("noise", std::move(noise));
    return build(std::move(setup));
  };
  // A stage in front of the others, other numbers, another form, none at all, and another factor.
  std::vector<std::unique_ptr<Simulation>> changed;
  changed.push_back(with("scanner", stages({{"uniform", map({{"min", "-1"}, {"max", "1"}})},
                                            {"gaussian", map({{"std", "0.02"}})},
                                            {"outliers", map({{"rate", "0.1"}, {"std", "1"}})}})));
  changed.push_back(with("scanner", stages({{"gaussian", map({{"std", "0.5"}})}})));
  changed.push_back(with("scanner", map({{"white", "0.3"}})));
  changed.push_back(with("scanner", Node()));
  model::Setup exact = errant();
  device_of(exact, "rover1", "scanner").config.set("errors", Node::scalar("0"));
  changed.push_back(build(std::move(exact)));
  for (int second = 0; second < 3; ++second) {
    advance(*plain, 100);
    const auto expected = by_path(*plain);
    ASSERT_EQ(expected.count("rover1/scanner"), 1u);
    ASSERT_EQ(expected.count("rover2/scanner"), 1u);
    for (const auto& other : changed) {
      advance(*other, 100);
      for (const auto& [path, hash] : by_path(*other)) {
        if (path == "rover1/scanner") EXPECT_NE(hash, expected.at(path));
        else EXPECT_EQ(hash, expected.at(path)) << path;
      }
    }
  }
  // They do drive, and what they see does err.
  const BodyId base = plain->engine().bodies(*plain->find_instance("rover1"))[0];
  EXPECT_GT(norm(plain->engine().states()[base.index].V_WB.linear), 0.1);
}

TEST(Noise, SnapshotsHoldChainsFactorsAndTunedStages) {
  const auto simulation = build(errant());
  advance(*simulation, 50);
  simulation->submit(ParameterRequest{"rover1/scanner", "errors", Node::scalar("0.5")});
  simulation->submit(ParameterRequest{"rover1/imu", "gyro/x/0/gaussian/std", Node::scalar("0.2 deg/s")});
  advance(*simulation, 1);
  for (const auto& outcome : simulation->outcomes())
    EXPECT_TRUE(outcome.status) << outcome.status.error().text();
  const auto restored = again(*simulation);
  ASSERT_TRUE(restored);
  EXPECT_EQ(by_path(*restored), by_path(*simulation));
  advance(*simulation, 150);
  advance(*restored, 150);
  EXPECT_EQ(by_path(*restored), by_path(*simulation));
}

TEST(Noise, WithoutErrorsAScanIsExact) {
  // Beside the scanner with its factor at 0 one that never had noise shows the same ranges.
  model::Setup setup = errant();
  model::DeviceDecl twin = device_of(setup, "rover1", "scanner");
  twin.name = "twin";
  twin.config.erase("noise");
  device_of(setup, "rover1", "scanner").config.set("errors", Node::scalar("0"));
  for (model::Instance& instance : setup.instances)
    if (instance.name == "rover1") instance.devices.push_back(twin);
  const auto simulation = build(std::move(setup));
  advance(*simulation, 200);
  const auto ranges = [&](const char* name) {
    const auto* const topic = topic_cast<msg::LaserScan>(simulation->find_topic(name));
    return topic ? topic->message.ranges : std::vector<float>();
  };
  EXPECT_EQ(ranges("rover1/scanner").size(), 31u);
  EXPECT_EQ(ranges("rover1/scanner"), ranges("rover1/twin"));
  EXPECT_NE(ranges("rover1/scanner"), ranges("rover2/scanner"));
}

}  // namespace
}  // namespace sandlot::test
