/// The differential drive plugins of Gazebo (gz-sim), Ignition and Gazebo classic, as keys of our spec.
#include "devices/drives/diff_drive/diff_drive.h"
#include "devices/drives/sdf_drive.h"
#include "devices/sdf_noise.h"

namespace sandlot::diff_drive {
using namespace sdf_element;

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  Node config = Node::map(element.place());
  copy_joints(element,
              {"left_joint", "leftJoint", "left_front", "left_rear", "leftFrontJoint", "leftRearJoint"},
              config, "left_joint");
  copy_joints(element,
              {"right_joint", "rightJoint", "right_front", "right_rear", "rightFrontJoint", "rightRearJoint"},
              config, "right_joint");
  SL_TRY(copy_number(element, {"wheel_separation", "wheelSeparation"}, 1.0, config, "wheel_separation"));
  SL_TRY(copy_number(element, {"wheel_radius"}, 1.0, config, "wheel_radius"));
  if (!config.find("wheel_radius"))
    SL_TRY(copy_number(element, {"wheel_diameter", "wheelDiameter"}, 0.5, config, "wheel_radius"));
  SL_TRY(copy_number(element, {"odom_publish_frequency", "update_rate", "updateRate"}, 1.0, config, "rate"));
  SL_TRY(copy_limits(element, config, diagnostics));
  // The acceleration of a wheel's rim, in the plugins of gazebo_ros: 0 means none.
  SL_ASSIGN(const auto rim, number(element, "max_wheel_acceleration"));
  if (rim && *rim > 0)
    config.set("max_linear_acceleration", scalar(*rim, *find(element, "max_wheel_acceleration")));
  config.set("max_wheel_effort",
             Node::scalar(unlimited, element.place()));  // then the joint's own limit holds
  SL_TRY(
      copy_number(element, {"max_wheel_torque", "wheelTorque", "torque"}, 1.0, config, "max_wheel_effort"));
  warn_unknown(
      element,
      {"left_joint", "leftJoint", "right_joint", "rightJoint", "left_front", "left_rear", "right_front",
       "right_rear", "leftFrontJoint", "leftRearJoint", "rightFrontJoint", "rightRearJoint",
       "wheel_separation", "wheelSeparation", "wheel_radius", "wheel_diameter", "wheelDiameter",
       "odom_publish_frequency", "update_rate", "updateRate", "max_linear_velocity", "min_linear_velocity",
       "max_angular_velocity", "min_angular_velocity", "max_velocity", "min_velocity",
       "max_linear_acceleration", "min_linear_acceleration", "max_angular_acceleration",
       "min_angular_acceleration", "max_acceleration", "min_acceleration", "max_wheel_torque", "wheelTorque",
       "torque", "max_wheel_acceleration",
       // Names of topics and frames, and whether to publish them: ours are fixed, and all are published.
       "ros", "num_wheel_pairs", "publish_odom", "publish_odom_tf", "publish_wheel_tf", "odometry_frame",
       "robot_base_frame", "robotNamespace", "commandTopic", "odometryTopic", "odometryFrame",
       "robotBaseFrame", "publishWheelTF", "publishWheelJointState", "publishOdomTF", "publishTf",
       "broadcastTF", "legacyMode", "rosDebugLevel"},
      "the differential drive plugin", diagnostics);
  return config;
}

}  // namespace sandlot::diff_drive
