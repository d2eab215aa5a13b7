#pragma once
/// What the joints of a robot do: angle, speed and effort of some or all of them.
///
/// Output   level `joints`: sensor_msgs/JointState, one entry per joint in the order named (all: the model's order).
///          Angles [rad] (prismatic: [m]) count from the model's declared pose and do not wrap; the effort is what
///          motors put in, without limits, friction and springs.
/// Time     the end of the tick.
/// Noise    none: see wheel_encoder for a counting sensor.
/// Limits   joints with one degree of freedom only; of a universal joint nothing.
/// Cost     three copies per joint and sample, no allocation.
/// Errors   a joint that is not there or has no single degree of freedom; an engine without simulated joints is none:
///          its joints show what they are turned by.
#include <vector>

#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::joint_state {

struct Spec {
  std::vector<std::string> joints;
  double rate_hz = 50.0;

  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"joints", "", "Names of the joints; none: all that turn or slide.", 0, 0, Field::none, 10'000},
        s.joints);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct Joints {
  using Spec = joint_state::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  std::vector<std::uint32_t> joints;  ///< index of each in the engine
  Topic<msg::JointState>* message = nullptr;

  static Result<Joints> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Joints> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::joint_state
