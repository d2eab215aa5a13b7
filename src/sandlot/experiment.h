#pragma once
/// For experiments in C++: hooks around a run, and a main() that is `sandlot run` with them.
#include "app/experiment.h"
#include "sandlot/embed.h"
