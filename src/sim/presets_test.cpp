/// Every preset builds, and says what it was asked for.
#include "sim/presets.h"

#include <gtest/gtest.h>

#include "messages/messages.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

model::Instance with_device(const char* kind, Node config) {
  model::Instance instance = placed("robot", rover_model(), {});
  instance.is_robot = true;
  model::DeviceDecl decl;
  decl.name = "device";
  decl.kind = kind;
  decl.config = std::move(config);
  instance.devices.push_back(std::move(decl));
  return instance;
}

Result<std::unique_ptr<Simulation>> simulate(const char* kind, Node config) {
  model::Setup setup;
  setup.step = Time::from_s(0.001);
  setup.instances.push_back(with_device(kind, std::move(config)));
  Diagnostics diagnostics;
  return Simulation::create(std::move(setup), {}, diagnostics);
}

TEST(Presets, EachOfEachKindBuildsARunningDevice) {
  std::size_t count = 0;
  for (const Kind* kind : device_kinds())
    for (const Preset& preset : kind->presets) {
      auto simulation = simulate(kind->name, map({{"preset", preset.name}}));
      ASSERT_TRUE(simulation) << preset.name << ": " << simulation.error().text();
      EXPECT_TRUE((*simulation)->tick());
      EXPECT_NE(std::string(preset.help), "");
      ++count;
    }
  EXPECT_GE(count, 10u);
}

TEST(Presets, TheKeysBesideAPresetGoBefore) {
  const auto simulation = simulate("laser_scanner", map({{"preset", "sick_lms200"}, {"beams", "19"}}));
  ASSERT_TRUE(simulation) << simulation.error().text();
  const auto* scan = topic_cast<msg::LaserScan>((*simulation)->find_topic("robot/device"));
  ASSERT_NE(scan, nullptr);
  EXPECT_EQ(scan->message.ranges.size(), 19u);
  EXPECT_EQ(scan->message.range_max, 8);
  // A snapshot holds the preset by name and lays it again.
  const auto restored = again(**simulation);
  EXPECT_EQ(restored->state_hash(), (*simulation)->state_hash());
}

TEST(Presets, AnUnknownOneIsAnErrorWithTheNearest) {
  EXPECT_EQ(simulate("laser_scanner", map({{"preset", "sick_lsm200"}})).error().text(),
            "/preset: device kind 'laser_scanner' has no preset 'sick_lsm200'; did you mean 'sick_lms200'?");
  EXPECT_EQ(simulate("ground_truth", map({{"preset", "x"}})).error().text(),
            "/preset: device kind 'ground_truth' has no preset 'x'; it has none at all");
}

}  // namespace
}  // namespace sandlot::test
