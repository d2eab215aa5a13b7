#include "sim/world/lookup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/test_world.h"

namespace sandlot::test {
namespace {

TEST(Lookup, FindsByNameOrSuggestsTheNearest) {
  const auto simulation = build(arena("planar", 2));
  EXPECT_EQ(entity_named(*simulation, "rover2").value()->instance.name, "rover2");
  EXPECT_EQ(device_named(*simulation, "rover2/laser").value()->path, "rover2/laser");
  const auto what = [](const auto& result) { return result ? std::string() : result.error().what; };
  const auto entity = entity_named(*simulation, "rower2");
  EXPECT_EQ(what(entity), "there is nothing named 'rower2'");
  EXPECT_NE(entity.error().fix.find("rover2"), std::string::npos);
  EXPECT_EQ(what(device_named(*simulation, "rower2/laser")), "there is nothing named 'rower2'");
  const auto device = device_named(*simulation, "rover2/lasser");
  EXPECT_EQ(what(device), "there is no device 'rover2/lasser'");
  EXPECT_NE(device.error().fix.find("rover2/laser"), std::string::npos);
}

/// A viewer that has a const simulation cannot change what it finds there.
TEST(Lookup, WhatIsFoundIsConstThroughAndThrough) {
  using Entity = decltype(*std::declval<const Simulation&>().entities()[0]);
  static_assert(std::is_same_v<Entity, const Simulation::Entity&>);
  using Device = decltype(*std::declval<Entity>().devices[0]);
  static_assert(std::is_same_v<Device, const Simulation::Device&>);
  static_assert(std::is_same_v<decltype(*std::declval<Device>().topics[0].topic), const TopicBase&>);
  static_assert(std::is_same_v<decltype(*std::declval<Device>().commands[0].topic), const TopicBase&>);
  static_assert(std::is_same_v<decltype(*std::declval<Device>().faults), const Faults&>);
  using ProgramEntry = decltype(*std::declval<Entity>().programs[0]);
  static_assert(std::is_same_v<ProgramEntry, const Simulation::ProgramEntry&>);
  static_assert(std::is_same_v<decltype(*std::declval<ProgramEntry>().program), const Program&>);
  static_assert(std::is_same_v<decltype(*std::declval<ProgramEntry>().routes[0].device), Device>);
  static_assert(
      std::is_same_v<decltype(*std::declval<ProgramEntry>().routes[0].slot), const Simulation::Slot&>);
  const auto simulation = build(arena("planar", 1));
  EXPECT_THAT(entity_names(*simulation), testing::Contains("rover1"));
}

}  // namespace
}  // namespace sandlot::test
