#pragma once
/// The controller manager of a robot as the simulation uses it: what it is for, sim/world/controllers.h says.
#include "devices/device_service.h"
#include "messages/controller_manager_msgs.h"
#include "sim/world/controllers.h"

namespace sandlot {

namespace cm = msg::controller_manager;

/// One call of a robot's controller manager. Each operation checks everything first.
struct Simulation::ControllerManager {
  /// What it answers.
  static std::span<const DeviceService> services();
  /// The robot whose controller manager has this path; null: there is none.
  static Entity* robot_at(Simulation& sim, std::string_view path);
  static Status answer(Simulation& sim, Entity& robot, const CallRequest& request,
                       std::vector<std::byte>& response);
  /// The controllers that came while the run went on and are no programs.
  static void save_loaded(const Simulation& sim, ByteWriter& w);
  static bool load_loaded(Simulation& sim, ByteReader& r);

  Simulation& sim;
  Entity& robot;

  Result<cm::ListControllers::Response> list(const cm::ListControllers::Request& asked,
                                             const Context& context);
  Result<cm::LoadController::Response> load(const cm::LoadController::Request& asked, const Context& context);
  Result<cm::ConfigureController::Response> configure(const cm::ConfigureController::Request& asked,
                                                      const Context& context);
  Result<cm::SwitchController::Response> switch_over(const cm::SwitchController::Request& asked,
                                                     const Context& context);
  Result<cm::UnloadController::Response> unload(const cm::UnloadController::Request& asked,
                                                const Context& context);

 private:
  Status check_name(const std::string& name) const;
  Result<LoadedController> declared(const cm::LoadController::Request& asked) const;
  Status check_switch(const std::vector<ControllerView>& all, const std::vector<std::string>& start,
                      const std::vector<std::string>& stop) const;
  Status check_claims(const std::vector<ControllerView>& all, const std::vector<std::string>& start,
                      const std::vector<std::string>& stop) const;
  void set_active(const ControllerView& view, bool active);
  Status add_devices(LoadedController& loaded);
  Status take_devices(const std::vector<std::string>& names);
  void changed();
};

}  // namespace sandlot
