#pragma once
/// Program: anything that decides for a robot or a team. It is resumed and returns what it waits for next: its control step, a
/// time, a message, an answer from outside, or nothing more.
///
/// A controller is a program that steps in this process (ControllerProgram). The other kinds are one folder under programs/
/// and one line in programs/kinds.h each; their names share the scenario's key `controller` with those of controllers. A
/// program whose decisions are made outside this process implements Outside in addition.
///
/// Outside   resume() sends what the program observes, without waiting. The simulation waits for all such programs in one
///           place, after the tick, and turns what came into input of the next tick: a line that came, or that none came in
///           time. That input is logged; answer() alone acts on it. A replay has no outside: answer() gets the same from
///           the log, so that the run is the same.
/// State     follows from resume() and answer() alone, never from whether the outside is connected.
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "control/controller.h"

namespace sandlot {

/// What came from outside for a program.
struct OutsideAnswer {
  enum class Kind : std::uint8_t {
    message,  ///< `bytes` are what the outside sent
    missed,   ///< nothing came until the deadline
    gone,     ///< the outside has ended: nothing will come any more; `bytes` are the reason as text
    late,     ///< `bytes` answer an earlier step, whose deadline was over; nothing answers this one
  } kind = Kind::message;
  std::vector<std::byte> bytes;

  static OutsideAnswer of(Kind kind, std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {kind, {bytes.begin(), bytes.end()}};
  }
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
};

/// The side of a program that runs outside this process: a child process, a connection. None of it is State.
///
/// Threads   the simulation's only; no call waits.
class Outside {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~Outside() = default;
  /// Starts or connects it. Errors: it cannot be started.
  virtual Status connect() = 0;
  virtual bool connected() const = 0;
  /// Whether connect() may be called for a run that was restored; false: the program stays without orders.
  virtual bool connects_again() const = 0;
  /// A client of a server answers, not a process that the run starts: what it needs to answer comes to it between two ticks,
  /// so that it is waited for before the next tick begins.
  virtual bool is_client() const { return false; }
  /// A client that who serves the run can start.
  virtual bool has_command() const { return false; }
  /// An observation was sent that is not answered yet.
  virtual bool expects_answer() const = 0;
  virtual Clock::time_point deadline() const = 0;
  /// File descriptors that become readable, or writable, when receive() has something to do.
  struct Watched {
    int descriptor = -1;
    bool writing = false;
  };
  virtual void watched(std::vector<Watched>& out) const = 0;
  /// Writes what its process prints to a file in the folder, too, from now on. Errors: the file cannot be written.
  /// @return false: it has no process of its own
  virtual Result<bool> keep_output(const std::string& /*folder*/) { return false; }
  /// Takes the connection over from a program that this one replaces.
  virtual void adopt(Outside& before) = 0;
  /// Moves data without waiting. @return the next answer that has come, never `missed`
  virtual std::optional<OutsideAnswer> receive() = 0;
};

class Program {
 public:
  enum class Waiting : std::uint8_t {
    control_step,
    time,     ///< the first tick that ends at `until` or later
    message,  ///< a new message of the reading
    outside,  ///< an answer, then what answer() returns
    nothing,  ///< it has ended
  };
  struct Resumed {
    Waiting waiting_for = Waiting::control_step;
    Time until = {};
    std::uint32_t reading = 0;                ///< index in the description
    std::optional<std::string> failure = {};  ///< why it cannot go on; ends the run
  };
  virtual ~Program() = default;
  /// Reads the configuration, resolves names and makes topics. Called once, before the first resume().
  virtual Status init(const Description& robot, const Node& config, Outputs& out) = 0;
  /// Lets the program run. Called in parallel with other programs. Of one that waited for its outside when the run was left, it
  /// is called again, once that is connected to the run that goes on: it sends what it observes, and what it returns is ignored.
  virtual Resumed resume(const Observation& obs, Command& cmd) = 0;
  /// Acts on what came from outside, at the beginning of a tick; orders act in the same tick.
  /// @param forms  per actuator an object of its message type; what it holds does not matter
  virtual Resumed answer(const OutsideAnswer&, [[maybe_unused]] std::span<const TopicBase* const> forms,
                         Command&) {
    return {};
  }
  /// Null: all of it runs in this process.
  virtual Outside* outside() { return nullptr; }
  virtual Status set_parameter(std::string_view path, const Node& value) = 0;
  /// A number of its parameters or state by its path, and all of them; none when it keeps them to itself.
  virtual ValueFound value(ValuePart, std::span<const ValueStep>) const { return {}; }
  virtual void list_values(ValuePart, const ValueVisit&) const {}
  virtual void save(ByteWriter& w) const = 0;
  virtual void load(ByteReader& r) = 0;
};

/// A kind of program that is not a controller of ControllerKind.
struct ProgramKind {
  const char* name;
  const char* help;
  std::vector<FieldInfo> (*describe)() = nullptr;
  std::unique_ptr<Program> (*create)() = nullptr;
};

/// A controller as a program: one step per resume.
class ControllerProgram final : public Program {
 public:
  explicit ControllerProgram(std::unique_ptr<Controller> controller) : controller_(std::move(controller)) {}
  Controller& controller() { return *controller_; }
  Status init(const Description& robot, const Node& config, Outputs& out) override {
    return controller_->init(robot, config, out);
  }
  Resumed resume(const Observation& obs, Command& cmd) override {
    return {.failure = caught([&] { controller_->step(obs, cmd); })};
  }
  Status set_parameter(std::string_view path, const Node& value) override {
    return controller_->set_parameter(path, value);
  }
  ValueFound value(ValuePart part, std::span<const ValueStep> path) const override {
    return controller_->value(part, path);
  }
  void list_values(ValuePart part, const ValueVisit& visit) const override {
    controller_->list_values(part, visit);
  }
  void save(ByteWriter& w) const override { controller_->save(w); }
  void load(ByteReader& r) override { controller_->load(r); }

 private:
  std::unique_ptr<Controller> controller_;
};

}  // namespace sandlot
