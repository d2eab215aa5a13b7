#pragma once
/// A run that people steer while it goes on: play, pause, step, speed, reset, rewind, jump.
///
///   Session session(std::move(simulation), {.pace = {1.0}});
///   session.add_observer(&viewer);
///   ... other threads: session.pause(); session.submit(request, source, done); session.post(task);
///   Status status = session.run(report, keep_going);      // returns when the run has ended or quit() was called
///
/// The wall clock decides when a tick happens, never what it does. What comes from outside enters through submit() at
/// tick boundaries and is logged, so a steered run can be recorded and replayed like any other.
///
/// Rewinding   snapshots are kept while the run goes on, and what came from outside since. A jump back restores one and
///             runs again up to the time asked for, with the same input: the world there is the same to the bit. What
///             had happened behind it is forgotten.
/// Worlds      a reset, a jump back and a load put another Simulation in place of the first: epoch() counts them, and
///             Options::on_world is told. References to the old one end there.
/// InputLog        input of a recording, given as Options::input_log: the run then is that recording's, ends where it ends, and
///             takes no other input.
/// Threads     run() belongs to one thread, the simulation's. Orders may come from any.
/// Cost        a lock per tick; a snapshot now and then: at most 2 % of the wall time, and `history_mb` of memory.
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sim/world/simulation.h"

namespace sandlot {

/// Speed of a run against the wall clock.
struct Pace {
  /// Real time x factor; unset: as fast as possible, and real time for a setup with a continuous clock.
  std::optional<double> factor;
};

/// Totals of Session::run().
struct RunReport {
  std::uint64_t ticks = 0;
  double wall_s = 0;
  double sim_s = 0;
  /// Ticks that began more than one step behind the clock; of a continuous clock, ticks cut to the longest step.
  std::uint64_t late_ticks = 0;
  Time shortest, longest;  ///< tick
};

/// Input log: all input from outside by the tick that carried it out. Together with a first state it gives the same run.
struct InputLog {
  std::map<std::uint64_t, std::vector<LogEntry>> entries;
  std::uint64_t last_tick = 0;  ///< last tick of the log
  Time end;                     ///< time of that tick
};

class Session {
 public:
  enum class State : std::uint8_t {
    playing,
    paused,
    seeking,  ///< on its way to where jump() asked for, as fast as it can
    ended,    ///< it has a reason to stop; a jump back goes on from there
    failed,   ///< a tick failed
  };
  struct Options {
    Pace pace;
    bool paused = false;  ///< begins so
    bool stay = false;    ///< when the run ends by itself, wait for orders instead of returning from run()
    double history_mb = 256;     ///< memory for snapshots to rewind to; 0: none
    double history_every_s = 1;  ///< simulated time between two, at least; more as the run becomes long
    SimulationOptions simulation = {};  ///< for the worlds that follow the first
    std::optional<InputLog> input_log = {};
    std::string may_not_rewind = {};  ///< not empty: why reset, load and jumps back are refused
    /// Called on the simulation's thread when another world has come; `why`: "reset", "rewound to 3 s", "loaded".
    std::function<void(Simulation& world, const std::string& why)> on_world = {};
    /// Does a tick, with everything around it; unset: Simulation::tick().
    std::function<Status(Simulation& world, std::optional<Time> measured)> tick = {};
  };
  Session(std::unique_ptr<Simulation> simulation, Options options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // --- orders, from any thread; they act between two ticks ---
  void play();
  void pause();
  /// Exactly so many ticks, then pause. @pre ticks > 0
  void step(std::uint64_t ticks = 1);
  /// Real time x factor; nothing: as fast as possible. Errors: not in 0.001 to 1000.
  Status set_speed(std::optional<double> factor);
  /// To the first state; goes on playing if it was. Errors: the run may not be rewound.
  Status reset();
  /// To the first tick not before a simulated time: back, from a snapshot; forward, by running as fast as possible. Then
  /// playing or paused as before. Errors: before the beginning, or behind the end of a tape; back, where that is not allowed.
  Status jump(Time to);
  /// Replaces the world by that of a snapshot, which a later reset goes back to. Of several that wait the last one counts.
  /// `done` is called once: on the simulation's thread, or here when the run has ended.
  void load(std::vector<std::byte> snapshot, std::function<void(const Status&)> done);
  /// Ends run().
  void quit();

  /// What became of a request, on the simulation's thread.
  using Done = std::function<void(const Status&)>;
  /// Queues a request for the next tick. @return its sequence number; an error at once when the run takes no input now.
  /// While the run is paused the request waits.
  Result<std::uint64_t> submit(Request request, Source source = {}, Done done = {});

  /// Calls `task` on the simulation's thread, between two ticks, also while the run is paused. False: too many wait, or
  /// run() has returned; it will not be called then.
  bool post(std::function<void(Session&)> task);

  struct Report {
    State state = State::playing;
    Time now, step, begin;
    std::optional<Time> end;  ///< where it will stop by itself
    std::uint64_t tick = 0, epoch = 1, revision = 0;
    std::optional<double> speed;
    double real_time_factor = 0;  ///< over the last second or so; 0 when paused
    std::uint64_t late_ticks = 0;
    std::string reason;          ///< why it ended or failed
    std::optional<Time> target;  ///< of a jump
    std::vector<Time> history;   ///< times of the snapshots kept, ascending
    std::string takes_no_input;  ///< not empty: why requests are refused now
    std::string may_not_rewind;
    bool replay = false;
  };
  /// From any thread.
  Report report() const;
  /// Called when the state of the run has changed, or an order was given, on the thread where that happened. It must not
  /// block, nor call the session. Set it before run().
  std::function<void()> on_change;

  // --- on the simulation's thread, or before run() ---
  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }
  std::uint64_t epoch() const { return epoch_; }
  /// It runs again what had happened before; input comes from the tape, and nobody should add any.
  bool rerunning() const { return simulation_->tick_index() < rerun_until_; }
  /// For this and all following worlds.
  void add_observer(Observer* observer);
  void remove_observer(Observer* observer);
  /// Runs until the end, quit(), or `keep_going` (asked after each tick and at least 10 times a second) says no.
  Status run(RunReport& report, const std::function<bool(const Simulation&)>& keep_going = {});

