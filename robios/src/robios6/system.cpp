#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "../clocks.h"
#include "../timers.h"
#include "api.h"

using namespace robios;

namespace {

constexpr std::int64_t tick = 10 * millisecond;
constexpr std::size_t latches = 8;
BYTE written[latches] = {};
char name_text[name_size];
char version[64];

bool is_latch(int latch) { return latch >= 0 && latch < static_cast<int>(latches); }

}  // namespace

extern "C" {

// Keys

int KEYGetBuf(char* buffer) {
  enter(Call::KEYGetBuf);
  const std::uint32_t key = await_key(ANYKEY);
  if (buffer) *buffer = static_cast<char>(key);
  return ok;
}
// Time

TimerHandle OSAttachTimer(int scale, TimerFnc function) {
  enter(Call::OSAttachTimer);
  return attach_timer(scale, tick, function);
}
int OSDetachTimer(TimerHandle handle) {
  enter(Call::OSDetachTimer);
  return detach_timer(handle) ? ok : failed;
}
int OSGetTime(int* hours, int* minutes, int* seconds, int* ticks) {
  enter(Call::OSGetTime);
  const TimeOfDay time = time_of_day();
  set(hours, time.hours);
  set(minutes, time.minutes);
  set(seconds, time.seconds);
  set(ticks, static_cast<int>(time.ns / tick));
  return ok;
}
int OSShowTime() {
  enter(Call::OSShowTime);
  const TimeOfDay time = time_of_day();
  char text[40];
  std::snprintf(text, sizeof(text), "%02d:%02d:%02d", time.hours, time.minutes, time.seconds);
  screen.print(text);
  return ok;
}
int OSGetCount() {
  enter(Call::OSGetCount);
  return count_since_start(tick);
}
int OSWait(int n) {
  enter(Call::OSWait);
  if (n < 0) return failed;
  sleep_until(after(n * tick), Others::by_mode);
  return ok;
}

// System

char* OSVersion() {
  enter(Call::OSVersion);
  std::snprintf(version, sizeof(version), "%s", version_text);
  return version;
}
int OSError(const char* message, int number, BOOL dead) {
  enter(Call::OSError);
  char text[256];
  std::snprintf(text, sizeof(text), "%.200s %d\n", message ? message : "", number);
  screen.print(text);
  std::fprintf(stderr, "OSError: %s", text);
  if (dead) exit(1);
  return ok;
}
char* OSMachineName() {
  enter(Call::OSMachineName);
  std::snprintf(name_text, sizeof(name_text), "%.*s", static_cast<int>(name_size) - 1, machine.robot().name);
  return name_text;
}
int OSMachineSpeed() {
  enter(Call::OSMachineSpeed);
  return 35'000'000;
}
int OSInfoCPU(int* speed, int* memory, int* free_memory) {
  enter(Call::OSInfoCPU);
  set(speed, 35'000'000);
  set(memory, 2 << 20);
  set(free_memory, 1 << 20);
  return ok;
}
int OSGetAD(int channel) {
  enter(Call::OSGetAD);
  return channel == 1 ? battery_level() : 0;
}
BYTE OSReadInLatch(int latch) {
  enter(Call::OSReadInLatch);
  if (latch < 0 || latch >= static_cast<int>(most_bumpers / 8)) return 0;
  unsigned bits = 0;
  for (int i = 0; i < 8; i++) bits |= (machine.senses().bumper[latch * 8 + i] ? 1u : 0u) << i;
  return static_cast<BYTE>(bits);
}
BYTE OSWriteOutLatch(int latch, BYTE mask, BYTE value) {
  enter(Call::OSWriteOutLatch);
  if (!is_latch(latch)) return 0;
  const BYTE old = written[latch];
  written[latch] = static_cast<BYTE>((old & ~mask) ^ value);
  return old;
}
BYTE OSReadOutLatch(int latch) {
  enter(Call::OSReadOutLatch);
  return is_latch(latch) ? written[latch] : BYTE{0};
}

}  // extern "C"
