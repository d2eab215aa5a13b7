#pragma once
/// Programs: the control programs of all robots and teams. They are made for an entity or a team, step in the control phase,
/// and their orders are delivered in the next tick.
///
/// Order     all programs in entity order, then those of teams, for their orders; for their steps kind by kind, in batches,
///           in parallel. What they publish is written after all have stepped.
/// Time      a program steps at the run's control steps, or at the due times of its own `rate`, as devices do.
/// State     of each program (save, load); the lists here follow from the entities.
/// Errors    an exception from a controller fails the tick and goes no further.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "messages/sandlot_drive.h"
#include "sim/world/commands.h"
#include "sim/world/device_pools.h"
#include "sim/world/parts.h"

namespace sandlot {

struct SimulationOptions;

/// Topics and commands of maneuvers, which are State only once one was commanded (devices/kind.h, late_level); they are the last
/// entries of a description.
inline bool is_late(const Description::Entry& entry) {
  return entry.type == msg::DriveManeuver::ros_type || entry.type == msg::DriveProgress::ros_type;
}

class Programs {
 public:
  using Device = SimulationParts::Device;
  using Entity = SimulationParts::Entity;
  using ProgramEntry = SimulationParts::ProgramEntry;
  using ProgramEntries = SimulationParts::ProgramEntries;
  using Team = SimulationParts::Team;
  using Entities = std::span<Owned<Entity>>;
  using FindDevice = std::function<Device*(std::string_view path)>;

  /// All must outlive the programs.
  Programs(const model::Setup& setup, DevicePools& devices, Commands& commands)
      : setup_(setup), devices_(devices), commands_(commands) {}

  /// Collects the kinds that `controller:` may name: ours, the embedding program's, then those of the plugins. The entries
  /// of `plugins` become those of the files that were loaded.
  Status gather_kinds(std::vector<model::PluginDecl>& plugins, const SimulationOptions& options,
                      Diagnostics& diagnostics);
  std::span<const ControllerKind* const> kinds() const { return kinds_; }
  /// Whether a kind's programs run outside this process.
  static bool is_outside(std::string_view kind);

  Status add(Entity& entity, std::shared_ptr<const model::ControllerDecl> declared, Time now,
             Diagnostics& diagnostics);
  /// As add(), for a controller that comes while the run goes on: it is inactive. On an error nothing has changed.
  Status add_inactive(Entities entities, Entity& entity,
                      std::shared_ptr<const model::ControllerDecl> declared, Time now);
  /// Takes a program from its robot. Refused while another one reads a topic of it; then nothing has changed.
  Status remove(Entities entities, Entity& entity, std::size_t index);
  /// Lets a program step from this tick on, or no more: orders that it has given and that wait are dropped then. One with a
  /// rate of its own counts its steps from now on.
  void set_active(ProgramEntry& program, bool active, Time now);
  /// Makes the setup's teams with their programs, for the entities there are.
  Status add_teams(Entities entities, Time now, Diagnostics& diagnostics);
  const std::vector<Team>& teams() const { return teams_; }
  std::vector<Team>& teams() { return teams_; }
  Team* find_team(std::string_view name);

  /// Gives the programs of an entity, and of its team, the description of its devices as they are now, with their State. On
  /// an error nothing has changed.
  Status describe_again(Entities entities, Entity& entity);
  /// The same for the programs of a team whose robots change. @param leaving  a robot to leave out, or null
  Status describe_team(Entities entities, std::string_view team, const Entity* leaving = nullptr);
  /// Points readings and orders of the programs of an entity and its team at the active levels of its devices.
  void follow_levels(Entities entities, Entity& entity);
  /// To be called when entities were added or removed, and when programs were loaded.
  void entities_changed() { changed_ = true; }

  /// Delivers the orders of the latest step to the devices. @param end  of the tick that begins. @param logged  whether to log them
  /// @param find_device  by path; null: there is none
  void deliver_orders(Entities entities, Time now, Time end, bool logged, const FindDevice& find_device);
  /// A message that came from outside for those of the programs that read the topic "rover/goal_pose" with that type: they see it
  /// at their next step. Errors: none does, the bytes are no such message, or too many.
  static Status deliver(ProgramEntries& programs, const CommandRequest& command, Time now);
  /// Steps the programs that are due. @param control_step  whether the tick is one of the run's control steps
  /// @return the first failure
  std::optional<Error> step(Entities entities, Time now, bool control_step);

