#pragma once
/// geometry_msgs (Humble): poses, velocities, forces. Pose, Vector3 and Quaternion are those of geometry/.
#include <array>
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// A point in a frame.
struct PointStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/PointStamped";
  Header header;
  Point point;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"point", "m", "The point in header.frame_id."}, s.point);
  }
};

/// A pose in the plane.
struct Pose2D {
  static constexpr const char* ros_type = "geometry_msgs/msg/Pose2D";
  double x = 0;
  double y = 0;
  double theta = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Component along x."}, s.x);
    visit(Field{"y", "m", "Component along y."}, s.y);
    visit(Field{"theta", "rad", "Heading of the pose."}, s.theta);
  }
};

/// A pose in a frame.
struct PoseStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/PoseStamped";
  Header header;
  Pose pose;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"pose", "", "Pose in header.frame_id."}, s.pose);
  }
};

/// Poses in one frame.
struct PoseArray {
  static constexpr const char* ros_type = "geometry_msgs/msg/PoseArray";
  Header header;
  std::vector<Pose> poses;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"poses", "", "Poses in header.frame_id."}, s.poses);
  }
};

/// A pose and how sure it is.
struct PoseWithCovariance {
  static constexpr const char* ros_type = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose;
  std::array<double, 36> covariance{};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"pose", "", "Position and orientation."}, s.pose);
    visit(Field{"covariance", "", "Row-major 6x6: x y z and turns about x y z."}, s.covariance);
  }
};

/// A pose in a frame and how sure it is.
struct PoseWithCovarianceStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/PoseWithCovarianceStamped";
  Header header;
  PoseWithCovariance pose;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"pose", "", "Pose in header.frame_id."}, s.pose);
  }
};

/// An orientation in a frame.
struct QuaternionStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/QuaternionStamped";
  Header header;
  Quat quaternion;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"quaternion", "1", "Orientation in header.frame_id."}, s.quaternion);
  }
};

/// A vector in a frame.
struct Vector3Stamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/Vector3Stamped";
  Header header;
  Vec3 vector;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"vector", "", "The vector in header.frame_id."}, s.vector);
  }
};

/// Where a frame lies in another.
struct Transform {
  static constexpr const char* ros_type = "geometry_msgs/msg/Transform";
  Vec3 translation;
  Quat rotation;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"translation", "m", "Origin of the child in the parent."}, s.translation);
    visit(Field{"rotation", "1", "Orientation of the child in the parent."}, s.rotation);
  }
};

/// Where child_frame_id lies in header.frame_id.
struct TransformStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/TransformStamped";
  Header header;
  std::string child_frame_id;
  Transform transform;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"child_frame_id", "", "Name of the child frame."}, s.child_frame_id);
    visit(Field{"transform", "", "Pose of the child in its parent."}, s.transform);
  }
};

/// Velocity of a body in its own frame.
struct Twist {
  static constexpr const char* ros_type = "geometry_msgs/msg/Twist";
  Vec3 linear;
  Vec3 angular;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"linear", "m/s", "Linear velocity."}, s.linear);
    visit(Field{"angular", "rad/s", "Angular velocity."}, s.angular);
  }
};

/// A velocity in a frame.
struct TwistStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/TwistStamped";
  Header header;
  Twist twist;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"twist", "", "Velocity in header.frame_id."}, s.twist);
  }
};

/// A velocity and how sure it is.
struct TwistWithCovariance {
  static constexpr const char* ros_type = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist;
  std::array<double, 36> covariance{};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"twist", "", "The velocity."}, s.twist);
    visit(Field{"covariance", "", "Row-major 6x6: linear, then angular."}, s.covariance);
  }
};

/// A velocity in a frame and how sure it is.
struct TwistWithCovarianceStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/TwistWithCovarianceStamped";
  Header header;
  TwistWithCovariance twist;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"twist", "", "Velocity in header.frame_id."}, s.twist);
  }
};

/// Acceleration of a body.
struct Accel {
  static constexpr const char* ros_type = "geometry_msgs/msg/Accel";
  Vec3 linear;
  Vec3 angular;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"linear", "m/s^2", "Linear acceleration."}, s.linear);
    visit(Field{"angular", "rad/s^2", "Angular acceleration."}, s.angular);
  }
};

/// An acceleration in a frame.
struct AccelStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/AccelStamped";
  Header header;
  Accel accel;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"accel", "", "Acceleration in header.frame_id."}, s.accel);
  }
};

/// An acceleration and how sure it is.
struct AccelWithCovariance {
  static constexpr const char* ros_type = "geometry_msgs/msg/AccelWithCovariance";
  Accel accel;
  std::array<double, 36> covariance{};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"accel", "", "The acceleration."}, s.accel);
    visit(Field{"covariance", "", "Row-major 6x6: linear, then angular."}, s.covariance);
  }
};

/// An acceleration in a frame and how sure it is.
struct AccelWithCovarianceStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/AccelWithCovarianceStamped";
  Header header;
  AccelWithCovariance accel;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"accel", "", "Acceleration in header.frame_id."}, s.accel);
  }
};

/// Force and torque on a body.
struct Wrench {
  static constexpr const char* ros_type = "geometry_msgs/msg/Wrench";
  Vec3 force;
  Vec3 torque;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"force", "N", "Force vector."}, s.force);
    visit(Field{"torque", "Nm", "Torque vector."}, s.torque);
  }
};

/// Force and torque in a frame.
struct WrenchStamped {
  static constexpr const char* ros_type = "geometry_msgs/msg/WrenchStamped";
  Header header;
  Wrench wrench;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"wrench", "", "Wrench that acts at the origin of header.frame_id."}, s.wrench);
  }
};

}  // namespace sandlot::msg
