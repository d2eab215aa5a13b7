#pragma once
/// Distance driven and ground covered by each robot of a run.
///
/// Distance  sum of the steps in the horizontal plane between two ticks: falling is not driving.
/// Ground    cells of 0.5 m that the origin of the robot was in.
/// Cost      one pose per robot and tick. Not an observer: frames would cost more.
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/vec3.h"

namespace sandlot {

class Simulation;

class TravelMeter {
 public:
  struct Travel {
    std::string name;
    bool started = false;
    Vec3 last, lowest, highest;  ///< [m] of the robot's model frame
    double distance_m = 0;
    std::pair<int, int> cell{};                ///< where it is
    std::vector<std::pair<int, int>> cells{};  ///< visited, in order
    double covered_m2() const { return cell_m * cell_m * static_cast<double>(cells.size()); }
  };
  static constexpr double cell_m = 0.5;

  /// Forgets everything; robots count from the first tick after this one.
  void restart(std::uint64_t tick);
  /// Takes the robots' places; the second call within a tick does nothing.
  void update(const Simulation& simulation);
  const std::vector<Travel>& robots() const { return robots_; }

 private:
  std::uint64_t tick_ = 0;
  std::vector<Travel> robots_;
  std::unordered_map<std::string, std::size_t> by_name_;
};

}  // namespace sandlot
