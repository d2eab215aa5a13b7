#pragma once
/// Test rig of controllers that see a field from above: a camera, and on demand a radio, a battery, a gripper,
/// a kicker and a property.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "control/controller.h"

namespace sandlot::controllers {

template <class C>
struct FieldRig {
  C controller;
  Description robot;
  Topic<msg::ObjectPoseArray> camera{"/me/camera/world"};
  Topic<msg::RadioReceptionArray> radio{"/me/radio/packets"};
  Topic<msg::BatteryState> battery{"/me/battery/state"};
  Topic<msg::GripperState> hand{"/me/hand/hold"};
  Topic<msg::KickerState> kicker{"/me/kicker/kick"};
  Topic<msg::PropertyStamped> health{"/me/health/property"};
  std::vector<std::uint64_t> seen{0, 0, 0, 0, 0, 0};
  Command cmd;

  explicit FieldRig(typename C::Spec spec, std::string name = "me") {
    robot.robot = std::move(name);
    robot.control_period_s = 0.05;
    robot.readings = {{"camera", "world", msg::ObjectPoseArray::ros_type, 0, {}},
                      {"radio", "packets", msg::RadioReceptionArray::ros_type, 1, {}},
                      {"battery", "state", msg::BatteryState::ros_type, 2, {}},
                      {"hand", "hold", msg::GripperState::ros_type, 3, {}},
                      {"kicker", "kick", msg::KickerState::ros_type, 4, {}},
                      {"health", "property", msg::PropertyStamped::ros_type, 5, {}}};
    robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}},
                       {"radio", "packets", msg::RadioPacket::ros_type, 1, {}},
                       {"kicker", "kick", msg::Float64::ros_type, 2, {}},
                       {"hand", "hold", msg::Bool::ros_type, 3, {}}};
    controller.spec = std::move(spec);
    const Status ready = controller.init(robot);
    EXPECT_TRUE(static_cast<bool>(ready)) << (ready ? "" : ready.error().text());
  }

  void put(const std::string& name, const std::string& label, double x, double y, double yaw = 0) {
    for (msg::ObjectPose& object : camera.message.objects)
      if (object.name == name) {
        object.pose = {{x, y, 0}, quat_from_axis_angle({0, 0, 1}, yaw)};
        return;
      }
    msg::ObjectPose& object = camera.message.objects.emplace_back();
    object.name = name, object.label = label;
    object.pose = {{x, y, 0}, quat_from_axis_angle({0, 0, 1}, yaw)};
  }
  void hear(const std::string& from, const std::string& text) {
    msg::RadioReception& packet = radio.message.packets.emplace_back();
    packet.from = from;
    packet.data.assign(text.begin(), text.end());
  }
  /// One step; what the radio had is gone after it.
  void step(double now_s) {
    const Time now = Time::from_s(now_s);
    camera.publish(now);
    radio.publish(now);
    battery.publish(now);
    hand.publish(now);
    kicker.publish(now);
    health.publish(now);
    const TopicBase* const topics[] = {&camera, &radio, &battery, &hand, &kicker, &health};
    cmd.clear();
    controller.step(
        Observation(now, topics, seen, Stream(1, 2, Purpose::controller, static_cast<std::uint64_t>(now.ns))),
        cmd);
    seen = {camera.count, radio.count, battery.count, hand.count, kicker.count, health.count};
    radio.message.packets.clear();
  }
  /// The order to an actuator in the latest step.
  template <class M>
  std::optional<M> order(std::uint32_t slot) const {
    for (const Command::Order& each : cmd.orders()) {
      if (each.slot != slot) continue;
      M message;
      ByteReader r(cmd.bytes(each));
      read(r, message);
      EXPECT_TRUE(r.ok());
      return message;
    }
    return {};
  }
  msg::Twist twist() const { return order<msg::Twist>(0).value_or(msg::Twist{.linear = {-99, 0, 0}}); }
  std::string sent() const {
    const auto packet = order<msg::RadioPacket>(1);
    return packet ? std::string(packet->data.begin(), packet->data.end()) : "nothing";
  }
};

}  // namespace sandlot::controllers
