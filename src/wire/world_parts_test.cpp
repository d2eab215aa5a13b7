/// Programs, and what belongs to no robot, as the world that is told lists them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "messages/geometry_msgs.h"
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

/// Reads two topics that clients publish.
struct Goer {
  struct Spec {
    static void fields(auto&, auto&&) {}
  };
  struct State {
    static void fields(auto&, auto&&) {}
  };
  Spec spec;
  State state;
  Status init(const Description&, Outputs& out) {
    out.subscribe<msg::PoseStamped>("goal_pose");
    out.subscribe<msg::PoseWithCovarianceStamped>("initialpose");
    return {};
  }
  void step(const Observation&, Command&) {}
};
constexpr ControllerKind goer = make_controller<Goer>({.name = "goer", .help = "Waits for goals."});
constexpr const ControllerKind* goers[] = {&goer};

TEST(World, TellsWhichTopicsOfClientsProgramsRead) {
  auto setup = arena("planar", 1);
  setup.instances.back().controllers.push_back({"way", "goer", test::map({}), {}});
  Diagnostics diagnostics;
  auto made = Simulation::create(std::move(setup), {.extra_controllers = goers}, diagnostics);
  ASSERT_TRUE(made) << made.error().text();
  WorldJsonWriter writer{Assets()};
  const Json world = Json::parse(writer.write(**made, 1));
  EXPECT_FALSE(world["instances"].front().contains("start")) << "of robots only";
  const Json& programs = world["instances"].back()["controllers"];
  EXPECT_FALSE(programs[0].contains("inputs")) << programs[0];
  EXPECT_EQ(programs[1], Json::parse(R"({"name":"way","path":"rover1/way","kind":"goer",
              "inputs":[{"name":"/rover1/goal_pose","type":"geometry_msgs/msg/PoseStamped"},
                        {"name":"/rover1/initialpose","type":"geometry_msgs/msg/PoseWithCovarianceStamped"}]})"));
}

}  // namespace
}  // namespace sandlot::wire
