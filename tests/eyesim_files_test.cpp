/// EyeSim's files in runs: worlds and robots as files a user could write.
#include <gtest/gtest.h>

#include "messages/messages.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

model::Setup loaded_setup(const std::string& file, std::vector<formats::Override> overrides = {}) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.overrides = overrides;
  auto setup = load(file, options, diagnostics);
  if (!setup) {
    ADD_FAILURE() << setup.error().text();
    return {};
  }
  for (const Error& warning : diagnostics.warnings) ADD_FAILURE() << warning.text();
  return std::move(*setup);
}

double range_of(const Simulation& sim, const std::string& device) {
  const auto* const topic = dynamic_cast<const Topic<msg::Range>*>(sim.find_topic("mouse/" + device));
  if (!topic || topic->count == 0) return ADD_FAILURE() << device, -1;
  return topic->message.range;
}

TEST(EyesimFiles, ARobotInAMazeMeasuresItsWalls) {
  for (const char* const engine : {"rigid", "planar"}) {
    SCOPED_TRACE(engine);
    auto sim = test::build(loaded_setup("tests/scenarios/eyesim_maze.yaml",
                                        {{"physics", engine}, {"robots.controller", "null"}}));
    ASSERT_TRUE(sim);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(static_cast<bool>(sim->tick()));
    // It stands in the middle of a cell of 360 mm and looks down a corridor: two walls of 10 mm are 175 mm away on either side,
    // from beams that begin 70 mm off the middle.
    EXPECT_NEAR(range_of(*sim, "PSD_LEFT"), 0.175 - 0.07, 2e-3);
    EXPECT_NEAR(range_of(*sim, "PSD_RIGHT"), 0.175 - 0.07, 2e-3);
  }
}

TEST(EyesimFiles, AScenarioRunsOnBothEnginesAndItsSensorsSeeItsMaze) {
  for (const char* const engine : {"rigid", "planar"}) {
    SCOPED_TRACE(engine);
    auto sim = test::build(loaded_setup("scenarios/maze.sim", {{"physics", engine},
                                                               {"errors", "0"},
                                                               {"robots.mouse.controller", "null"},
                                                               {"robots.S4.controller", "null"}}));
    ASSERT_TRUE(sim);
    EXPECT_EQ(sim->setup().step, Time::from_s(0.05));
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(static_cast<bool>(sim->tick()));
    // The first start: the middle of the top left cell of 360 mm, looking up. Walls of 10 mm are 175 mm away, the beams begin
    // 45 mm to the side and 60 mm ahead.
    EXPECT_NEAR(range_of(*sim, "PSD_LEFT"), 0.175 - 0.045, 2e-3);
    EXPECT_NEAR(range_of(*sim, "PSD_RIGHT"), 0.175 - 0.045, 2e-3);
    EXPECT_NEAR(range_of(*sim, "PSD_FRONT"), 0.175 - 0.06, 2e-3);
  }
}

}  // namespace
}  // namespace sandlot
