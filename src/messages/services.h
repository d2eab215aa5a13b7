#pragma once
/// Services that Sandlot answers, as pairs of messages: its own, those of simulation_interfaces 2.1.0, and those of devices.
///
/// A service type has a name and two messages, Request and Response, named as ROS 2 names them: `pkg/srv/Name_Request` and
/// `pkg/srv/Name_Response`. messages/services.def lists them; messages/registry.h finds them by name.
/// long file: one list of messages
#include <cstdint>
#include <string>
#include <vector>

#include "messages/controller_manager_msgs.h"
#include "messages/device_services.h"
#include "messages/sandlot_soccer.h"
#include "messages/simulation_interfaces.h"
#include "messages/simulation_services.h"

namespace sandlot::msg {

/// Executes one line of the console.
struct Console {
  static constexpr const char* ros_type = "sandlot_msgs/srv/Console";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Console_Request";
    std::string line;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"line", "", "A line of the console language."}, s.line);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Console_Response";
    bool ok = false;
    std::string text;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether the command succeeded."}, s.ok);
      visit(Field{"text", "", "Answer, or the reason of a failure."}, s.text);
    }
  };
};

/// How the last word of a console line may go on.
struct Complete {
  static constexpr const char* ros_type = "sandlot_msgs/srv/Complete";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Complete_Request";
    std::string line;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"line", "", "The line up to the cursor."}, s.line);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Complete_Response";
    std::vector<std::string> candidates;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"candidates", "", "Words that may stand in place of the last one."}, s.candidates);
    }
  };
};

/// Decisions of a referee from the beginning of the run on: who begins to look has the latest message of the topic alone.
struct Decisions {
  static constexpr const char* ros_type = "sandlot_msgs/srv/Decisions";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Decisions_Request";
    std::string topic;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"topic", "", "Topic of the decisions; empty: the first that has some."}, s.topic);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Decisions_Response";
    std::vector<RefereeDecision> decisions;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"decisions", "", "Decisions, oldest first; of very many the latest."}, s.decisions);
    }
  };
};

/// Where the ball and the robots of a match were while it was in play, and who touched the ball, from the beginning of the run on.
struct MatchTrack {
  static constexpr const char* ros_type = "sandlot_msgs/srv/MatchTrack";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/MatchTrack_Request";
    static void fields(auto&, auto&&) {}
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/MatchTrack_Response";
    std::vector<std::string> robots, teams;
    std::vector<double> times;
    std::vector<std::int32_t> places;
    std::vector<double> touch_times;
    std::vector<std::string> touches;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"robots", "", "Robots of teams."}, s.robots);
      visit(Field{"teams", "", "Team of each robot."}, s.teams);
      visit(Field{"times", "s", "Times of the places, oldest first."}, s.times);
      visit(Field{"places", "mm",
                  "For each time x and y of the ball, then of each robot; -2147483648 where there is none."},
            s.places);
      visit(Field{"touch_times", "s", "Times from which another robot is the last that touched the ball."},
            s.touch_times);
      visit(Field{"touches", "", "Name of that robot; empty: the ball is not in play."}, s.touches);
    }
  };
};

/// Ends the connection of a client.
struct DisconnectClient {
  static constexpr const char* ros_type = "sandlot_msgs/srv/DisconnectClient";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/DisconnectClient_Request";
    std::uint64_t client = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"client", "1", "Number of the client."}, s.client);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/DisconnectClient_Response";
    bool ok = true;
    std::string text;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether the connection ends."}, s.ok);
      visit(Field{"text", "", "Reason why it does not."}, s.text);
    }
  };
};

/// Ends a program that the run has started, and starts it again.
struct RestartProgram {
  static constexpr const char* ros_type = "sandlot_msgs/srv/RestartProgram";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/RestartProgram_Request";
    std::string program;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"program", "", "Path of the program: red1/controller."}, s.program);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/RestartProgram_Response";
    bool ok = true;
    std::string text;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether it is started again."}, s.ok);
      visit(Field{"text", "", "Reason why it is not."}, s.text);
    }
  };
};

/// Asks for numbers on a channel of their own.
struct WatchValues {
  static constexpr const char* ros_type = "sandlot_msgs/srv/Watch";
  struct Request {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Watch_Request";
    std::vector<std::string> values;
    double rate_hz = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"values", "", "Addresses of values, or expressions."}, s.values);
      visit(Field{"rate_hz", "Hz", "Messages per second; 0: one in every tick."}, s.rate_hz);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "sandlot_msgs/srv/Watch_Response";
    bool ok = false;
    std::string text;
    std::string topic;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"ok", "", "Whether the channel exists."}, s.ok);
      visit(Field{"text", "", "Reason of a failure."}, s.text);
      visit(Field{"topic", "", "Topic of the channel; its messages are sandlot_msgs/msg/Samples."}, s.topic);
    }
  };
};

}  // namespace sandlot::msg

