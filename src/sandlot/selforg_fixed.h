#pragma once
/// Sox of a fixed size for microcontrollers. This header and those that it includes are all that it takes.
#include "selforg/fixed/fixed_sox.h"
