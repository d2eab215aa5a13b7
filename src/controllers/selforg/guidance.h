#pragma once
/// Guidance of a selforg agent from its scenario: cross-motor teaching, and rewards from what the robot measures.
///
/// Cross-motor   `cross_motor` names for each motor the one that teaches it, -1 for none (selforg/teaching.h).
/// Reward        sum of the terms, clipped to [-1, 1] by the agent. A term is a number of a message, or with `magnitude` the root of
///               the sum of squares of several, whose range becomes [-1, 1], times its weight.
/// State         none.
/// Errors        agents that take no teaching or no reward; motors and readings that are not there.
#include <optional>
#include <string>
#include <vector>

#include "control/controller.h"
#include "selforg/controller.h"
#include "selforg/teaching.h"

namespace sandlot::controllers::selforg {

struct RewardTerm {
  std::string device;
  std::vector<std::string> values;
  double min = -1, max = 1, weight = 1;
  bool magnitude = false;
  Status check(const Node& node, const std::string& path) const;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"device", "", "Device, or device/level.", 0, 0, Field::required, 1000, 1}, s.device);
    visit(Field{"values", "", "Paths of numbers in the message: their sum counts.", 0, 0, Field::required, 20,
                1},
          s.values);
    visit(Field{"magnitude", "", "Whether the root of the sum of their squares counts instead."},
          s.magnitude);
    visit(Field{"min", "", "Value of which the reward is -1."}, s.min);
    visit(Field{"max", "", "Value of which the reward is 1."}, s.max);
    visit(Field{"weight", "1", "Factor on the term.", -100, 100}, s.weight);
  }
};

struct GuidanceSpec {
  std::vector<int> cross_motor;
  double cross_motor_threshold = 0.4;
  std::vector<RewardTerm> reward;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"cross_motor", "1", "Index of the motor that teaches each motor; -1: none.", -1, 10'000,
                Field::none, 1000},
          s.cross_motor);
    visit(Field{"cross_motor_threshold", "1", "Size of motor values from which on they teach others.", 0, 1},
          s.cross_motor_threshold);
    visit(Field{"reward", "", "Terms of the reward.", 0, 0, Field::none, 20}, s.reward);
  }
};

class Guidance {
 public:
  /// @param agent  one of the kind that apply() gets
  Status init(const GuidanceSpec& spec, const Description& robot, ::sandlot::selforg::Controller& agent);
  /// Before each step of the agent.
  void apply(const Observation& obs, ::sandlot::selforg::Controller& agent);

 private:
  struct Term {
    std::uint32_t topic = 0;
    std::vector<ValuePath> values;
    double middle = 0, scale = 1, weight = 1;
    bool magnitude = false;
  };
  std::optional<::sandlot::selforg::CrossMotorTeaching> cross_;
  std::vector<Term> terms_;
};

/// Index of the robot's reading `device` or `device/level` that has a number at a path. Errors: there is none; paths are those of
/// the keys `device` and `value` below `path`.
Result<std::uint32_t> find_number(const Description& robot, const std::string& device,
                                  const std::string& text, const ValuePath& value, const std::string& path,
                                  const char* value_key);
/// Error: none of the entries has that name.
Error not_there(const std::vector<Description::Entry>& entries, const std::string& device,
                const std::string& path);
/// The entry of `device` or `device/level`; of several for a device alone the first, which follows the active level.
const Description::Entry* entry_of(const std::vector<Description::Entry>& entries, std::string_view name);

}  // namespace sandlot::controllers::selforg
