/// Power of drives with wheels: of their joints, and with a motor of its winding.
#include "devices/drives/wheeled_base.h"

namespace sandlot::wheeled {

void post_substep(Drive drive, std::uint32_t levels, const Context& context, double h_s) {
  State& state = drive.state;
  state.power_W = 0;
  if (active(levels) == ideal) return;
  const auto joints = context.engine.joint_states();
  for (std::size_t i = 0; i < drive.base.wheels.size(); ++i) {
    if (!drive.base.wheels[i].driven) continue;
    const JointState& joint = joints[drive.base.wheels[i].joint.index];
    const auto& motor = drive.spec.motor;
    if (!motor) {
      state.power_W += joint.effort * joint.velocity;
      continue;
    }
    double& current = state.wheels[i].current_A;
    if (drive.base.running[i].on_voltage) {
      const Flow flow = flow_after(*motor, drive.base.running[i].winding, current, joint.velocity);
      current = flow.current_A;
      state.power_W += flow.mean_A * flow.terminal_V;
    } else {
      const double per_ampere = motor->gear_ratio * motor->torque_constant *
                                (joint.effort * joint.velocity < 0 ? 1 / motor->gear_efficiency
                                                                   : motor->gear_efficiency);
      current = joint.effort / per_ampere;
      const double back_emf = motor->torque_constant * motor->gear_ratio * joint.velocity;
      state.power_W += current * (back_emf + motor->resistance_Ohm * current);
    }
  }
  for (const Pivot& pivot : drive.base.pivots) {
    const JointState& joint = joints[pivot.joint.index];
    state.power_W += joint.effort * joint.velocity;
  }
  state.energy_J += state.power_W * h_s;
  if (drive.base.energy && drive.spec.motor) drive.base.energy->draw(state.power_W * h_s);
}

}  // namespace sandlot::wheeled
