/// What belongs to no robot, as the world that is told lists it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sim/test_world.h"
#include "wire/scene.h"

namespace sandlot::wire {
namespace {

using Json = nlohmann::json;
using test::arena;
using test::build;

TEST(World, MediaRulesAndProgramsOfTeamsAreListedWithTheirKinds) {
  model::Setup setup = arena("planar", 1, "");
  WorldJsonWriter writer{Assets()};
  const Json none = Json::parse(writer.write(*build(setup), 1));
  for (const char* key : {"media", "rules", "criteria", "teams"}) EXPECT_FALSE(none.contains(key)) << key;
  setup.media.push_back({"air", "shout", Node::map(), {}});
  setup.rules.push_back({"impact", "impact", Node::map(), {}});
  model::TeamDecl& team = setup.teams.emplace_back();
  team.name = "red";
  team.controllers.push_back({"coach", "formation", test::map({{"odometry", "truth"}}), {}});
  team.criterion = {.value = "sim.time", .success = "sim.time > 1"};
  setup.criterion = {.value = "2 * sim.time"};
  setup.instances.back().team = "red";
  const Json world = Json::parse(writer.write(*build(setup), 2));
  EXPECT_EQ(world["media"], Json::parse(R"([{"name": "air", "path": "media/air", "kind": "shout"}])"));
  EXPECT_EQ(world["rules"], Json::parse(R"([{"name": "impact", "path": "rules/impact", "kind": "impact"}])"));
  EXPECT_EQ(
      world["teams"],
      Json::parse(
          R"([{"name": "red", "programs": [{"name": "coach", "path": "red/coach", "kind": "formation"}]}])"));
  EXPECT_EQ(world["criteria"], Json::parse(R"([{"team": "", "address": "criterion", "value": "2 * sim.time"},
      {"team": "red", "address": "red.criterion", "value": "sim.time", "success": "sim.time > 1"}])"));
  EXPECT_EQ(world["kinds"]["media/shout"]["fields"][0]["path"], "speed");
  EXPECT_EQ(world["kinds"]["rules/impact"]["fields"][0]["path"], "threshold");
  EXPECT_EQ(world["kinds"]["formation"]["fields"][0]["path"], "shape");
}

}  // namespace
}  // namespace sandlot::wire
