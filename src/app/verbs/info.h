#pragma once
/// What `sandlot info` knows of a built world, and its two forms.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "geometry/bounds.h"
#include "sim/world/simulation.h"

namespace sandlot::app {

struct Overview {
  int robots = 0, objects = 0, statics = 0, actors = 0;
  double moving_mass_kg = 0;
  Bounds bounds;                ///< of all collision shapes that have an end
  bool endless_ground = false;  ///< there is a plane
};
Overview overview_of(const Simulation& simulation);

/// "robot", "static", "actor" or "object".
const char* role_of(const model::Instance& instance);

/// Everything, each thing by itself.
nlohmann::ordered_json info_json(const Simulation& simulation, const Diagnostics& diagnostics);

/// The tree for people: things that differ in name and place alone are one entry, simple things one line.
/// @param file  as the user named it
std::string info_text(const std::string& file, const Simulation& simulation, const Diagnostics& diagnostics);

/// The addresses of all values with unit and present value; lists of numbers are one entry.
nlohmann::ordered_json values_json(const Simulation& simulation);
std::string values_text(const Simulation& simulation);

}  // namespace sandlot::app
