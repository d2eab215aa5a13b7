#include "app/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "sim/load/load.h"

namespace sandlot::app {
namespace {

/// Robots that come and go keep their own distances: told apart by name, whatever their place in the list.
TEST(TravelRecorder, FollowsEachRobotWhenOneLeaves) {
  Diagnostics diagnostics;
  const std::vector<formats::Override> overrides{{"robots.count", "4"}};
  LoadOptions options;
  options.overrides = overrides;
  auto setup = load("scenarios/swarm.yaml", options, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_TRUE(made) << made.error().text();
  Simulation& simulation = **made;

  TravelRecorder travel;
  travel.begin_at(simulation.tick_index());
  travel.look(simulation);
  EXPECT_TRUE(travel.robots().empty()) << "what stands at the beginning is no news";

  std::map<std::string, double> driven_m;
  std::map<std::string, Vec3> last;
  std::map<std::string, std::set<std::pair<int, int>>> cells;
  for (int tick = 0; tick < 60; ++tick) {
    if (tick == 30) simulation.submit(DeleteRequest{"scout2"});
    ASSERT_TRUE(simulation.tick());
    travel.look(simulation);
    travel.look(simulation);  // twice in one tick is once
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
  for (const TravelRecorder::Travel& robot : travel.robots()) {
    EXPECT_NEAR(robot.distance_m, driven_m[robot.name], 1e-12) << robot.name;
    EXPECT_EQ(robot.cells.size(), cells[robot.name].size()) << robot.name;
    EXPECT_EQ(robot.last, last[robot.name]) << robot.name;
  }
  EXPECT_GT(driven_m["scout3"], 0.2);
}

}  // namespace
}  // namespace sandlot::app
