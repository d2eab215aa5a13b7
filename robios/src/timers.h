#pragma once
/// Functions that the program has called periodically, as interrupts do on the robot.
#include <cstdint>

namespace robios {

/// Calls `function` every `scale` units, first after one period. Number from 1; 0: no such period, or too many timers (16).
int attach_timer(int scale, std::int64_t unit_ns, void (*function)());
bool detach_timer(int number);

}  // namespace robios
