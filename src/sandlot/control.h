#pragma once
/// For controllers of your own: the border they are written against, and what makes a shared library of them.
#include "base/math.h"  // the same bits on every machine, unlike <cmath>
#include "control/controller.h"
#include "control/plugin.h"
