/// Things on paths in a whole simulation: where they are, what they push, what sees them, and that it all repeats.
#include "model/motion.h"

#include <gtest/gtest.h>

#include "messages/messages.h"
#include "messages/topic.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

class OnPaths : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Engines, OnPaths, testing::Values("rigid", "planar"),
                         [](const auto& p) { return std::string(p.param); });

/// A pillar of 0.2 m that walks from (3, 0) to (1.5, 0) in 3 s and back, after half a second.
model::Setup world(const char* engine) {
  model::Setup setup = arena(engine, 0);
  setup.instances.clear();
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  model::Instance walker = placed("walker", one_shape("walker", Cylinder{0.2, 1}, 0), {});
  walker.motion = model::Motion{
      .keys = {{0, {{3, 0, 0.5}, {}}}, {3, {{1.5, 0, 0.5}, {}}}, {6, {{3, 0, 0.5}, {}}}}, .delay_s = 0.5};
  setup.instances.push_back(walker);
  setup.instances.push_back(
      placed("crate", one_shape("crate", Cylinder{0.2, 0.4}, 2), {{2.2, 0.01, 0.2}, {}}));
  setup.instances.push_back(rover("watcher", rover_model(), {0, 0.5, 0}, 0, ""));
  return setup;
}

double x_of(const Simulation& simulation, const char* name) {
  return simulation.engine().pose(*simulation.find_instance(name)).p.x;
}

TEST_P(OnPaths, ItIsWhereThePathSaysAndPushesWhatIsInItsWay) {
  const auto simulation = build(world(GetParam()));
  EXPECT_NEAR(x_of(*simulation, "walker"), 3, 1e-12);
  advance(*simulation, 50);
  EXPECT_NEAR(x_of(*simulation, "walker"), 3, 1e-9);
  advance(*simulation, 100);
  EXPECT_NEAR(x_of(*simulation, "walker"), 2.5, 1e-9);
  advance(*simulation, 190);
  EXPECT_NEAR(x_of(*simulation, "walker"), 3 - 0.5 * 2.9, 1e-9);
  // At 0.5 m/s it holds the crate 0.4 m ahead of itself, but for what slipped aside.
  EXPECT_LT(x_of(*simulation, "crate"), 1.4);
  EXPECT_GT(x_of(*simulation, "crate"), 1.0);
}

TEST_P(OnPaths, ALaserSeesItCome) {
  model::Setup setup = world(GetParam());
  std::erase_if(setup.instances, [](const auto& i) { return i.name == "crate"; });
  setup.instances.back().X_WM = {};
  Node laser = map({{"beams", "1"}, {"rate", "100"}, {"min_range", "0.05"}, {"max_range", "6"}});
  for (auto& device : setup.instances.back().devices)
    if (device.name == "laser") device.config = laser;
  const auto simulation = build(setup);
  for (int i = 0; i < 4; ++i) {
    advance(*simulation, 75);
    const auto* topic = simulation->find_topic("watcher/laser");
    ASSERT_TRUE(topic);
    const auto* scan = dynamic_cast<const Topic<msg::LaserScan>*>(topic);
    ASSERT_TRUE(scan);
    const double t = 0.75 * (i + 1) - 0.5;
    // From the laser, above the axle, to the near side of the pillar. The rover may settle by a millimetre.
    EXPECT_NEAR(scan->message.ranges[0], 3 - 0.5 * t - 0.2, 2e-3) << t;
  }
}

TEST_P(OnPaths, EveryTickHasOneHashForAnyNumberOfThreadsAndAfterARestore) {
  const auto one = build(world(GetParam()), {.threads = 1}), two = build(world(GetParam()), {.threads = 2});
  advance(*one, 213);
  advance(*two, 213);
  ASSERT_EQ(one->state_hash(), two->state_hash());
  const auto restored = again(*one, {.threads = 2});
  ASSERT_TRUE(restored);
  for (int i = 0; i < 200; ++i) {
    advance(*one, 1);
    advance(*restored, 1);
    ASSERT_EQ(one->state_hash(), restored->state_hash()) << i;
  }
  EXPECT_EQ(x_of(*one, "walker"), x_of(*restored, "walker"));
}

}  // namespace
}  // namespace sandlot::test