  // --- programs that run outside this process (control/program.h) ---
  /// Connects them, once; await_answers() follows.
  /// @param allowed   whether the run may start programs; else they stay without orders, with a warning each
  /// @param restored  the world comes from a snapshot: what cannot be connected is a warning, too
  Status connect(Entities entities, Time now, bool allowed, bool restored);
  /// Waits until those that stepped in this tick have answered or their deadlines are over. What came is input of the next
  /// tick: an AnswerRequest each. To be called outside of parallel work.
  void await_answers();
  /// Of those that clients answer, without waiting: takes what has come; whose deadline is over has missed it. @return the next
  /// deadline; nothing: no answer is awaited, and the next tick may begin
  std::optional<Outside::Clock::time_point> await_clients();
  /// At the beginning of a tick: clients that have not answered have missed it.
  void end_waiting_for_clients();
  /// Acts on an answer. @return why the program cannot go on
  std::optional<Error> answer(ProgramEntry& entry, const OutsideAnswer& answer, Time now);

  /// Whether there ever was one that is not a controller.
  bool any_beyond_controllers() const { return any_beyond_controllers_; }

  static void save(const ProgramEntry& program, ByteWriter& w);
  static bool load(ProgramEntry& program, ByteReader& r, Time now);

 private:
  /// What a program drives: a robot, or the robots of a team.
  struct Driven {
    std::string name;
    std::vector<Entity*> robots;
    bool team = false;
  };
  /// Programs that replace others, with their State.
  struct Remade {
    ProgramEntries programs;
    std::uint64_t refused = 0;  ///< orders whose devices are gone
  };
  static Driven driven_by(Entity& entity) { return {entity.instance.name, {&entity}, false}; }
  static Driven driven_by(Entities entities, const Team& team, const Entity* leaving);

  Result<Owned<ProgramEntry>> make(const Driven& driven, const ProgramEntries& before,
                                   std::shared_ptr<const model::ControllerDecl> declared, Time now,
                                   Diagnostics& diagnostics);
  Result<double> take_rate(const model::ControllerDecl& decl, std::vector<FieldInfo> (*fields)(),
                           Node& config, Diagnostics& diagnostics) const;
  std::shared_ptr<const Description> describe(const Driven& driven, const ProgramEntries& before,
                                              double period_s);
  void describe_robot(const Entity& entity, const ProgramEntries& programs, const std::string& prefix,
                      Description& out) const;
  Result<Remade> remake(const Driven& driven, const ProgramEntries& old);
  void commit(ProgramEntries& old, Remade remade);
  static Status check_inputs(const ProgramEntry& program, const Driven& driven, const ProgramEntries& before);
  void follow(ProgramEntry& program, const Driven& driven, const ProgramEntries& programs) const;
  void gather(Entities entities);
  bool is_due(const ProgramEntry& entry, Time now, bool control_step) const;
  void plan_next_step(ProgramEntry& entry, Time now) const;
  /// @return whether one of them ended or failed
  bool step_batch(std::span<ProgramEntry* const> batch, Time now) const;
  void ask_again(ProgramEntry& entry, Time now);
  void submit_answer(const ProgramEntry& entry, OutsideAnswer answer);
  bool take_answers(ProgramEntry& entry);
  bool take_or_miss(ProgramEntry& entry);
  static void take(ProgramEntry& entry, Program::Resumed resumed);
  static Error failure_of(const ProgramEntry& entry, Time now);
  void prefetch_orders(std::size_t i) const;
  void deliver_sample(ProgramEntry& program, const Command::Order& order, Time end, bool logged,
                      std::uint64_t source, const FindDevice& find_device);

  const model::Setup& setup_;
  DevicePools& devices_;
  Commands& commands_;
  std::vector<const ControllerKind*> kinds_;
  std::vector<Team> teams_;
  bool any_beyond_controllers_ = false;
  std::shared_ptr<const Description> described_;  ///< the latest
  /// All programs in entity order, then the teams'; those that run at every control step, kind by kind; those that may be
  /// due at other times; those with topics.
  std::vector<ProgramEntry*> all_, running_, timed_, publishing_;
  std::vector<ProgramEntry*> outside_,
      awaited_,          ///< those that run outside; those of them that stepped in this tick, of processes
      awaited_clients_;  ///< and of clients
  bool connected_ = false;
  std::vector<std::uint64_t> sources_;  ///< per entry of all_: Source::id of its orders
  std::vector<ProgramEntry*> due_;
  bool changed_ = true;  ///< the lists above have to be made again
};

}  // namespace sandlot
