#pragma once
/// Inventory of a world's topics and parameters, copied once per revision so that the transport's thread can
/// look them up by itself.
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/result.h"
#include "messages/registry.h"
#include "sim/world/simulation.h"

namespace sandlot::server {

struct Inventory {
  struct Topic {
    std::string name;  ///< "/rover/laser/ranges"
    const MessageInfo* info = nullptr;
    std::string device;  ///< that publishes it: "rover/laser", or a program, "rover/estimator"
  };
  struct Slot {
    std::string name;    ///< "/rover/drive/ideal/command"
    std::string device;  ///< "rover/drive"
    std::string level;   ///< "ideal"; "": whatever the level
    bool active = false;
    const MessageInfo* info = nullptr;
    std::shared_ptr<const TopicBase> blank;  ///< an empty one of its type
    bool of_program = false;  ///< a topic that programs read: `device` is its name, "rover/goal_pose"
  };
  struct Service {
    std::string name;    ///< "/rover/odometry/reset"
    std::string device;  ///< "rover/odometry"; or a robot's controller manager
    const DeviceService* service = nullptr;
  };
  struct Program {
    std::string path;  ///< "rover/controller"
    /// Topics and slots of its robot at their active levels: what it may read and order; which of them it does is its own affair.
    std::vector<std::string> reads, orders;
  };
  std::uint64_t epoch = 1, revision = 0;
  std::vector<Topic> topics;
  std::vector<Slot> slots;
  std::vector<Service> services;
  std::vector<Program> programs;
  struct Robot {
    std::string name, team;
  };
  std::vector<Robot> robots;
  model::Sharing sharing;

  /// Where a message that a client calls so goes: "/rover/drive/ideal/command", "/rover/drive" (its active level),
  /// "/rover/cmd_vel" (the active drive that takes a Twist or TwistStamped). Errors name the nearest.
  /// @param type     of the messages as the client calls it; "": whatever is expected there
  /// @param visible  whether the client may know of a slot; unset: of all
  struct Target {
    std::string address;  ///< as CommandRequest has it
    const Slot* slot = nullptr;
  };
  Result<Target> target(std::string_view topic, std::string_view type,
                        const std::function<bool(const Slot&)>& visible = {}) const;
};

/// @pre on the simulation's thread
std::shared_ptr<const Inventory> take_inventory(const Simulation& simulation, std::uint64_t epoch);

}  // namespace sandlot::server
