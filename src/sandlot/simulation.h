#pragma once
/// Simulation inside a program of your own: load, step, read, command, save.
#include "sandlot/embed.h"
