#include "formats/ros2_control/ros2_control.h"

#include <algorithm>
#include <map>

#include "base/read.h"
#include "base/text.h"
#include "files/text.h"
#include "files/yaml.h"

namespace sandlot::formats {
namespace {

using Loop = ControllerType::Loop;

constexpr ControllerType types[] = {
    {"diff_drive_controller/DiffDriveController", "diff_drive", "contact", Loop::none},
    {"effort_controllers/JointEffortController", "joint_motor", "effort", Loop::none},
    {"effort_controllers/JointGroupEffortController", "joint_motor", "effort", Loop::none},
    {"effort_controllers/JointGroupPositionController", "joint_motor", "position", Loop::gains},
    {"effort_controllers/JointPositionController", "joint_motor", "position", Loop::gains},
    {"effort_controllers/JointTrajectoryController", "joint_trajectory", "", Loop::gains},
    {"effort_controllers/JointVelocityController", "joint_motor", "velocity", Loop::gains},
    {"forward_command_controller/ForwardCommandController", "joint_motor", "", Loop::exact},
    {"joint_state_broadcaster/JointStateBroadcaster", "joint_state", "", Loop::none},
    {"joint_state_controller/JointStateController", "joint_state", "", Loop::none},
    {"joint_trajectory_controller/JointTrajectoryController", "joint_trajectory", "", Loop::exact},
    {"position_controllers/JointGroupPositionController", "joint_motor", "position", Loop::exact},
    {"position_controllers/JointPositionController", "joint_motor", "position", Loop::exact},
    {"position_controllers/JointTrajectoryController", "joint_trajectory", "", Loop::exact},
    {"velocity_controllers/JointGroupVelocityController", "joint_motor", "velocity", Loop::exact},
    {"velocity_controllers/JointVelocityController", "joint_motor", "velocity", Loop::exact},
};

constexpr int max_depth = 16;

using Controller = DeclaredController;

std::string_view last_part(std::string_view key) {
  const std::size_t slash = key.rfind('/');
  return slash == std::string_view::npos ? key : key.substr(slash + 1);
}

/// Contents of the whole file, before its parts are put together.
struct Gathered {
  std::vector<Controller> controllers;                   ///< in the order of their types
  std::vector<std::pair<std::string, Node>> parameters;  ///< ROS 2: by controller
  Node gains;                                            ///< of joints, ROS 1
};

Status add(Gathered& out, std::string name, const Node& type, Node parameters, const Place& place) {
  if (!type.is_scalar()) return wrong_type(type, "the type of a controller", "/" + name + "/type");
  for (const Controller& other : out.controllers)
    if (other.name == name)
      return Error{"there are two controllers named '" + name + "'",
                   "the other one is at " + to_string(other.place), place};
  out.controllers.push_back({std::move(name), type, std::move(parameters), {}, place});
  return {};
}

Status gather(const Node& node, Gathered& out, int depth) {
  if (depth > max_depth) return node.error("namespaces are nested too deeply");
  for (const Node::Entry& entry : node.entries()) {
    const Node& value = entry.value;
    if (!value.is_map()) continue;
    const std::string name(last_part(entry.key));
    const Node* const ros2 = value.find("ros__parameters");
    if (ros2 && name == "controller_manager") {
      for (const Node::Entry& each : ros2->entries())
        if (const Node* const type = each.value.find("type"))
          SL_TRY(add(out, each.key, *type, Node::map(each.value.place()), each.key_place));
    } else if (ros2) {
      out.parameters.emplace_back(name, *ros2);
    } else if (name == "pid_gains") {
      out.gains = value;
    } else if (const Node* const type = value.find("type")) {
      SL_TRY(add(out, name, *type, value, entry.key_place));
    } else {
      SL_TRY(gather(value, out, depth + 1));
    }
  }
  return {};
}

Node text_node(const char* text, const Place& place) { return Node::scalar(text, place); }

/// The joints a controller names, as `joints` (a list) or `joint`.
Result<std::vector<Node>> joints_of(const Controller& controller, bool needed) {
  std::vector<Node> out;
  for (const char* key : {"joints", "joint"}) {
    const Node* const node = controller.parameters.find(key);
    if (!node || node->is_null()) continue;
    if (node->is_scalar()) out.push_back(*node);
    else if (node->is_sequence()) out.insert(out.end(), node->items().begin(), node->items().end());
    else return wrong_type(*node, "names of joints", "/" + controller.name + "/" + key);
  }
  for (const Node& joint : out)
    if (!joint.is_scalar())
      return wrong_type(joint, "the name of a joint", "/" + controller.name + "/joints");
  if (out.empty() && needed)
    return Error{"controller '" + controller.name + "' names no joints", "write joints: [...]",
                 controller.place};
  return out;
}

/// p, i and d of a joint, wherever the file puts them; nothing when it has none.
Result<std::optional<Node>> gains_of(const Controller& controller, const std::string& joint,
                                     const Node& global, Diagnostics& diagnostics) {
  const Node& own = controller.parameters;
  const Node* found = nullptr;
  const auto look = [&](const Node* map, const char* key) {
    if (!found && map) found = map->find(key);
  };
  look(own.find("gains"), joint.c_str());
  look(own.find(joint), "pid");
  look(&own, "pid");
  if (const Node* const gains = own.find("gains"); !found && gains && gains->find("p")) found = gains;
  look(&global, joint.c_str());
  if (!found) return std::optional<Node>();
  if (!found->is_map()) return wrong_type(*found, "a map of p, i and d", "/" + controller.name);
  Node out = Node::map(found->place());
  for (const Node::Entry& entry : found->entries()) {
    if (entry.key == "p" || entry.key == "i" || entry.key == "d") {
      out.set(entry.key, entry.value);
      continue;
    }
    double value = 0;
    const bool zero = entry.value.is_scalar() && ((parse_number(entry.value.text(), value) && value == 0) ||
                                                  entry.value.text() == "false");
    if (!zero && entry.key != "antiwindup")
      diagnostics.warn({"'" + entry.key + "' of the gains of '" + joint + "' has no effect",
                        "the integral unwinds by itself while the effort is limited", entry.key_place});
  }
  return std::optional<Node>(std::move(out));
}

/// How a joint is followed: its gains, or the exact servo.
Status set_loop(const Controller& controller, Loop loop, const std::string& joint, const char* level,
                const Node& global, Node& config, Diagnostics& diagnostics) {
  if (loop == Loop::none || std::string_view(level) == "effort") return {};
  SL_ASSIGN(auto gains, gains_of(controller, joint, global, diagnostics));
  if (gains) config.set(level, std::move(*gains));
  else if (loop == Loop::gains)
    return Error{"controller '" + controller.name + "' has no gains for joint '" + joint + "'",
                 "write gains: {" + joint + ": {p: ..., i: ..., d: ...}} (ROS 1: pid: {...})",
                 controller.place};
  else config.set("servo", text_node("exact", controller.place));
  return {};
}

void copy(const Node& from, const char* key, Node& to, const char* as) {
  if (const Node* const value = from.find(key)) to.set(as, *value);
}

/// A number times a factor given by another key.
Status copy_scaled(const Node& from, const char* key, const char* factor_key, Node& to, const char* as) {
  const Node* const value = from.find(key);
  if (!value) return {};
  double number = 0, factor = 1;
  const Node* const scale = from.find(factor_key);
  if (scale && (!scale->is_scalar() || !parse_number(scale->text(), factor)))
    return wrong_type(*scale, "a number", std::string("/") + factor_key);
  if (!value->is_scalar() || !parse_number(value->text(), number))
    return wrong_type(*value, "a number", std::string("/") + key);
  to.set(as, Node::scalar(number_text(number * factor), value->place()));
  return {};
}

/// linear.x.max_velocity and its like, nested or with dots.
void copy_limit(const Node& from, const char* group, const char* axis, const char* limit, Node& to,
                const char* as) {
  const Node* node = from.find(group);
  if (node) node = node->find(axis);
  if (node) node = node->find(limit);
  if (!node) node = from.find(std::string(group) + "." + axis + "." + limit);
  if (node) to.set(as, *node);
}

Result<Node> diff_drive(const Controller& controller) {
  const Node& from = controller.parameters;
  Node config = Node::map(controller.place);
  for (const char* key : {"left_wheel_names", "left_wheel"}) copy(from, key, config, "left_joint");
  for (const char* key : {"right_wheel_names", "right_wheel"}) copy(from, key, config, "right_joint");
  SL_TRY(copy_scaled(from, "wheel_separation", "wheel_separation_multiplier", config, "wheel_separation"));
  SL_TRY(copy_scaled(from, "wheel_radius", "left_wheel_radius_multiplier", config, "wheel_radius"));
  copy(from, "publish_rate", config, "rate");
  copy(from, "cmd_vel_timeout", config, "command_timeout");
  copy_limit(from, "linear", "x", "max_velocity", config, "max_linear_speed");
  copy_limit(from, "angular", "z", "max_velocity", config, "max_angular_speed");
  copy_limit(from, "linear", "x", "max_acceleration", config, "max_linear_acceleration");
  copy_limit(from, "angular", "z", "max_acceleration", config, "max_angular_acceleration");
  return config;
}

Result<Node> joint_state(const Controller& controller) {
  Node config = Node::map(controller.place);
  SL_ASSIGN(const std::vector<Node> joints, joints_of(controller, false));
  if (!joints.empty()) {
    Node& list = config.set("joints", Node::sequence(joints.front().place()));
    for (const Node& joint : joints) list.push(joint);
  }
  // Without a rate of its own it publishes with every update.
  config.set("rate", text_node("0", controller.place));
  copy(controller.parameters, "publish_rate", config, "rate");
  return config;
}

/// Several joints on one device, each with its own gains.
Result<Node> joint_trajectory(const Controller& controller, Loop loop, const Node& global,
                              Diagnostics& diagnostics) {
  Node config = Node::map(controller.place);
  SL_ASSIGN(const std::vector<Node> joints, joints_of(controller, true));
  Node& list = config.set("joints", Node::sequence(joints.front().place()));
  for (const Node& joint : joints) list.push(joint);
  Node gains = Node::sequence(controller.place);
  bool by_effort = loop == Loop::gains;
  if (const Node* const interfaces = controller.parameters.find("command_interfaces"))
    for (const Node& item : interfaces->items()) by_effort = by_effort || item.text() == "effort";
  for (const Node& joint : joints) {
    SL_ASSIGN(auto found, gains_of(controller, joint.text(), global, diagnostics));
    if (found) gains.push(std::move(*found));
    else if (by_effort)
      return Error{"controller '" + controller.name + "' has no gains for joint '" + joint.text() + "'",
                   "write gains: {" + joint.text() + ": {p: ..., i: ..., d: ...}}", controller.place};
  }
  if (by_effort || gains.items().size() == joints.size()) config.set("gains", std::move(gains));
  return config;
}

Result<const char*> level_of(const Controller& controller, const ControllerType& type) {
  if (*type.level) return type.level;
  const Node* const interface = controller.parameters.find("interface_name");
  if (!interface)
    return Error{"controller '" + controller.name + "' names no interface",
                 "write interface_name: position, velocity or effort", controller.place};
  for (const char* level : {"position", "velocity", "effort"})
    if (interface->is_scalar() && interface->text() == level) return level;
  return interface->error("interface '" + interface->text().substr(0, 60) + "' cannot be driven",
                          "position, velocity and effort can");
}

Status make_devices(const Controller& controller, const ControllerType& type, const Node& global,
                    std::vector<model::DeviceDecl>& out, Diagnostics& diagnostics) {
  const auto push = [&](std::string name, Node config) {
    model::DeviceDecl decl;
    decl.name = std::move(name);
    decl.kind = type.kind;
    decl.config = std::move(config);
    decl.place = controller.place;
    out.push_back(std::move(decl));
  };
  const std::string_view kind = type.kind;
  if (kind == "diff_drive") {
    SL_ASSIGN(Node config, diff_drive(controller));
    push(controller.name, std::move(config));
  } else if (kind == "joint_state") {
    SL_ASSIGN(Node config, joint_state(controller));
    push(controller.name, std::move(config));
  } else if (kind == "joint_trajectory") {
    SL_ASSIGN(Node config, joint_trajectory(controller, type.loop, global, diagnostics));
    push(controller.name, std::move(config));
  } else {
    SL_ASSIGN(const char* const level, level_of(controller, type));
    SL_ASSIGN(const std::vector<Node> joints, joints_of(controller, true));
    for (const Node& joint : joints) {
      Node config = Node::map(controller.place);
      config.set("joint", joint);
      config.set("level", text_node(level, controller.place));
      SL_TRY(set_loop(controller, type.loop, joint.text(), level, global, config, diagnostics));
      push(joints.size() == 1 ? controller.name : controller.name + "_" + joint.text(), std::move(config));
    }
  }
  return {};
}

}  // namespace

std::span<const ControllerType> controller_types() { return types; }

Result<std::optional<DeclaredController>> find_controller(const Node& file, std::string_view name) {
  Gathered gathered;
  SL_TRY(gather(file, gathered, 0));
  std::optional<DeclaredController> found;
  std::vector<std::string> known;
  for (DeclaredController& each : gathered.controllers) {
    known.push_back(each.name);
    if (each.name == name) found = std::move(each);
  }
  for (const auto& [owner, parameters] : gathered.parameters) {
    if (owner != name) continue;
    if (!found) found = {owner, {}, Node::map(parameters.place()), {}, parameters.place()};
    merge(found->parameters, parameters);
  }
  if (found) found->gains = std::move(gathered.gains);
  if (!found && file.find("controller_manager"))
    return file.error("this file declares no controller '" + std::string(name.substr(0, 100)) + "'",
                      suggestion(name, known));
  return found;
}

Result<std::vector<model::DeviceDecl>> joint_devices(const DeclaredController& controller,
                                                     Diagnostics& diagnostics) {
  const auto type = std::find_if(std::begin(types), std::end(types), [&](const ControllerType& each) {
    return controller.type.text() == each.type;
  });
  SL_CHECK(type != std::end(types));
  std::vector<model::DeviceDecl> out;
  SL_TRY(make_devices(controller, *type, controller.gains, out, diagnostics));
  return out;
}

Result<std::vector<model::DeviceDecl>> parse_joint_controllers(std::string_view text, const std::string& file,
                                                               Diagnostics& diagnostics) {
  SL_ASSIGN(const Node root, parse_yaml(text, file));
  if (!root.is_map()) return wrong_type(root, "a map of controllers", "");
  Gathered gathered;
  SL_TRY(gather(root, gathered, 0));
  if (gathered.controllers.empty())
    return root.error("this file declares no controllers",
                      "ROS 2: controller_manager.ros__parameters.NAME.type; ROS 1: NAME: {type: ...}");
  std::map<std::string, bool, std::less<>> used;
  std::vector<model::DeviceDecl> out;
  for (Controller& controller : gathered.controllers) {
    for (const auto& [name, parameters] : gathered.parameters)
      if (name == controller.name) merge(controller.parameters, parameters);
    used[controller.name] = true;
    const auto type = std::find_if(std::begin(types), std::end(types), [&](const ControllerType& each) {
      return controller.type.text() == each.type;
    });
    if (type == std::end(types)) {
      std::vector<std::string> known;
      for (const ControllerType& each : types) known.emplace_back(each.type);
      diagnostics.warn(controller.type.error("controller '" + controller.name + "' of type '" +
                                                 controller.type.text().substr(0, 100) +
                                                 "' is not supported and is left out",
                                             suggestion(controller.type.text(), known)));
      continue;
    }
    SL_TRY(make_devices(controller, *type, gathered.gains, out, diagnostics));
  }
  for (const auto& [name, parameters] : gathered.parameters)
    if (!used.contains(name))
      diagnostics.warn(
          parameters.error("the parameters of '" + name + "' belong to no controller of this file"));
  std::map<std::string, Place> names;
  for (const model::DeviceDecl& decl : out)
    if (const auto [known, fresh] = names.emplace(decl.name, decl.place); !fresh)
      return Error{"two joint controllers would be called '" + decl.name + "'",
                   "the other one is at " + to_string(known->second), decl.place};
  return out;
}

Result<std::vector<model::DeviceDecl>> read_joint_controllers(const std::string& path,
                                                              Diagnostics& diagnostics) {
  SL_ASSIGN(const std::string text, read_text_file(path, TextLimits{}.max_bytes));
  return parse_joint_controllers(text, path, diagnostics);
}

}  // namespace sandlot::formats
