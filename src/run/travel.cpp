#include "run/travel.h"

#include <algorithm>
#include <cmath>

#include "sim/world/simulation.h"

namespace sandlot {

void TravelMeter::restart(std::uint64_t tick) {
  robots_.clear();
  by_name_.clear();
  tick_ = tick;
}

void TravelMeter::update(const Simulation& simulation) {
  if (std::exchange(tick_, simulation.tick_index()) == simulation.tick_index()) return;
  std::size_t next = 0;  // as long as nobody leaves, robots come in the order of their first tick
  for (const auto& entity : simulation.entities()) {
    if (!entity->instance.is_robot) continue;
    const std::string& name = entity->instance.name;
    std::size_t index = next++;
    if (index >= robots_.size() || robots_[index].name != name) {
      const auto [known, fresh] = by_name_.emplace(name, robots_.size());
      if (fresh) robots_.push_back({.name = name});
      index = known->second;
    }
    Travel& travel = robots_[index];
    const Vec3 p = simulation.engine().pose(entity->id).p;
    const std::pair cell{static_cast<int>(std::floor(p.x / cell_m)),
                         static_cast<int>(std::floor(p.y / cell_m))};
    if (!travel.started) {
      travel.lowest = travel.highest = p;
    } else {
      const Vec3 step = p - travel.last;
      travel.distance_m += std::sqrt(step.x * step.x + step.y * step.y);  // falling is not driving
    }
    travel.last = p;
    for (std::size_t i = 0; i < 3; ++i) {
      travel.lowest[i] = std::min(travel.lowest[i], p[i]);
      travel.highest[i] = std::max(travel.highest[i], p[i]);
    }
    if (std::exchange(travel.started, true) && cell == travel.cell) continue;
    travel.cell = cell;
    const auto place = std::lower_bound(travel.cells.begin(), travel.cells.end(), cell);
    if (place == travel.cells.end() || *place != cell) travel.cells.insert(place, cell);
  }
}

}  // namespace sandlot
