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

/// sensor_msgs/PointField: where a value stands within a point of a PointCloud2.
struct PointField {
  static constexpr std::uint8_t uint16 = 4, float32 = 7;
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = float32;
  std::uint32_t count = 1;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the value."}, s.name);
    visit(Field{"offset", "1", "Bytes from the beginning of the point."}, s.offset);
    visit(Field{"datatype", "1", "4: uint16, 7: float32."}, s.datatype);
    visit(Field{"count", "1", "How many of them."}, s.count);
  }
};

/// sensor_msgs/PointCloud2: `height` rows of `width` points.
struct PointCloud2 {
  static constexpr const char* ros_type = "sensor_msgs/msg/PointCloud2";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::vector<PointField> point_fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;  ///< [bytes]
  std::vector<std::uint8_t> data;
  bool is_dense = false;  ///< false: points without a hit are in it, as NaN
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"height", "1", "Rows; 1: the points are in no order."}, s.height);
    visit(Field{"width", "1", "Points per row."}, s.width);
    visit(Field{"fields", "", "What a point is made of."}, s.point_fields);
    visit(Field{"is_bigendian", "", "Order of bytes."}, s.is_bigendian);
    visit(Field{"point_step", "1", "Bytes per point."}, s.point_step);
    visit(Field{"row_step", "1", "Bytes per row."}, s.row_step);
    visit(Field{"data", "", "The points."}, s.data);
    visit(Field{"is_dense", "", "True when no point is NaN."}, s.is_dense);
  }
};

/// sensor_msgs/Range: one distance in a cone. +inf nothing seen, -inf too near (REP 117).
struct Range {
  static constexpr const char* ros_type = "sensor_msgs/msg/Range";
  static constexpr std::uint8_t ultrasound = 0, infrared = 1;
  Header header;
  std::uint8_t radiation_type = ultrasound;
  float field_of_view = 0;             ///< [rad] full opening angle
  float min_range = 0, max_range = 0;  ///< [m]
  float range = 0;                     ///< [m]
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"radiation_type", "1", "0: ultrasound, 1: infra-red."}, s.radiation_type);
    visit(Field{"field_of_view", "rad", "Opening angle of the cone."}, s.field_of_view);
    visit(Field{"min_range", "m", "Shortest distance measured."}, s.min_range);
    visit(Field{"max_range", "m", "Longest distance measured."}, s.max_range);
    visit(Field{"range", "m", "Distance."}, s.range);
  }
};

/// sensor_msgs/Imu: covariances row-major 3x3.
struct Imu {
  static constexpr const char* ros_type = "sensor_msgs/msg/Imu";
  Header header;
  Quat orientation;
  std::array<double, 9> orientation_covariance{};
  Vec3 angular_velocity;  ///< [rad/s] in header.frame_id
  std::array<double, 9> angular_velocity_covariance{};
  Vec3 linear_acceleration;  ///< [m/s^2] specific force, in header.frame_id: (0, 0, 9.81) at rest
  std::array<double, 9> linear_acceleration_covariance{};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Stamp and frame."}, s.header);
    visit(Field{"orientation", "1", "Quaternion w x y z of the sensor in its reference frame."},
          s.orientation);
    visit(Field{"orientation_covariance", "", "Row-major 3x3."}, s.orientation_covariance);
    visit(Field{"angular_velocity", "rad/s", "Rate of turn."}, s.angular_velocity);
    visit(Field{"angular_velocity_covariance", "", "Row-major 3x3."}, s.angular_velocity_covariance);
    visit(Field{"linear_acceleration", "m/s^2", "Specific force."}, s.linear_acceleration);
    visit(Field{"linear_acceleration_covariance", "", "Row-major 3x3."}, s.linear_acceleration_covariance);
  }
};

/// trajectory_msgs/JointTrajectoryPoint: what the joints named by the trajectory shall be at a time.
struct JointTrajectoryPoint {
  std::vector<double> positions;      ///< [rad] or [m]
  std::vector<double> velocities;     ///< empty: not given
  std::vector<double> accelerations;  ///< empty: not given
  std::vector<double> effort;         ///< empty: not given
  Time time_from_start;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"positions", "rad", "Positions."}, s.positions);
    visit(Field{"velocities", "rad/s", "Velocities."}, s.velocities);
    visit(Field{"accelerations", "rad/s^2", "Accelerations."}, s.accelerations);
    visit(Field{"effort", "Nm", "Efforts."}, s.effort);
    visit(Field{"time_from_start", "ns", "Time since the start of the trajectory."}, s.time_from_start);
  }
};

/// trajectory_msgs/JointTrajectory. A stamp of 0 starts it at once.
struct JointTrajectory {
  static constexpr const char* ros_type = "trajectory_msgs/msg/JointTrajectory";
  Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"header", "", "Start."}, s.header);
    visit(Field{"joint_names", "", "Joint names."}, s.joint_names);
    visit(Field{"points", "", "Points in order of time."}, s.points);
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
