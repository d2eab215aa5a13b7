#pragma once
/// Simulation: one simulated world, built from a Setup, advanced tick by tick, saved and restored at any tick.
///
///   auto sim = Simulation::create(setup, {.threads = 2}, diagnostics);   // Result
///   while (!(*sim)->stop_reason()) SL_TRY((*sim)->tick());
///
/// Determinism   the same Setup, seed and requests give the same state_hash() after every tick, for any number of
///               threads and observers.
/// Threads       one thread calls tick(); submit() may be called from any.
/// Parts         entities and the list of phases (tick) are here; devices, programs, commands, pulls, scenes and the frames
///               for observers are classes of their own, with headers beside this one.
/// Cost          no heap allocation of ours per tick once vectors have reached their size.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/kind.h"
#include "elements/request.h"
#include "sim/world/commands.h"
#include "sim/world/device_keys.h"
#include "sim/world/device_pools.h"
#include "sim/world/frame.h"
#include "sim/world/parts.h"
#include "sim/world/phase_timer.h"
#include "sim/world/programs.h"
#include "sim/world/publisher.h"
#include "sim/world/pull.h"
#include "sim/world/scenes.h"
#include "sim/world/world_elements.h"

namespace tbb::detail::d1 {
class global_control;
class task_arena;
}  // namespace tbb::detail::d1

namespace sandlot {

class Monitor;

struct SimulationOptions {
  int threads = 1;           ///< 0: as many as the machine has
  bool run_programs = true;  ///< false: programs are not resumed (commands come from a log)
  std::span<const Kind* const> extra_kinds = {};  ///< in addition to the built-in ones
  /// In addition to the built-in ones and those of plugins.
  std::span<const ControllerKind* const> extra_controllers = {};
  std::span<const MediumKind* const> extra_media = {};  ///< in addition to the built-in ones
  std::span<const RuleKind* const> extra_rules = {};    ///< in addition to the built-in ones
  ContactRule contact_rule = {};            ///< exceptions from the contact law (physics/contact_rule.h)
  std::span<const std::string> paths = {};  ///< folders to search first for the plugins of a snapshot
  /// Whether programs that run in processes of their own are started. A scenario, and a snapshot, carry command lines:
  /// allow it for those you trust. Without it, such programs give no orders but those of a log.
  bool start_programs = false;
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

  /// Calls visit(program, outside) for all programs that run outside this process.
  template <class Visit>
  void for_each_outside(Visit&& visit) {
    const auto each = [&](ProgramEntries& programs) {
      for (auto& program : programs)
        if (Outside* const outside = program->program->outside()) visit(std::as_const(*program), *outside);
    };
    for (auto& entity : entities_) each(entity->programs);
    for (Team& team : programs_.teams()) each(team.programs);
  }

  /// Connects programs that run outside this process, where the options allow it; else a warning each. create() has done
  /// so if it was allowed; for a restored world, call it where the log of what came from outside ends.
  void connect_programs();
  /// Takes what clients have answered that drive robots in step with the run, without waiting. The next tick counts those who
  /// have not as late.
  /// @return until when an answer is awaited; nothing: the next tick may begin
  std::optional<std::chrono::steady_clock::time_point> await_clients() { return programs_.await_clients(); }

  /// Queues a request for the next tick. @return its sequence number
  std::uint64_t submit(Request request, Source source = {}) {
    return commands_.submit(std::move(request), source);
  }
  /// Queues a request of a log for the next tick, behind those queued so before it and ahead of all others.
  std::uint64_t repeat(Request request, Source source) {
    return commands_.repeat(std::move(request), source);
  }
  /// Drops the requests that wait and are not of a log: who repeats a tick has them there.
  void drop_unlogged() { commands_.drop_unlogged(); }
  /// Outcomes of the requests that the last tick carried out.
  std::span<const Outcome> outcomes() const { return commands_.outcomes(); }

