#pragma once
/// What the sources of RoBIOS 6 share.
///
/// Handles   devices' handles are their index + 1, those of distance sensors a bit; 0 is none.
#include <string>

#include "../functions.h"

namespace robios {

inline constexpr int bad_handle = -1;

/// Name of a device without what its name begins with: FRONT of PSD_FRONT; empty: no such number.
std::string device_name(DeviceSemantics semantics);
/// Index of a sensor, motor, servo, bumper; -1: the robot has none of that name.
int find_distance(DeviceSemantics semantics);
int find_motor(DeviceSemantics semantics);  ///< also of encoders
int find_servo(DeviceSemantics semantics);
int find_bumper(DeviceSemantics semantics);

}  // namespace robios
