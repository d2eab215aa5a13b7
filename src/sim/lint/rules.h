#pragma once
/// The rules of lint.h, one function per group, and their shared geometry.
#include <set>
#include <string>
#include <string_view>
#include <tuple>

#include "geometry/bounds.h"
#include "sim/lint/lint.h"
#include "sim/load/device_settings.h"

namespace sandlot::lint_rules {

class Findings {
 public:
  void add(const char* rule, std::string what, std::string fix, const Place& place);
  std::vector<Finding> take();

 private:
  std::vector<Finding> findings_;
  std::set<std::tuple<std::string, int, std::string>> known_;  ///< file, line, what
};

using Entity = Simulation::Entity;

// One file each.
void check_inertia(const Simulation& simulation, Findings& findings);
void check_start(const Simulation& simulation, Findings& findings);
void check_speed(const Simulation& simulation, Findings& findings);
void check_gains(const Simulation& simulation, Findings& findings);
void check_actuators(const Simulation& simulation, Findings& findings);
void check_sensors(const Simulation& simulation, Findings& findings);
void check_surfaces(const Simulation& simulation, Findings& findings);
void check_programs(const Simulation& simulation, Findings& findings);
void check_units(const Simulation& simulation, Findings& findings);

/// Box around the collision shapes of a model (`visuals`: and around its visuals) in M; planes and terrain aside.
Bounds bounds_in_model(const model::Model& model, bool visuals);
/// The same of one link, in L.
Bounds bounds_in_link(const model::Link& link, bool visuals);

/// "12 mm", "0.35 m": a length with two digits.
std::string length_text(double m);

/// Says where the other thing was declared: " (file:line)", or "".
std::string at(const Place& place);

}  // namespace sandlot::lint_rules
