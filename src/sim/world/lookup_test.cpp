#include "sim/world/lookup.h"

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

}  // namespace
}  // namespace sandlot::test
