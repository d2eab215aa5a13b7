#include "controllers/grid_map.h"

#include <gmock/gmock.h>

#include "base/random.h"

namespace sandlot::controllers {
namespace {

using navigation::GridMap;
using testing::HasSubstr;

TEST(MapText, ReadsWhatTheHeaderShows) {
  const auto map = read_map_text("3 2 0.05 -1 -0.5 1.5\n  2*-1 1*100 3*0");
  ASSERT_TRUE(map) << map.error().text();
  EXPECT_EQ(map->geometry.width, 3);
  EXPECT_EQ(map->geometry.height, 2);
  EXPECT_EQ(map->geometry.resolution_m, 0.05);
  EXPECT_EQ(map->geometry.origin.x, -1);
  EXPECT_EQ(map->geometry.origin.y, -0.5);
  EXPECT_EQ(map->geometry.origin.theta, 1.5);
  EXPECT_EQ(map->occupancy, (std::vector<std::int8_t>{-1, -1, 100, 0, 0, 0}));
}

/// Numbers that no short decimal text gives come back to the bit, and every percentage.
TEST(MapText, KeepsEveryBit) {
  Stream random(5, entity_key("map text"), Purpose::experiment, 0);
  GridMap map{{31, 17, 0.1 / 3, {1e9 / 7, -1.0 / 3, math::pi}}, {}};
  while (map.occupancy.size() < map.geometry.cells()) {
    const auto percent = static_cast<std::int8_t>(static_cast<int>(random.below(102)) - 1);
    map.occupancy.insert(
        map.occupancy.end(),
        std::min<std::size_t>(1 + random.below(3), map.geometry.cells() - map.occupancy.size()), percent);
  }
  const auto back = read_map_text(map_text(map));
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(back->geometry.resolution_m, map.geometry.resolution_m);
  EXPECT_EQ(back->geometry.origin.x, map.geometry.origin.x);
  EXPECT_EQ(back->geometry.origin.y, map.geometry.origin.y);
  EXPECT_EQ(back->geometry.origin.theta, map.geometry.origin.theta);
  EXPECT_EQ(back->occupancy, map.occupancy);
}

TEST(MapText, RefusesWhatIsNoMap) {
  const auto refusal = [](std::string_view text) {
    const auto map = read_map_text(text);
    return map ? "" : map.error().text();
  };
  for (const char* none : {"", "3", "3 2 0.05 0 0", "a map", "3 2 0.05 0 0 x\n6*0"})
    EXPECT_THAT(refusal(none), HasSubstr("does not begin with width, height, resolution and origin")) << none;
  EXPECT_THAT(refusal("100000 10000 0.05 0 0 0\n1000000000*0"), HasSubstr("too large"));
  EXPECT_THAT(refusal("3 2 nan 0 0 0\n6*0"), HasSubstr("resolution"));
  EXPECT_THAT(refusal("3 2 0 0 0 0\n6*0"), HasSubstr("resolution"));
  EXPECT_THAT(refusal("3 2 -1 0 0 0\n6*0"), HasSubstr("resolution"));
  EXPECT_NE(refusal("3 2 1 inf 0 0\n6*0"), "");
  EXPECT_NE(refusal("-3 2 1 0 0 0\n6*0"), "");
  EXPECT_THAT(refusal("3 2 1 0 0 0\n5*0"), HasSubstr("has 5 cells"));
  EXPECT_THAT(refusal("3 2 1 0 0 0\n7*0"), HasSubstr("more than 6 cells"));
  EXPECT_THAT(refusal("3 2 1 0 0 0\n18446744073709551615*0"), HasSubstr("more than 6 cells"));
  EXPECT_THAT(refusal("3 2 1 0 0 0\n0*0 6*0"), HasSubstr("an empty run"));
  for (const char* run : {"6*101", "6*-2", "6", "6*", "*0", "6 * 0", "6x0", "3*0 3*0x", "6*99999999999"})
    EXPECT_THAT(refusal("3 2 1 0 0 0\n" + std::string(run)), HasSubstr("COUNT*PERCENT")) << run;
}

TEST(MapOf, NamesWhatIsMissing) {
  EXPECT_THAT(map_of({}).error().text(), HasSubstr("there is no map; map: a YAML file"));
  EXPECT_THAT(map_of({"flat.yaml", ""}).error().text(),
              HasSubstr("the map 'flat.yaml' was not read; declare the controller in the scenario"));
  EXPECT_TRUE(map_of({"flat.yaml", "1 1 1 0 0 0 1*0"}));
}

}  // namespace
}  // namespace sandlot::controllers
