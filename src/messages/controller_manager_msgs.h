#pragma once
/// controller_manager_msgs of ros2_control, as far as a robot's controller manager answers it (sim/world/controllers.h), and the
/// service that loads a controller, which ros2_control does by parameters of a node.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg::controller_manager {

/// A controller whose output is the input of another.
struct ChainConnection {
  static constexpr const char* ros_type = "controller_manager_msgs/msg/ChainConnection";
  std::string name;
  std::vector<std::string> reference_interfaces;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the controller that takes the output."}, s.name);
    visit(Field{"reference_interfaces", "", "Inputs of the other controller."}, s.reference_interfaces);
  }
};

/// A controller and what it does now.
struct ControllerState {
  static constexpr const char* ros_type = "controller_manager_msgs/msg/ControllerState";
  std::string name, state, type;
  std::vector<std::string> claimed_interfaces, required_command_interfaces, required_state_interfaces;
  bool is_chainable = false, is_chained = false;
  std::vector<std::string> reference_interfaces;
  std::vector<ChainConnection> chain_connections;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the controller in its robot."}, s.name);
    visit(Field{"state", "", "State: unconfigured, inactive or active."}, s.state);
    visit(Field{"type", "", "Kind of the controller."}, s.type);
    visit(Field{"claimed_interfaces", "", "Devices and joints that it commands now."}, s.claimed_interfaces);
    visit(Field{"required_command_interfaces", "", "Devices and joints that it commands while active."},
          s.required_command_interfaces);
    visit(Field{"required_state_interfaces", "", "Interfaces that it reads; not filled."},
          s.required_state_interfaces);
    visit(Field{"is_chainable", "", "Whether others can use its output; never here."}, s.is_chainable);
    visit(Field{"is_chained", "", "Whether another one uses its output; never here."}, s.is_chained);
    visit(Field{"reference_interfaces", "", "Inputs for others in a chain; none here."},
          s.reference_interfaces);
    visit(Field{"chain_connections", "", "Controllers behind it in a chain; none here."},
          s.chain_connections);
  }
};

/// The controllers of a robot.
struct ListControllers {
  static constexpr const char* ros_type = "controller_manager_msgs/srv/ListControllers";
  struct Request {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/ListControllers_Request";
    static void fields(auto&, auto&&) {}
  };
  struct Response {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/ListControllers_Response";
    std::vector<ControllerState> controller;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"controller", "", "All controllers of the robot."}, s.controller);
    }
  };
};

/// Reads the keys of a controller: it is inactive then.
struct ConfigureController {
  static constexpr const char* ros_type = "controller_manager_msgs/srv/ConfigureController";
  struct Request {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/ConfigureController_Request";
    std::string name;
    static void fields(auto& s, auto&& visit) { visit(Field{"name", "", "Name of the controller."}, s.name); }
  };
  struct Response {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/ConfigureController_Response";
    bool ok = true;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether it was done; a refusal has no response."}, s.ok);
    }
  };
};

/// Takes a controller that is not active from its robot.
struct UnloadController {
  static constexpr const char* ros_type = "controller_manager_msgs/srv/UnloadController";
  struct Request {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/UnloadController_Request";
    std::string name;
    static void fields(auto& s, auto&& visit) { visit(Field{"name", "", "Name of the controller."}, s.name); }
  };
  struct Response {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/UnloadController_Response";
    bool ok = true;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether it was done; a refusal has no response."}, s.ok);
    }
  };
};

/// Starts and stops controllers in one tick.
struct SwitchController {
  static constexpr const char* ros_type = "controller_manager_msgs/srv/SwitchController";
  struct Request {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/SwitchController_Request";
    static constexpr std::int32_t best_effort = 1, strict = 2, automatic = 3, force_auto = 4;
    std::vector<std::string> activate_controllers, deactivate_controllers;
    std::int32_t strictness = strict;
    bool activate_asap = false;
    Duration timeout;
    static void constants(auto&& visit) {
      visit("BEST_EFFORT", best_effort);
      visit("STRICT", strict);
      visit("AUTO", automatic);
      visit("FORCE_AUTO", force_auto);
    }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"activate_controllers", "", "Controllers to start."}, s.activate_controllers);
      visit(Field{"deactivate_controllers", "", "Controllers to stop."}, s.deactivate_controllers);
      visit(Field{"strictness", "1", "What a mistake stops: STRICT, the whole switch; no other is known."},
            s.strictness);
      visit(Field{"activate_asap", "", "Whether to start before the hardware is ready; of no effect."},
            s.activate_asap);
      visit(Field{"timeout", "s", "Patience with the hardware; of no effect: a switch takes no time."},
            s.timeout);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "controller_manager_msgs/srv/SwitchController_Response";
    bool ok = true;
    std::string message;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether it was done; a refusal has no response."}, s.ok);
      visit(Field{"message", "", "What was started and stopped."}, s.message);
    }
  };
};

/// Adds a controller to a robot: it is unconfigured then.
struct LoadController {
  static constexpr const char* ros_type = "sandlot_msgs/srv/LoadController";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/LoadController_Request";
    std::string name, kind, parameters, file;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"name", "", "Name of the controller; unique within its robot."}, s.name);
      visit(Field{"kind", "", "Kind of controller, or a type of ros2_control; empty: as the parameters say."},
            s.kind);
      visit(Field{"parameters", "", "YAML: the keys of the kind, or a file of ros2_control's form."},
            s.parameters);
      visit(Field{"file", "", "Name of the file that the parameters are from, for messages."}, s.file);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/LoadController_Response";
    bool ok = true;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether it was done; a refusal has no response."}, s.ok);
    }
  };
};

}  // namespace sandlot::msg::controller_manager
