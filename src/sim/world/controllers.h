#pragma once
/// Controllers of a robot that come, start, stop and go while the simulation runs, in the manner of ros2_control's
/// controller_manager.
///
/// Controllers   the robot's programs (control/program.h), and its devices with a key `active`, such as joint motors: what the
///               joint controllers of ros2_control become (formats/ros2_control). Several devices that one of these became are
///               one controller.
/// States        unconfigured (loaded, its keys not read yet), inactive, active. Those of a scenario begin active.
/// Operations    load, configure, switch (start some and stop others in one tick), unload, list: calls of the robot's
///               controller manager, "rover/controller_manager", by CallRequest. They are ordered, logged and replayed as all
///               requests are; a refusal has changed nothing.
/// Stopped       a program does not step, and what it has ordered and was not delivered is dropped; its devices keep their last
///               order, as those of a program that has ended. Its State stays: started again, it goes on. The joint of a
///               stopped joint controller is free.
/// Claims        two active controllers of a robot never command the same device or joint: a switch that would lead to it is
///               refused, all of it. A program claims the actuators that it looks up (control/claims.h), one that runs outside
///               or is no controller every device that takes commands. What a scenario has active together stays so.
/// State         which are inactive, and those that are not configured; in snapshots, and in the hash where there are some.
/// Limits        of robots, not of teams; kinds that run outside this process begin with the run and cannot be loaded; a plugin's
///               library is loaded with the run (`plugins:`), its kinds any time.
#include <string>
#include <vector>

#include "sim/world/simulation.h"

namespace sandlot {

/// The last part of a controller manager's path.
inline constexpr std::string_view controller_manager_name = "controller_manager";
/// Of a robot.
inline constexpr std::size_t most_controllers = 1000;

struct ControllerView {
  enum class State : std::uint8_t { unconfigured, inactive, active };
  std::string name;  ///< in its robot
  std::string kind;
  State state = State::active;
  bool program = false;                   ///< else its devices are it
  std::vector<std::string> devices = {};  ///< of a joint controller, by name
  std::vector<std::string> claims =
      {};  ///< "drive", "joint left_wheel_joint"; none while it is not configured
};
const char* name_of(ControllerView::State state);

/// What a robot's controller manager answers.
std::span<const DeviceService> controller_services();

/// Programs, then joint controllers, then those that are not configured.
std::vector<ControllerView> controllers_of(const Simulation& simulation, const Simulation::Entity& robot);

}  // namespace sandlot
