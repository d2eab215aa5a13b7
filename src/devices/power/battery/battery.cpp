#include "devices/power/battery/battery.h"

#include <cmath>
#include <limits>

#include "physics/parallel.h"

namespace sandlot::battery {
namespace {

/// A curve from the keys.
Result<std::vector<Point>> points_of(const DeviceBuild& build, const Spec& spec) {
  if (spec.curve.empty()) {
    const double voltage = spec.voltage_V.value_or(12);
    return std::vector<Point>{{0, voltage}, {1, voltage}};
  }
  if (spec.voltage_V)
    return build.error("voltage", "the voltage is given twice", "give either 'voltage' or 'curve'");
  if (spec.curve.front().charge != 0 || spec.curve.back().charge != 1)
    return build.error("curve", "the curve does not go from charge 0 to charge 1",
                       "its first point is at charge 0, its last at 1");
  for (std::size_t i = 1; i < spec.curve.size(); ++i)
    if (!(spec.curve[i].charge > spec.curve[i - 1].charge))
      return build.error("curve", "the points of the curve are not in the order of their charge",
                         "sort them, and give each charge once");
  return spec.curve;
}

/// What a battery may have seen in its life [J].
constexpr double most_energy_J = 1e18;

}  // namespace

Result<Battery> Battery::create(const DeviceBuild& build, SharedSpec<Spec> spec) {
  if (!build.account) return Error{"a battery needs a robot", "declare it with the robot", build.decl.place};
  if (spec->capacity_J.has_value() == spec->charge_capacity_C.has_value())
    return build.error("capacity",  // a preset gives the charge
                       spec->capacity_J ? "the capacity is given twice" : "the battery has no capacity",
                       "give either 'capacity', as in 50 Wh, or 'charge_capacity', as in 5 Ah");
  SL_ASSIGN(const std::vector<Point> points, points_of(build, *spec));
  Battery battery{std::move(spec)};
  battery.open_circuit = OpenCircuit(points);
  const double mean_V = battery.open_circuit.mean_V();
  battery.charge_C = battery.spec->charge_capacity_C.value_or(battery.spec->capacity_J.value_or(0) / mean_V);
  battery.capacity_J = battery.spec->capacity_J.value_or(battery.charge_C * mean_V);
  battery.initial_J = battery.spec->initial_charge == 1
                          ? battery.capacity_J
                          : battery.charge_C * battery.open_circuit.energy_at(battery.spec->initial_charge);
  battery.state.energy_J = battery.initial_J;
  battery.account = build.account;
  battery.account->body = build.body();
  battery.account->p_LS = build.decl.X_LS.p;
  battery.follow_energy();
  battery.state.terminal_V = battery.state.open_V;
  battery.show();

  battery.message = build.publish<msg::BatteryState>(0, "state");
  msg::BatteryState& message = battery.message->message;
  message.header.frame_id = build.frame_id();
  message.temperature = std::numeric_limits<float>::quiet_NaN();
  message.capacity = message.design_capacity = static_cast<float>(battery.charge_C / 3600);
  message.power_supply_health = 1;  // POWER_SUPPLY_HEALTH_GOOD
  message.power_supply_technology = static_cast<std::uint8_t>(battery.spec->technology);
  message.present = true;
  return battery;
}

/// What follows from the energy left.
void Battery::follow_energy() {
  const OpenCircuit::At at = open_circuit.at(state.energy_J / charge_C);
  state.open_V = at.voltage_V;
  state.fraction = state.energy_J >= capacity_J ? 1 : at.charge;
  state.empty = state.energy_J <= 0;
}

/// Tells the account what rules and chargers need to know.
void Battery::show() const {
  account->energy_J = state.energy_J;
  account->fraction = state.fraction;
  account->room_J = capacity_J - state.energy_J;
  account->max_charge_W = spec->max_charge_W;
  account->empty = state.empty;
}

void Battery::settle(PoolView<Battery> pool, const Context& context) {
  constexpr std::size_t at_a_time = 256;
  parallel_for(pool.due.size(), at_a_time, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t by = 1; by <= 3 && i + by < end; ++by) pool.all[pool.due[i + by]].account->expect(by);
      if (i + 2 < end) pool.all[pool.due[i + 2]].open_circuit.expect();
      pool.all[pool.due[i]].pay(context.tick.s());
    }
  });
}

