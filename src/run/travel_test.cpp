#include "run/travel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// Robots that come and go keep their own distances: distinguished by name, whatever their place in the list.
TEST(TravelMeter, FollowsEachRobotWhenOneLeaves) {
  Diagnostics diagnostics;
  const std::vector<formats::Override> overrides{{"robots.count", "4"}};
  LoadOptions options;
  options.overrides = overrides;
  auto setup = load("scenarios/swarm.yaml", options, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_TRUE(made) << made.error().text();
  Simulation& simulation = **made;

  TravelMeter travel;
  travel.restart(simulation.tick_index());
  travel.update(simulation);
  EXPECT_TRUE(travel.robots().empty()) << "the state at the beginning is not a step";

  std::map<std::string, double> driven_m;
  std::map<std::string, Vec3> last;
  std::map<std::string, std::set<std::pair<int, int>>> cells;
  for (int tick = 0; tick < 60; ++tick) {
    if (tick == 30) simulation.submit(DeleteRequest{"scout2"});
    ASSERT_TRUE(simulation.tick());
    travel.update(simulation);
    travel.update(simulation);  // twice in one tick is once
    for (const auto& entity : simulation.entities()) {
      if (!entity->instance.is_robot) continue;
      const std::string& name = entity->instance.name;
      const Vec3 p = simulation.engine().pose(entity->id).p;
      if (last.contains(name))
        driven_m[name] += std::sqrt((p.x - last[name].x) * (p.x - last[name].x) +
                                    (p.y - last[name].y) * (p.y - last[name].y));
      last[name] = p;
      cells[name].emplace(static_cast<int>(std::floor(2 * p.x)), static_cast<int>(std::floor(2 * p.y)));
    }
  }
  ASSERT_EQ(travel.robots().size(), 4u);
  for (const TravelMeter::Travel& robot : travel.robots()) {
    EXPECT_NEAR(robot.distance_m, driven_m[robot.name], 1e-12) << robot.name;
    EXPECT_EQ(robot.cells.size(), cells[robot.name].size()) << robot.name;
    EXPECT_EQ(robot.last, last[robot.name]) << robot.name;
  }
  EXPECT_GT(driven_m["scout3"], 0.2);
}

}  // namespace
}  // namespace sandlot
