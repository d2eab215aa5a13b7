#pragma once
/// Run hooks: functions of a user's C++ program that are called around each tick of a run, and its console commands.
///
/// Order         on_start once, before the first tick. Then for each tick: before_tick, the tick, on_contact for each
///               pair that touches, on_event for each event of the tick, after_tick. on_end once.
/// Determinism   hooks are called on the thread that ticks, in a fixed order. What they do to the world goes through
///               Simulation::submit() or command(), takes effect in the next tick and is logged, so that a recording
///               replays without them. Draw random numbers from a Stream, never from elsewhere.
/// State         hooks keep their own state, outside of the simulation's. A run is reset and rewound where Hooks::save and load
///               write and read that state, or Hooks::stateless says that there is none. The ticks on the way to the target call
///               the hooks and commands again; what they request there is ignored, because the input log has it. After a reset on_start is
///               called as at the beginning, after load() of the state from before it.
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

/// Key of the page that runs a line of the console.
struct KeyBinding {
  std::string key;   ///< as the browser names it, in lower case: "k", "f2", "arrowup", "ctrl+k"
  std::string line;  ///< "kick ball 3"; any line that the console takes
  std::string help;  ///< for the page's sheet of keys
};

/// Functions of the user's program. All are optional.
struct Hooks {
  std::function<Status(RunHooks&)> on_start, before_tick, after_tick, on_end;
  std::function<Status(RunHooks&, const Touch&)> on_contact;
  std::function<Status(RunHooks&, const std::string& name)> on_event;
  std::vector<HookCommand> commands;
  /// State of the hooks, both or neither: written to bytes and read back. See keep().
  std::function<void(ByteWriter&)> save;
  std::function<void(ByteReader&)> load;
  bool stateless = false;                          ///< the hooks remember nothing from tick to tick
  std::vector<const ControllerKind*> controllers;  ///< controller kinds of the program, known to scenarios

  /// Saves and loads a value or a struct with a field list. @pre it outlives the hooks
  template <class T>
  void keep(T& state) {
    save = [&state](ByteWriter& w) { write(w, state); };
    load = [&state](ByteReader& r) { read(r, state); };
  }
  /// "": a run with these hooks can be rewound.
  std::string may_not_rewind() const;
};

class RunHooks {
 public:
  /// @pre both outlive this object; a simulation that replaces the first by replace()
  RunHooks(Simulation& sim, const Hooks& hooks) : sim_(&sim), hooks_(hooks) {}
  /// The present one: another after a reset or a jump back.
  Simulation& simulation() { return *sim_; }
  const Simulation& simulation() const { return *sim_; }
  std::span<const HookCommand> commands() const { return hooks_.commands; }

  Status start();
  /// One tick with the hooks around it; argument as Simulation::tick().
  /// @param repeats  the input of the tick is in the log of the run: what hooks request for it is dropped
  Status tick(std::optional<Time> measured = std::nullopt, bool repeats = false);
  Status finish();

  /// Emits a named event: on_event is called for it after the present or next tick, after the events of the scenario.
  void emit(std::string name) { emitted_.push_back(std::move(name)); }
  /// Binds a key of the page to a line of the console; to be called by on_start. Keys that the page needs itself stay what they are.
  /// Errors: no key, no line, or a key that is bound already to another line.
  Status bind(std::string key, std::string line, std::string help);
  std::span<const KeyBinding> bindings() const { return bindings_; }

  // --- runs that are rewound ---
  void replace(Simulation& sim);
  /// State of the hooks, and what has been seen of contacts and events.
  std::vector<std::byte> save() const;
  /// @param saved  by save(); empty: the beginning, for which on_start is called again
  Status load(std::span<const std::byte> saved);

  /// Runs a line: the name of a command and its words, separated by blanks; "..." keeps blanks.
  Result<std::string> execute(std::string_view line);

 private:
  template <class... Arguments>
  Status call(const char* name, const std::function<Status(RunHooks&, Arguments...)>& hook,
              const std::type_identity_t<Arguments>&... arguments);
  Result<std::string> act(std::string_view line);
  void repeat_lines();
  void forget_future_lines();
  Result<const HookCommand*> find_command(const std::vector<std::string>& words) const;
  Status report_contacts();
  Status report_events();

  Simulation* sim_;
  const Hooks& hooks_;
  std::vector<KeyBinding> bindings_;
  std::vector<std::byte> first_;  ///< state of the hooks before on_start
  /// Lines that came from outside of the hooks, by the tick after which they came; those from next_line_ on are of a future that
  /// was left.
  struct Line {
    std::uint64_t tick = 0;
    std::string text;
  };
  std::vector<Line> lines_;
  std::size_t next_line_ = 0;
  bool inside_ = false;  ///< a hook or a command is at work
  std::vector<std::string> emitted_;
  std::vector<std::uint32_t> owner_;  ///< per body: index of its entity
  std::uint64_t owner_revision_ = ~std::uint64_t{0};
  /// Pairs that touched after the latest tick, by serial number, which is never used again.
  std::set<std::pair<std::uint64_t, std::uint64_t>> touching_;
};

}  // namespace sandlot
