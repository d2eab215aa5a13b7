#include "controllers/sine/sine.h"

#include <cmath>

namespace sandlot::controllers::sine {
namespace {

/// @param turns  of phase, any
double shape_at(const Spec& spec, double turns) {
  const double into = turns - std::floor(turns);
  switch (spec.shape) {
    case Shape::sine: return math::sin(math::tau * into);
    case Shape::triangle: return into < 0.25 ? 4 * into : into < 0.75 ? 2 - 4 * into : 4 * into - 4;
    case Shape::pulse: break;
  }
  return into < spec.width ? 1 : -1;
}

}  // namespace

Status Sine::init(const Description& robot) {
  if (spec.motors.empty()) {
    for (const Description::Entry& entry : robot.actuators)
      if (entry.level.empty() && entry.type == msg::Float64::ros_type) {
        SL_ASSIGN(const auto motor, robot.actuator<msg::Float64>(entry.device));
        motors.push_back(motor);
      }
    if (motors.empty())
      return Error{"robot '" + robot.robot + "' has no device that takes a number", "add joint_motors"};
  }
  for (const std::string& name : spec.motors) {
    auto motor = robot.actuator<msg::Float64>(name);
    if (!motor) return motor.error().path = "/motors", std::move(motor.error());
    motors.push_back(*motor);
  }
  const auto fits = [&](const std::vector<double>& list, const char* key) -> Status {
    if (list.empty() || list.size() == motors.size()) return {};
    return Error{"'" + std::string(key) + "' has " + std::to_string(list.size()) + " values for " +
                     std::to_string(motors.size()) + " motors",
                 "give one for each motor, or leave it out",
                 {},
                 "/" + std::string(key)};
  };
  SL_TRY(fits(spec.amplitudes, "amplitudes"));
  SL_TRY(fits(spec.offsets, "offsets"));
  return fits(spec.phases_rad, "phases");
}

void Sine::step(const Observation& obs, Command& cmd) {
  if (state.started) state.phase += (obs.now() - state.last).s() / spec.period_s;
  state.phase -= std::floor(state.phase);  // whole turns would cost digits in the end
  state.last = obs.now();
  state.started = true;
  for (std::size_t i = 0; i < motors.size(); ++i) {
    double lag = static_cast<double>(i) * spec.phase_shift_rad;
    if (!spec.phases_rad.empty()) lag += spec.phases_rad[i];
    double value = spec.amplitude * shape_at(spec, state.phase - lag / math::tau);
    if (!spec.amplitudes.empty()) value *= spec.amplitudes[i];
    if (!spec.offsets.empty()) value += spec.offsets[i];
    cmd.set(motors[i], msg::Float64{value});
  }
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Sine>({
    .name = "sine",
    .help = "Moves motors back and forth, each a little after the one before it.",
});

}  // namespace sandlot::controllers::sine
