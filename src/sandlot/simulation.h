#pragma once
/// For programs that have a simulation inside: load, step, read, command, save.
#include "sandlot/embed.h"