  /// Sets or clears the simulated time at which the run stops by itself; a run that had stopped may go on.
  void set_stop(std::optional<Time> stop);
  /// An event in addition to the scenario's own; not State. See sim/watch/monitor.h.
  Status add_event(model::EventDecl decl);
  /// Named values and events. `monitor().happened()`: the events of the latest tick.
  const Monitor& monitor() const { return *monitor_; }
  void add_observer(Observer* observer) { publisher_.add(observer); }
  void remove_observer(Observer* observer) { publisher_.remove(observer); }

  /// Hash of all State.
  std::uint64_t state_hash() const;
  /// Hashes of the parts of the State: the run's own ("sim"), media and rules, then each entity's in creation order.
  std::vector<SubHash> sub_hashes() const;
  /// All State with the Model it belongs to.
  std::vector<std::byte> snapshot() const;
  /// Numeric profile, on which results depend in addition to the inputs: "x86-64-v3 embree-avx2 ...". Part of every snapshot.
  static const std::string& profile();

  // Reading, by address. Null or nothing when there is no such thing.
  const Engine& engine() const { return *engine_; }
  const RayCaster& rays() const { return scenes_.rays(); }
  std::optional<InstanceId> find_instance(std::string_view name) const;
  /// "/rover/laser/ranges", or "rover/laser" for a device's first topic.
  const TopicBase* find_topic(std::string_view name) const override;
  std::vector<const TopicBase*> topics() const;
  /// Calls visit(topic, path of the device or program that publishes it) for each topic: by entity in creation order, its
  /// devices' and then its programs', then those of teams, in the end those of rules.
  template <class Visit>
  void for_each_topic(Visit&& visit) const {
    const auto published = [&](const ProgramEntries& programs) {
      for (const auto& program : programs)
        if (program->outputs)
          for (const Outputs::Output& output : program->outputs->all()) visit(*output.topic, program->path);
    };
    for (const auto& entity : entities_) {
      for (const auto& device : entity->devices)
        for (const Slot& slot : device->topics) visit(*slot.topic, device->path);
      published(entity->programs);
    }
    for (const Team& team : teams()) published(team.programs);
    for (const WorldElements::Part& part : elements_.parts())
      for (const auto& topic : part.topics) visit(*topic, part.path);
  }
  /// The instances of the world now, in creation order.
  std::vector<const model::Instance*> instances() const;
  /// Devices and programs of an instance: path, kind, active levels, topics.
  struct DeviceView {
    std::string path, kind;
    std::vector<std::string> active_levels;
    std::vector<const TopicBase*> topics, commands;
    std::vector<const DeviceOrder*> orders;  ///< that it gives to other devices
  };
  std::vector<DeviceView> devices(std::string_view instance) const;

  /// A frame of the present, for readers between two ticks: instances, and links and contacts if wanted.
  std::shared_ptr<const Frame> look(const Observer::Wants& wants) const { return publisher_.look(wants); }

  /// The world as cameras draw it, at the end of the last tick, for readers between two ticks. Not State: a call changes
  /// no run. Built at the first call where no device needs it; warnings of textures are then dropped.
  RenderScene& render_scene();

  /// Rate [Hz] at which viewers may look through the device of a topic, 0: in each tick. Nothing: it samples by itself.
  std::optional<double> look_rate_hz(const TopicBase& topic) const;
  /// What such a device would publish on the topic at the end of the last tick. Not State: a call changes no run. Null: nothing.
  std::unique_ptr<TopicBase> look_through(const TopicBase& topic);

  /// Media, rules and markers.
  const WorldElements& elements() const { return elements_; }

  const PhaseTimes& phase_times() const { return phase_times_; }
  std::uint64_t refused_commands() const { return commands_.refused(); }

