#pragma once
/// trajectory_msgs (Humble).
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"

namespace sandlot::msg {

/// What the joints named by the trajectory shall be at a time.
struct JointTrajectoryPoint {
  static constexpr const char* ros_type = "trajectory_msgs/msg/JointTrajectoryPoint";
  std::vector<double> positions;
  std::vector<double> velocities;
  std::vector<double> accelerations;
  std::vector<double> effort;
  Duration time_from_start;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"positions", "rad", "Positions of the joints."}, s.positions);
    visit(Field{"velocities", "rad/s", "Velocities; empty: not given."}, s.velocities);
    visit(Field{"accelerations", "rad/s^2", "Accelerations; empty: not given."}, s.accelerations);
    visit(Field{"effort", "Nm", "Efforts; empty: not given."}, s.effort);
    visit(Field{"time_from_start", "s", "Time since the start of the trajectory."}, s.time_from_start);
  }
};

/// A stamp of 0 starts it at once.
struct JointTrajectory {
  static constexpr const char* ros_type = "trajectory_msgs/msg/JointTrajectory";
  Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"joint_names", "", "Names of the joints."}, s.joint_names);
    visit(Field{"points", "", "Points in order of time."}, s.points);
  }
};

/// What joints with several degrees of freedom shall be at a time.
struct MultiDOFJointTrajectoryPoint {
  static constexpr const char* ros_type = "trajectory_msgs/msg/MultiDOFJointTrajectoryPoint";
  std::vector<Transform> transforms;
  std::vector<Twist> velocities;
  std::vector<Twist> accelerations;
  Duration time_from_start;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"transforms", "", "Poses of the joints."}, s.transforms);
    visit(Field{"velocities", "", "Velocities of the joints."}, s.velocities);
    visit(Field{"accelerations", "", "Accelerations of the joints."}, s.accelerations);
    visit(Field{"time_from_start", "s", "Time since the start of the trajectory."}, s.time_from_start);
  }
};

/// A trajectory of joints with several degrees of freedom.
struct MultiDOFJointTrajectory {
  static constexpr const char* ros_type = "trajectory_msgs/msg/MultiDOFJointTrajectory";
  Header header;
  std::vector<std::string> joint_names;
  std::vector<MultiDOFJointTrajectoryPoint> points;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"joint_names", "", "Names of the joints."}, s.joint_names);
    visit(Field{"points", "", "Points in order of time."}, s.points);
  }
};

}  // namespace sandlot::msg
