#pragma once
/// Joint controllers from ROS parameter files (formats/ros2_control), put on robots while files are loaded.
#include "files/resources.h"
#include "model/model.h"

namespace sandlot {

/// True for the plugins with which Gazebo runs ros2_control.
bool is_ros_control_plugin(const model::DeviceDecl& decl);

/// The devices of the parameter files that such a plugin names. A file that is not there is warned of: the robot is
/// usable without; a file with faults is an error.
Result<std::vector<model::DeviceDecl>> controllers_of_plugin(const model::DeviceDecl& decl,
                                                             const SearchPath& path,
                                                             Diagnostics& diagnostics);

/// Adds devices to a robot. An error for a name it has already.
Status add_devices(model::Instance& instance, std::vector<model::DeviceDecl> devices);

}  // namespace sandlot
