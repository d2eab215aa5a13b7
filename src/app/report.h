#pragma once
/// What a run leaves behind: the summary, as JSON and as text.
#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sim/session/runner.h"
#include "sim/world/simulation.h"

namespace sandlot::app {

/// Follows the robots: distance driven, ground covered. Asked after every tick, not an observer: frames would cost more.
class TravelRecorder {
 public:
  /// Takes the robots' places after a tick. @param simulation  the one that ran
  void look(const Simulation& simulation);
  /// What stands at this tick is no news.
  void begin_at(std::uint64_t tick) { tick_ = tick; }
  struct Travel {
    std::string name;
    bool started = false;
    Vec3 last, lowest, highest;
    double distance_m = 0;
    std::pair<int, int> cell{};                ///< of 0.5 m, where it is
    std::vector<std::pair<int, int>> cells{};  ///< visited, in order
  };
  const std::vector<Travel>& robots() const { return robots_; }

 private:
  std::uint64_t tick_ = 0;
  std::vector<Travel> robots_;
  std::unordered_map<std::string, std::size_t> by_name_;
};

/// @param errors  what ended the run early, if anything
nlohmann::ordered_json summarise(const Simulation& simulation, const RunReport& report,
                                 const TravelRecorder& travel, const Diagnostics& diagnostics,
                                 const std::vector<Error>& errors);

/// A dozen lines for people.
std::string as_text(const nlohmann::ordered_json& summary);

/// 16 hexadecimal digits.
std::string hex(std::uint64_t hash);

}  // namespace sandlot::app
