#pragma once
/// Run hooks: functions of a user's C++ program that are called around each tick of a run, and its console commands.
///
/// Order         on_start once, before the first tick. Then for each tick: before_tick, the tick, on_contact for each
///               pair that touches, on_event for each event of the tick, after_tick. on_end once.
/// Determinism   hooks are called on the thread that ticks, in a fixed order. What they do to the world goes through
///               Simulation::submit() or command(), takes effect in the next tick and is logged, so that a recording
///               replays without them. Draw random numbers from a Stream, never from elsewhere.
/// State         hooks keep their own state; it is not part of snapshots, so a run with hooks cannot be rewound.
/// Errors        a hook that returns an error, or throws, ends the run with exit code 1; results so far are kept.
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/world/simulation.h"

namespace sandlot {

class RunHooks;

/// Contact of two instances after a tick: one per pair, in order of their creation.
struct Touch {
  std::string a, b;  ///< names of instances, `a` created before `b`
  Vec3 point_W;      ///< [m] point of the deepest overlap, at the last sub-step of the tick
  Vec3 normal_W;     ///< unit, from a towards b
  double depth_m = 0;
  bool began = false;  ///< they did not touch after the previous tick
};

/// Console command of the user's program: "kick ball 3". Known wherever console commands are typed or scheduled.
struct HookCommand {
  std::string name, help;
  /// @param words  the words that follow the name. @return the answer
  std::function<Result<std::string>(RunHooks&, std::span<const std::string> words)> act;
};

/// Functions of the user's program. All are optional.
struct Hooks {
  std::function<Status(RunHooks&)> on_start, before_tick, after_tick, on_end;
  std::function<Status(RunHooks&, const Touch&)> on_contact;
  std::function<Status(RunHooks&, const std::string& name)> on_event;
  std::vector<HookCommand> commands;
  std::vector<const ControllerKind*> controllers;  ///< controller kinds of the program, known to scenarios
};

class RunHooks {
 public:
  /// @pre both outlive this object
  RunHooks(Simulation& sim, const Hooks& hooks) : sim_(sim), hooks_(hooks) {}
  Simulation& simulation() { return sim_; }
  const Simulation& simulation() const { return sim_; }
  std::span<const HookCommand> commands() const { return hooks_.commands; }

  Status start();
  /// One tick with the hooks around it; argument as Simulation::tick().
  Status tick(std::optional<Time> measured = std::nullopt);
  Status finish();

  /// Emits a named event: on_event is called for it after the present or next tick, after the events of the scenario.
  void emit(std::string name) { emitted_.push_back(std::move(name)); }
  /// Runs a line: the name of a command and its words, separated by blanks; "..." keeps blanks.
  Result<std::string> execute(std::string_view line);

 private:
  template <class... Arguments>
  Status call(const char* name, const std::function<Status(RunHooks&, Arguments...)>& hook,
              const std::type_identity_t<Arguments>&... arguments);
  Result<const HookCommand*> find_command(const std::vector<std::string>& words) const;
  Status report_contacts();
  Status report_events();

  Simulation& sim_;
  const Hooks& hooks_;
  std::vector<std::string> emitted_;
  std::vector<std::uint32_t> owner_;  ///< per body: index of its entity
  std::uint64_t owner_revision_ = ~std::uint64_t{0};
  /// Pairs that touched after the latest tick, by serial number, which is never used again.
  std::set<std::pair<std::uint64_t, std::uint64_t>> touching_;
};

}  // namespace sandlot
