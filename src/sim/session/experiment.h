#pragma once
/// Experiments in C++: functions of the user's own around a run.
///
/// Order         on_start once, before the first tick. Then for each tick: scheduled lines that are due, before_tick, the
///               tick, on_contact for each pair that touches, on_event for what happened in it, after_tick. on_end once.
/// Determinism   hooks are called on the thread that ticks, in a fixed order. What they do to the world goes through
///               Simulation::submit() or command(), takes effect in the next tick and is logged, so that a recording
///               replays without them. Draw random numbers from a Stream, never from elsewhere.
/// State         hooks keep their own; a snapshot does not hold it.
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

class Experiment;

/// Two things that touch after a tick: one call per pair, in order of their creation.
struct Touch {
  std::string a, b;  ///< names of instances, `a` created before `b`
  Vec3 point_W;      ///< [m] where they overlap most, at the last sub-step of the tick
  Vec3 normal_W;     ///< unit, from a towards b
  double depth_m = 0;
  bool began = false;  ///< they did not touch after the tick before
};

/// A line that people and programs may say to a running experiment: "kick ball 3".
struct ConsoleCommand {
  std::string name, help;
  /// @param words  what follows the name. @return what to answer
  std::function<Result<std::string>(Experiment&, std::span<const std::string> words)> act;
};

/// All are optional.
struct Hooks {
  std::function<Status(Experiment&)> on_start, before_tick, after_tick, on_end;
  std::function<Status(Experiment&, const Touch&)> on_contact;
  std::function<Status(Experiment&, const std::string& name)> on_event;
  std::vector<ConsoleCommand> commands;
  std::vector<const ControllerKind*> controllers;  ///< kinds of the program's own, known to scenarios
};

class Experiment {
 public:
  /// `sim` must outlive the experiment.
  Experiment(Simulation& sim, const Hooks& hooks) : sim_(sim), hooks_(hooks) {}
  Simulation& simulation() { return sim_; }
  const Simulation& simulation() const { return sim_; }
  std::span<const ConsoleCommand> commands() const { return hooks_.commands; }

  Status start();
  /// One tick with everything around it; arguments as Simulation::tick().
  Status tick(std::optional<Time> measured = std::nullopt);
  Status finish();

  /// A named event; on_event sees it after the tick that runs now or comes next, after those of the scenario.
  void emit(std::string name) { emitted_.push_back(std::move(name)); }
  /// Does what a line says: a command's name and its words, parted by blanks; "..." keeps blanks.
  Result<std::string> execute(std::string_view line);
  /// "at 2s kick ball": the line is executed before the first tick that begins at that time or later. Without
  /// "at TIME": before the first tick. Commands that are not there are an error now.
  Status schedule(std::string_view text);
  /// What scheduled lines answered, with their times, since this was last called.
  std::vector<std::string> take_answers() { return std::exchange(answers_, {}); }

 private:
  struct Line {
    Time at;
    std::string text;
  };
  template <class... Arguments>
  Status call(const char* name, const std::function<Status(Experiment&, Arguments...)>& hook,
              const std::type_identity_t<Arguments>&... arguments);
  Result<const ConsoleCommand*> find_command(const std::vector<std::string>& words) const;
  Status say_due_lines();
  Status report_contacts();
  Status report_events();

  Simulation& sim_;
  const Hooks& hooks_;
  std::vector<Line> lines_;  ///< in order of time
  std::vector<std::string> answers_, emitted_;
  std::vector<std::uint32_t> owner_;  ///< index of the entity that a body belongs to
  std::uint64_t owner_revision_ = ~std::uint64_t{0};
  /// Pairs that touched after the latest tick, by creation: numbers that stay when others are deleted.
  std::set<std::pair<std::uint64_t, std::uint64_t>> touching_;
};

}  // namespace sandlot
