#include "devices/motor.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot {
namespace {

/// The winding on a voltage behind a resistance, for a sub-step.
Winding behind(const MotorSpec& spec, double volts, double resistance, double current, double h_s) {
  Winding w{.volts = volts, .resistance_Ohm = resistance};
  double mean_keep = 0;  // of the current's distance to its final value, in the mean
  if (spec.inductance_H > 0) {
    const double x = resistance * h_s / spec.inductance_H;
    w.keep = math::exp(-x);
    mean_keep = x > 1e-6 ? (1 - w.keep) / x : 1 - 0.5 * x;
  }
  w.at_rest_A = volts / resistance * (1 - mean_keep) + current * mean_keep;
  w.per_speed = spec.torque_constant / resistance * (1 - mean_keep);
  return w;
}

}  // namespace

Winding winding_on_voltage(const MotorSpec& spec, double volts, double current_A, double motor_speed,
                           double h_s) {
  const double duty = spec.supply_voltage_V > 0 ? std::clamp(volts / spec.supply_voltage_V, -1.0, 1.0) : 0;
  const Winding w = behind(spec, duty * spec.supply_voltage_V,
                           spec.resistance_Ohm + duty * duty * spec.supply_resistance_Ohm, current_A, h_s);
  const double mean = w.at_rest_A - w.per_speed * motor_speed;
  if (std::abs(mean) > spec.max_current_A)
    return {.at_rest_A = std::copysign(spec.max_current_A, mean), .fixed = true};
  return w;
}

Winding winding_for_torque(const MotorSpec& spec, double torque_Nm, double current_A, double motor_speed,
                           double h_s) {
  const double wanted = std::clamp(
      torque_Nm / (spec.gear_ratio * spec.gear_efficiency * spec.torque_constant), -spec.max_current_A,
      spec.max_current_A);
  // Across winding and supply; the duty that gives it, if there is one below 1, lets the current loop hold
  // it.
  const double needed = wanted * (spec.resistance_Ohm + spec.supply_resistance_Ohm) +
                        spec.torque_constant * motor_speed;
  if (std::abs(needed) <= spec.supply_voltage_V) return {.at_rest_A = wanted, .fixed = true};
  return winding_on_voltage(spec, std::copysign(spec.supply_voltage_V, needed), current_A, motor_speed, h_s);
}

JointTarget motor_target(const MotorSpec& spec, const Winding& w, JointId joint, double joint_speed) {
  const double n = spec.gear_ratio;
  const double mean_A = w.at_rest_A - w.per_speed * (n * joint_speed);
  const double efficiency = mean_A * joint_speed < 0 ? 1 / spec.gear_efficiency : spec.gear_efficiency;
  const double per_ampere = n * efficiency * spec.torque_constant;
  return {.joint = joint,
          .mode = JointTarget::Mode::effort,
          .effort = per_ampere * w.at_rest_A,
          .damping = per_ampere * w.per_speed * n + n * n * spec.viscous_friction,
          .inertia = n * n * spec.rotor_inertia_kgm2,
          .friction = n * spec.friction_Nm};
}

Flow flow_after(const MotorSpec& spec, const Winding& w, double current_A, double joint_speed) {
  const double back_emf = spec.torque_constant * spec.gear_ratio * joint_speed;
  Flow flow{.mean_A = w.at_rest_A - w.per_speed * back_emf / spec.torque_constant};
  if (w.fixed) {
    flow.current_A = w.at_rest_A;
    flow.terminal_V = back_emf + spec.resistance_Ohm * w.at_rest_A;
  } else {
    const double final_A = (w.volts - back_emf) / w.resistance_Ohm;
    flow.current_A = final_A + (current_A - final_A) * w.keep;
    flow.terminal_V = w.volts - (w.resistance_Ohm - spec.resistance_Ohm) * flow.mean_A;
  }
  return flow;
}

}  // namespace sandlot