void Battery::pay(double dt_s) {
  EnergyAccount::Bill bill = account->bill();
  const double given_J = bill.given_J;
  bill.given_J *= spec->recuperation;
  const double net_J = bill.drawn_J - bill.given_J - account->offered_J;
  if (net_J > 0) discharge(bill, net_J, dt_s);
  else charge(bill, net_J, dt_s);
  state.rejected_J += given_J - bill.given_J;  // burnt on its way
  follow_energy();
  show();
}

/// @param net_J  > 0: what the cell has to deliver
void Battery::discharge(EnergyAccount::Bill bill, double net_J, double dt_s) {
  const double V = state.open_V, R = spec->resistance_Ohm, power_W = net_J / dt_s;
  // The most it can deliver: at half its voltage, or all that is left.
  const double of_energy_A = state.energy_J / (V * dt_s);
  const bool last = R == 0 || of_energy_A <= V / (2 * R);
  const double most_A = last ? of_energy_A : V / (2 * R);
  const double most_W = (V - R * most_A) * most_A;
  double delivered_J = net_J, share = 1;
  if (power_W < most_W) {
    state.load_A = 2 * power_W / (V + std::sqrt(std::max(0.0, V * V - 4 * R * power_W)));
  } else {
    state.load_A = most_A;
    delivered_J = most_W * dt_s;
    share = std::min(1.0, (delivered_J + bill.given_J + account->offered_J) / bill.drawn_J);
  }
  const double lost_J = R * state.load_A * state.load_A * dt_s;
  const bool emptied = last && power_W >= most_W;
  state.energy_J = emptied ? 0 : std::max(0.0, state.energy_J - delivered_J - lost_J);
  state.terminal_V = V - R * state.load_A;
  state.lost_J += lost_J;
  state.drained_J += delivered_J + account->offered_J + lost_J;
  state.charged_J += account->offered_J;
  state.missing_J += (1 - share) * bill.drawn_J;
  account->settle(share, spec->recuperation);
}

/// @param net_J  <= 0: what comes in
void Battery::charge(EnergyAccount::Bill bill, double net_J, double dt_s) {
  const double V = state.open_V, R = spec->resistance_Ohm;
  const auto current = [&](double power_W) { return 2 * power_W / (V + std::sqrt(V * V + 4 * R * power_W)); };
  double power_W = std::min(-net_J / dt_s, spec->max_charge_W);
  double charge_A = current(power_W);
  const double room_A = std::max(0.0, capacity_J - state.energy_J) / (V * dt_s);
  const bool full = charge_A >= room_A;
  if (full) charge_A = room_A, power_W = (V + R * room_A) * room_A;
  const double accepted_J = std::min(-net_J, power_W * dt_s);
  const double rejected_J = -net_J - accepted_J;
  // What devices give back waits behind what chargers give.
  const double refused_J = std::min(rejected_J, bill.given_J);
  const double taken_J = bill.given_J - refused_J;
  const double offered_J = std::max(0.0, account->offered_J - (rejected_J - refused_J));
  const double lost_J = R * charge_A * charge_A * dt_s;
  state.load_A = -charge_A;
  state.terminal_V = V + R * charge_A;
  state.energy_J = full ? capacity_J : std::min(capacity_J, state.energy_J + accepted_J - lost_J);
  state.lost_J += lost_J;
  state.charged_J += offered_J;
  state.drained_J += bill.drawn_J - taken_J + lost_J;
  state.rejected_J += rejected_J;
  account->settle(1, bill.given_J > 0 ? spec->recuperation * taken_J / bill.given_J : spec->recuperation);
}

