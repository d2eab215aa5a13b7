#pragma once
/// Wall time spent per phase of the tick. Measured time informs people only: nothing in a run depends on it.
#include <array>
#include <chrono>
#include <cstdint>

namespace sandlot {

enum class Phase : std::uint8_t { commands, actuate, physics, scene, media, sense, rules, control, publish };
inline constexpr std::array phase_names{"commands", "actuate", "physics", "scene",  "media",
                                        "sense",    "rules",   "control", "publish"};

struct PhaseTimes {
  std::array<std::int64_t, phase_names.size()> ns{};
};

/// Adds the time since its construction to one phase.
class PhaseTimer {
 public:
  PhaseTimer(PhaseTimes& times, Phase phase)
      : ns_(times.ns[static_cast<std::size_t>(phase)]), begin_(std::chrono::steady_clock::now()) {}
  ~PhaseTimer() { ns_ += std::chrono::nanoseconds(std::chrono::steady_clock::now() - begin_).count(); }
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;

 private:
  std::int64_t& ns_;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace sandlot
