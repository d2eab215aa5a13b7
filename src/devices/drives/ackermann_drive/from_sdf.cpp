/// The Ackermann plugins of Gazebo (gz-sim), Ignition and gazebo_ros, as keys of our spec.
#include "devices/drives/ackermann_drive/ackermann_drive.h"
#include "devices/drives/sdf_drive.h"
#include "devices/sdf_noise.h"

namespace sandlot::ackermann_drive {
using namespace sdf_element;

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  Node config = Node::map(element.place());
  copy_joints(element, {"left_joint", "front_left_joint", "rear_left_joint"}, config, "left_joint");
  copy_joints(element, {"right_joint", "front_right_joint", "rear_right_joint"}, config, "right_joint");
  copy(element, "left_steering_joint", config, "left_steering_joint");
  copy(element, "right_steering_joint", config, "right_steering_joint");
  SL_TRY(copy_number(element, {"wheel_base"}, 1.0, config, "wheelbase"));
  SL_TRY(copy_number(element, {"kingpin_width", "wheel_separation"}, 1.0, config, "track"));
  SL_TRY(copy_number(element, {"wheel_radius"}, 1.0, config, "wheel_radius"));
  SL_TRY(copy_number(element, {"steering_limit", "max_steer"}, 1.0, config, "max_steering_angle"));
  SL_TRY(copy_number(element, {"odom_publish_frequency", "update_rate"}, 1.0, config, "rate"));
  SL_TRY(copy_limits(element, config, diagnostics));
  SL_TRY(copy_number(element, {"max_speed"}, 1.0, config, "max_linear_speed"));
  config.set("max_wheel_effort",
             Node::scalar(unlimited, element.place()));  // then the joint's own limit holds
  warn_unknown_of_drive(
      element, {"left_joint",       "right_joint",         "front_left_joint",    "front_right_joint",
                "rear_left_joint",  "rear_right_joint",    "left_steering_joint", "right_steering_joint",
                "wheel_base",       "kingpin_width",       "wheel_separation",    "wheel_radius",
                "steering_limit",   "max_steer",           "max_speed",           "publish_odom",
                "publish_odom_tf",  "publish_wheel_tf",    "publish_distance",    "odometry_frame",
                "robot_base_frame", "steering_wheel_joint"},
      "the Ackermann plugin", diagnostics);
  return config;
}

}  // namespace sandlot::ackermann_drive