bool Battery::fits() const {
  for (const double number : {state.energy_J, state.drained_J, state.lost_J, state.charged_J,
                              state.rejected_J, state.missing_J, state.terminal_V, state.load_A})
    if (!(std::abs(number) <= most_energy_J)) return false;
  if (!(state.energy_J >= 0 && state.energy_J <= capacity_J)) return false;
  Battery same = *this;
  same.follow_energy();
  return state.open_V == same.state.open_V && state.fraction == same.state.fraction &&
         state.empty == same.state.empty;
}

Result<msg::std_srvs::Trigger::Response> Battery::exchange(const msg::std_srvs::Trigger::Request&,
                                                           const Context&) {
  state.charged_J += initial_J - state.energy_J;
  state.energy_J = initial_J;
  follow_energy();
  state.terminal_V = state.open_V;
  state.load_A = 0;
  show();
  return msg::std_srvs::Trigger::Response{true, "the battery is exchanged"};
}

void Battery::sense(PoolView<Battery> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Battery& battery = pool.all[index];
    const State& state = battery.state;
    msg::BatteryState& message = battery.message->message;
    message.voltage = static_cast<float>(state.terminal_V);
    message.current = static_cast<float>(-state.load_A);
    message.charge = static_cast<float>(state.fraction * battery.charge_C / 3600);
    message.percentage = static_cast<float>(state.fraction);
    // POWER_SUPPLY_STATUS_CHARGING, DISCHARGING, NOT_CHARGING, FULL
    message.power_supply_status = state.load_A < 0 ? 1 : state.load_A > 0 ? 2 : state.fraction >= 1 ? 4 : 3;
    battery.message->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"state", msg::BatteryState::ros_type, "", "Voltage, current and charge."},
};
constexpr DeviceService services[] = {
    device_service<Battery, msg::std_srvs::Trigger, &Battery::exchange>(
        "exchange", "Puts a battery with the initial charge in its place."),
};
constexpr const char* sdf_types[] = {
    "plugin:LinearBatteryPlugin",
    "plugin:gz-sim-linearbatteryplugin-system",
    "plugin:gz-sim-linearbattery-plugin-system",
    "plugin:ignition-gazebo-linearbatteryplugin-system",
    "plugin:ignition-gazebo-linearbattery-plugin-system",
};
constexpr Preset presets[] = {
    {"lipo_850mah",
     "Lithium polymer cell of 850 mAh (TCL PL-383562) as measured by M. Chen and G. Rincon-Mora, IEEE "
     "Transactions on Energy Conversion 21(2), 2006: their formula of the voltage at 13 points; resistance: "
     "the sum of their three at half charge.",
     "{charge_capacity: 0.85 Ah, resistance: 0.171, technology: lipo, curve: ["
     "{charge: 0, voltage: 2.654}, {charge: 0.02, voltage: 3.1773}, {charge: 0.05, voltage: 3.5164},"
     "{charge: 0.1, voltage: 3.6746}, {charge: 0.2, voltage: 3.7250}, {charge: 0.3, voltage: 3.7477},"
     "{charge: 0.4, voltage: 3.7729}, {charge: 0.5, voltage: 3.8034}, {charge: 0.6, voltage: 3.8411},"
     "{charge: 0.7, voltage: 3.8880}, {charge: 0.8, voltage: 3.9460}, {charge: 0.9, voltage: 4.0170},"
     "{charge: 1, voltage: 4.1029}]}"},
    {"lead_acid_7ah",
     "Lead-acid battery of 12 V and 7 Ah, as Yuasa NP7-12: resistance and charge of its data sheet from "
     "general "
     "knowledge; voltages at rest as the Battery Council International lists them.",
     "{charge_capacity: 7 Ah, resistance: 0.025, curve: ["
     "{charge: 0, voltage: 11.89}, {charge: 0.25, voltage: 12.06}, {charge: 0.5, voltage: 12.24},"
     "{charge: 0.75, voltage: 12.45}, {charge: 1, voltage: 12.65}]}"},
};
}  // namespace

constinit const Kind kind = make_kind<Battery>({
    .name = "battery",
    .help = "Battery of a robot, from which all its devices draw.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "smoothing of the current, recharging, topics that start and stop the load",
    .presets = presets,
    .services = services,
    .stores_energy = true,
});

}  // namespace sandlot::battery
