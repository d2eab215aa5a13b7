#pragma once
/// Winding, gear and power stage of a brushed DC motor: what devices with motors share. The equations are in
/// devices/joints/dc_motor/dc_motor.h.
///
/// In every sub-step: winding_on_voltage() or winding_for_torque(), motor_target() to the engine, and
/// flow_after() when the step is done. In between lies the mean current, affine in the speed that the step
/// ends with.
///
/// Units    V, A, Ohm, H, Nm; speeds of the motor are those of the joint times the gear ratio.
/// Cost     one exponential per sub-step if the winding has an inductance; no allocation.
#include "physics/engine.h"

namespace sandlot {

struct MotorSpec {
  double supply_voltage_V = 12.0, supply_resistance_Ohm = 0.0;
  double resistance_Ohm = 1.0, inductance_H = 0.0;
  double torque_constant = 0.02;  ///< [Nm/A]
  double max_current_A = 1e6;
  double rotor_inertia_kgm2 = 0.0, friction_Nm = 0.0, viscous_friction = 0.0;
  double gear_ratio = 1.0, gear_efficiency = 1.0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"supply_voltage", "V", "Voltage of the battery without load.", 0, 1e5, Field::tunable},
          s.supply_voltage_V);
    visit(Field{"supply_resistance", "Ohm", "Resistance of battery and power stage.", 0, 1e6},
          s.supply_resistance_Ohm);
    visit(Field{"resistance", "Ohm", "Resistance of the winding.", 1e-6, 1e6}, s.resistance_Ohm);
    visit(Field{"inductance", "H", "Inductance of the winding; 0: the current follows at once.", 0, 1e3},
          s.inductance_H);
    visit(Field{"torque_constant", "Nm/A", "Torque per current; the back-EMF [V s/rad] is the same number.",
                1e-9, 1e4},
          s.torque_constant);
    visit(Field{"max_current", "A", "Largest current, limited by the power stage.", 0, 1e6, Field::tunable},
          s.max_current_A);
    visit(Field{"rotor_inertia", "kg m^2", "Moment of inertia of the rotor, before the gear.", 0, 1e3},
          s.rotor_inertia_kgm2);
    visit(Field{"friction", "Nm", "Coulomb friction before the gear.", 0, 1e4}, s.friction_Nm);
    visit(Field{"viscous_friction", "Nm s/rad", "Viscous friction before the gear.", 0, 1e4},
          s.viscous_friction);
    visit(Field{"gear_ratio", "1", "Turns of the motor per turn of the joint.", 1e-3, 1e5}, s.gear_ratio);
    visit(Field{"gear_efficiency", "1", "Efficiency of the gear.", 0.01, 1}, s.gear_efficiency);
  }
};

/// The winding over one sub-step: its mean current is at_rest - per_speed * (motor speed at the end).
struct Winding {
  double at_rest_A = 0, per_speed = 0;
  double volts = 0, resistance_Ohm = 1;  ///< behind which the motor sees the supply
  double keep = 0;                       ///< of the current's distance to its final value, after the sub-step
  bool fixed = false;                    ///< the power stage holds the current at at_rest_A
};

/// Sets the bridge's output to `volts` (as far as the supply reaches).
Winding winding_on_voltage(const MotorSpec& spec, double volts, double current_A, double motor_speed,
                           double h_s);
/// The bridge drives the current that gives this torque on the joint, as far as voltage and current limit
/// reach.
Winding winding_for_torque(const MotorSpec& spec, double torque_Nm, double current_A, double motor_speed,
                           double h_s);
JointTarget motor_target(const MotorSpec& spec, const Winding& winding, JointId joint, double joint_speed);

struct Flow {
  double mean_A = 0, terminal_V = 0;  ///< over the sub-step
  double current_A = 0;               ///< at its end
};
Flow flow_after(const MotorSpec& spec, const Winding& winding, double current_A, double joint_speed);

}  // namespace sandlot
