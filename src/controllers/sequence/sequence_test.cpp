#include "controllers/sequence/sequence.h"

#include <gtest/gtest.h>

namespace sandlot::controllers::sequence {
namespace {

Description description() {
  Description robot;
  robot.robot = "arm";
  robot.actuators = {{"elbow", "position", msg::Float64::ros_type, 0, {}},
                     {"wrist", "position", msg::Float64::ros_type, 1, {}},
                     {"base", "ideal", msg::Twist::ros_type, 2, {}}};
  return robot;
}

Node step_at(const char* at, std::vector<std::pair<std::string, std::string>> orders) {
  Node step = Node::map(), values = Node::map();
  for (auto& [device, value] : orders) values.set(device, Node::scalar(value));
  step.set("at", Node::scalar(at));
  step.set("orders", std::move(values));
  return step;
}
Node list_of(std::vector<Node> steps) {
  Node list = Node::sequence();
  for (Node& step : steps) list.push(std::move(step));
  return list;
}

/// (slot, value) of the orders given at `now_s`.
std::vector<std::pair<std::uint32_t, double>> orders_at(Sequence& controller, double now_s) {
  const Observation obs(Time::from_s(now_s), {}, {}, Stream(1, 2, Purpose::controller, 3));
  Command cmd;
  controller.step(obs, cmd);
  std::vector<std::pair<std::uint32_t, double>> given;
  for (const Command::Order& order : cmd.orders()) {
    ByteReader r(cmd.bytes(order));
    msg::Float64 number;
    read(r, number);
    given.emplace_back(order.slot, number.data);
  }
  return given;
}
using Given = std::vector<std::pair<std::uint32_t, double>>;

TEST(Sequence, EachOrderIsGivenOnceAtTheFirstStepNotBeforeItsTime) {
  Sequence controller;
  controller.spec.steps = list_of(
      {step_at("0", {{"elbow", "0.5"}}), step_at("250 ms", {{"elbow", "-1"}, {"wrist", "2"}})});
  ASSERT_TRUE(static_cast<bool>(controller.init(description())));
  EXPECT_EQ(orders_at(controller, 0.0), (Given{{0, 0.5}}));
  EXPECT_EQ(orders_at(controller, 0.1), Given{});
  EXPECT_EQ(orders_at(controller, 0.2), Given{});
  EXPECT_EQ(orders_at(controller, 0.3), (Given{{0, -1}, {1, 2}}));
  EXPECT_EQ(orders_at(controller, 99), Given{});
}

TEST(Sequence, RoundsBeginAgainAndASlowControllerSkipsWholeRounds) {
  Sequence controller;
  controller.spec.steps = list_of({step_at("0", {{"elbow", "1"}}), step_at("1", {{"elbow", "2"}})});
  controller.spec.repeat_s = 2;
  ASSERT_TRUE(static_cast<bool>(controller.init(description())));
  EXPECT_EQ(orders_at(controller, 0), (Given{{0, 1}}));
  EXPECT_EQ(orders_at(controller, 1), (Given{{0, 2}}));
  EXPECT_EQ(orders_at(controller, 1.9), Given{});
  EXPECT_EQ(orders_at(controller, 2), (Given{{0, 1}}));
  EXPECT_EQ(orders_at(controller, 7.5), (Given{{0, 1}, {0, 2}})) << "round 3 began at 6 s";
  EXPECT_EQ(controller.state.round, 3u);
}

TEST(Sequence, AListIsAMotionOfADrive) {
  Sequence controller;
  Node motion = Node::sequence();
  for (const char* each : {"0.5", "0", "-0.25"}) motion.push(Node::scalar(each));
  Node step = step_at("0", {});
  step.find("orders")->set("base", motion);
  controller.spec.steps = list_of({step});
  ASSERT_TRUE(static_cast<bool>(controller.init(description())));
  const Observation obs({}, {}, {}, Stream(1, 2, Purpose::controller, 3));
  Command cmd;
  controller.step(obs, cmd);
  ASSERT_EQ(cmd.orders().size(), 1u);
  EXPECT_EQ(cmd.orders()[0].slot, 2u);
  ByteReader r(cmd.bytes(cmd.orders()[0]));
  msg::Twist twist;
  read(r, twist);
  EXPECT_EQ(twist.linear.x, 0.5);
  EXPECT_EQ(twist.linear.y, 0.0);
  EXPECT_EQ(twist.angular.z, -0.25);
}

TEST(Sequence, TrueAndFalseAreBool) {
  Sequence controller;
  controller.spec.steps = list_of(
      {step_at("0", {{"hand", "true"}, {"elbow", "1"}}), step_at("1", {{"hand", "false"}})});
  Description robot = description();
  robot.actuators.push_back({"hand", "hold", msg::Bool::ros_type, 3, {}});
  ASSERT_TRUE(controller.init(robot));
  for (const double now_s : {0.0, 1.0}) {
    const Observation obs(Time::from_s(now_s), {}, {}, Stream(1, 2, Purpose::controller, 3));
    Command cmd;
    controller.step(obs, cmd);
    ASSERT_EQ(cmd.orders().size(), now_s == 0 ? 2u : 1u);
    EXPECT_EQ(cmd.orders()[0].slot, 3u);
    ByteReader r(cmd.bytes(cmd.orders()[0]));
    msg::Bool order;
    read(r, order);
    EXPECT_EQ(order.data, now_s == 0);
  }
}

TEST(Sequence, ATextForARadioIsAPacketForAll) {
  Sequence controller;
  controller.spec.steps = list_of({step_at("0", {{"radio", "hello"}})});
  Description robot = description();
  robot.actuators.push_back({"radio", "send", msg::RadioPacket::ros_type, 3, {}});
  ASSERT_TRUE(controller.init(robot));
  const Observation obs(Time{}, {}, {}, Stream(1, 2, Purpose::controller, 3));
  Command cmd;
  controller.step(obs, cmd);
  ASSERT_EQ(cmd.orders().size(), 1u);
  ByteReader r(cmd.bytes(cmd.orders()[0]));
  msg::RadioPacket packet;
  read(r, packet);
  EXPECT_EQ(packet.to, "");
  EXPECT_EQ(std::string(packet.data.begin(), packet.data.end()), "hello");
}

TEST(Sequence, AMapForARadioSaysWhoItIsFor) {
  const auto sequence = [](const Node& order, Command& cmd) {
    Node orders = Node::map(), step = Node::map();
    orders.set("radio", order);
    step.set("at", Node::scalar("0"));
    step.set("orders", orders);
    Sequence controller;
    controller.spec.steps = list_of({step});
    Description robot = description();
    robot.actuators.push_back({"radio", "send", msg::RadioPacket::ros_type, 3, {}});
    const Status ready = controller.init(robot);
    if (!ready) return ready.error().text();
    controller.step(Observation(Time{}, {}, {}, Stream(1, 2, Purpose::controller, 3)), cmd);
    return std::string();
  };
  Node order = Node::map();
  order.set("to", Node::scalar("red"));
  order.set("data", Node::scalar("hello"));
  Command cmd;
  EXPECT_EQ(sequence(order, cmd), "");
  ASSERT_EQ(cmd.orders().size(), 1u);
  ByteReader r(cmd.bytes(cmd.orders()[0]));
  msg::RadioPacket packet;
  read(r, packet);
  EXPECT_EQ(packet.to, "red");
  EXPECT_EQ(std::string(packet.data.begin(), packet.data.end()), "hello");
  order.set("date", Node::scalar("hello"));
  EXPECT_NE(sequence(order, cmd).find("did you mean 'data'?"), std::string::npos) << sequence(order, cmd);
  EXPECT_NE(sequence(Node::sequence(), cmd).find("{to: robot or team, data: text}"), std::string::npos);
}

TEST(Sequence, RefusesWhatItCannotOrder) {
  const auto complaint = [](std::vector<Node> steps) {
    Sequence controller;
    controller.spec.steps = list_of(std::move(steps));
    const Status ready = controller.init(description());
    return ready ? "" : ready.error().what;
  };
  EXPECT_NE(complaint({step_at("0", {{"elbo", "1"}})}).find("'elbo'"), std::string::npos);
  EXPECT_NE(complaint({step_at("0", {{"base", "1"}})}).find("'base'"), std::string::npos)
      << "no Float64 there";
  EXPECT_NE(complaint({step_at("0", {{"elbow", "true"}})}).find("'elbow'"), std::string::npos)
      << "no Bool there";
  EXPECT_NE(complaint({step_at("0", {{"elbow", "fast"}})}).find("is not a number"), std::string::npos);
  EXPECT_NE(complaint({step_at("2", {{"elbow", "1"}}), step_at("1", {{"elbow", "1"}})})
                .find("before the one above"),
            std::string::npos);
}

}  // namespace
}  // namespace sandlot::controllers::sequence
