#pragma once
/// What the sources of RoBIOS 6 share: the programs' header, whose functions are all that the library shows.
///
/// Handles   devices' handles are their index + 1, those of distance sensors a bit; 0 is none.
#include <string>

#include "../devices.h"
#include "../machine.h"
#include "../screen.h"
#include "../tasks.h"

#pragma GCC visibility push(default)
#include "eyebot.h"
#pragma GCC visibility pop

namespace robios {

inline constexpr int ok = 0, failed = 1, bad_handle = -1;

/// Name of a device without what its name begins with: FRONT of PSD_FRONT; empty: no such number.
std::string device_name(DeviceSemantics semantics);
/// Index of a sensor, motor, servo, bumper; -1: the robot has none of that name.
int find_distance(DeviceSemantics semantics);
int find_motor(DeviceSemantics semantics);  ///< also of encoders
int find_servo(DeviceSemantics semantics);
int find_bumper(DeviceSemantics semantics);

template <class T>
void set(T* to, T value) {
  if (to) *to = value;
}

}  // namespace robios
