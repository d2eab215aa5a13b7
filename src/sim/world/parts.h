#pragma once
/// Parts of a Simulation: entities with their devices and programs, for the files of sim/ and for readers by address. Those
/// of a const entity are const through and through.
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/deep_const.h"
#include "control/program.h"
#include "devices/kind.h"

namespace sandlot {

struct Faults;     // sim/world/faults.h
class DeviceKeys;  // sim/world/device_keys.h

struct SimulationParts {
  struct Slot {
    Owned<TopicBase> topic;
    std::uint32_t level = 0;
    bool queued = false;  ///< it keeps several orders
  };
  /// What few devices have.
  struct DeviceExtras {
    std::unique_ptr<Inbox> inbox;                      ///< null: it receives from no medium
    std::unique_ptr<SceneLight> light;                 ///< null: it does not shine
    std::vector<std::pair<std::string, Pose>> frames;  ///< in addition to its own, as X_SF
    std::vector<std::unique_ptr<DeviceOrder>> orders;  ///< that it gives to other devices
    bool empty() const { return !inbox && !light && frames.empty() && orders.empty(); }
  };
  struct Device {
    explicit Device(std::shared_ptr<const model::DeviceDecl> declared)
        : shared_decl(std::move(declared)), decl(*shared_decl) {}
    // Read with every command.
    DeepConst<std::shared_ptr<Faults>> faults;  ///< null: it has none
    std::shared_ptr<DeviceKeys> keys;           ///< null: it has none of the common keys
    Owned<EnergyMeter> energy;                  ///< null: its robot has no battery
    std::uint64_t key = 0;
    std::uint32_t kind = 0;   ///< index of its pool
    std::uint32_t index = 0;  ///< in its pool
    std::uint32_t levels = 1;
    bool keys_act = false;  ///< DeviceKeys::act(), when they last changed
    std::vector<Slot> topics, commands;
    std::unique_ptr<DeviceExtras> extras;                  ///< null: it has none
    double errors = 1;                                     ///< the world's factor on errors times the robot's
    std::shared_ptr<const model::DeviceDecl> shared_decl;  ///< one object for equal declarations
    const model::DeviceDecl& decl;
    std::string path;

    Inbox* inbox() const { return extras ? extras->inbox.get() : nullptr; }
    SceneLight* light() const { return extras ? extras->light.get() : nullptr; }
    std::span<const std::pair<std::string, Pose>> frames() const {
      return extras ? std::span(extras->frames) : std::span<const std::pair<std::string, Pose>>();
    }
    std::span<const std::unique_ptr<DeviceOrder>> orders() const {
      return extras ? std::span(extras->orders) : std::span<const std::unique_ptr<DeviceOrder>>();
    }
  };
  /// Sampling times of a device. Read in every tick, so those of a pool lie side by side.
  struct Timing {
    Time start;                ///< due times count from here
    std::uint64_t sample = 0;  ///< index of the next sample
    Time last;                 ///< time of the previous sample
    Time due;                  ///< of the next one; follows from start, sample and the rate
    double rate_hz = 0;        ///< 0: every tick
    bool requested = false;
    bool on_request = false;  ///< it takes samples that are requested alone
  };
  /// Destination of an order of a program at the active levels.
  struct Route {
    DeepConst<Device*> device;
    DeepConst<Slot*> slot;  ///< null: nothing takes it
  };
  /// When a program with a `rate` of its own steps: as devices do, see Timing.
  struct Schedule {
    double rate_hz = 0;
    Time start;
    std::uint64_t step = 0;  ///< index of the next step
    Time due;                ///< of it; follows from the others
  };
  /// What a program waits for, where it is not simply its next control step.
  struct Wait {
    Program::Waiting waiting_for = Program::Waiting::control_step;
    Time until;
    std::uint32_t reading = 0;
  };
  struct ProgramEntry {
    explicit ProgramEntry(std::shared_ptr<const model::ControllerDecl> declared)
        : shared_decl(std::move(declared)), decl(*shared_decl) {}
    // Read in every step, the first ones of them side by side: see prefetch() in programs.cpp.
    std::uint64_t key = 0;
    const ControllerKind* kind = nullptr;  ///< null: not a controller, but a kind of programs/
    DeepConst<Controller*> controller;     ///< the program's, where it is no more than a controller
    Owned<Program> program;
    std::vector<const TopicBase*> topics;  ///< topics of its readings at the active levels
    std::vector<std::uint64_t> seen;       ///< message counts at its previous step
    std::uint64_t steps = 0;
    Owned<Schedule> schedule;              ///< null: it steps at the run's control steps
    Owned<Wait> wait;                      ///< null: it is a controller
    std::unique_ptr<std::string> failure;  ///< in its last step; ends the run. Null: it did not fail
    bool ended = false;
    bool inactive = false;  ///< it was stopped, or is not started yet: it does not step and gives no orders
    Command command;
    std::vector<Route> routes;  ///< per actuator of the description
    Owned<Outputs> outputs;     ///< null: it has no topics
    /// One object for robots with equal devices: its `robot` is the first of them.
    std::shared_ptr<const Description> description;
    std::shared_ptr<const model::ControllerDecl> shared_decl;  ///< one object for equal declarations
    const model::ControllerDecl& decl;
    std::string path;
    std::vector<std::uint32_t> claims,
        reads;  ///< actuators and readings that it looked up (control/claims.h)
  };
  using ProgramEntries = std::vector<Owned<ProgramEntry>>;
  /// A controller that came while the run went on (sim/world/controllers.h) and is no program: one that is not configured yet,
  /// or one that drives joints by devices.
  struct LoadedController {
    model::ControllerDecl decl;
    std::vector<model::DeviceDecl> devices;  ///< none: it becomes a program when it is configured
    bool configured = false;                 ///< its devices are the robot's
  };
  struct Entity {
    model::Instance instance;
    InstanceId id;
    std::uint64_t key = 0;
    std::uint64_t serial = 0;     ///< creation order over the whole run
    Owned<EnergyAccount> energy;  ///< null: it has no battery
    std::vector<Owned<Device>> devices;
    ProgramEntries programs;
    std::vector<LoadedController> loaded;  ///< in the order in which they came
    /// The model without the masses of devices, of an instance whose devices have some; else null.
    std::shared_ptr<const model::Model> declared_model;

    /// The instance as it was declared, to make it again.
    model::Instance declared() const {
      model::Instance out = instance;
      if (declared_model) out.model = declared_model;
      return out;
    }
    /// By path, "rover/laser"; null when there is none.
    Device* find_device(std::string_view path) {
      for (auto& device : devices)
        if (device->path == path) return device.get();
      return nullptr;
    }
    ProgramEntry* find_program(std::string_view path) {
      for (auto& program : programs)
        if (program->path == path) return program.get();
      return nullptr;
    }
  };
  /// Team: robots that programs of their own drive together.
  struct Team {
    model::TeamDecl decl;
    ProgramEntries programs;
  };
};

}  // namespace sandlot
