#pragma once
/// A run that people steer while it goes on: play, pause, step, speed, reset, rewind, jump.
///
///   Session session(std::move(simulation), {.pace = {1.0}});
///   session.add_observer(&viewer);
///   ... other threads: session.pause(); session.submit(request, source, done); session.post(task);
///   Status status = session.run(report, keep_going);      // returns when the run has ended or quit() was called
///
/// The wall clock decides when a tick happens, never what it does. What comes from outside enters through submit() at tick
/// boundaries and is logged, so a steered run can be recorded and replayed like any other.
///
/// Rewinding   snapshots are kept while the run goes on, and what came from outside since. A jump back restores one and runs
///             again up to the time asked for, with the same input: the world there is the same to the bit. What had happened
///             behind it is forgotten once the run goes on from there.
/// Worlds      a reset, a jump back and a load put another Simulation in place of the first: epoch() counts them, and
///             Options::on_world is told. References to the old one end there.
/// Tape        input of a recording, given as Options::tape: the run then is that recording's, ends where it ends, and takes
///             no other input.
/// Threads     run() belongs to one thread, the simulation's. "Any thread" below means just that.
/// Cost        a lock per tick; a snapshot now and then: at most 2 % of the wall time, and `history_mb` of memory.
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sim/experiment.h"
#include "sim/runner.h"
#include "sim/simulation.h"

namespace sandlot {

/// What came from outside, by the tick that it entered: with a state it makes the same run again.
struct Tape {
  std::map<std::uint64_t, std::vector<LogEntry>> entries;  ///< by the tick that carries them out
  std::uint64_t last_tick = 0;                             ///< where it ends
  Time end;
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
    double history_mb = 256;  ///< memory for snapshots to rewind to; 0: none
    double history_every_s =
        1;  ///< simulated time between two, at least; further apart as the run becomes long
    SimulationOptions simulation = {};  ///< for the worlds that follow the first
    std::optional<Tape> tape;
    std::string may_not_rewind;  ///< not empty: why reset and jumps back are refused
    /// Called on the simulation's thread before the first tick of a new world; `from` is why: "reset", "rewound to 3 s".
    std::function<Status(Simulation& world, const std::string& from)> on_world;
    /// Does a tick, with everything around it; unset: Simulation::tick().
    std::function<Status(Simulation& world, std::optional<Time> measured)> tick;
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
  /// To the first state. The run is paused if it was, else it goes on. Errors: the run may not be rewound.
  Status reset();
  /// To a simulated time: back, from a snapshot; forward, by running as fast as possible. Then as it was: playing or paused.
  /// Errors: before the beginning, or behind the end of a tape; back, where that is not allowed.
  Status jump(Time to);
  /// Replaces the world by that of a snapshot (kept for a later reset as well). The answer comes when it was done.
  void load(std::vector<std::byte> snapshot, std::function<void(Status)> done);
  /// Ends run().
  void quit();

  /// What became of a request, on the simulation's thread.
  using Done = std::function<void(const Status&)>;
  /// Queues a request for the next tick. @return its sequence number; an error at once when the run takes no input.
  /// While the run is paused the request waits.
  Result<std::uint64_t> submit(Request request, Source source, Done done = {});

  /// Calls `task` on the simulation's thread, between two ticks, also while the run is paused. False: too many wait, or run() has
  /// returned; it will not be called then.
  bool post(std::function<void(Session&)> task);

  struct Report {
    State state = State::playing;
    Time now, step, begin;
    std::optional<Time> end;  ///< where it will stop by itself
    std::uint64_t tick = 0, epoch = 0, revision = 0;
    std::optional<double> speed;
    double real_time_factor = 0;  ///< over the last second or so; 0 when paused
    std::uint64_t late_ticks = 0;
    std::string reason;          ///< why it ended or failed
    std::optional<Time> target;  ///< of a jump
    std::vector<Time> history;   ///< times of the snapshots kept, ascending
    bool takes_input = true;
    std::string may_not_rewind;
    bool replay = false;
  };
  /// From any thread.
  Report report() const;
  /// Called after each order or change of state, on the thread that made it. Must not block.
  std::function<void()> on_change;

  // --- on the simulation's thread, or before run() ---
  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }
  std::uint64_t epoch() const { return epoch_; }
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
  struct Input;  ///< an observer that writes the tape of this run
  enum class Order : std::uint8_t { none, reset, jump, load };

  Status one_tick(std::optional<Time> measured);
  void feed_tape(std::optional<Time>& measured);
  Status obey(std::unique_lock<std::mutex>& lock);
  Status travel(Time to);
  Status replace(std::span<const std::byte> bytes, const std::string& from);
  void keep_snapshot();
  void thin_out();
  void run_tasks();
  void answer_outcomes();
  void publish_report();

  Options options_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<Observer*> observers_;
  std::unique_ptr<Input> input_;
  std::uint64_t epoch_ = 1;
  Tape past_;                 ///< what came from outside since the first state kept; or the recording's
  std::deque<Kept> history_;  ///< ascending; the first is where the run began
  std::size_t history_bytes_ = 0;
  double history_gap_s_ = 1;
  std::map<std::uint64_t, Done> waiting_;  ///< by sequence number

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  State state_ = State::playing;  ///< guarded, like all below
  bool playing_ = true;
  std::uint64_t steps_left_ = 0;
  Pace pace_;
  bool pace_changed_ = false, quit_ = false, running_ = true;
  Order order_ = Order::none;
  Time target_;
  std::vector<std::byte> to_load_;
  std::function<void(Status)> loaded_;
  std::vector<std::function<void(Session&)>> tasks_;
  Report report_;
};

}  // namespace sandlot
