#pragma once
/// Session: one run of a simulation that can be paused, stepped, sped up, reset and rewound while it goes on.
///
///   Session session(std::move(simulation), {.pace = {1.0}});
///   session.add_observer(&viewer);
///   ... other threads: session.pause(); session.submit(request, source, done); session.post(task);
///   Status status = session.run(report, keep_going);      // returns when the run has ended or quit() was called
///
/// The wall clock decides when a tick happens, never its result. Input from outside enters through submit() between two
/// ticks and is logged, so that a steered run can be recorded and replayed like any other.
///
/// Orders      act between two ticks, in this order: quit; a load; a reset; a jump; then play, pause, step and speed.
///               play     ticks at the speed, until a pause
///               step     exactly so many ticks without waiting, then pause
///               jump     ticks without waiting until the target ("seeking"), then as before: playing or paused
///             pause, step and reset end a jump that is under way. See Session::next_step().
/// Rewinding   snapshots are kept while the run goes on, and the input since. A jump back restores one and runs again up
///             to the target with the same input: the world there is the same to the bit. The history after the
///             target is dropped. Snapshots are thinned out where they become too much; where the input does, the oldest part of
///             the history is forgotten: the run then goes back to kept_from at most, or by a reset to its beginning.
/// Worlds      a reset, a jump back and a load replace the Simulation by another one: epoch() counts them, and
///             Options::on_world is called. References to the old one become invalid there.
/// Input log   of a recording, given as Options::input_log: the run repeats the recording, ends where it ends, and takes no
///             other input.
/// Threads     run() belongs to one thread, the simulation's. Orders may come from any thread.
/// Cost        a lock per tick; a snapshot now and then: `history_share` of the wall time, and twice `history_mb` of memory.
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sim/session/step_times.h"
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

  /// Sets the input of a tick, in place of what there was; empty: none.
  void set(std::uint64_t tick, std::vector<LogEntry> input);
  void forget_before(std::uint64_t tick);
  void forget_after(std::uint64_t tick);
  /// Memory of the entries that came by set(), near enough to hold a limit. Bytes
  std::size_t size() const { return size_; }

 private:
  using Entries = std::map<std::uint64_t, std::vector<LogEntry>>;
  void forget(Entries::iterator first, Entries::iterator last);
  std::size_t size_ = 0;
};

class Session {
 public:
  enum class State : std::uint8_t {
    playing,
    paused,
    seeking,  ///< on its way to the target of a jump, as fast as possible
    ended,    ///< it has a reason to stop; a jump back continues from there
    failed,   ///< a tick failed
  };
  static const char* name_of(State state);
  struct Options {
    Pace pace;
    bool paused = false;  ///< begins paused
    bool stay = false;    ///< when the run ends by itself, wait for orders instead of returning from run()
    double history_mb =
        256;  ///< memory for snapshots to rewind to, and for the input since as much again; 0: none
    double history_every_s = 1;  ///< simulated time between two, at least; more as the run becomes long
    double history_share =
        0.02;  ///< of the wall time, that snapshots may take; infinite: one whenever it is due
    SimulationOptions simulation = {};       ///< for the worlds that follow the first
    std::optional<InputLog> input_log = {};  ///< input of a recording to repeat
    std::string may_not_rewind = {};         ///< not empty: why reset, load and jumps back are refused
    std::string may_not_load = {};           ///< not empty: why a snapshot of another run is refused
    /// State beside the simulation's (run hooks): kept with each snapshot, given back with it. A jump back repeats one tick at
    /// least, because what such state has requested for the next tick is in no snapshot; the beginning is given back as empty.
    std::function<std::vector<std::byte>()> save_beside = {};
    std::function<void(std::span<const std::byte> saved)> load_beside = {};
    /// Called on the simulation's thread when the world was replaced; `why`: "reset", "rewound to 3 s", "loaded".
    std::function<void(Simulation& world, const std::string& why)> on_world = {};
    /// Runs one tick with everything around it; unset: Simulation::tick().
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
  /// playing or paused as before. Errors: before the beginning or after the end; back, where that is not allowed.
  Status jump(Time to);
  /// Replaces the world by that of a snapshot, which a later reset returns to. Of several pending loads the last one counts.
  /// `done` is called once: on the simulation's thread, or here when the run has ended.
  void load(std::vector<std::byte> snapshot, std::function<void(const Status&)> done);
  /// Ends run().
  void quit();

  /// Receives the outcome of a request, on the simulation's thread.
  using Done = std::function<void(const Status&)>;
  /// Queues a request for the next tick. @return its sequence number; an error at once when the run takes no input now.
  /// While the run is paused the request waits.
  Result<std::uint64_t> submit(Request request, Source source = {}, Done done = {});
  /// As above for a call of a device's service: `answer` receives the response in CDR, or why there is none.
  using Answer = std::function<void(const Result<std::vector<std::byte>>&)>;
  Result<std::uint64_t> call(CallRequest request, Source source, Answer answer);

  /// Has the loop look again whether what it waits for has come: a client's answer.
  void wake();
  /// Calls `task` on the simulation's thread, between two ticks, also while the run is paused. False: too many wait, or
  /// run() has returned; it will not be called then.
  bool post(std::function<void(Session&)> task);

  struct Report {
    State state = State::playing;
    Time now, step, begin;
    Time kept_from;           ///< jumps back reach it; it is `begin` until the history becomes too large
    std::optional<Time> end;  ///< time at which it will stop by itself
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
  /// Called when the state of the run has changed or an order was given, on the thread where that happened. It must not
  /// block, nor call the session. Set it before run().
  std::function<void()> on_change;

