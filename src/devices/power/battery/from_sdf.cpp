/// Gazebo's LinearBatteryPlugin as keys of our spec: V = e0 + e1 (1 - Q / c), a curve of two points. Its load is a `drain` of the
/// battery itself.
#include "devices/power/battery/battery.h"
#include "devices/sdf_element.h"

namespace sandlot::battery {
using namespace sdf_element;

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  Node config = Node::map(element.place());
  const auto at = [&](const char* name) -> const Node& {
    const Node* const found = find(element, name);
    return found ? *found : element;
  };
  SL_ASSIGN(const auto capacity_Ah, number(element, "capacity"));
  if (!capacity_Ah || !(*capacity_Ah > 0))
    return at("capacity").error("the battery has no capacity", "give <capacity> in Ah");
  config.set("charge_capacity", scalar(*capacity_Ah * 3600, at("capacity")));
  SL_ASSIGN(const auto initial_Ah, number(element, "initial_charge"));
  if (initial_Ah && !(*initial_Ah >= 0 && *initial_Ah <= *capacity_Ah))
    return at("initial_charge").error("<initial_charge> is not within 0 and <capacity>", "both are in Ah");
  if (initial_Ah) config.set("initial_charge", scalar(*initial_Ah / *capacity_Ah, at("initial_charge")));

  SL_ASSIGN(const auto voltage, number(element, "voltage"));
  SL_ASSIGN(const auto constant, number(element, "open_circuit_voltage_constant_coef"));
  SL_ASSIGN(const auto linear, number(element, "open_circuit_voltage_linear_coef"));
  const double full_V = constant.value_or(voltage.value_or(0)), empty_V = full_V + linear.value_or(0);
  if (!(full_V > 0 && empty_V > 0))
    return at(linear ? "open_circuit_voltage_linear_coef" : "open_circuit_voltage_constant_coef")
        .error("the battery has no voltage at some charge",
               "<open_circuit_voltage_constant_coef> and its sum with the linear one are above 0");
  const Node& place = at("open_circuit_voltage_constant_coef");
  Node& curve = config.set("curve", Node::sequence(place.place()));
  for (const auto& [charge, volts] : {std::pair(0.0, empty_V), std::pair(1.0, full_V)}) {
    Node point = Node::map(place.place());
    point.set("charge", scalar(charge, place));
    point.set("voltage", scalar(volts, place));
    curve.push(std::move(point));
  }
  copy(element, "resistance", config, "resistance");
  SL_ASSIGN(const auto load_W, number(element, "power_load"));
  if (load_W && *load_W > 0) config.set("drain", scalar(*load_W, at("power_load")));
  for (const char* const name : {"enable_recharge", "recharge_by_topic"})
    if (const std::string on = text(find(element, name)); on == "true" || on == "1")
      diagnostics.warn({"<" + std::string(name) + "> has no effect: nothing recharges the battery",
                        "put a device of kind charger in reach", at(name).place()});
  warn_unknown(
      element,
      {"battery_name", "voltage", "open_circuit_voltage_constant_coef", "open_circuit_voltage_linear_coef",
       "initial_charge", "capacity", "resistance", "power_load", "enable_recharge", "recharge_by_topic",
       "charging_time", "soc_threshold", "smooth_current_tau", "fix_issue_225", "start_on_motion",
       "start_draining", "power_draining_topic", "stop_power_draining_topic"},
      "the linear battery plugin", diagnostics);
  return config;
}

}  // namespace sandlot::battery
