#include "formats/ros2_control/ros2_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandlot::formats {
namespace {

using testing::HasSubstr;

struct Read {
  std::vector<model::DeviceDecl> devices;
  std::vector<std::string> warnings;
  std::string error;
};

Read parse(const std::string& text) {
  Diagnostics diagnostics;
  Read out;
  auto devices = parse_joint_controllers(text, "c.yaml", diagnostics);
  if (devices) out.devices = std::move(*devices);
  else out.error = devices.error().text();
  for (const Error& warning : diagnostics.warnings) out.warnings.push_back(warning.text());
  return out;
}

/// "kind name: key=value key=[a, b] ..." of each device.
std::string flat(const Node& node) {
  if (node.is_scalar()) return node.text();
  std::string out;
  for (const Node& item : node.items()) out += (out.empty() ? "" : " ") + flat(item);
  for (const Node::Entry& entry : node.entries())
    out += (out.empty() ? "" : " ") + entry.key + "=" + (entry.value.is_scalar() ? "" : "(") +
           flat(entry.value) + (entry.value.is_scalar() ? "" : ")");
  return out;
}
std::vector<std::string> lines(const Read& read) {
  std::vector<std::string> out;
  for (const model::DeviceDecl& d : read.devices)
    out.push_back(d.kind + " " + d.name + ": " + flat(d.config));
  return out;
}
using Lines = std::vector<std::string>;

TEST(Ros2Control, TakesTheFilesOfRos2) {
  const Read read = parse(R"(
controller_manager:
  ros__parameters:
    update_rate: 100
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    arm: {type: position_controllers/JointGroupPositionController}
    wheels: {type: forward_command_controller/ForwardCommandController}
    torque: {type: effort_controllers/JointGroupEffortController}
    drive: {type: diff_drive_controller/DiffDriveController}
arm:
  ros__parameters:
    joints: [shoulder, elbow]
/robot1/wheels:
  ros__parameters: {joints: [left], interface_name: velocity}
torque:
  ros__parameters: {joints: [grip]}
drive:
  ros__parameters:
    left_wheel_names: [l1, l2]
    right_wheel_names: [r1, r2]
    wheel_separation: 0.5
    wheel_separation_multiplier: 1.2
    wheel_radius: 0.1
    publish_rate: 50.0
    cmd_vel_timeout: 0.5
    linear.x.max_velocity: 1.5
    angular: {z: {max_acceleration: 3}}
)");
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.warnings, Lines{});
  EXPECT_EQ(
      lines(read),
      (Lines{"joint_state joint_state_broadcaster: rate=0",
             "joint_motor arm_shoulder: joint=shoulder level=position servo=exact",
             "joint_motor arm_elbow: joint=elbow level=position servo=exact",
             "joint_motor wheels: joint=left level=velocity servo=exact",
             "joint_motor torque: joint=grip level=effort",
             "diff_drive drive: left_joint=(l1 l2) right_joint=(r1 r2) wheel_separation=0.6 wheel_radius=0.1 "
             "rate=50.0 command_timeout=0.5 max_linear_speed=1.5 max_angular_acceleration=3"}));
}

TEST(Ros2Control, TakesTheFilesOfRos1WithGainsWhereverTheyStand) {
  const Read read = parse(R"(
mario:
  joint_state_controller: {type: joint_state_controller/JointStateController, publish_rate: 50}
  servo1_position_controller:
    type: effort_controllers/JointPositionController
    joint: servo1
    pid: {p: 100.0, i: 0.01, d: 10.0}
  motor1_velocity_controller: {type: velocity_controllers/JointVelocityController, joint: motor1}
  motor2_velocity_controller: {type: velocity_controllers/JointVelocityController, joint: motor2}
  group:
    type: effort_controllers/JointGroupPositionController
    joints: [a, b]
    a: {pid: {p: 1, i: 2, d: 3}}
    b: {pid: {p: 4, i: 5, d: 6, i_clamp: 7, antiwindup: true}}
  gazebo_ros_control:
    pid_gains: {motor2: {p: 8, i: 0, d: 0, i_clamp_max: 0.0}}
)");
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(
      lines(read),
      (Lines{"joint_state joint_state_controller: rate=50",
             "joint_motor servo1_position_controller: joint=servo1 level=position position=(p=100.0 i=0.01 "
             "d=10.0)",
             "joint_motor motor1_velocity_controller: joint=motor1 level=velocity servo=exact",
             "joint_motor motor2_velocity_controller: joint=motor2 level=velocity velocity=(p=8 i=0 d=0)",
             "joint_motor group_a: joint=a level=position position=(p=1 i=2 d=3)",
             "joint_motor group_b: joint=b level=position position=(p=4 i=5 d=6)"}));
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_EQ(
      read.warnings[0],
      "c.yaml:14:33: 'i_clamp' of the gains of 'b' has no effect; the integral unwinds by itself while the "
      "effort is limited");
}

