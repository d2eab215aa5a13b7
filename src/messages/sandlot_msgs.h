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
    visit(Field{"collision1_name", "", "Name of the shape that measures."}, s.collision1_name);
    visit(Field{"collision2_name", "", "Name of the other shape."}, s.collision2_name);
    visit(Field{"wrenches", "", "Wrenches on shape 1, one per contact point."}, s.wrenches);
    visit(Field{"total_wrench", "", "Sum of the wrenches."}, s.total_wrench);
    visit(Field{"contact_positions", "m", "Positions of the contact points."}, s.contact_positions);
    visit(Field{"contact_normals", "1", "Normals at the contact points, towards shape 1."},
          s.contact_normals);
    visit(Field{"depths", "m", "Penetration depths at the contact points."}, s.depths);
  }
};

/// All contacts of a device; after gazebo_msgs/ContactsState.
struct ContactsState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ContactsState";
  Header header;
  std::vector<ContactState> states;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"states", "", "Contacts, one per pair of shapes."}, s.states);
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
    visit(Field{"vertical_position", "m", "Height above the reference."}, s.vertical_position);
    visit(Field{"vertical_velocity", "m/s", "Vertical velocity, up positive."}, s.vertical_velocity);
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
    visit(Field{"closed", "", "Whether the gripper is commanded to close."}, s.closed);
    visit(Field{"held", "", "Instance and link that is held, \"can::body\"; empty: nothing."}, s.held);
    visit(Field{"force", "N", "Force of the gripper on the held object, in the gripper's frame."}, s.force);
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
    visit(Field{"target", "rad/s", "Target velocity of the controller."}, s.target);
    visit(Field{"velocity", "rad/s", "Velocity of the output shaft."}, s.velocity);
    visit(Field{"torque", "Nm", "Torque on the output shaft."}, s.torque);
    visit(Field{"voltage", "V", "Voltage at the motor's terminals."}, s.voltage);
    visit(Field{"current", "A", "Current through the motor's winding."}, s.current);
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
    visit(Field{"tick", "1", "Number of the tick."}, s.tick);
    visit(Field{"source_kind", "1", "Kind of the source."}, s.source_kind);
    visit(Field{"source_id", "1", "Identifier of the source among its kind."}, s.source_id);
    visit(Field{"sequence", "1", "Number of the request among those of its source."}, s.sequence);
    visit(Field{"kind", "1", "Kind of the request."}, s.kind);
    visit(Field{"target", "", "Device, program, robot or object that the request is about."}, s.target);
    visit(Field{"type", "", "Type of the request's bytes."}, s.type);
    visit(Field{"bytes", "", "Bytes of the request."}, s.bytes);
    visit(Field{"refused", "", "Whether the request was refused."}, s.refused);
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
    visit(Field{"tick", "1", "Number of the tick."}, s.tick);
    visit(Field{"revision", "1", "Revision of the model."}, s.revision);
    visit(Field{"hash", "1", "Hash of the whole state."}, s.hash);
    visit(Field{"parts", "1", "Hashes of the entities, in the order of the latest StateParts."}, s.parts);
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
    visit(Field{"tick", "1", "Number of the tick."}, s.tick);
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
    visit(Field{"label", "", "Label of the object, such as ball."}, s.label);
    visit(Field{"name", "", "Name of the object; empty where the detector does not report names."}, s.name);
    visit(Field{"color", "", "Colour of the object's largest part."}, s.color);
    visit(Field{"bearing", "rad", "Angle to the object's middle: from x to y of the frame."}, s.bearing);
    visit(Field{"elevation", "rad", "Angle to the object's middle: up from the xy plane."}, s.elevation);
    visit(Field{"range", "m", "Distance to the object's middle."}, s.range);
    visit(Field{"position", "m", "Position of the object's middle: bearing, elevation and range as a point."},
          s.position);
    visit(Field{"visible", "1", "Visible part of the object, from 0 to 1."}, s.visible);
    visit(Field{"confidence", "1", "Confidence of the detector, from 0 to 1."}, s.confidence);
  }
};

/// All that a camera sees.
struct ObjectArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ObjectArray";
  Header header;
  std::vector<Object> objects;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"objects", "", "Detected objects, in no particular order."}, s.objects);
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
    visit(Field{"label", "", "Label of the object, such as ball."}, s.label);
    visit(Field{"name", "", "Name of the object; empty where the detector does not report names."}, s.name);
    visit(Field{"color", "", "Colour of the object's largest part."}, s.color);
    visit(Field{"pose", "", "Pose of the object's body in header.frame_id."}, s.pose);
    visit(Field{"position_std", "m", "Standard deviation of x and y."}, s.position_std);
    visit(Field{"confidence", "1", "Confidence of the detector, from 0 to 1."}, s.confidence);
  }
};

/// Where things are.
struct ObjectPoseArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ObjectPoseArray";
  Header header;
  std::vector<ObjectPose> objects;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"objects", "", "Detected objects, in no particular order."}, s.objects);
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
    visit(Field{"status", "1", "Status of the device: IDLE, MOVING ..."}, s.status);
    visit(Field{"label", "", "Label of the object, such as ball."}, s.label);
    visit(Field{"pan", "rad", "Angle of the pan joint."}, s.pan);
    visit(Field{"tilt", "rad", "Angle of the tilt joint."}, s.tilt);
    visit(Field{"pan_target", "rad", "Target angle of the pan joint."}, s.pan_target);
    visit(Field{"tilt_target", "rad", "Target angle of the tilt joint."}, s.tilt_target);
    visit(Field{"zoom", "1",
                "Focal length of the camera, as a multiple of its shortest; 1 without a zoom lens."},
          s.zoom);
    visit(Field{"zoom_target", "1", "Target of the zoom."}, s.zoom_target);
  }
};

/// Numbers that somebody watches.
struct Samples {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Samples";
  Time stamp;
  std::vector<double> values;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Simulated time of the tick."}, s.stamp);
    visit(Field{"values", "", "Values in the order of the request; NaN where one has no value."}, s.values);
  }
};

}  // namespace sandlot::msg
