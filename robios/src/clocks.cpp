#include "clocks.h"

#include <dlfcn.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/time.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "interpose.h"
#include "machine.h"
#include "tasks.h"
#include "timers.h"

namespace robios {
namespace {

std::int64_t day_offset_ns = 0;

timespec time_of(std::int64_t ns) { return {ns / second, ns % second}; }
bool is_duration(const timespec& t) { return t.tv_sec >= 0 && t.tv_nsec >= 0 && t.tv_nsec < second; }
std::int64_t ns_of(const timespec& t) {
  return t.tv_sec >= never / second - 1 ? never / 2 : t.tv_sec * second + t.tv_nsec;
}
timespec realtime() {
  timespec t = time_of(machine.clock_ns);
  t.tv_sec += epoch_s;
  return t;
}
bool is_realtime(clockid_t clock) {
  return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_TAI;
}
bool attached() { return machine.memory != nullptr; }

void doze(std::int64_t ns) {
  enter(Call::sleeps);
  sleep_until(after(std::max<std::int64_t>(ns, 0)), Others::run);
}

template <class F>
F real(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

}  // namespace

std::int64_t after(std::int64_t ns) { return ns > never - machine.clock_ns ? never : machine.clock_ns + ns; }

TimeOfDay time_of_day() {
  const std::int64_t day = 86'400 * second;
  const std::int64_t ns = ((machine.clock_ns + day_offset_ns) % day + day) % day;
  const std::int64_t s = ns / second;
  return {static_cast<int>(s / 3600), static_cast<int>(s / 60 % 60), static_cast<int>(s % 60), ns % second};
}

bool set_time_of_day(int hours, int minutes, int seconds) {
  if (hours < 0 || hours > 23 || minutes < 0 || minutes > 59 || seconds < 0 || seconds > 59) return false;
  day_offset_ns = ((hours * 60 + minutes) * 60 + seconds) * second - machine.clock_ns % (86'400 * second);
  return true;
}

int count_since_start(std::int64_t unit_ns) {
  return static_cast<int>((machine.clock_ns - machine.start_ns) / unit_ns & 0x7FFF'FFFF);
}

std::int64_t deadline_ns(const timespec& t) {
  const std::int64_t s = t.tv_sec >= epoch_s / 2 ? t.tv_sec - epoch_s : t.tv_sec;
  return s < 0 ? 0 : ns_of({s, t.tv_nsec});
}

}  // namespace robios

using namespace robios;

ROBIOS_INTERPOSE(time_t, time, time_t* to) {
  if (attached()) enter(Call::clocks);
  const time_t now = realtime().tv_sec;
  if (to) *to = now;
  return now;
}

ROBIOS_INTERPOSE(clock_t, clock, void) {
  if (attached()) enter(Call::clocks);
  return (machine.clock_ns - machine.start_ns) / (second / CLOCKS_PER_SEC);
}

ROBIOS_INTERPOSE(int, gettimeofday, timeval* to, void*) {
  if (attached()) enter(Call::clocks);
  const timespec now = realtime();
  if (to) *to = {now.tv_sec, now.tv_nsec / 1000};
  return 0;
}

ROBIOS_INTERPOSE(int, clock_gettime, clockid_t clock, timespec* to) {
  if (attached()) enter(Call::clocks);
  if (to) *to = is_realtime(clock) ? realtime() : time_of(machine.clock_ns);
  return 0;
}

ROBIOS_INTERPOSE(int, timespec_get, timespec* to, int base) {
  if (base != TIME_UTC || !to) return 0;
  if (attached()) enter(Call::clocks);
  *to = realtime();
  return base;
}

ROBIOS_INTERPOSE(unsigned, sleep, unsigned seconds) {
  doze(seconds * second);
  return 0;
}

ROBIOS_INTERPOSE(int, usleep, useconds_t microseconds) {
  doze(microseconds * microsecond);
  return 0;
}

ROBIOS_INTERPOSE(int, nanosleep, const timespec* duration, timespec* rest) {
  if (!duration || !is_duration(*duration)) {
    errno = EINVAL;
    return -1;
  }
  doze(ns_of(*duration));
  if (rest) *rest = {0, 0};
  return 0;
}

ROBIOS_INTERPOSE(int, clock_nanosleep, clockid_t, int flags, const timespec* t, timespec* rest) {
  if (!t || !is_duration(*t)) return EINVAL;
  doze(flags & TIMER_ABSTIME ? deadline_ns(*t) - machine.clock_ns : ns_of(*t));
  if (rest) *rest = {0, 0};
  return 0;
}

ROBIOS_INTERPOSE(int, poll, pollfd* files, nfds_t count, int timeout_ms) {
  static const auto next = real<int (*)(pollfd*, nfds_t, int)>("poll");
  const int ready = next(files, count, timeout_ms < 0 && count > 0 ? -1 : 0);
  if (ready != 0 || timeout_ms == 0) {
    enter(Call::sleeps);
    return ready;
  }
  doze(timeout_ms < 0 ? never : timeout_ms * millisecond);
  return next(files, count, 0);
}

ROBIOS_INTERPOSE(int, select, int count, fd_set* in, fd_set* out, fd_set* error, timeval* timeout) {
  static const auto next = real<int (*)(int, fd_set*, fd_set*, fd_set*, timeval*)>("select");
  if (!timeout) return next(count, in, out, error, nullptr);
  const auto copy = [](fd_set* set) { return set ? *set : fd_set{}; };
  const fd_set in_before = copy(in), out_before = copy(out), error_before = copy(error);
  timeval none{0, 0};
  const int ready = next(count, in, out, error, &none);
  const std::int64_t ns = timeout->tv_sec < 0 ? 0 : ns_of({timeout->tv_sec, timeout->tv_usec * 1000});
  if (ready != 0 || ns == 0) {
    enter(Call::sleeps);
    return ready;
  }
  doze(ns);
  *timeout = none;
  if (in) *in = in_before;
  if (out) *out = out_before;
  if (error) *error = error_before;
  return next(count, in, out, error, &none);
}

// Random numbers of the system are the same in every run: they count, from the robot's number on.
namespace {
void fill(void* to, std::size_t size) {
  static std::uint64_t state = 0;
  if (state == 0 && attached()) state = machine.robot().id * 0x9E37'79B9'7F4A'7C15u;
  for (std::size_t i = 0; i < size; i++) {
    std::uint64_t z = state += 0x9E37'79B9'7F4A'7C15u;  // splitmix64
    z = (z ^ (z >> 30)) * 0xBF58'476D'1CE4'E5B9u;
    z = (z ^ (z >> 27)) * 0x94D0'49BB'1331'11EBu;
    static_cast<unsigned char*>(to)[i] = static_cast<unsigned char>(z >> 56);
  }
}
}  // namespace

ROBIOS_INTERPOSE(ssize_t, getrandom, void* to, std::size_t size, unsigned) {
  fill(to, size);
  return static_cast<ssize_t>(size);
}
ROBIOS_INTERPOSE(int, getentropy, void* to, std::size_t size) {
  fill(to, size);
  return 0;
}
ROBIOS_INTERPOSE(std::uint32_t, arc4random, void) {
  std::uint32_t value = 0;
  fill(&value, sizeof(value));
  return value;
}

// An alarm is a timer that raises its signal.
namespace {
std::int64_t alarm_ns = never;
int alarm_timer = 0;
void ring() {
  if (machine.clock_ns < alarm_ns) return;
  alarm_ns = never;
  raise(SIGALRM);
}
}  // namespace

ROBIOS_INTERPOSE(unsigned, alarm, unsigned seconds) {
  enter(Call::sleeps);
  const std::int64_t rest = alarm_ns == never ? 0 : std::max<std::int64_t>(alarm_ns - machine.clock_ns, 1);
  if (alarm_timer != 0) detach_timer(alarm_timer);
  alarm_timer = 0;
  alarm_ns = never;
  if (seconds > 0 && seconds <= 2'000'000) {
    alarm_ns = machine.clock_ns + seconds * second;
    alarm_timer = attach_timer(static_cast<int>(seconds), second, ring);
  }
  return static_cast<unsigned>((rest + second - 1) / second);
}
