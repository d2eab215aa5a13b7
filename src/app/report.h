#pragma once
/// What a run leaves behind: the summary, as JSON and as text.
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "sim/runner.h"
#include "sim/simulation.h"

namespace sandlot::app {

/// Follows the robots: distance driven, ground covered.
class TravelRecorder final : public Observer {
 public:
  void on_frame(const std::shared_ptr<const Frame>& frame) override;
  struct Travel {
    std::string name;
    bool started = false;
    Vec3 last, lowest, highest;
    double distance_m = 0;
    std::set<std::pair<int, int>> cells;  ///< of 0.5 m, visited
  };
  const std::vector<Travel>& robots() const { return robots_; }

 private:
  std::vector<Travel> robots_;
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
