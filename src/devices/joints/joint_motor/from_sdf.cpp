/// Gazebo's plugins that drive one joint, as keys of our spec.
#include "base/text.h"
#include "devices/joints/joint_motor/joint_motor.h"
#include "devices/sdf_noise.h"

namespace sandlot::joint_motor {
namespace {

using namespace sdf_element;

/// Which of the three plugins this is: the element carries their names as attributes.
Level level_of(const Node& element) {
  const std::string names = text(find(element, "@name")) + " " + text(find(element, "@filename"));
  const auto has = [&](const char* part) { return names.find(part) != std::string::npos; };
  if (has("ApplyJointForce") || has("apply-joint-force")) return effort;
  if (has("JointPosition") || has("joint-position")) return position;
  return velocity;
}

Result<Node> gains(const Node& element, double p, double i, double d) {
  Node out = Node::map(element.place());
  out.set("p", scalar(p, element));
  out.set("i", scalar(i, element));
  out.set("d", scalar(d, element));
  SL_TRY(copy_number(element, {"p_gain"}, 1.0, out, "p"));
  SL_TRY(copy_number(element, {"i_gain"}, 1.0, out, "i"));
  SL_TRY(copy_number(element, {"d_gain"}, 1.0, out, "d"));
  return out;
}

}  // namespace

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  Node config = Node::map(element.place());
  const Node* const joints = element.find("joint_name");
  if (!joints) return element.error("this plugin names no joint", "write <joint_name>");
  if (joints->is_sequence() && joints->items().size() > 1)
    diagnostics.warn(joints->items()[1].error("only the first joint of this plugin is driven",
                                              "write one plugin for each joint"));
  copy(element, "joint_name", config, "joint");
  const Level level = level_of(element);
  constexpr const char* names[] = {"velocity", "position", "effort"};
  config.set("level", Node::scalar(names[level], element.place()));
  const auto is_true = [&](const char* name) {
    const std::string value = text(find(element, name));
    return value == "true" || value == "1";
  };
  if (level == effort) {
    warn_unknown(element, {"joint_name"}, "the plugin ApplyJointForce", diagnostics);
    return config;
  }
  // Gazebo's defaults: gains of 1, 0.1, 0.01 for positions, of 1, 0, 0 for a speed that is held by forces.
  const bool exact = level == velocity ? !is_true("use_force_commands") : is_true("use_velocity_commands");
  config.set("servo", Node::scalar(exact ? "exact" : "pid", element.place()));
  if (!exact) {
    SL_ASSIGN(Node keys, level == velocity ? gains(element, 1, 0, 0) : gains(element, 1, 0.1, 0.01));
    config.set(names[level], std::move(keys));
  }
  SL_ASSIGN(const auto cmd_max, number(element, "cmd_max"));
  SL_ASSIGN(const auto cmd_min, number(element, "cmd_min"));
  if (cmd_max && *cmd_max > 0) {
    if (cmd_min && *cmd_min != -*cmd_max)
      diagnostics.warn(
          find(element, "cmd_min")->error("<cmd_min> is not -<cmd_max>: <cmd_max> limits both ways"));
    config.set(exact ? "max_velocity" : "max_effort", scalar(*cmd_max, *find(element, "cmd_max")));
  }
  SL_TRY(copy_number(element, {level == velocity ? "initial_velocity" : "initial_position"}, 1.0, config,
                     "initial_command"));
  // Both plugins hold their joint at 0 before any command.
  if (!config.find("initial_command")) config.set("initial_command", scalar(0, element));
  warn_unknown(element,
               {"joint_name", "p_gain", "i_gain", "d_gain", "cmd_max", "cmd_min", "use_force_commands",
                "use_velocity_commands", "initial_velocity", "initial_position"},
               level == velocity ? "the plugin JointController" : "the plugin JointPositionController",
               diagnostics);
  return config;
}

}  // namespace sandlot::joint_motor
