/// Was built with other flags: see the rule that compiles it with -ffast-math.
#include "control/plugin.h"

SANDLOT_PLUGIN("test_other_build", nullptr)
