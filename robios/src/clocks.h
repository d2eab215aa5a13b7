#pragma once
/// Clocks of the program: virtual time as the functions of RoBIOS and of the C library show it.
#include <time.h>

#include <cstdint>

namespace robios {

inline constexpr const char* version_text = "RoBIOS of Sandlot";
inline constexpr std::int64_t epoch_s = 946'684'800;  ///< 2000-01-01, the date at the beginning of every run

struct TimeOfDay {
  int hours, minutes, seconds;
  std::int64_t ns;
};
TimeOfDay time_of_day();
bool set_time_of_day(int hours, int minutes, int seconds);
int count_since_start(std::int64_t unit_ns);  ///< wraps around
/// Time of an absolute time of the C library, of whichever clock.
std::int64_t deadline_ns(const timespec& t);
/// Now and a duration, without overflow.
std::int64_t after(std::int64_t ns);

}  // namespace robios
