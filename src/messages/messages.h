#pragma once
/// The ROS 2 messages that today's devices speak, as plain structs with one field list each.
///
/// Names and members follow the ROS 2 packages (common_interfaces, Humble). Deviation: quaternions are w x y z
/// in memory here and x y z w on the wire. Vectors keep their capacity between samples, so that filling a
/// message costs no heap once it has been filled before.
#include <array>
#include <string>
#include <vector>

#include "base/time.h"
#include "geometry/pose.h"

namespace sandlot::msg {

/// std_msgs/Header. The frame's name is fixed when the device is built.
struct Header {
  Time stamp;
  std::string frame_id;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "ns", "Simulated time of the measurement."}, s.stamp);
    visit(Field{"frame_id", "", "Frame the data is expressed in."}, s.frame_id);
  }
};

/// geometry_msgs/Twist: velocity of a body in its own frame.
struct Twist {
  static constexpr const char* ros_type = "geometry_msgs/msg/Twist";
  Vec3 linear;   ///< [m/s]
  Vec3 angular;  ///< [rad/s]
  static void fields(auto& s, auto&& visit) {
    visit(Field{"linear", "m/s", "Linear velocity."}, s.linear);
    visit(Field{"angular", "rad/s", "Angular velocity."}, s.angular);
  }
};

/// geometry_msgs/PoseStamped.
struct PoseStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/PoseStamped";
  Header header;
  Pose pose;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"pose", "", "Pose in header.frame_id."}, s.pose);
  }
};

/// sensor_msgs/LaserScan. Beams in order of angle, REP 117: +inf nothing seen, -inf too near, NaN invalid.
struct LaserScan {
  static constexpr const char* ros_type = "sensor_msgs/msg/LaserScan";
  Header header;
  float angle_min = 0, angle_max = 0, angle_increment = 0;  ///< [rad]
  float time_increment = 0, scan_time = 0;                  ///< [s]
  float range_min = 0, range_max = 0;                       ///< [m]
  std::vector<float> ranges;                                ///< [m]
  std::vector<float> intensities;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"angle_min", "rad", "Angle of beam 0."}, s.angle_min);
    visit(Field{"angle_max", "rad", "Angle of the last beam."}, s.angle_max);
    visit(Field{"angle_increment", "rad", "Angle between beams."}, s.angle_increment);
    visit(Field{"time_increment", "s", "Time between beams."}, s.time_increment);
    visit(Field{"scan_time", "s", "Time between scans."}, s.scan_time);
    visit(Field{"range_min", "m", "Shortest distance measured."}, s.range_min);
    visit(Field{"range_max", "m", "Longest distance measured."}, s.range_max);
    visit(Field{"ranges", "m", "Distances."}, s.ranges);
    visit(Field{"intensities", "1", "Intensities; empty when not modelled."}, s.intensities);
  }
};

/// sensor_msgs/JointState.
struct JointState {
  static constexpr const char* ros_type = "sensor_msgs/msg/JointState";
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;  ///< [rad] or [m]
  std::vector<double> velocity;  ///< [rad/s] or [m/s]
  std::vector<double> effort;    ///< [Nm] or [N]
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"name", "", "Joint names."}, s.name);
    visit(Field{"position", "rad", "Positions."}, s.position);
    visit(Field{"velocity", "rad/s", "Velocities."}, s.velocity);
    visit(Field{"effort", "Nm", "Efforts."}, s.effort);
  }
};

/// nav_msgs/Odometry: pose in header.frame_id, twist in child_frame_id; covariances row-major 6x6.
struct Odometry {
  static constexpr const char* ros_type = "nav_msgs/msg/Odometry";
  Header header;
  std::string child_frame_id;
  Pose pose;
  std::array<double, 36> pose_covariance{};
  Twist twist;
  std::array<double, 36> twist_covariance{};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"child_frame_id", "", "Frame of the twist."}, s.child_frame_id);
    visit(Field{"pose", "", "Pose of the child frame."}, s.pose);
    visit(Field{"pose_covariance", "", "Row-major 6x6."}, s.pose_covariance);
    visit(Field{"twist", "", "Velocity in the child frame."}, s.twist);
    visit(Field{"twist_covariance", "", "Row-major 6x6."}, s.twist_covariance);
  }
};

/// std_msgs/Float64: single joint commands.
struct Float64 {
  static constexpr const char* ros_type = "std_msgs/msg/Float64";
  double data = 0;
  static void fields(auto& s, auto&& visit) { visit(Field{"data", "1", "The value."}, s.data); }
};

/// std_msgs/Int64: encoder ticks.
struct Int64Stamped {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Int64Stamped";
  Header header;
  std::int64_t data = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"data", "1", "The value."}, s.data);
  }
};

}  // namespace sandlot::msg
