#pragma once
/// `sandlot run` with an experiment of the user's own inside.
#include "sim/session/run_hooks.h"

namespace sandlot {

/// The main() of an experiment: everything that `sandlot run` can do, with these hooks around the run, and
/// `--command 'at 2s kick ball'` for their console. The arguments are those of `run`: FILE --duration 10s ...
/// @return the exit code: 0 ok, 1 the run failed, 2 the input is wrong
int experiment_main(int argc, char** argv, const Hooks& hooks);

}  // namespace sandlot
