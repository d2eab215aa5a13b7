#pragma once
/// RoBIOS: a program of EyeBot and EyeSim as a robot's controller, unchanged, in a process of its own.
///
///   controller: {kind: robios, program: wander.c}
///   controller: {kind: robios, program: chase.so, api: 6, slot: 20 ms, delays: off, supervisor: on}
///
/// Turns        by a memory that both sides share (robios/slot.h). The program senses and orders once per time slot: at the first
///              tick that ends at a slot's beginning or later it gets the turn, and the orders of its answer act in the tick in
///              which its slot ends. Slots count from the beginning of the run. Programs of several robots have their turns at once.
/// Waiting      a program that waits for a time or an event has no turn until the slot in which it comes, and costs nothing.
/// Senses       are those at the beginning of the turn, and orders wait for the end of the slot: no message and no picture comes
///              from the future, whatever slots the others have.
/// End          of the process, by itself, by a signal, or because it used more than `deadline` of wall time in a turn, which counts
///              as spinning: drive and motors stop, and the run goes on. Its last words are in the log.
/// Trust        none: orders are checked (robios/orders.h); it runs in a sandbox unless told otherwise (programs/sandbox.h).
/// Determinism  orders and ends are input from outside and logged: replays get them from there, without the process. Its real-time
///              clock is the one thing that it sees of this machine; what it makes of that is in its orders.
/// State        what it waits for, what has come for it, orders that do not act yet, its own odometry, numbers of turns and
///              refused orders.
/// Limits       1000 orders and 4 MB a turn; 200 lines of its output are logged per turn. Robots are numbered in the order of their
///              creation; when one is deleted, those behind it move up. Of a radio that samples more often than the run has control
///              steps, messages in between are lost. Moves of a supervisor, and gains of VWStartControl, act at the
///              beginning of its slot.
/// Cost         two switches of processes per turn.
#include "programs/output_file.h"
#include "programs/outside_program.h"
#include "programs/process_tree.h"
#include "programs/robios/robot.h"
#include "programs/robios/shared_memory.h"
#include "programs/sandbox.h"

namespace sandlot::programs::robios {

class Robios final : public OutsideProgram<Spec, State>, public Surrounded {
 public:
  Status init(const Description& robot, const Node& config, Outputs& out) override;
  Resumed resume(const Observation& obs, Command& cmd) override;
  Resumed answer(const OutsideAnswer& answer, std::span<const TopicBase* const> forms, Command& cmd) override;

  Status connect() override;
  bool connected() const override { return child_.has_value(); }
  bool connects_again() const override {
    return spec_.after_restore == AfterRestore::restart && state_.ended == 0;
  }
  bool expects_answer() const override { return child_ && (waiting_ || begins_anew_); }
  Clock::time_point deadline() const override { return deadline_; }
  void watched(std::vector<Watched>& out) const override;
  Result<bool> keep_output(const std::string& folder) override;
  void adopt(Outside& before) override;
  std::optional<OutsideAnswer> receive() override;
  void load(ByteReader& r) override;

  void describe(std::vector<DeviceFacts> devices, Time tick) override {
    facts_ = std::move(devices);
    tick_ = tick;
  }
  bool looks_around() const override { return spec_.supervisor && connected(); }
  void see(std::span<const Being> beings) override { beings_.assign(beings.begin(), beings.end()); }
  void meet(std::span<const Being> beings) override;
  bool await(Clock::time_point until) override;
  std::vector<Move> take_moves() override { return std::move(moves_); }
  std::vector<Setting> take_settings() override { return std::move(settings_); }

 private:
  std::int64_t slot_ns() const;
  std::int64_t acting_ns() const;
  void take_messages(const Observation& obs);
  bool is_due(const Observation& obs) const;
  Resumed wait_on() const;
  void fill(const Observation& obs);
  void give_turn(const Observation& obs);
  void request_changes(std::span<const std::byte> orders);
  void carry_out(std::span<const std::byte> orders, Command& cmd);
  Resumed ended(std::uint8_t how, Command& cmd);
  void move_output();
  OutsideAnswer leave(std::string why);
  std::optional<std::string> over_budget();

  std::string path_;  ///< "rover/brain"
  Description robot_;
  std::vector<DeviceFacts> facts_;
  RobotDevices devices_;
  Time tick_;

  // The process; none of it is State.
  std::optional<SharedMemory> memory_;
  std::optional<Child> child_;
  bool waiting_ = false, halted_ = false, answered_ = false;
  bool begins_anew_ = false;  ///< where another process had got to a time or event that it waits for
  Clock::time_point deadline_, begun_, measured_;
  std::chrono::microseconds slice_{};
  std::uint64_t sent_pictures_ = 0;
  std::vector<Being> beings_;
  std::vector<Move> moves_;
  std::vector<Setting> settings_;
  std::vector<std::string> last_words_;
  OutputFile output_;
  std::size_t lines_ = 0;  ///< of output in this turn
  ProcessMeter meter_;
};

}  // namespace sandlot::programs::robios
