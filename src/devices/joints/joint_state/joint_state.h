#pragma once
/// Joint states of a robot: angle, speed and effort of some or all of its joints.
///
/// Output   level `joints`: sensor_msgs/JointState, one entry per joint in the order named (all: the model's
///          order). Angles [rad] (prismatic: [m]) count from the model's declared pose and do not wrap; the
///          effort is what motors put in, without limits, friction and springs.
/// Units    `units: si` (the default): rad, m, rad/s, Nm. `centred`: angles and lengths as -1 to 1 between the joint's limits,
///          of a joint that turns without end as part of half a turn; speeds and efforts as parts of the joint's
///          largest, or SI where it has none. Errors come first.
/// Time     the end of the tick.
/// Noise    noise/chain.h for angles, speeds and efforts, each joint by itself; none by default. See
///          wheel_encoder for a counting sensor.
/// Limits   joints with one degree of freedom only; of a universal joint nothing.
/// Cost     three copies per joint and sample, no allocation.
/// Errors   a joint that is not there or has no single degree of freedom; an engine without simulated joints
///          is none: its joints show what they are turned by.
#include <vector>

#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/chain.h"

namespace sandlot::joint_state {

enum class Units : std::uint8_t { si, centred };
inline std::span<const EnumName<Units>> enum_names(Units) {
  static constexpr EnumName<Units> names[] = {{"si", Units::si}, {"centred", Units::centred}};
  return names;
}

struct NoiseSpec {
  ChainSpec position, velocity, effort;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"position", "1", "Errors of each angle [rad] or length [m]."}, s.position);
    visit(Field{"velocity", "1", "Errors of each speed [rad/s] or [m/s]."}, s.velocity);
    visit(Field{"effort", "1", "Errors of each effort [Nm] or [N]."}, s.effort);
  }
};

struct Spec {
  std::vector<std::string> joints;
  double rate_hz = 50.0;
  Units units = Units::si;
  NoiseSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joints", "", "Names of the joints; none: all joints that can move.", 0, 0, Field::none,
                10'000},
          s.joints);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"units", "", "Units of the message: SI, or -1 to 1 between the joints' limits."}, s.units);
    visit(Field{"noise", "", "Errors of angles, speeds and efforts."}, s.noise);
    visit(errors_field, s.errors);
  }
};

/// One chain per joint.
struct State {
  std::vector<ChannelChain> position, velocity, effort;

  static void fields(auto& s, auto&& visit) {
    for (auto& chain : s.position) visit(Field{"position", "", "Errors of an angle."}, chain);
    for (auto& chain : s.velocity) visit(Field{"velocity", "", "Errors of a speed."}, chain);
    for (auto& chain : s.effort) visit(Field{"effort", "", "Errors of an effort."}, chain);
  }
};

struct Joints {
  using Spec = joint_state::Spec;
  using State = joint_state::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::vector<std::uint32_t> joints;  ///< index of each in the engine
  struct Scale {
    double middle = 0, half = 1, velocity = 1, effort = 1;
    bool turns = false;  ///< without end
  };
  std::vector<Scale> scales;  ///< of each; empty: SI
  Topic<msg::JointState>* message = nullptr;

  static Result<Joints> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Joints> pool, const Context& context);
  void scale(msg::JointState& message) const;
  /// The lists of the message are as long as they were made.
  bool fits() const;
};

extern const Kind kind;

}  // namespace sandlot::joint_state