TEST(Ros2Control, TakesTrajectoryControllers) {
  const Read read = parse(R"(
/**:
  controller_manager:
    ros__parameters:
      arm: {type: joint_trajectory_controller/JointTrajectoryController}
      hand: {type: joint_trajectory_controller/JointTrajectoryController}
  arm: {ros__parameters: {joints: [a, b], command_interfaces: [position]}}
  hand: {ros__parameters: {joints: [c], command_interfaces: [effort], gains: {c: {p: 9, d: 1}}}}
)");
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(lines(read), (Lines{"joint_trajectory arm: joints=(a b)",
                                "joint_trajectory hand: joints=(c) gains=(p=9 d=1)"}));
}

TEST(Ros2Control, WhatItCannotUseIsNamedOnce) {
  const Read read = parse(R"(controller_manager:
  ros__parameters:
    imu: {type: imu_sensor_broadcaster/IMUSensorBroadcaster}
    good: {type: position_controllers/JointPositionController}
good: {ros__parameters: {joint: a}}
navigator: {ros__parameters: {speed: 1}}
)");
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.devices.size(), 1u);
  ASSERT_EQ(read.warnings.size(), 2u);
  EXPECT_THAT(read.warnings[0], HasSubstr("c.yaml:3:17: controller 'imu' of type "
                                          "'imu_sensor_broadcaster/IMUSensorBroadcaster' is not supported"));
  EXPECT_THAT(read.warnings[1], HasSubstr("c.yaml:6:"));
  EXPECT_THAT(read.warnings[1], HasSubstr("the parameters of 'navigator' belong to no controller"));
}

TEST(Ros2Control, FaultsAreOneErrorWithALine) {
  const auto error = [](const std::string& text) { return parse(text).error; };
  EXPECT_THAT(error(""), HasSubstr("a map of controllers"));
  EXPECT_EQ(error("a: {b: 1}"),
            "c.yaml:1:1: this file declares no controllers; ROS 2: "
            "controller_manager.ros__parameters.NAME.type; ROS 1: NAME: {type: ...}");
  EXPECT_EQ(error("a: {type: position_controllers/JointPositionController}"),
            "c.yaml:1:1: controller 'a' names no joints; write joints: [...]");
  EXPECT_EQ(error("a: {type: effort_controllers/JointPositionController, joint: j}"),
            "c.yaml:1:1: controller 'a' has no gains for joint 'j'; write gains: {j: {p: ..., i: ..., d: "
            "...}} (ROS "
            "1: pid: {...})");
  EXPECT_THAT(error("a: {type: forward_command_controller/ForwardCommandController, joints: [j]}"),
              HasSubstr("names no interface"));
  EXPECT_THAT(error("a: {type: forward_command_controller/ForwardCommandController, joints: [j], "
                    "interface_name: warp}"),
              HasSubstr("interface 'warp' cannot be driven"));
  EXPECT_THAT(error("x:\n  a: {type: joint_state_controller/JointStateController}\ny:\n  a: {type: "
                    "joint_state_controller/JointStateController}"),
              HasSubstr("c.yaml:4:3: there are two controllers named 'a'; the other one is at c.yaml:2:3"));
  EXPECT_THAT(error("a: {type: [1]}"), HasSubstr("the type of a controller"));
  EXPECT_THAT(error("a: {type: position_controllers/JointPositionController, joint: {x: 1}}"),
              HasSubstr("names of joints"));
  EXPECT_THAT(error("a: [1"), HasSubstr("c.yaml:1:"));
  std::string deep;
  for (int i = 0; i < 40; ++i) deep += std::string(static_cast<std::size_t>(i), ' ') + "n:\n";
  EXPECT_THAT(error(deep + std::string(41, ' ') + "x: 1\n"), HasSubstr("too deeply"));
}

}  // namespace
}  // namespace sandlot::formats
