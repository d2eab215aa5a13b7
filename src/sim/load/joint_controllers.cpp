#include "sim/load/joint_controllers.h"

#include <algorithm>

#include "base/text.h"
#include "devices/sdf_element.h"
#include "files/text.h"
#include "formats/ros2_control/ros2_control.h"

namespace sandlot {

bool is_ros_control_plugin(const model::DeviceDecl& decl) {
  constexpr const char* parts[] = {"ros2_control", "ROS2Control", "gazebo_ros_control"};
  return std::any_of(decl.sdf_types.begin(), decl.sdf_types.end(), [&](const std::string& type) {
    return type.substr(0, 7) == "plugin:" &&
           std::any_of(std::begin(parts), std::end(parts),
                       [&](const char* part) { return type.find(part) != std::string::npos; });
  });
}

Result<std::vector<model::DeviceDecl>> controllers_of_plugin(const model::DeviceDecl& decl,
                                                             const SearchPath& path,
                                                             Diagnostics& diagnostics) {
  std::vector<model::DeviceDecl> out;
  const Node* const parameters = decl.config.find("parameters");
  if (!parameters) {
    diagnostics.warn({"this plugin names no file of controllers, so the robot has none",
                      "name it in the scenario: joint_controllers: FILE", decl.place});
    return out;
  }
  const std::string folder = decl.place.file ? folder_of(*decl.place.file) : "";
  const auto add = [&](const Node& node) -> Status {
    const auto file = find_resource(sdf_element::text(&node), folder, path, node.place());
    if (!file) return diagnostics.warn(file.error()), Status();
    SL_ASSIGN(auto devices, formats::read_joint_controllers(*file, diagnostics));
    std::move(devices.begin(), devices.end(), std::back_inserter(out));
    return {};
  };
  if (parameters->is_sequence())
    for (const Node& node : parameters->items()) SL_TRY(add(node));
  else SL_TRY(add(*parameters));
  return out;
}

Status add_devices(model::Instance& instance, std::vector<model::DeviceDecl> devices) {
  for (model::DeviceDecl& device : devices) {
    for (const model::DeviceDecl& other : std::as_const(instance.devices))
      if (sanitised(other.name) == sanitised(device.name))
        return Error{"the robot has a device named '" + device.name + "' already",
                     other.place.file ? "the other one is at " + to_string(other.place) : "", device.place};
    instance.devices.push_back(std::move(device));
  }
  return {};
}

}  // namespace sandlot
