#pragma once
/// Lint: probable mistakes in a world that can run. `sandlot check` and `sandlot run --verbose` report them.
///
/// Each rule is a function of rules.h with its derivation beside it. A rule that cannot be derived has no place here: a
/// false alarm costs more than a slip that stays.
///
/// Limits   collision shapes only, as engines and rays do; what a run turns up later (a robot that drives off a table) is
///          not foreseen.
/// Cost     one engine step in a second engine, and for each range sensor one scan.
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/scenario/scenario.h"
#include "sim/world/simulation.h"

namespace sandlot {

struct Finding {
  std::string rule;  ///< "overlap", "inertia" ...: the same for all findings of one kind
  Error text;        ///< what, fix and place
};

/// @param simulation  just built: nothing has moved yet
/// @return in the order of the rules; each is said once, however many robots are built alike, and at most ten of one
///         rule, then how many more there are
std::vector<Finding> lint(const Simulation& simulation);

/// Slips of the scenario file itself, which the simulation built from it no longer shows.
std::vector<Finding> lint(const formats::Scenario& scenario);

}  // namespace sandlot
