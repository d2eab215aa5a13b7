#include "functions.h"

#include <cstdarg>

#include "clocks.h"

namespace robios {

bool radio_on = false, camera_on = false;

int end_radio() {
  if (!radio_on) return failed;
  radio_on = false;
  machine.messages.clear();
  return ok;
}

bool go_to(int row, int column) {
  if (row < 0 || column < 0 || row >= screen.rows() || column >= screen.columns()) return false;
  screen.row = row;
  screen.column = column;
  return true;
}

}  // namespace robios

using namespace robios;

extern "C" {

// Camera

int CAMRelease() {
  enter(Call::CAMRelease);
  if (!camera_on) return failed;
  camera_on = false;
  return ok;
}

// Screen

int LCDInit() {
  enter(Call::LCDInit);
  return ok;
}
int LCDRelease() {
  enter(Call::LCDRelease);
  return ok;
}
int LCDPrintf(const char* pattern, ...) {
  enter(Call::LCDPrintf);
  va_list arguments;
  va_start(arguments, pattern);
  screen.print(format(pattern, arguments));
  va_end(arguments);
  return ok;
}
int LCDSetPrintf(int row, int column, const char* pattern, ...) {
  enter(Call::LCDSetPrintf);
  if (!go_to(row, column)) return failed;
  va_list arguments;
  va_start(arguments, pattern);
  screen.print(format(pattern, arguments));
  va_end(arguments);
  return ok;
}
int LCDClear() {
  enter(Call::LCDClear);
  screen.clear();
  return ok;
}
int LCDSetPos(int row, int column) {
  enter(Call::LCDSetPos);
  return go_to(row, column) ? ok : failed;
}
int LCDGetPos(int* row, int* column) {
  enter(Call::LCDGetPos);
  set(row, screen.row);
  set(column, screen.column);
  return ok;
}

// Keys

int KEYGet() {
  enter(Call::KEYGet);
  return static_cast<int>(await_key(static_cast<std::uint32_t>(ANYKEY)));
}
int KEYRead() {
  enter(Call::KEYRead);
  return static_cast<int>(take_key());
}
int KEYWait(int keys) {
  enter(Call::KEYWait);
  return static_cast<int>(await_key(static_cast<std::uint32_t>(keys == 0 ? ANYKEY : keys)));
}

// Radio and sound

int RADIOInit() {
  enter(Call::RADIOInit);
  if (!machine.robot().has_radio) return failed;
  if (!radio_on) machine.messages.clear();
  radio_on = true;
  return ok;
}
int AUBeep() {
  enter(Call::AUBeep);
  play(1000, 0.1, "");
  return ok;
}

// System

int OSSetTime(int hours, int minutes, int seconds) {
  enter(Call::OSSetTime);
  return set_time_of_day(hours, minutes, seconds) ? ok : failed;
}
int OSMachineID() {
  enter(Call::OSMachineID);
  return static_cast<int>(machine.robot().id);
}
int OSMachineType() {
  enter(Call::OSMachineType);
  return machine.robot().drive == Drive::none ? PLATFORM : VEHICLE;
}

// What the robot has not

int IRTVGet() {
  enter(Call::IRTVGet);
  sleep_until(after(100 * millisecond), Others::by_mode);
  return 0;
}
int IRTVRead() {
  enter(Call::IRTVRead);
  return 0;
}

}  // extern "C"