 private:
  struct Kept {
    std::uint64_t tick = 0;
    Time now;
    std::vector<std::byte> bytes;
  };
  struct Input;
  struct Pacer;
  struct Load {
    std::vector<std::byte> bytes;
    std::function<void(const Status&)> done;
  };

  void order(const std::function<void()>& give);
  bool woken() const;
  Status may_rewind() const;
  Status advance(std::optional<Time> measured, RunReport& report);
  std::optional<Time> feed_input_log();
  /// Carries out what waits; unlocks meanwhile. @return whether it did something
  bool obey(std::unique_lock<std::mutex>& lock);
  Status go_back(Time to);
  Status replace(std::span<const std::byte> bytes, const std::string& why);
  static void refuse_loads(std::vector<Load> loads, const char* why);
  std::string why_no_input() const;
  void forget_future();
  void keep_snapshot();
  void run_tasks(std::chrono::milliseconds patience);
  void answer_outcomes();
  void set_state(State state);
  void refresh_report();

  Options options_;
  std::unique_ptr<Simulation> simulation_;  ///< replaced under the mutex
  std::vector<Observer*> observers_;
  std::unique_ptr<Input> input_;
  std::uint64_t epoch_ = 1;
  InputLog past_;             ///< what came from outside since the first state kept; or the recording's
  std::deque<Kept> history_;  ///< ascending; the first is where the run began
  std::size_t history_bytes_ = 0;
  double history_gap_s_ = 1, snapshot_cost_s_ = 0, snapshot_at_s_ = -1e9;  ///< wall clock
  std::uint64_t rerun_until_ = 0;                                          ///< tick
  Status status_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded:
  std::map<std::uint64_t, Done> waiting_;  ///< by sequence number
  bool playing_ = true, seeking_ = false, reset_ = false, quit_ = false, running_ = true, woken_ = false;
  std::uint64_t steps_left_ = 0;
  Pace pace_;
  std::optional<Time> jump_, target_;
  std::vector<Load> loads_;
  std::deque<std::function<void(Session&)>> tasks_;
  Report report_;
};

}  // namespace sandlot
