#pragma once
/// Agent: robot, wiring and controller as one thing that steps.
///
///   MyRobot robot;                                        // derives from selforg::Robot
///   auto agent = selforg::make_agent(robot, {.controller = "sox"});
///   agent.value()->step(0.01);                            // read sensors, wire, control, wire back, set motors
///
/// WiredController is the same without a robot: the robot's numbers in, the robot's numbers out.
#include <memory>

#include "base/text.h"
#include "selforg/controller.h"
#include "selforg/log_file.h"
#include "selforg/wiring.h"

namespace sandlot::selforg {

/// Robot: where sensor values come from and motor values go to, by convention within [-1, 1].
class Robot {
 public:
  virtual ~Robot() = default;
  virtual std::size_t sensors() const = 0;
  virtual std::size_t motors() const = 0;
  virtual void read_sensors(std::span<double> x) = 0;
  virtual void set_motors(std::span<const double> y) = 0;
  /// Names of a sensor and a motor, for logs.
  virtual std::string sensor_name(std::size_t i) const { return "x_R[" + std::to_string(i) + "]"; }
  virtual std::string motor_name(std::size_t i) const { return "y_R[" + std::to_string(i) + "]"; }
};

/// Parts of an agent, by name. A wiring of several parts is a sequence, from the robot to the controller.
struct AgentSpec {
  std::string controller = "sox";
  Node parameters;
  struct Part {
    std::string kind;
    Node parameters;
  };
  std::vector<Part> wiring = {};  ///< empty: one_to_one
  double noise = 0.1;             ///< factor on the noise of the wirings
  std::uint64_t seed = 0;
  std::string name = "agent";  ///< key of random numbers
};

class WiredController {
 public:
  /// @param sensors, motors  of the robot
  static Result<std::unique_ptr<WiredController>> make(std::size_t sensors, std::size_t motors,
                                                       const AgentSpec& spec);

  /// @param x  the robot's sensor values  @param y  out: the robot's motor values
  void step(std::span<const double> x, std::span<double> y, Mode mode = Mode::learn);
  /// For that many steps a babbling controller drives, and the own one learns from what it does.
  void babble(std::uint64_t steps) { babbling_left_ = steps; }
  std::uint64_t babbling_left() const { return babbling_left_; }

  Controller& controller() { return *controller_; }
  const Controller& controller() const { return *controller_; }
  Wiring& wiring() { return *wiring_; }
  const Wiring& wiring() const { return *wiring_; }
  /// Named values: the controller's, and the robot's sensor and motor values x_R and y_R.
  void channels(const ChannelVisit& visit) const;
  double noise() const { return noise_; }
  void set_noise(double factor) { noise_ = clipped(factor, 1e3); }
  std::uint64_t steps() const { return steps_; }
  std::size_t robot_sensors() const { return robot_x_.size(); }
  std::size_t robot_motors() const { return robot_y_.size(); }

  void save(ByteWriter& w) const;
  /// Fails the reader, and leaves the agent as it was, on bytes of another agent.
  void load(ByteReader& r);
  /// Everything that lasts, with version and check sum; errors as of selforg/store.h.
  Status store(const std::string& path) const;
  Status load(const std::string& path);
  /// The bytes of such a file.
  std::vector<std::byte> stored() const;
  /// @param from  name of the source, for messages
  Status take_stored(std::span<const std::byte> bytes, const std::string& from);
  /// "sox behind one_to_one": only agents of the same kinds take each other's files.
  std::string kinds() const;

 private:
  WiredController() = default;
  std::unique_ptr<Wiring> wiring_;
  std::unique_ptr<Controller> controller_, babbler_;
  std::vector<double> x_, y_, robot_x_, robot_y_;  ///< the robot's are for channels() alone: not State
  double noise_ = 0;
  std::uint64_t steps_ = 0, babbling_left_ = 0;
};

class Agent {
 public:
  /// @param robot  outlives the agent
  static Result<std::unique_ptr<Agent>> make(Robot& robot, const AgentSpec& spec);

  /// @param dt_s  length of a step, for the time in logs
  void step(double dt_s, Mode mode = Mode::learn);
  /// The last motor values again, between two steps of the controller.
  void only_control_robot() { robot_->set_motors(y_); }

  WiredController& wired() { return *wired_; }
  const WiredController& wired() const { return *wired_; }
  Controller& controller() { return wired_->controller(); }
  Robot& robot() { return *robot_; }
  std::span<const double> last_sensors() const { return x_; }
  std::span<const double> last_motors() const { return y_; }
  double time_s() const { return time_s_; }

  Status start_log(const std::string& path, const LogSpec& spec = {}) {
    return log_.open(path, spec, *wired_);
  }
  Status stop_log() { return log_.close(); }
  /// Sets a parameter and notes it in the log: of the controller, of the wiring ("wiring.noise.strength"), or "noise".
  Status set(std::string_view parameter, double number) {
    return set(parameter, std::string_view(number_text(number)));
  }
  Status set(std::string_view parameter, std::string_view value);

 private:
  Agent() = default;
  Robot* robot_ = nullptr;
  std::unique_ptr<WiredController> wired_;
  std::vector<double> x_, y_;
  LogFile log_;
  double time_s_ = 0;
};

inline Result<std::unique_ptr<Agent>> make_agent(Robot& robot, const AgentSpec& spec) {
  return Agent::make(robot, spec);
}

}  // namespace sandlot::selforg