namespace sandlot::msg::simulation {

/// What the simulator can do.
struct GetSimulatorFeatures {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetSimulatorFeatures";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetSimulatorFeatures_Request";
    static void fields(auto&, auto&&) {}
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetSimulatorFeatures_Response";
    SimulatorFeatures features;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"features", "", "Features of the simulator."}, s.features);
    }
  };
};

/// What the simulator is doing.
struct GetSimulationState {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetSimulationState";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetSimulationState_Request";
    static void fields(auto&, auto&&) {}
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetSimulationState_Response";
    SimulationState state;
    Result result;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"state", "", "Present state of the simulation."}, s.state);
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

/// Play, pause, stop, quit.
struct SetSimulationState {
  static constexpr const char* ros_type = "simulation_interfaces/srv/SetSimulationState";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SetSimulationState_Request";
    SimulationState state;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"state", "", "Requested state of the simulation."}, s.state);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SetSimulationState_Response";
    static constexpr std::uint8_t already_in_target_state = 101;
    static constexpr std::uint8_t state_transition_error = 102;
    static constexpr std::uint8_t incorrect_transition = 103;
    Result result;
    static void constants(auto&& visit) {
      visit("ALREADY_IN_TARGET_STATE", already_in_target_state);
      visit("STATE_TRANSITION_ERROR", state_transition_error);
      visit("INCORRECT_TRANSITION", incorrect_transition);
    }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

/// Some ticks, then pause.
struct StepSimulation {
  static constexpr const char* ros_type = "simulation_interfaces/srv/StepSimulation";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/StepSimulation_Request";
    std::uint64_t steps = 1;
    static void fields(auto& s, auto&& visit) { visit(Field{"steps", "1", "Number of steps."}, s.steps); }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/StepSimulation_Response";
    Result result;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

/// Back to the beginning.
struct ResetSimulation {
  static constexpr const char* ros_type = "simulation_interfaces/srv/ResetSimulation";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/ResetSimulation_Request";
    static constexpr std::uint8_t scope_default = 0;
    static constexpr std::uint8_t scope_time = 1;
    static constexpr std::uint8_t scope_state = 2;
    static constexpr std::uint8_t scope_spawned = 4;
    static constexpr std::uint8_t scope_all = 255;
    std::uint8_t scope = 0;
    static void constants(auto&& visit) {
      visit("SCOPE_DEFAULT", scope_default);
      visit("SCOPE_TIME", scope_time);
      visit("SCOPE_STATE", scope_state);
      visit("SCOPE_SPAWNED", scope_spawned);
      visit("SCOPE_ALL", scope_all);
    }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"scope", "1", "Sum of constants SCOPE_..."}, s.scope);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/ResetSimulation_Response";
    Result result;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

/// The names of what stands in the world.
struct GetEntities {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntities";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntities_Request";
    EntityFilters filters;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"filters", "", "Filters of the entities; empty ones let all through."}, s.filters);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntities_Response";
    Result result;
    std::vector<std::string> entities;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"entities", "", "Names of the entities."}, s.entities);
    }
  };
};

/// Where an entity is and how it moves.
struct GetEntityState {
  static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityState";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityState_Request";
    std::string entity;
    static void fields(auto& s, auto&& visit) { visit(Field{"entity", "", "Name of the entity."}, s.entity); }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/GetEntityState_Response";
    Result result;
    EntityState state;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
      visit(Field{"state", "", "State of the entity."}, s.state);
    }
  };
};

/// Puts an entity somewhere.
struct SetEntityState {
  static constexpr const char* ros_type = "simulation_interfaces/srv/SetEntityState";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SetEntityState_Request";
    std::string entity;
    EntityState state;
    bool set_pose = false, set_twist = false, set_acceleration = false;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"entity", "", "Name of the entity."}, s.entity);
      visit(Field{"state", "", "Requested state of the entity."}, s.state);
      visit(Field{"set_pose", "", "Whether the pose is set."}, s.set_pose);
      visit(Field{"set_twist", "", "Whether the twist is set."}, s.set_twist);
      visit(Field{"set_acceleration", "", "Whether the acceleration is set."}, s.set_acceleration);
    }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/SetEntityState_Response";
    static constexpr std::uint8_t invalid_pose = 101;
    Result result;
    static void constants(auto&& visit) { visit("INVALID_POSE", invalid_pose); }
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

/// Takes an entity out of the world.
struct DeleteEntity {
  static constexpr const char* ros_type = "simulation_interfaces/srv/DeleteEntity";
  struct Request {
    static constexpr const char* ros_type = "simulation_interfaces/srv/DeleteEntity_Request";
    std::string entity;
    static void fields(auto& s, auto&& visit) { visit(Field{"entity", "", "Name of the entity."}, s.entity); }
  };
  struct Response {
    static constexpr const char* ros_type = "simulation_interfaces/srv/DeleteEntity_Response";
    Result result;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"result", "", "Result of the request."}, s.result);
    }
  };
};

}  // namespace sandlot::msg::simulation
