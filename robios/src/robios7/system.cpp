#include <algorithm>
#include <cstdio>
#include <cstring>

#include "../clocks.h"
#include "../functions.h"
#include "../timers.h"

using namespace robios;

extern "C" {

int KEYGetXY(int* x, int* y) {
  enter(Call::KEYGetXY);
  const KeyPress touch = await_touch();
  set(x, touch.x);
  set(y, touch.y);
  return ok;
}
int KEYReadXY(int* x, int* y) {
  enter(Call::KEYReadXY);
  const auto touch = take_touch();
  if (!touch) return failed;
  set(x, touch->x);
  set(y, touch->y);
  return ok;
}

int OSExecute(char* command, ...) {
  enter(Call::OSExecute);
  (void)command;
  note_once("OSExecute", "OSExecute is refused: a robot of the simulation has no shell");
  return failed;
}

int OSVersion(char* text) {
  enter(Call::OSVersion);
  if (!text) return failed;
  std::strcpy(text, version_text);
  return ok;
}
int OSVersionIO(char* text) {
  enter(Call::OSVersionIO);
  if (!text) return failed;
  std::strcpy(text, version_text);
  return ok;
}
int OSMachineSpeed() {
  enter(Call::OSMachineSpeed);
  return 900;
}
int OSMachineName(char* name) {
  enter(Call::OSMachineName);
  if (!name) return failed;
  std::snprintf(name, name_size, "%.*s", static_cast<int>(name_size) - 1, machine.robot().name);
  return ok;
}
int OSWait(int milliseconds) {
  enter(Call::OSWait);
  if (milliseconds < 0) return failed;
  sleep_until(after(milliseconds * millisecond), Others::by_mode);
  return ok;
}
TIMER OSAttachTimer(int scale, void (*function)()) {
  enter(Call::OSAttachTimer);
  return attach_timer(scale, millisecond, function);
}
int OSDetachTimer(TIMER timer) {
  enter(Call::OSDetachTimer);
  return detach_timer(timer) ? ok : failed;
}
int OSGetTime(int* hours, int* minutes, int* seconds, int* ticks) {
  enter(Call::OSGetTime);
  const TimeOfDay time = time_of_day();
  set(hours, time.hours);
  set(minutes, time.minutes);
  set(seconds, time.seconds);
  set(ticks, static_cast<int>(time.ns / millisecond));
  return ok;
}
int OSGetCount() {
  enter(Call::OSGetCount);
  return count_since_start(millisecond);
}

}  // extern "C"
