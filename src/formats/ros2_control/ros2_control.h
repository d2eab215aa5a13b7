#pragma once
/// Parameter files of ROS controllers (ros2_control, and ros_control of ROS 1) as devices of a robot.
///
/// ROS 2:  controller_manager.ros__parameters.<name>.type, and the parameters under <name>.ros__parameters.
/// ROS 1:  <name>: {type: ..., joint: ..., pid: {p, i, d}}, within any namespace; gains for position and velocity
///         controllers in gazebo_ros_control/pid_gains.
///
/// A controller of one joint becomes one joint_motor of its name; one of several joints a joint_motor per joint, named
/// <controller>_<joint>. An interface of positions or speeds without gains is followed exactly, as Gazebo does; with
/// gains, and always for effort_controllers, by a PID loop.
///
/// Errors   no YAML, a controller without joints or gains where it needs them, one name twice: with line.
/// Limits   a type that is not in controller_types() is named in one warning; of a known one, keys that have no
///          counterpart are ignored (rates of the loop, tolerances, topics). Limits of the integral have no effect.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/model.h"

namespace sandlot::formats {

/// What a type of controller becomes.
struct ControllerType {
  const char* type;                             ///< "joint_state_broadcaster/JointStateBroadcaster"
  const char* kind;                             ///< of the device
  const char* level;                            ///< of the device; "" for its default
  enum class Loop { none, exact, gains } loop;  ///< of joint motors; exact: by gains when there are any
};

/// All that are known, in the order of their names.
std::span<const ControllerType> controller_types();

/// One controller as a file spreads it.
struct DeclaredController {
  std::string name;
  Node type;        ///< null: the file gives its parameters alone
  Node parameters;  ///< what is under its name, and under its ros__parameters
  Node gains;       ///< of joints, where the file keeps them apart (ROS 1)
  Place place;
};
/// The controller of that name. Nothing: the file knows no such name and has no controller_manager, so that it may be something
/// else than a file of controllers. Errors: as above; a file with a controller_manager that has others only.
Result<std::optional<DeclaredController>> find_controller(const Node& file, std::string_view name);
/// The devices that a controller becomes. @pre its type is in controller_types()
Result<std::vector<model::DeviceDecl>> joint_devices(const DeclaredController& controller,
                                                     Diagnostics& diagnostics);

/// The devices that a file declares, on the first link, in the order of the file.
Result<std::vector<model::DeviceDecl>> read_joint_controllers(const std::string& path,
                                                              Diagnostics& diagnostics);
/// As above from text; `file` names it in messages.
Result<std::vector<model::DeviceDecl>> parse_joint_controllers(std::string_view text, const std::string& file,
                                                               Diagnostics& diagnostics);

}  // namespace sandlot::formats
