#pragma once
/// One simulated world: built from a Setup, advanced tick by tick, saved and restored at any tick.
///
///   auto sim = Simulation::create(setup, {.threads = 2}, diagnostics);   // Result
///   while (!(*sim)->stop_reason()) SL_TRY((*sim)->tick());
///
/// Determinism   the same Setup, seed and requests give the same state_hash() after every tick, for any number of
///               threads and observers.
/// Threads       one thread calls tick(); submit() may be called from any.
/// Cost          no heap allocation of ours per tick once vectors have reached their size.
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "devices/kind.h"
#include "optics/ray_scene.h"
#include "sim/world/frame.h"
#include "sim/world/parts.h"
#include "sim/world/phase_timer.h"
#include "sim/world/pull.h"
#include "sim/world/request.h"
#include "sim/world/rule.h"

namespace tbb::detail::d1 {
class global_control;
class task_arena;
}  // namespace tbb::detail::d1

namespace sandlot {

class Monitor;
class RenderScene;

struct SimulationOptions {
  int threads = 1;           ///< 0: as many as the machine has
  bool run_programs = true;  ///< false: programs are not resumed (commands come from a log)
  std::span<const Kind* const> extra_kinds = {};  ///< beside the built-in ones
  std::span<const ControllerKind* const> extra_controllers =
      {};                                   ///< beside the built-in ones and the plugins'
  ContactRule contact_rule = {};            ///< exceptions from the contact law (physics/contact_rule.h)
  std::span<const std::string> paths = {};  ///< folders to search first for the plugins of a snapshot
};

class Simulation final : public SimulationParts, public TopicFinder {
 public:
  static Result<std::unique_ptr<Simulation>> create(model::Setup setup, const SimulationOptions& options,
                                                    Diagnostics& diagnostics);
  /// Rebuilds the world that `snapshot()` saved; needs nothing else.
  static Result<std::unique_ptr<Simulation>> restore(std::span<const std::byte> snapshot,
                                                     const SimulationOptions& options,
                                                     Diagnostics& diagnostics);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Advances by one step. An error (a state that is no longer finite) ends the run.
  /// @param measured  length of this step instead of the setup's (clock `continuous`): an input like any other, so it
  ///                  is in the log. It is cut to the setup's shortest and longest step.
  Status tick(std::optional<Time> measured = std::nullopt);

  Time now() const { return now_; }
  std::uint64_t tick_index() const { return tick_; }
  std::uint64_t revision() const { return revision_; }
  const std::optional<std::string>& stop_reason() const { return stop_reason_; }
  const model::Setup& setup() const { return setup_; }

  /// Queues a request for the next tick. @return its sequence number
  std::uint64_t submit(Request request, Source source = {});
  /// What became of the requests carried out in the last tick.
  std::span<const Outcome> outcomes() const { return outcomes_; }

  /// Sets or clears the simulated time at which the run stops by itself; a run that had stopped may go on.
  void set_stop(std::optional<Time> stop);
  /// An event beside the scenario's own; no part of State. See sim/watch/monitor.h.
  Status add_event(model::EventDecl decl);
  /// Named values and events. `monitor().happened()`: the events of the latest tick.
  const Monitor& monitor() const { return *monitor_; }
  void add_observer(Observer* observer) { observers_.push_back(observer); }
  void remove_observer(Observer* observer) { std::erase(observers_, observer); }
  void add_rule(std::unique_ptr<Rule> rule) { rules_.push_back(std::move(rule)); }
  void add_medium(std::unique_ptr<Medium> medium) { media_.push_back(std::move(medium)); }

  /// Hash of all State.
  std::uint64_t state_hash() const;
  /// Hashes of the parts of the State: the run's own ("sim"), then each entity's in creation order.
  std::vector<SubHash> sub_hashes() const;
  /// All State with the Model it belongs to.
  std::vector<std::byte> snapshot() const;
  /// What the numbers depend on beside the inputs: "x86-64-v3 embree-avx2 ...". Part of every snapshot.
  static const std::string& profile();

