#pragma once
/// What the sources of both generations share: the programs' header of the generation, whose functions are all that its library
/// shows, and what they return. functions.cpp has the functions that are the same in both.
#include "devices.h"
#include "machine.h"
#include "screen.h"
#include "tasks.h"

#pragma GCC visibility push(default)
#include "eyebot.h"
#pragma GCC visibility pop

namespace robios {

inline constexpr int ok = 0, failed = 1;

extern bool radio_on, camera_on;  ///< between their functions of begin and end
/// Ends the radio: what waits is lost.
int end_radio();

/// Whether a character of the screen stands there; the cursor goes to it.
bool go_to(int row, int column);

/// Nothing for a null pointer.
template <class T>
void set(T* to, T value) {
  if (to) *to = value;
}

}  // namespace robios
