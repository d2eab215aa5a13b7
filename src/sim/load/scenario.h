#pragma once
/// From a scenario to a Setup: the files that it names are loaded and put together.
#include "formats/scenario/scenario.h"
#include "sim/load/load.h"

namespace sandlot {

Result<model::Setup> load_scenario(formats::Scenario scenario, const LoadOptions& options,
                                   Diagnostics& diagnostics);

}  // namespace sandlot
