#pragma once
/// sandlot_msgs: what no ROS 2 package has.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"

namespace sandlot::msg {

/// Encoder ticks.
struct Int64Stamped {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Int64Stamped";
  Header header;
  std::int64_t data = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"data", "1", "The value."}, s.data);
  }
};

/// Where two collision shapes touch; after gazebo_msgs/ContactState without `info`.
struct ContactState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ContactState";
  std::string collision1_name;
  std::string collision2_name;
  std::vector<Wrench> wrenches;
  Wrench total_wrench;
  std::vector<Vec3> contact_positions;
  std::vector<Vec3> contact_normals;
  std::vector<double> depths;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"collision1_name", "", "The shape of the one who measures."}, s.collision1_name);
    visit(Field{"collision2_name", "", "The other shape."}, s.collision2_name);
    visit(Field{"wrenches", "", "On shape 1, for each point."}, s.wrenches);
    visit(Field{"total_wrench", "", "Their sum."}, s.total_wrench);
    visit(Field{"contact_positions", "m", "The points."}, s.contact_positions);
    visit(Field{"contact_normals", "1", "At each point, towards shape 1."}, s.contact_normals);
    visit(Field{"depths", "m", "At each point, how deep."}, s.depths);
  }
};

/// All contacts of a device; after gazebo_msgs/ContactsState.
struct ContactsState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ContactsState";
  Header header;
  std::vector<ContactState> states;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"states", "", "One for each pair of shapes."}, s.states);
  }
};

/// Height and its change; after gz.msgs.Altimeter.
struct Altimeter {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Altimeter";
  Header header;
  double vertical_position = 0;
  double vertical_velocity = 0;
  double vertical_reference = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"vertical_position", "m", "Above the reference."}, s.vertical_position);
    visit(Field{"vertical_velocity", "m/s", "Up positive."}, s.vertical_velocity);
    visit(Field{"vertical_reference", "m", "Height of the reference in the world."}, s.vertical_reference);
  }
};

/// What a gripper holds.
struct GripperState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/GripperState";
  Header header;
  bool closed = false;
  std::string held;
  Vec3 force;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"closed", "", "It was told to close."}, s.closed);
    visit(Field{"held", "", "Instance and link, \"can::body\"; empty: nothing."}, s.held);
    visit(Field{"force", "N", "What holds it there, on what is held, in the gripper's frame."}, s.force);
  }
};

/// What a motor is doing.
struct MotorState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/MotorState";
  Header header;
  double target = 0;
  double velocity = 0;
  double torque = 0;
  double voltage = 0;
  double current = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"target", "rad/s", "Velocity that its controller follows."}, s.target);
    visit(Field{"velocity", "rad/s", "Velocity of the output shaft."}, s.velocity);
    visit(Field{"torque", "Nm", "Torque on the output shaft."}, s.torque);
    visit(Field{"voltage", "V", "Voltage at its terminals."}, s.voltage);
    visit(Field{"current", "A", "Current through its winding."}, s.current);
  }
};

/// Something carried out at a tick boundary; with the seed these are the replay.
struct LogEntry {
  static constexpr const char* ros_type = "sandlot_msgs/msg/LogEntry";
  Time stamp;
  std::uint64_t tick = 0;
  std::uint8_t source_kind = 0;
  std::uint64_t source_id = 0;
  std::uint64_t sequence = 0;
  std::uint8_t kind = 0;
  std::string target;
  std::string type;
  std::vector<std::uint8_t> bytes;
  bool refused = false;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Simulated time of the tick."}, s.stamp);
    visit(Field{"tick", "1", "Its number."}, s.tick);
    visit(Field{"source_kind", "1", "Who asked."}, s.source_kind);
    visit(Field{"source_id", "1", "Which of them."}, s.source_id);
    visit(Field{"sequence", "1", "Number of the request of that source."}, s.sequence);
    visit(Field{"kind", "1", "What was asked."}, s.kind);
    visit(Field{"target", "", "Address it is for."}, s.target);
    visit(Field{"type", "", "Type of the bytes."}, s.type);
    visit(Field{"bytes", "", "The request."}, s.bytes);
    visit(Field{"refused", "", "It was not carried out."}, s.refused);
  }
};

/// Proof of the state after a tick.
struct StateHash {
  static constexpr const char* ros_type = "sandlot_msgs/msg/StateHash";
  Time stamp;
  std::uint64_t tick = 0;
  std::uint64_t revision = 0;
  std::uint64_t hash = 0;
  std::vector<std::uint64_t> parts;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Simulated time of the tick."}, s.stamp);
    visit(Field{"tick", "1", "Its number."}, s.tick);
    visit(Field{"revision", "1", "Revision of the model."}, s.revision);
    visit(Field{"hash", "1", "Of the whole state."}, s.hash);
    visit(Field{"parts", "1", "Of each entity, in the order of the latest StateParts."}, s.parts);
  }
};

