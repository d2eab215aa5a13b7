#pragma once
/// `sandlot run` with hooks of a C++ program around the run.
#include "sim/session/run_hooks.h"

namespace sandlot {

/// main() of such a program: everything that `sandlot run` can do, with these hooks around the run, and
/// `--command 'at 2s kick ball'` for their commands. Arguments are those of `run`: FILE --duration 10s.
/// @return the exit code: 0 ok, 1 the run failed, 2 the input is wrong
int experiment_main(int argc, char** argv, const Hooks& hooks);

}  // namespace sandlot
