#pragma once
/// Overview of a built world for `sandlot info`, as text and as JSON.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "geometry/bounds.h"
#include "sim/world/simulation.h"

namespace sandlot::app {

struct Overview {
  int robots = 0, objects = 0, statics = 0, actors = 0;
  double moving_mass_kg = 0;
  Bounds bounds;                ///< of all bounded collision shapes
  bool endless_ground = false;  ///< there is a plane
};
Overview overview_of(const Simulation& simulation);

/// "robot", "static", "actor" or "object".
const char* role_of(const model::Instance& instance);

/// Everything, one entry per object.
nlohmann::ordered_json info_json(const Simulation& simulation, const Diagnostics& diagnostics);

/// Tree for people: objects that differ in name and pose alone are one entry, simple objects one line.
/// Numbers are rounded.
/// @param file  as the user named it
std::string info_text(const std::string& file, const Simulation& simulation, const Diagnostics& diagnostics);

/// Addresses of all values with unit and present value; a list of numbers is one entry.
nlohmann::ordered_json values_json(const Simulation& simulation);
std::string values_text(const Simulation& simulation);

}  // namespace sandlot::app