  // --- on the simulation's thread, or before run() ---
  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }
  std::uint64_t epoch() const { return epoch_; }
  /// Whether it came while the run went on.
  bool is_spawned(const Simulation::Entity& entity) const { return entity.serial >= first_serials_; }
  /// For the worlds that follow the first.
  const SimulationOptions& simulation_options() const { return options_.simulation; }
  /// The run repeats ticks from before a jump back: its input comes from the log, and no other should be added.
  bool rerunning() const { return simulation_->tick_index() < rerun_until_; }
  /// For this and all following worlds.
  void add_observer(Observer* observer);
  void remove_observer(Observer* observer);
  void add_step_observer(StepObserver* observer) { step_observers_.push_back(observer); }
  void remove_step_observer(StepObserver* observer);
  /// Runs until the end, quit(), or `keep_going` (called after each tick and at least 10 times a second) returns false.
  Status run(RunReport& report, const std::function<bool(const Simulation&)>& keep_going = {});

 private:
  /// Snapshot to rewind to.
  struct Kept {
    std::uint64_t tick = 0;
    Time now;
    std::vector<std::byte> bytes;
    std::vector<std::byte> beside = {};  ///< of Options::save_beside
    std::size_t size() const { return bytes.size() + beside.size(); }
  };
  struct InputRecorder;
  struct Pacer;
  struct Load {
    std::vector<std::byte> bytes;
    std::function<void(const Status&)> done;
  };
  /// Orders that replace the world or move the run in time; carried out between two ticks by process_order().
  struct Pending {
    std::vector<Load> loads;
    bool reset = false;
    std::optional<Time> jump;
    bool any() const { return !loads.empty() || reset || jump; }
  };
  /// What the run does while no order is pending and it seeks nothing.
  enum class Mode : std::uint8_t { paused, playing, stepping };
  /// Whether the run is on its way to `target_`.
  enum class Seek : std::uint8_t {
    none,
    active,
    cancelled,  ///< by an order from another thread; the simulation's thread has to forget the future still
  };
  /// What the loop of run() does next.
  enum class Step : std::uint8_t { leave, process_order, end_seek, end, pause, tick };

  // session.cpp: orders and reports
  void post_order(const std::function<void()>& apply);
  void cancel_seek();
  void stop_stepping();
  Status may_rewind() const;
  std::string why_no_input() const;
  void set_state(State state);
  void refresh_report();

  // session_loop.cpp: the loop
  Step next_step() const;
  bool is_over() const;
  void process_order();
  Status load_last(std::vector<Load> loads);
  Status reset_world();
  void clear_end();
  void drop_target();
  void end_seek();
  void end_run();
  void wait_for_order();
  bool wait_until_due(Pacer& pacer, RunReport& report, std::optional<Time>& measured);
  void run_tick(Pacer& pacer, RunReport& report, std::optional<Time> measured);
  void report_step(Time before, std::chrono::steady_clock::time_point begin);
  void end_stretch();
  Status advance(std::optional<Time> measured, RunReport& report);
  void note_first_entities();
  void run_tasks(std::chrono::milliseconds patience);
  void answer_outcomes();
  void answer_the_rest();

  // session_history.cpp: snapshots and input
  std::optional<Time> feed_input_log();
  Status go_back(Time to);
  Status replace(std::span<const std::byte> bytes, const std::string& why);
  Status restore_kept(std::size_t index, const std::string& why);
  void forget_future();
  void keep_snapshot();
  void keep_within_limits();
  Time kept_from() const;
  Status may_go_back(Time to) const;
  static Error forgotten_before(Time kept_from);

  Options options_;
  std::unique_ptr<Simulation> simulation_;  ///< replaced under the mutex
  std::vector<Observer*> observers_;
  std::vector<StepObserver*> step_observers_;
  std::optional<std::chrono::steady_clock::time_point>
      step_end_;                                   ///< of the tick before; unset: a stretch begins
  std::unique_ptr<InputRecorder> input_recorder_;  ///< null for a run with an input log
  std::uint64_t epoch_ = 1;
  std::uint64_t first_serials_ = 0;  ///< entities of the beginning have serials below it
  InputLog past_;                    ///< input since kept_from(); or the recording's
  std::deque<Kept> history_;         ///< ascending; the first is the beginning of the run
  std::size_t history_bytes_ = 0;
  bool begins_late_ = false;  ///< input between the first and the second snapshot was forgotten
  double history_gap_s_ = 1, snapshot_cost_s_ = 0, snapshot_at_s_ = -1e9;  ///< wall clock
  std::uint64_t rerun_until_ = 0;                                          ///< tick
  Status status_;                                                          ///< of the latest tick

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  Mode mode_ = Mode::playing;
  Seek seek_ = Seek::none;
  std::optional<Time> target_;    ///< of the jump under way
  std::uint64_t steps_left_ = 0;  ///< > 0 while mode_ is stepping
  Pending pending_;
  bool quit_ = false, running_ = true;
  bool woken_ = false;  ///< something came that the loop must look at before it sleeps
  Pace pace_;
  using Waiting = std::function<void(const Outcome&)>;
  Result<std::uint64_t> submit_waiting(Request request, Source source, Waiting waiting);
  std::map<std::uint64_t, Waiting> waiting_;  ///< by sequence number
  std::deque<std::function<void(Session&)>> tasks_;
  Report report_;
};

}  // namespace sandlot