  // Reading, by address. Null or nothing when there is no such thing.
  const Engine& engine() const { return *engine_; }
  const RayCaster& rays() const { return *rays_; }
  std::optional<InstanceId> find_instance(std::string_view name) const;
  /// "/rover/laser/ranges", or "rover/laser" for a device's first topic.
  const TopicBase* find_topic(std::string_view name) const override;
  TopicBase* find_command(std::string_view name) const override;
  std::vector<const TopicBase*> topics() const;
  /// What stands in the world now, in creation order.
  std::vector<const model::Instance*> instances() const;
  /// Devices and programs of an instance: path, kind, active levels, topics.
  struct DeviceView {
    std::string path, kind;
    std::vector<std::string> active_levels;
    std::vector<const TopicBase*> topics, commands;
  };
  std::vector<DeviceView> devices(std::string_view instance) const;

  /// A frame of the present, for those who come between two ticks: instances, and links and contacts if asked for.
  std::shared_ptr<const Frame> look(const Observer::Wants& wants) const;

  /// The world as cameras draw it, at the end of the last tick, for those who come between two ticks. Not State: asking
  /// for it changes no run. Made at the first call where no device sees; warnings of textures are then dropped.
  RenderScene& render_scene();

  const PhaseTimes& phase_times() const { return phase_times_; }
  std::uint64_t refused_commands() const { return refused_commands_; }

  // --- the parts, for the files of sim/ ---
  /// What the world holds, in creation order. Valid until the next tick.
  std::span<const std::unique_ptr<Entity>> entities() const { return entities_; }
  const Entity* find_entity(std::string_view name) const;
  const PoolBase& pool(const Device& device) const { return *pools_[device.kind].pool; }
  const Kind& kind(const Device& device) const { return *pools_[device.kind].kind; }
  const Timing& timing(const Device& device) const { return pools_[device.kind].timing[device.index]; }
  /// Those that programs of this world may be: the built-in ones and the plugins'.
  std::span<const ControllerKind* const> controller_kinds() const { return controller_kinds_; }

 private:
  struct Pool {
    const Kind* kind = nullptr;
    std::unique_ptr<PoolBase> pool;
    std::vector<Device*> devices;
    std::vector<Timing> timing;                   ///< per device
    std::vector<std::uint32_t> all, due, levels;  ///< `levels` per device: a copy of Device::levels
    std::vector<std::uint64_t> sample;
    std::vector<Time> since;
    std::uint32_t faulty = 0;  ///< how many have faults
  };
  struct Pending {
    Source source;
    std::uint64_t sequence;
    Request request;
  };

  Simulation(model::Setup setup, const SimulationOptions& options);

  // build.cpp
  Status build(Diagnostics& diagnostics);
  Status gather_controllers(Diagnostics& diagnostics);
  Status add_entity(model::Instance instance, Diagnostics& diagnostics);
  Status add_device(Entity& entity, const model::DeviceDecl& decl, Diagnostics& diagnostics);
  Status add_program(Entity& entity, std::shared_ptr<const model::ControllerDecl> declared);
  Result<std::unique_ptr<ProgramEntry>> make_program(const Entity& entity,
                                                     std::shared_ptr<const model::ControllerDecl> declared);
  void remove_entity(std::size_t index);
  void remove_from_pool(const Device& device);
  void point_programs_at_active_levels(Entity& entity);
  Entity* find_entity(std::string_view name);
  Device* find_device(std::string_view path);
  ProgramEntry* find_program(std::string_view path);
  void rebuild_scene();
  void rebuild_sight(Diagnostics& diagnostics);
  void plan_next_sample(const Device& device);
  void set_active_levels(Device& device, std::uint32_t levels);
  std::shared_ptr<const Description> describe(const Entity& entity);
  std::uint64_t hash_parts(std::vector<std::uint64_t>& parts) const;
  std::shared_ptr<const std::vector<std::string>> name_parts() const;

  // tick.cpp: the phases, in order
  void set_step(std::optional<Time> measured);
  void take_commands();
  void actuate();
  void physics();
  void pull();
  void update_scene();
  void sense();
  void deliver_media();
  void judge();
  void control();
  void gather_programs();
  Context context();

  // publish.cpp: the last phase
  struct Publishing;
  void publish();
  void fill_instances(Frame& frame, bool links) const;
  void fill_contacts(Frame& frame) const;
  void fill_topics(Frame& frame);
  void fill_hashes(Frame& frame);

