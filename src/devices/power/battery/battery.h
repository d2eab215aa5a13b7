#pragma once
/// Battery of a robot: what all its devices draw from (devices/energy.h).
///
///   P = U I,  U = V - R I     V: open-circuit voltage at the charge left, R: inner resistance
///   I = 2 P / (V + sqrt(V^2 - 4 R P))
///   energy' = - V I           of which U I goes to the devices and R I^2 is lost
///
/// with the mean power P of a tick: what the devices drew in it, less what they gave back, less what chargers gave. P < 0
/// charges. Positive currents discharge here; in the message, as ROS has it, they are negative.
///
/// Output   level `state`: sensor_msgs/BatteryState. voltage under load, current, charge and capacity [Ah], percentage 0 to 1.
///          Its temperature is not a number: not measured.
/// Settled  once per tick, after physics and before the sensors: `energy`, `drained`, `charged`, `lost` and all totals are those
///          at the end of the tick. energy = initial + charged - drained; drained = sum of `drawn` of all devices + lost.
/// Limit    a load above V^2 / 4R, the most that a battery can deliver, or more than is left gets what there is: all draws of
///          the tick the same share, and the rest is counted as `missing`, here and by each device. The energy is never below 0.
/// Full     what does not go in any more is counted as `rejected`: first what devices give back (motors that brake), which
///          then is not taken off what they drew.
/// Empty    `empty` is true when nothing is left. What an empty robot does is said by the rule `energy`.
/// Service  exchange (std_srvs/Trigger): a battery with the initial charge takes its place; the difference counts as charged.
/// Limits   no temperature, ageing, self-discharge (give it a `drain`), transients or limits of the current but that of V / 2R.
///          The voltage within a tick is that at its beginning. A battery that has failed as dead publishes nothing, but feeds
///          its robot all the same.
/// Cost     a few additions per device, two roots per tick; no allocation.
/// Errors   two batteries on a robot, both capacities or none, points of `curve` out of order.
/// Source   a cell with inner resistance: any textbook, e.g. C. Hamann, Electrochemistry. Curves: see the presets.
#include <array>

#include "devices/kind.h"
#include "devices/power/battery/open_circuit.h"
#include "messages/device_services.h"
#include "messages/messages.h"

namespace sandlot::battery {

enum class Technology : std::uint8_t { unknown, nimh, lion, lipo, life, nicd, limn };
inline std::span<const EnumName<Technology>> enum_names(Technology) {
  static constexpr EnumName<Technology> names[] = {
      {"unknown", Technology::unknown}, {"nimh", Technology::nimh}, {"lion", Technology::lion},
      {"lipo", Technology::lipo},       {"life", Technology::life}, {"nicd", Technology::nicd},
      {"limn", Technology::limn}};
  return names;
}

struct Spec {
  std::optional<double> capacity_J, charge_capacity_C, voltage_V;
  std::vector<Point> curve;
  double resistance_Ohm = 0, initial_charge = 1, max_charge_W = 1e9, recuperation = 1;
  Technology technology = Technology::unknown;
  double rate_hz = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"capacity", "J", "Energy of the full battery.", 1e-6, 1e15}, s.capacity_J);
    visit(Field{"charge_capacity", "C", "Charge of the full battery, where its energy is not given.", 1e-6,
                1e15},
          s.charge_capacity_C);
    visit(Field{"voltage", "V",
                "Open-circuit voltage at any charge; 12 V if neither it nor `curve` is given.", 1e-3, 1e6},
          s.voltage_V);
    visit(Field{"curve", "", "Open-circuit voltage over the charge left, from 0 to 1.", 0, 0, Field::none,
                1000, 2},
          s.curve);
    visit(Field{"resistance", "ohm", "Inner resistance.", 0, 1e6}, s.resistance_Ohm);
    visit(Field{"initial_charge", "1", "Charge at the start, as a share of the whole.", 0, 1},
          s.initial_charge);
    visit(Field{"max_charge_power", "W", "Greatest power with which it can be charged.", 0, 1e9,
                Field::tunable},
          s.max_charge_W);
    visit(Field{"recuperation", "1", "Share of what braking motors give back that reaches the battery.", 0, 1,
                Field::tunable},
          s.recuperation);
    visit(Field{"technology", "", "Chemistry that its messages name."}, s.technology);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct State {
  double energy_J = 0, fraction = 0;
  double open_V = 0, terminal_V = 0, load_A = 0;
  double drained_J = 0, lost_J = 0, charged_J = 0, rejected_J = 0, missing_J = 0;
  bool empty = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"energy", "J", "Energy left."}, s.energy_J);
    visit(Field{"fraction", "1", "Charge left, as a share of the whole."}, s.fraction);
    visit(Field{"open_voltage", "V", "Voltage without a load."}, s.open_V);
    visit(Field{"terminal_voltage", "V", "Voltage under the load of the latest tick."}, s.terminal_V);
    visit(Field{"load_current", "A", "Current in the latest tick, positive when discharging."}, s.load_A);
    visit(Field{"drained", "J", "Energy that all devices drew, and that was lost inside."}, s.drained_J);
    visit(Field{"lost", "J", "Energy lost in the inner resistance."}, s.lost_J);
    visit(Field{"charged", "J", "Energy from chargers and exchanges."}, s.charged_J);
    visit(Field{"rejected", "J", "Energy given to a battery that could not take it."}, s.rejected_J);
    visit(Field{"missing", "J", "Energy that the devices wanted and did not get."}, s.missing_J);
    visit(Field{"empty", "", "Whether nothing is left."}, s.empty);
  }
};

struct Battery {
  using Spec = battery::Spec;
  using State = battery::State;
  SharedSpec<Spec> spec;
  State state;

  OpenCircuit open_circuit;
  double charge_C = 0, capacity_J = 0, initial_J = 0;
  EnergyAccount* account = nullptr;
  Topic<msg::BatteryState>* message = nullptr;

  static Result<Battery> create(const DeviceBuild& build, SharedSpec<Spec> spec);
  static void settle(PoolView<Battery> pool, const Context& context);
  static void sense(PoolView<Battery> pool, const Context& context);
  bool fits() const;
  void restored() const { show(); }
  Result<msg::std_srvs::Trigger::Response> exchange(const msg::std_srvs::Trigger::Request&, const Context&);

 private:
  void pay(double dt_s);
  void discharge(EnergyAccount::Bill bill, double net_J, double dt_s);
  void charge(EnergyAccount::Bill bill, double net_J, double dt_s);
  void follow_energy();
  void show() const;
};

/// Gazebo's linear battery as keys of the spec (from_sdf.cpp).
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics);

extern const Kind kind;

}  // namespace sandlot::battery
