#pragma once
/// What the sources of RoBIOS-7 share: the programs' header, whose functions are all that the library shows.
#include "../devices.h"
#include "../machine.h"
#include "../screen.h"
#include "../tasks.h"

#pragma GCC visibility push(default)
#include "eyebot.h"
#pragma GCC visibility pop

namespace robios {

inline constexpr int ok = 0, failed = 1;
void set(int* to, int value);  ///< nothing for a null pointer

}  // namespace robios