  // requests.cpp
  Status carry_out(Request& request, const Source& source);
  Status apply_command(const CommandRequest& command, const Source& source);
  bool is_held(const Device& device) const;
  void hold(const Device& device);
  Status start_pull(const PullRequest& request);
  Status give_command(Slot& slot, std::span<const std::byte> bytes);
  LogEntry& log_entry(std::uint8_t kind, const Source& source, std::uint64_t sequence);
  void log_request(const Request& request, const Outcome& outcome);
  Slot* active_command_slot(Device& device, std::string_view type, std::string_view level);
  Status set_levels(const LevelRequest& request);
  void apply_program_orders();

  // faults.cpp
  bool takes_commands(const Device& device) const;
  void sense_faulty(Pool& pool, const Context& context);
  std::span<const std::uint32_t> acting(Pool& pool, const Context* let_go);
  Status set_errors(Entity* entity, std::string_view field, const Node& value);
  bool errors_scaled() const;
  void save_errors(ByteWriter& w) const;

  // mount.cpp
  Status mount_device(const LoadDeviceRequest& request);
  Status unmount_device(const UnloadDeviceRequest& request);
  Status describe_anew(Entity& entity);

  // state.cpp
  template <class Visit>
  void for_each_state(Visit&& visit) const;
  void save_device(const Device& device, ByteWriter& w) const;
  void load_device(Device& device, ByteReader& r);
  static void save_program(const ProgramEntry& program, ByteWriter& w);
  static bool load_program(ProgramEntry& program, ByteReader& r);
  void save_run(ByteWriter& w) const;
  void save_pulls(ByteWriter& w) const;
  bool load_pulls(ByteReader& r);
  bool load_run(ByteReader& r);

  model::Setup setup_;
  SimulationOptions options_;
  std::unique_ptr<tbb::detail::d1::global_control> more_threads_;
  std::unique_ptr<tbb::detail::d1::task_arena> arena_;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<RayScene> scene_;  ///< null when the engine casts rays itself
  const RayCaster* rays_ = nullptr;
  SceneFrame scene_frame_;
  std::unique_ptr<RenderScene> render_scene_;  ///< null as long as nobody sees

  std::vector<std::unique_ptr<Entity>> entities_;
  std::vector<const Entity*> guided_;  ///< those with a motion
  std::map<std::string, Entity*, std::less<>> by_name_;
  std::vector<Pool> pools_;
  std::vector<const ControllerKind*> controller_kinds_;
  std::vector<std::unique_ptr<Rule>> rules_;
  std::unique_ptr<Monitor> monitor_;
  std::vector<std::unique_ptr<Medium>> media_;
  std::vector<Observer*> observers_;

  Time now_;
  Time step_;  ///< length of the tick that is being computed
  int substeps_ = 1;
  std::uint64_t tick_ = 0;
  std::uint64_t revision_ = 0;
  std::uint64_t next_serial_ = 0;
  std::uint64_t refused_commands_ = 0;
  std::optional<std::string> stop_reason_;
  Status status_;

  std::mutex inbox_mutex_;
  std::vector<Pending> inbox_;
  std::uint64_t next_sequence_ = 0;
  std::vector<Pending> carrying_out_;
  std::vector<Outcome> outcomes_;

  std::vector<Hold> holds_;  ///< State
  std::vector<Pull> pulls_;  ///< State; those that are over stay until the next tick

  Actuation actuation_;
  EmissionBuffer emissions_;
  std::shared_ptr<const Description> described_;  ///< the latest
  /// All programs in entity order, and those that run, kind by kind. Made anew when one comes, goes or ends.
  std::vector<ProgramEntry*> programs_, running_;
  std::vector<Entity*> owners_;  ///< per entry of programs_
  bool programs_changed_ = true;
  Observer::Wants wants_;  ///< of all observers together
  std::vector<LogEntry> log_, spare_log_;
  std::shared_ptr<Publishing> publishing_;  ///< known to publish.cpp alone
  PhaseTimes phase_times_;
  mutable ByteWriter scratch_;
};

}  // namespace sandlot
