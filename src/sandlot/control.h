#pragma once
/// Controllers of your own: their interface, and the table that makes a shared library a plugin.
#include "base/math.h"  // the same bits on every machine, unlike <cmath>
#include "control/controller.h"
#include "control/plugin.h"
#include "control/steering.h"