/// The names of StateHash.parts; sent when they change.
struct StateParts {
  static constexpr const char* ros_type = "sandlot_msgs/msg/StateParts";
  Time stamp;
  std::uint64_t tick = 0;
  std::uint64_t revision = 0;
  std::vector<std::string> paths;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Simulated time of the tick."}, s.stamp);
    visit(Field{"tick", "1", "Its number."}, s.tick);
    visit(Field{"revision", "1", "Revision of the model."}, s.revision);
    visit(Field{"paths", "", "Addresses of the entities."}, s.paths);
  }
};

/// Something that a camera sees, as a detector tells it.
struct Object {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Object";
  std::string label;
  std::string name;
  ColorRGBA color;
  double bearing = 0;
  double elevation = 0;
  double range = 0;
  Point position;
  double visible = 0;
  double confidence = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"label", "", "Its class, such as ball."}, s.label);
    visit(Field{"name", "", "Which one; empty where the detector does not tell."}, s.name);
    visit(Field{"color", "", "Of its largest part."}, s.color);
    visit(Field{"bearing", "rad", "To its middle: from x to y of the frame."}, s.bearing);
    visit(Field{"elevation", "rad", "To its middle: up from the xy plane."}, s.elevation);
    visit(Field{"range", "m", "To its middle."}, s.range);
    visit(Field{"position", "m", "Of its middle: the three above as a point."}, s.position);
    visit(Field{"visible", "1", "The part of it that is seen, from 0 to 1."}, s.visible);
    visit(Field{"confidence", "1", "How sure the detector is, from 0 to 1."}, s.confidence);
  }
};

/// All that a camera sees.
struct ObjectArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ObjectArray";
  Header header;
  std::vector<Object> objects;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"objects", "", "In no particular order."}, s.objects);
  }
};

/// Where something is.
struct ObjectPose {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ObjectPose";
  std::string label;
  std::string name;
  ColorRGBA color;
  Pose pose;
  double position_std = 0;
  double confidence = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"label", "", "Its class, such as ball."}, s.label);
    visit(Field{"name", "", "Which one; empty where the detector does not tell."}, s.name);
    visit(Field{"color", "", "Of its largest part."}, s.color);
    visit(Field{"pose", "", "Of its body in header.frame_id."}, s.pose);
    visit(Field{"position_std", "m", "Standard deviation of x and y."}, s.position_std);
    visit(Field{"confidence", "1", "How sure the detector is, from 0 to 1."}, s.confidence);
  }
};

/// Where things are.
struct ObjectPoseArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ObjectPoseArray";
  Header header;
  std::vector<ObjectPose> objects;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"objects", "", "In no particular order."}, s.objects);
  }
};

/// What a pan-tilt unit is doing.
struct PanTiltState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/PanTiltState";
  static constexpr std::uint8_t idle = 0, moving = 1, arrived = 2, searching = 3, tracking = 4, lost = 5,
                                out_of_reach = 6;
  Header header;
  std::uint8_t status = idle;
  std::string label;
  double pan = 0;
  double tilt = 0;
  double pan_target = 0;
  double tilt_target = 0;
  double zoom = 1;
  double zoom_target = 1;
  static void constants(auto&& visit) {
    visit("IDLE", idle);
    visit("MOVING", moving);
    visit("ARRIVED", arrived);
    visit("SEARCHING", searching);
    visit("TRACKING", tracking);
    visit("LOST", lost);
    visit("OUT_OF_REACH", out_of_reach);
  }
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"status", "1", "IDLE, MOVING ..."}, s.status);
    visit(Field{"label", "", "What it searches or tracks."}, s.label);
    visit(Field{"pan", "rad", "Angle of the pan joint."}, s.pan);
    visit(Field{"tilt", "rad", "Angle of the tilt joint."}, s.tilt);
    visit(Field{"pan_target", "rad", "Where it shall turn."}, s.pan_target);
    visit(Field{"tilt_target", "rad", "Where it shall turn."}, s.tilt_target);
    visit(Field{"zoom", "1", "Focal length of the camera, in its shortest ones; 1 without a zoom lens."},
          s.zoom);
    visit(Field{"zoom_target", "1", "What it shall become."}, s.zoom_target);
  }
};

/// Numbers that somebody watches.
struct Samples {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Samples";
  Time stamp;
  std::vector<double> values;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Simulated time of the tick."}, s.stamp);
    visit(Field{"values", "", "In the order they were asked for; NaN where one has no value."}, s.values);
  }
};

}  // namespace sandlot::msg