  // --- the parts, for the files of sim/ ---
  /// The entities of the world, in creation order. Valid until the next tick.
  std::span<const Owned<Entity>> entities() const { return entities_; }
  const Entity* find_entity(std::string_view name) const;
  /// Whether a new entity of this name would be refused: there is one, one waits for the next tick, or a team has it.
  bool is_taken(std::string_view name) const;
  /// In the order of the scenario.
  const std::vector<Team>& teams() const { return programs_.teams(); }
  /// Programs of an instance or a team; null: there is no such thing.
  const ProgramEntries* programs_of(std::string_view owner) const;
  const PoolBase& pool(const Device& device) const { return devices_.pool(device); }
  const Kind& kind(const Device& device) const { return devices_.kind(device); }
  const Timing& timing(const Device& device) const { return devices_.timing(device); }
  /// Numbers of a device's parameters and state, common keys included.
  ValueFound value(const Device& device, ValuePart part, std::span<const ValueStep> path) const {
    return devices_.value(device, part, path);
  }
  void list_values(const Device& device, ValuePart part, const ValueVisit& visit) const {
    devices_.list_values(device, part, visit);
  }
  /// Controller kinds that this world knows: the built-in ones, the embedding program's and those of plugins.
  std::span<const ControllerKind* const> controller_kinds() const { return programs_.kinds(); }
  /// Those that a program may be of besides.
  std::span<const ProgramKind* const> program_kinds() const;
  struct ControllerManager;  // sim/world/controller_manager.h

 private:
  friend class Publisher;  // reads everything, writes nothing

  Simulation(model::Setup setup, const SimulationOptions& options);

  // build.cpp: entities
  /// @param restored  from a snapshot: what names speak of may be gone
  Status build(Diagnostics& diagnostics, bool restored);
  Status add_entity(model::Instance instance, Diagnostics& diagnostics);
  Status check_team(const model::Instance& instance) const;
  Status check_sharing() const;
  Result<std::shared_ptr<const model::Model>> add_masses(model::Instance& instance);
  void remove_entity(std::size_t index);
  void world_changed();
  Entity* find_entity(std::string_view name);
  Entity& entity_of(const Device& device);
  Device* find_device(std::string_view path);
  ProgramEntry* find_program(std::string_view path);

  // tick.cpp: the phases, in order
  void set_step(std::optional<Time> measured);
  void process_commands();
  void actuate();
  void physics();
  void hand_over(const Actuation& actuation);
  void update_scene();
  void deliver_media();
  void sense();
  void judge();
  void find_stop_reason();
  void control();
  void publish();
  Context context();
  MediumContext medium_context() const;
  void fail(Error error);

  // requests.cpp
  struct Processor;
  std::string solid_at(const Entity& entity, const Pose& X_WM) const;
  Status process(Request& request, const Source& source, std::vector<std::byte>& response);

  // state.cpp
  template <class Visit>
  void for_each_state(Visit&& visit) const;
  std::uint64_t hash_parts(std::vector<std::uint64_t>& parts) const;
  std::shared_ptr<const std::vector<std::string>> name_parts() const;
  struct RunBlock;
  void save_run(ByteWriter& w) const;
  bool load_run(ByteReader& r);

  model::Setup setup_;
  SimulationOptions options_;
  std::unique_ptr<tbb::detail::d1::global_control> more_threads_;
  std::unique_ptr<tbb::detail::d1::task_arena> arena_;
  std::unique_ptr<Engine> engine_;
  Scenes scenes_{setup_};

  std::vector<Owned<Entity>> entities_;
  std::vector<const Entity*> guided_;  ///< those with a motion
  std::map<std::string, Entity*, std::less<>> by_name_;
  /// The latest model that got the masses of devices.
  struct WithMasses {
    std::shared_ptr<const model::Model> declared, loaded;
    std::vector<PointMass> masses;
  } with_masses_;
  DevicePools devices_{setup_};
  Commands commands_;
  Programs programs_{setup_, devices_, commands_};
  Pulls pulls_;
  WorldElements elements_{*this};
  std::unique_ptr<Monitor> monitor_;
  Publisher publisher_{*this};

  Time now_;
  Time step_;  ///< length of the tick that is being computed
  int substeps_ = 1;
  std::uint64_t tick_ = 0;
  std::uint64_t revision_ = 0;
  std::uint64_t next_serial_ = 0;
  std::optional<std::string> stop_reason_;
  Status status_;  ///< why the run has failed

  Actuation actuation_;
  EmissionBuffer emissions_;
  PhaseTimes phase_times_;
  mutable ByteWriter scratch_;
};

}  // namespace sandlot
