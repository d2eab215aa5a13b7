/// Two wheels for a microcontroller: no heap, no library of mathematics, 8 KiB of code.
///
///   g++ -std=c++17 -Os -ffreestanding -fno-exceptions -fno-rtti -I INCLUDE -c tiny.cpp
#include <sandlot/selforg_fixed.h>

namespace {

sandlot::selforg::fixed::Sox<4, 2> sox;  // speeds and currents of two wheels; all memory there is
static_assert(sizeof(sox) <= 1024, "fits");

}  // namespace

/// Called by the timer of the board, say fifty times a second.
extern "C" void control_step(const float (&sensors)[4], float (&motors)[2]) { sox.step(sensors, motors); }
