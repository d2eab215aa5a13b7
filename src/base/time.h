#pragma once
/// Simulated time: integer nanoseconds, so that a million steps of 0.1 s end exactly where they should.
#include <compare>
#include <cstdint>

namespace sandlot {

/// A duration or a point of simulated time, in nanoseconds since the start of the run.
struct Time {
  std::int64_t ns = 0;

  static constexpr std::int64_t per_s = 1'000'000'000;
  static constexpr Time from_ns(std::int64_t n) { return {n}; }
  /// @param s  seconds, rounded to the nearest nanosecond; beyond 9.2e9 s the greatest time there is
  static constexpr Time from_s(double s) {
    constexpr double most_ns = 9.2e18;
    const double ns = s * 1e9 + (s < 0 ? -0.5 : 0.5);
    if (ns < most_ns && ns > -most_ns) return {static_cast<std::int64_t>(ns)};
    return {static_cast<std::int64_t>(s > 0 ? most_ns : -most_ns)};
  }
  constexpr double s() const {
    return static_cast<double>(ns) / 1e9;
  }  // correctly rounded: 20 s is 20, not 20.000000000000004

  friend constexpr auto operator<=>(Time, Time) = default;  // NOLINT(modernize-use-nullptr): a false alarm
  friend constexpr Time operator+(Time a, Time b) { return {a.ns + b.ns}; }
  friend constexpr Time operator-(Time a, Time b) { return {a.ns - b.ns}; }
  friend constexpr Time operator*(Time a, std::int64_t k) { return {a.ns * k}; }
};

/// Due time of sample k of something that runs at `rate_hz` from `start`: start + floor(k * 1e9 / rate).
/// Computed from k, never accumulated, so that 3 Hz does not drift. After more than 127 years it never comes.
constexpr Time due_time(Time start, std::int64_t k, double rate_hz) {
  constexpr long double most_ns = 4e18L;
  const long double ns = static_cast<long double>(k) * 1e9L / static_cast<long double>(rate_hz);
  return {start.ns + static_cast<std::int64_t>(ns < most_ns ? ns : most_ns)};
}

}  // namespace sandlot
