#pragma once
/// Device pools: the devices of a world by kind, with their sampling times, levels and faults. One call per phase serves all.
///
/// Threads   the simulation's only; a phase uses as many threads as the arena around it has.
/// Cost      no heap allocation per tick once vectors have reached their size.
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "devices/kind.h"
#include "sim/world/parts.h"

namespace sandlot {

class Commands;       // sim/world/commands.h
struct FailureOrder;  // sim/world/faults.h

class DevicePools {
 public:
  using Device = SimulationParts::Device;
  using Entity = SimulationParts::Entity;
  using Slot = SimulationParts::Slot;
  using Timing = SimulationParts::Timing;

  /// `setup` must outlive the pools.
  explicit DevicePools(const model::Setup& setup) : setup_(setup) {}
  void add_kind(const Kind& kind);

  /// Opens the account of a robot with a battery, before its devices are built.
  /// Errors   two batteries.
  Status open_account(Entity& entity, const Engine& engine);
  void close_account(const Entity& entity) { ledger_.remove(entity.energy.get()); }
  const EnergyLedger& energy() const { return ledger_; }
  /// Builds a device at the end of its pool and of `entity.devices`.
  /// Errors   unknown kind, a name given twice, wrong keys, a rate above the tick rate; nothing has changed then.
  Status add(Entity& entity, const model::DeviceDecl& declared, const Engine& engine, Time now,
             Diagnostics& diagnostics);
  /// Connects the orders that a device gives to others of its robot. Once all devices of the robot are there.
  /// Errors   no such device, or it takes no such command.
  Status connect_orders(Entity& entity, Device& device, Commands& commands) const;
  /// Takes a device out of its pool; the caller destroys it.
  void remove(const Device& device);
  /// Lets an actuator release what it holds, into context.actuation.
  void release(const Device& device, const Context& context);

  /// Null: there is none of that name.
  const Kind* find_kind(std::string_view name) const;
  const Kind& kind(const Device& device) const { return *pools_[device.kind].kind; }
  std::optional<std::uint64_t> changes(const Device& device) const {
    return pools_[device.kind].pool->changes(device.index);
  }
  const PoolBase& pool(const Device& device) const { return *pools_[device.kind].pool; }
  const Timing& timing(const Device& device) const { return pools_[device.kind].timing[device.index]; }
  /// Numbers of a device by path, of its kind and of the common keys.
  ValueFound value(const Device& device, ValuePart part, std::span<const ValueStep> path) const;
  void list_values(const Device& device, ValuePart part, const ValueVisit& visit) const;
  /// Whether some device needs the render scene.
  bool need_render_scene() const;
  /// The command slot of a type: at the level of that name, or at an active level (""). Null: none takes it.
  Slot* command_slot(Device& device, std::string_view type, std::string_view level) const;
  /// Takes a command into a slot of the device, or puts it on its way there.
  /// Errors   the device has failed, takes no more now, has no room; bytes that are not a message of the slot's type, numbers
  ///          that are not finite.
  /// @param explain  false: errors that may come in every tick have no text, and cost no memory
  Status deliver(Device& device, Slot& slot, std::span<const std::byte> bytes, Time now,
                 bool explain = true) const;
  /// False while a failure keeps the device from taking commands.
  static bool takes_commands(const Device& device, Time now);
  /// The latest command that was accepted for a slot, which may be on its way still.
  static const TopicBase& latest_command(const Device& device, const Slot& slot);

  // Changes by requests.
  Status set_levels(Device& device, std::span<const std::string> names, const Context& context);
  Status set_parameter(Device& device, std::string_view field, const Node& value);
  Status order_failure(Device& device, const FailureOrder& order);
  /// @param at  the end of the tick that begins
  Status request_sample(Device& device, Time at);
  /// What a device that samples on request would publish on a topic of its own now, for those who look on: afterwards it is as
  /// before. Null: nothing. @pre  between the phases; context.now is the end of the latest tick
  std::unique_ptr<TopicBase> look_through(Device& device, const TopicBase& topic, const Context& context);
  /// Calls a service. Errors: no such service, the device has failed, what the service refuses.
  Status call(Device& device, std::string_view service, std::span<const std::byte> request,
              std::vector<std::byte>& response, const Context& context);
  /// @param factor  of the world times that of the robot
  void scale_errors(Device& device, double factor);
  /// Whether the failure of some device was ordered while the run went on.
  bool any_failure_ordered() const;

  // Phases. The tick that is computed begins at context.now - context.tick; in sense() it ends at context.now.
  void actuate(const Context& context);
  void pre_substep(const Context& context, double h_s);
  void post_substep(const Context& context, double h_s);
  void sense(const Context& context);

  void save(const Device& device, ByteWriter& w) const;
  void load(Device& device, ByteReader& r, Time now);

 private:
  struct Pool {
    const Kind* kind = nullptr;
    std::unique_ptr<PoolBase> pool;
    std::vector<Device*> devices;
    std::vector<EnergyMeter*> meters;             ///< per device; null: its robot has no battery
    std::vector<Timing> timing;                   ///< per device
    std::vector<std::uint32_t> all, due, levels;  ///< `levels` per device: a copy of Device::levels
    std::vector<std::uint64_t> sample;
    std::vector<Time> since;
    std::uint32_t faulty = 0;   ///< number of devices with faults
    std::uint32_t keyed = 0;    ///< number of devices whose common keys change commands or messages
    std::uint32_t metered = 0;  ///< number of devices whose robots have a battery
  };
  static std::span<const std::uint32_t> acting(Pool& pool, const Context& context, bool release_dead);
  /// Product of all factors on a device's errors, a failure's included.
  double all_errors(const Device& device, Time now) const;
  bool has_errors(const Device& device) const;
  void prepare_commands(Pool& pool, const Context& context) const;
  void find_due(Pool& pool, Time now, Time step) const;
  static std::unique_ptr<EnergyMeter> meter_of(Entity& entity, const Kind& kind);
  static bool load_meter(EnergyMeter& meter, ByteReader& r);
  void drain(const Context& context);
  void settle(const Context& context);
  void sense_due(Pool& pool, const Context& context) const;
  void sense_faulty(Pool& pool, const Context& context) const;
  void sense_keyed(Pool& pool, const Context& context) const;
  void plan_next_sample(const Device& device);
  void note_keys(Device& device);
  void set_active_levels(Device& device, std::uint32_t levels);

  const model::Setup& setup_;
  std::vector<Pool> pools_;
  EnergyLedger ledger_;
};

}  // namespace sandlot
