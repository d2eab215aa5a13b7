#pragma once
/// Hooks of your own around a run, and a main() that is `sandlot run` with them.
#include "app/experiment.h"
#include "sandlot/embed.h"

namespace sandlot {

/// What hooks receive; the name that programs use.
using Experiment = RunHooks;

}  // namespace sandlot
