#pragma once
/// SelfOrg: an agent of the library selforg drives the robot: homeokinesis and its kin find behaviours by themselves.
///
/// Reads    numbers of any messages, by device and path: {device: hip, value: 'position[0]', min: -1.2, max: 1.2}. The range
///          becomes [-1, 1]. A device without a message so far counts as the middle of the range, an infinite number as its end.
///          'position[0..5]' is six numbers; a device with a * is each that fits, in the robot's order.
/// Orders   a Float64, or one component of a Twist, per motor: {device: hip, min: -5, max: 5}, {device: drive, value: angular.z}.
///          The agent's [-1, 1] becomes the range.
/// Guided   by cross-motor teaching and rewards (guidance.h).
/// Topics   each matrix and vector of the controller as Float64MultiArray, its name in the equations: /ROBOT/PROGRAM/A. One per
///          `publish_interval` control steps.
/// State    the whole agent, with its seed, which is drawn in the first step: learning goes on after a restore to the same hash.
/// Tunable  noise, and the parameters of agent and wirings: `parameters/epsC`, `wiring/0/noise/strength`, with the index of the
///          wiring in the list; without the index for a single wiring.
/// Learned  `learned`, a parameter that is written only: a stored agent (selforg/agent.h) in Base64 replaces all that the agent has
///          learned. It is input of the run, as every parameter: logged and replayed.
/// Limits   the border to controllers gives no limits of devices: a range that is not [-1, 1] has to be stated.
/// Errors   sensors and motors that are not there, ranges that are empty, unknown controllers and parameters.
#include <memory>
#include <optional>

#include "controllers/selforg/guidance.h"
#include "selforg/agent.h"

namespace sandlot::controllers::selforg {

namespace so = ::sandlot::selforg;

/// Number of a device's message, and the range of it that is [-1, 1] for the agent.
struct Place {
  std::string device, value;
  double min = -1, max = 1;
  Status check(const Node& node, const std::string& path) const;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"device", "", "Device, or device/level; of all devices that fit, with *.", 0, 0,
                Field::required, 1000, 1},
          s.device);
    visit(Field{"value", "",
                "Path of the number in the message; empty: data. Of a Twist as motor: linear.x, linear.y or "
                "angular.z."},
          s.value);
    visit(Field{"min", "", "Value that is -1 for the agent."}, s.min);
    visit(Field{"max", "", "Value that is 1 for the agent."}, s.max);
  }
};

struct Part {
  std::string kind;
  Node parameters;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"kind", "", "Kind of the wiring: one_to_one, selective, derivative, feedback, motor_noise.",
                0, 0, Field::required, 100, 1},
          s.kind);
    visit(Field{"parameters", "", "Parameters of the wiring."}, s.parameters);
  }
};

/// Log that the run writes (record/agent_log.h).
struct Log {
  std::string file;
  int interval = 5;
  std::vector<std::string> values;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"file", "", "Text file in the format of selforg's tools, which the verb `plot` draws.", 0, 0,
                Field::required, 1000, 1},
          s.file);
    visit(Field{"interval", "1", "Control steps per line.", 1, 1e6}, s.interval);
    visit(Field{"values", "",
                "Values to log, with * for any letters; none: all. A minus in front leaves them out: -A*.", 0,
                0, Field::none, 1000},
          s.values);
  }
};

struct Spec {
  std::string agent = "sox";
  Node parameters;
  std::vector<Part> wiring;
  std::vector<Place> sensors, motors;
  double noise = 0.1;
  int publish_interval = 1;
  std::uint32_t babbling = 0;
  GuidanceSpec guidance;
  std::optional<Log> log;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"agent", "", "Kind of the agent's controller: sox, semox, dep, experts, sine, ...", 0, 0,
                Field::none, 100, 1},
          s.agent);
    visit(Field{"parameters", "", "Parameters of the agent's controller."}, s.parameters);
    visit(Field{"wiring", "", "Wirings from the robot to the controller; none: one_to_one.", 0, 0,
                Field::none, 16},
          s.wiring);
    visit(Field{"sensors", "", "Sensor values of the agent.", 0, 0, Field::none, 1000}, s.sensors);
    visit(
        Field{"motors", "", "Motor values of the agent; none: every device of the robot that takes a number.",
              0, 0, Field::none, 1000},
        s.motors);
    visit(Field{"noise", "1", "Factor on the noise of the wirings.", 0, 100, Field::tunable}, s.noise);
    visit(Field{"publish_interval", "1", "Control steps per message of each topic; 0: no topics.", 0, 1e6},
          s.publish_interval);
    visit(
        Field{"babbling", "1",
              "Control steps at the beginning in which motors move at random and the model learns.", 0, 1e9},
        s.babbling);
    GuidanceSpec::fields(s.guidance, visit);
    visit(Field{"log", "", "Log of the agent's values that the run writes; none: no log."}, s.log);
  }
};

class SelfOrg final : public Controller {
 public:
  Status init(const Description& robot, const Node& config, Outputs& out) override;
  void step(const Observation& obs, Command& cmd) override;
  Status set_parameter(std::string_view path, const Node& value) override;
  ValueFound value(ValuePart part, std::span<const ValueStep> path) const override;
  void list_values(ValuePart part, const ValueVisit& visit) const override;
  void save(ByteWriter& w) const override;
  void load(ByteReader& r) override;

  static constexpr const char* learned_field = "learned";
  const so::WiredController& agent() const { return *agent_; }
  const Spec& spec() const { return spec_; }
  /// Whether set_parameter(learned_field) would take these bytes; the error says why not.
  Status check_learned(std::span<const std::byte> stored, const std::string& from) const;

 private:
  struct Sensor {
    std::uint32_t topic = 0;
    ValuePath path;
    double middle = 0, scale = 1;
  };
  struct Motor {
    std::size_t target = 0;  ///< index in numbers_ or twists_
    int component = -1;      ///< -1: a number; 0, 1, 2: of a Twist
    double middle = 0, scale = 1;
  };
  struct TwistTarget {
    Actuator<msg::Twist> actuator;
    msg::Twist order;
  };
  struct Topic {
    Publication<msg::Float64MultiArray> publication;
    std::string name;
    msg::Float64MultiArray message;
  };
  Status find_sensors(const Description& robot);
  Status find_motors(const Description& robot);
  Status add_motor(const Description& robot, const std::string& device, const Place& place,
                   const std::string& path);
  Result<std::unique_ptr<so::WiredController>> make_agent(std::uint64_t seed) const;
  bool is_sequence() const { return spec_.wiring.size() > 1; }
  ValueFound wiring_value(ValuePart part, std::span<const ValueStep> path) const;
  void begin(std::uint64_t seed);
  Status take_learned(std::span<const std::byte> stored, const std::string& from);
  void publish(Command& cmd);

  Spec spec_;
  std::string robot_;
  std::vector<Sensor> sensors_;
  std::vector<Motor> motors_;
  std::vector<Actuator<msg::Float64>> numbers_;
  std::vector<TwistTarget> twists_;
  std::vector<Topic> topics_;
  Guidance guidance_;
  std::unique_ptr<so::WiredController> agent_;
  std::vector<double> x_, y_;
  // State:
  enum class Phase : std::uint8_t {
    new_one,
    begun,    ///< it has its seed
    learned,  ///< it has no seed yet, but something was loaded into it
  };
  std::uint64_t seed_ = 0;
  Phase phase_ = Phase::new_one;
};

}  // namespace sandlot::controllers::selforg
