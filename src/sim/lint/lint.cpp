#include "sim/lint/lint.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "sim/lint/rules.h"

namespace sandlot {
namespace lint_rules {

void Findings::add(const char* rule, std::string what, std::string fix, const Place& place) {
  if (!known_.emplace(place.file ? *place.file : "", place.line, what).second) return;
  findings_.push_back({rule, {std::move(what), std::move(fix), place, ""}});
}

std::vector<Finding> Findings::take() {
  constexpr int most = 10;
  std::vector<Finding> kept;
  std::map<std::string, int> count;
  for (Finding& finding : findings_)
    if (++count[finding.rule] <= most) kept.push_back(std::move(finding));
  for (const auto& [rule, n] : count)
    if (n > most)
      kept.push_back(
          {rule, {fmt::format("{} more of the kind '{}' are not shown", n - most, rule), "", {}, ""}});
  return kept;
}

Bounds bounds_in_link(const model::Link& link, bool visuals) {
  Bounds out;
  const auto include = [&](const Shape& shape, const Pose& X_LC) {
    if (!std::holds_alternative<Heightfield>(shape)) out.include(bounds_of(shape, X_LC));
  };
  for (const model::Collision& collision : link.collisions) include(collision.shape, collision.X_LC);
  if (visuals)
    for (const model::Visual& visual : link.visuals) include(visual.shape, visual.X_LC);
  return out;
}

Bounds bounds_in_model(const model::Model& model, bool visuals) {
  Bounds out;
  for (const model::Link& link : model.links) {
    const Bounds in_link = bounds_in_link(link, visuals);
    if (!in_link.empty()) out.include(bounds_of(Box{in_link.size()}, link.X_ML * Pose{in_link.centre(), {}}));
  }
  return out;
}

std::string length_text(double m) {
  if (std::abs(m) < 0.1) return fmt::format("{:.2g} mm", 1e3 * m);
  if (std::abs(m) < 100) return fmt::format("{:.2g} m", m);
  return fmt::format("{:.0f} m", m);
}

std::string at(const Place& place) { return place.file ? " (" + to_string(place) + ")" : ""; }

}  // namespace lint_rules

std::vector<Finding> lint(const Simulation& simulation) {
  using namespace lint_rules;
  Findings findings;
  check_units(simulation, findings);
  check_inertia(simulation, findings);
  check_start(simulation, findings);
  check_surfaces(simulation, findings);
  check_speed(simulation, findings);
  check_gains(simulation, findings);
  check_actuators(simulation, findings);
  check_sensors(simulation, findings);
  check_programs(simulation, findings);
  return findings.take();
}

std::vector<Finding> lint(const formats::Scenario& scenario) {
  lint_rules::Findings findings;
  for (const auto& [name, place] : scenario.unused_vars)
    findings.add("unused", "variable '" + name + "' is used nowhere",
                 "write ${" + name + "} where it belongs, or remove it", place);
  return findings.take();
}

}  // namespace sandlot
