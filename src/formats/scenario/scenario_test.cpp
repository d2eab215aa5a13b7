#include "formats/scenario/scenario.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/math.h"

namespace sandlot::formats {
namespace {

Result<Scenario> scenario_of_text(std::string_view text, std::vector<Override> overrides = {}) {
  Diagnostics diagnostics;
  return parse_scenario(text, "dir/s.yaml", overrides, diagnostics);
}

std::string error_of(std::string_view text, std::vector<Override> overrides = {}) {
  const auto result = scenario_of_text(text, std::move(overrides));
  return result ? "" : result.error().text();
}

constexpr std::string_view indoor = R"(version: 1
name: indoor
world: ../worlds/indoor.sdf
physics: {engine: rigid, solver: auto}
time: {step: 20 ms, substeps: 4, control_interval: 5, stop: 2 min}
seed: 7
vars: {speed: 0.4, beams: 181, who: rov}
robots:
  - name: ${who}er
    model: ../models/rover/model.sdf
    pose: [1, 2, 0.5, 0, 0, 90 deg]
    team: red
    controller: {kind: wander, speed: ${speed}}
    devices:
      laser: {kind: laser_scanner, beams: ${beams}, cost: $${5}}
)";

TEST(Scenario, ReadsPropertiesWithTheirUnits) {
  const auto s = scenario_of_text(
      "version: 1\nrobots:\n- {name: a, model: m.sdf, properties: {fuel: {value: 500 g, unit: kg, max: 10}, "
      "points: 3}}\n"
      "things: [{name: b, model: m.sdf, properties: {food: 1}}]\n");
  ASSERT_TRUE(s) << s.error().text();
  const auto& properties = s->robots[0].instance.properties;
  ASSERT_EQ(properties.size(), 2u);
  EXPECT_EQ(properties[0].name, "fuel");
  EXPECT_EQ(properties[0].unit, "kg");
  EXPECT_EQ(properties[0].value, 0.5);
  EXPECT_EQ(properties[0].max, 10);
  EXPECT_EQ(properties[1].value, 3);
}

TEST(Scenario, ReadsTheWholeForm) {
  const auto s = scenario_of_text(indoor);
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->setup.name, "indoor");
  EXPECT_EQ(s->world, "../worlds/indoor.sdf");
  EXPECT_EQ(s->world_place.line, 3);
  EXPECT_EQ(s->setup.engine, "rigid");
  EXPECT_EQ(s->setup.physics.find("solver")->text(), "auto");
  EXPECT_EQ(s->setup.physics.find("engine"), nullptr);
  EXPECT_NEAR(s->setup.step.s(), 0.02, 1e-17);
  EXPECT_EQ(s->setup.substeps, 4);
  EXPECT_EQ(s->setup.control_interval, 5);
  EXPECT_EQ(s->setup.stop->s(), 120);
  EXPECT_EQ(s->setup.seed, 7u);
  ASSERT_EQ(s->robots.size(), 1u);
  const RobotGroup& robot = s->robots[0];
  EXPECT_EQ(robot.name, "rover");
  EXPECT_EQ(robot.instance.team, "red");
  EXPECT_EQ(robot.placement.X_WM.p, (Vec3{1, 2, 0.5}));
  EXPECT_NEAR(yaw_of(robot.placement.X_WM.q), math::pi / 2, 1e-15);
  ASSERT_EQ(robot.instance.controllers.size(), 1u);
  EXPECT_EQ(robot.instance.controllers[0].name, "controller");
  EXPECT_EQ(robot.instance.controllers[0].kind, "wander");
  EXPECT_EQ(robot.instance.controllers[0].config.find("kind"), nullptr);
  EXPECT_EQ(robot.instance.controllers[0].config.find("speed")->text(), "0.4");
  EXPECT_EQ(robot.devices.find("laser")->find("beams")->text(), "181");
  EXPECT_EQ(robot.devices.find("laser")->find("cost")->text(), "${5}");
  EXPECT_EQ(base_folder(*s, robot.model_place), "dir");
}

TEST(Scenario, LeavesDefaultsWhereNothingIsSaid) {
  const auto s = scenario_of_text("version: 1\n");
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->setup.engine, "rigid");
  EXPECT_EQ(s->world, "");
  EXPECT_EQ(s->setup.step.s(), 0.01);
  EXPECT_FALSE(s->setup.stop);
}

TEST(Scenario, PlacesGroups) {
  const auto s = scenario_of_text(R"(version: 1
robots:
  - {name: a, model: m, count: 9, distribution: {grid: {centre: [1, 2, 3], spacing: 50 cm}}}
  - {name: b, model: m, count: 3, distribution: {uniform: {width: 4, height: 5, clearance: 0.3}}}
  - {name: c, model: m, count: 2}
  - {name: d, model: m, pose: [1, 2, 90 deg]}
  - {name: e, model: m, pose: {x: 3, yaw: 1}}
)");
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->robots[0].placement.kind, Placement::Kind::grid);
  EXPECT_EQ(s->robots[0].placement.centre_m, (Vec3{1, 2, 3}));
  EXPECT_EQ(s->robots[0].placement.spacing_m, 0.5);
  EXPECT_EQ(s->robots[1].placement.kind, Placement::Kind::uniform);
  EXPECT_EQ(s->robots[1].placement.width_m, 4);
  EXPECT_EQ(s->robots[1].placement.height_m, 5);
  EXPECT_EQ(s->robots[1].placement.clearance_m, 0.3);
  EXPECT_EQ(s->robots[2].placement.kind, Placement::Kind::grid);
  EXPECT_NEAR(yaw_of(s->robots[3].placement.X_WM.q), math::pi / 2, 1e-15);
  EXPECT_EQ(s->robots[3].placement.X_WM.p.z, 0);
  EXPECT_EQ(s->robots[4].placement.X_WM.p.x, 3);
  EXPECT_NEAR(yaw_of(s->robots[4].placement.X_WM.q), 1, 1e-15);
}

TEST(Scenario, SetReachesVariablesAndPlaces) {
  const auto s = scenario_of_text(indoor, {{"speed", "0.9"},
                                           {"vars.beams", "5"},
                                           {"robots.count", "1"},
                                           {"robots[0].devices.laser.fov", "90 deg"},
                                           {"robots.devices.sonar.kind", "sonar"},
                                           {"robots.controller.turn", "[1, 2]"},
                                           {"physics", "planar"},
                                           {"time.stop", "5"},
                                           {"seed", "42"}});
  ASSERT_TRUE(s) << s.error().text();
  const RobotGroup& robot = s->robots[0];
  EXPECT_EQ(robot.instance.controllers[0].config.find("speed")->text(), "0.9");
  EXPECT_EQ(robot.instance.controllers[0].config.find("turn")->items()[1].text(), "2");
  EXPECT_EQ(robot.devices.find("laser")->find("beams")->text(), "5");
  EXPECT_EQ(robot.devices.find("laser")->find("fov")->text(), "90 deg");
  EXPECT_EQ(robot.devices.find("sonar")->find("kind")->text(), "sonar");
  EXPECT_EQ(s->setup.engine, "planar");
  EXPECT_NE(s->setup.physics.find("solver"), nullptr) << "physics=planar keeps the other keys";
  EXPECT_EQ(s->setup.stop->s(), 5);
  EXPECT_EQ(s->setup.seed, 42u);
  EXPECT_EQ(base_folder(*s, s->engine_place), "dir") << "a --set starts from the scenario's folder";
}

TEST(Scenario, SetLengthensShortForms) {
  const auto s = scenario_of_text(
      "version: 1\nphysics: planar\nrobots: [{name: a, model: m, controller: wander}]",
      {{"physics.grid", "3"}, {"robots.controller.speed", "2"}});
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->setup.engine, "planar");
  EXPECT_EQ(s->setup.physics.find("grid")->text(), "3");
  EXPECT_EQ(s->robots[0].instance.controllers[0].kind, "wander");
  EXPECT_EQ(s->robots[0].instance.controllers[0].config.find("speed")->text(), "2");
}

TEST(Scenario, SetSaysWhatIsWrongWithItsPath) {
  EXPECT_EQ(error_of(indoor, {{"robts.count", "3"}}),
            "--set robts.count=3: unknown key 'robts'; did you mean 'robots'?");
  EXPECT_EQ(error_of(indoor, {{"robots.cuont", "3"}}),
            "--set robots.cuont=3: /robots/0: unknown key 'cuont'; did you mean 'count'?");
  EXPECT_EQ(error_of(indoor, {{"vars.sped", "3"}}),
            "--set vars.sped=3: no variable 'sped'; did you mean 'speed'?");
  EXPECT_EQ(error_of(indoor, {{"robots[1].count", "3"}}),
            "--set robots[1].count=3: 'robots' has 1 element; the last one is robots[0]");
  EXPECT_EQ(
      error_of(indoor, {{"robots.count", "-3"}}),
      "--set robots.count=-3: /robots/0/count: must be in [0, 1e+06], is -3; Number of robots; 0: none.");
  EXPECT_NE(error_of(indoor, {{"time.step.x", "3"}}).find("has no 'x' in it"), std::string::npos);
  EXPECT_NE(error_of(indoor, {{"seed", "[1"}}).find("--set seed=[1: the value cannot be read"),
            std::string::npos);
  EXPECT_NE(error_of(indoor, {{"robots[x].count", "1"}}).find("whole number in brackets"), std::string::npos);
  EXPECT_NE(error_of(indoor, {{"", "1"}}).find("empty part"), std::string::npos);
  EXPECT_NE(error_of(indoor, {{"seed[0]", "1"}}).find("not a list"), std::string::npos);
  EXPECT_NE(
      error_of("version: 1\nrobots: [{name: a, model: m}, {name: b, model: m}]", {{"robots.count", "1"}})
          .find("'robots' has 2 elements, none named 'count'; name one of them, as robots[0] or robots.a"),
      std::string::npos);
}

TEST(Scenario, SetFindsElementsOfListsByName) {
  const std::string text =
      "version: 1\nrobots:\n  - {name: front, model: m}\n  - {name: rear, model: m, modules: [{id: eye, "
      "model: "
      "e}, {id: ear, model: f}]}\nthings: [{name: ball, model: b}]\nevents: [{name: late, when: t}]\n";
  const auto s = scenario_of_text(text, {{"robots.rear.count", "3"},
                                         {"robots.rear.controller.kind", "wander"},
                                         {"robots.rear.modules.ear.model", "g"},
                                         {"things.ball.label", "round"},
                                         {"events.late.when", "t > 2"}});
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->robots[0].count, 1);
  EXPECT_EQ(s->robots[1].count, 3);
  EXPECT_EQ(s->robots[1].instance.controllers.at(0).kind, "wander");
  EXPECT_EQ(s->robots[1].modules[0].model, "e");
  EXPECT_EQ(s->robots[1].modules[1].model, "g");
  EXPECT_EQ(s->things[0].instance.label, "round");
  EXPECT_EQ(error_of(text, {{"robots.raer.count", "3"}}),
            "--set robots.raer.count=3: 'robots' has 2 elements, none named 'raer'; did you mean "
            "'robots.rear'?");
}

TEST(Scenario, VariablesMayUseEachOtherButNotThemselves) {
  const auto s = scenario_of_text("version: 1\nname: ${c}-x\nvars: {a: 2, b: \"${a}0\", c: \"n${b}\"}\n");
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->setup.name, "n20-x");
  EXPECT_EQ(error_of("version: 1\nvars: {a: \"${b}\", b: \"${a}\"}\n"),
            "dir/s.yaml:2:22: variable 'b' is defined by itself");
  EXPECT_EQ(error_of("version: 1\nname: ${spede}\nvars: {speed: 1}\n"),
            "dir/s.yaml:2:7: no variable 'spede'; did you mean 'speed'?");
  EXPECT_NE(error_of("version: 1\nname: ${a\n").find("never closed"), std::string::npos);
  EXPECT_NE(error_of("version: 1\nname: x${a}\nvars: {a: [1]}\n").find("is a list and cannot be part"),
            std::string::npos);
}

TEST(Scenario, AVariableMayChooseAmongTheEntriesOfAnother) {
  const std::string text =
      "version: 1\nname: ${of[level]}-${ of [ level ] }\nvars: {level: image, of: {image: \"${low}\", world: "
      "pose}, low: ranges}\n";
  const auto s = scenario_of_text(text);
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->setup.name, "ranges-ranges");
  const auto high = scenario_of_text(text, {{"level", "world"}});
  ASSERT_TRUE(high) << high.error().text();
  EXPECT_EQ(high->setup.name, "pose-pose");
  EXPECT_EQ(error_of(text, {{"level", "imge"}}),
            "--set level=imge: 'level' is 'imge', and 'of' has no entry for that; did you mean 'image'?");
  EXPECT_EQ(error_of("version: 1\nname: ${a[b]}\nvars: {a: 1, b: 2}\n"),
            "dir/s.yaml:2:7: variable 'a' is '1' and has no entries to choose from");
  EXPECT_EQ(error_of("version: 1\nname: ${a[b]}\nvars: {a: {x: 1}, b: [2]}\n"),
            "dir/s.yaml:2:7: variable 'b' is a list and names no entry of 'a'");
  EXPECT_EQ(error_of("version: 1\nname: ${a[c]}\nvars: {a: {x: 1}}\n"),
            "dir/s.yaml:2:7: no variable 'c'; did you mean 'a'?");
  EXPECT_EQ(error_of("version: 1\nname: ${a[x]}\nvars: {a: {x: \"${a[x]}\"}, x: x}\n"),
            "dir/s.yaml:3:11: variable 'a' is defined by itself");
}

TEST(Scenario, VariablesCannotExplode) {
  std::string text = "version: 1\nname: ${v40}\nvars:\n  v0: xxxxxxxx\n";
  std::string lists = "version: 1\nname: ${v9}\nvars:\n  v0: [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i <= 40; ++i) {
    const std::string before = "${v" + std::to_string(i - 1) + "}";
    text += "  v" + std::to_string(i) + ": " + before + before + "\n";
    lists += "  v" + std::to_string(i) + ": [";
    for (int k = 0; k < 10; ++k) lists += (k ? ", \"" : "\"") + before + "\"";
    lists += "]\n";
  }
  EXPECT_NE(error_of(text).find("too long"), std::string::npos) << error_of(text);
  EXPECT_NE(error_of(lists).find("too many values"), std::string::npos);
}

TEST(Scenario, IncludesLieBelowTheIncludingFile) {
  const std::string folder = testing::TempDir() + "sandlot_includes/";
  std::filesystem::create_directories(folder + "sub");
  std::ofstream(folder + "top.yaml")
      << "version: 1\ninclude: [a.yaml, sub/b.yaml]\nname: top\ntime: {substeps: 3}\nvars: {mine: 1}\n";
  std::ofstream(folder + "a.yaml")
      << "version: 1\nname: a\nseed: 1\ntime: {step: 5 ms, substeps: 7}\nvars: {theirs: 1}\n";
  std::ofstream(folder + "sub/b.yaml") << "seed: 2\nworld: w.sdf\n";
  std::ofstream(folder + "loop.yaml") << "version: 1\ninclude: sub/back.yaml\n";
  std::ofstream(folder + "sub/back.yaml") << "\ninclude: [../loop.yaml]\n";
  std::ofstream(folder + "gone.yaml") << "version: 1\ninclude: [nowhere.yaml]\n";
  Diagnostics diagnostics;
  const auto s = read_scenario(folder + "top.yaml", {}, diagnostics);
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->setup.name, "top");
  EXPECT_EQ(s->setup.seed, 2u);
  EXPECT_EQ(s->setup.substeps, 3);
  EXPECT_EQ(s->setup.step.s(), 0.005);
  EXPECT_EQ(base_folder(*s, s->world_place) + "/", folder + "sub/");
  // A part has variables for scenarios that need them.
  ASSERT_EQ(s->unused_vars.size(), 1u);
  EXPECT_EQ(s->unused_vars[0].first, "mine");
  const auto loop = read_scenario(folder + "loop.yaml", {}, diagnostics);
  ASSERT_FALSE(loop);
  EXPECT_EQ(loop.error().text(), folder + "sub/back.yaml:2:11: /include: '../loop.yaml' includes itself");
  const auto gone = read_scenario(folder + "gone.yaml", {}, diagnostics);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().text(),
            folder + "gone.yaml:2:11: /include: cannot include '" + folder + "nowhere.yaml': no such file");
  std::filesystem::remove_all(folder);
}

TEST(Scenario, ZonesOfTheGround) {
  const auto s = scenario_of_text(R"(version: 1
ground_zones:
  - {name: ice, polygon: [[0, 0], [200 cm, 0], [0, 3]], friction: 0.05}
  - {name: belt, centre: [1, 2], radius: 0.5, substance: rubber(20), belt_velocity: [0.7, 0], rolling_resistance: 2 mm}
  - {name: hole, centre: [1, 2], no_contact: true}
)");
  ASSERT_TRUE(s) << s.error().text();
  ASSERT_EQ(s->setup.zones.size(), 3u);
  EXPECT_EQ(s->setup.zones[0].name, "ice");
  EXPECT_EQ(s->setup.zones[0].outline_W, (std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}));
  EXPECT_EQ(s->setup.zones[0].surface.mu, 0.05);
  EXPECT_EQ(s->setup.zones[0].surface.mu2, 0.05);
  EXPECT_EQ(s->setup.zones[0].place.line, 3);
  EXPECT_EQ(s->setup.zones[1].centre_W, (Vec3{1, 2, 0}));
  EXPECT_EQ(s->setup.zones[1].radius_m, 0.5);
  EXPECT_TRUE(s->setup.zones[1].outline_W.empty());
  EXPECT_EQ(s->setup.zones[1].surface.substance->hardness, 20);
  EXPECT_EQ(s->setup.zones[1].surface.belt_velocity_mps, (Vec3{0.7, 0, 0}));
  EXPECT_EQ(s->setup.zones[1].surface.rolling_resistance_m, 0.002);
  EXPECT_FALSE(s->setup.zones[2].surface.touches);
  const auto wrong = [](const std::string& zones) { return error_of("version: 1\nground_zones:\n" + zones); };
  const char* const cases[][2] = {
      {"  - {name: a}", "dir/s.yaml:3:5: /ground_zones/0: expected one of 'polygon' and 'centre'"},
      {"  - {name: a, centre: [0, 0], polygon: [[0, 0], [1, 0], [0, 1]]}", "expected one of"},
      {"  - {name: a, polygon: [[0, 0], [1, 0]]}", "/ground_zones/0/polygon: the list is too short"},
      {"  - {name: a, polygon: [[0, 0], [1, 1], [2, 2]]}", "no area"},
      {"  - {name: a, polygon: [[0, 0], [1, 0], [0, 1]], radius: 2}", "no radius"},
      {"  - {name: a, centre: [0, 0], substance: wood}",
       "dir/s.yaml:3:42: /ground_zones/0/substance: 'wood'"},
      {"  - {name: a, centre: [0, 0], friction: -1}", "/ground_zones/0/friction"},
      {"  - {name: '', centre: [0, 0]}", "name is empty"},
      {"  - {name: a, centre: [0, 0]}\n  - {name: a, centre: [1, 0]}", "the other one is at dir/s.yaml:3"},
      {"  - {name: a, centre: [0, 0], ice: 1}", "unknown key 'ice'"}};
  for (const auto& [zones, message] : cases)
    EXPECT_NE(wrong(zones).find(message), std::string::npos) << zones << "\n" << wrong(zones);
}

TEST(Scenario, NamesOfRobotsAndGroupsDoNotMeet) {
  const auto two = [](const std::string& a, const std::string& b) {
    return error_of("version: 1\nrobots:\n  - {" + a + ", model: m}\n  - {" + b + ", model: m}\n");
  };
  EXPECT_EQ(two("name: a", "name: a"),
            "dir/s.yaml:4:12: /robots: two robots would be called 'a'; the other one is at dir/s.yaml:3:12");
  EXPECT_NE(two("name: a b", "name: a_b"), "") << "one address";
  EXPECT_NE(two("name: a7", "name: a, count: 7"), "");
  EXPECT_EQ(two("name: a8", "name: a, count: 7"), "");
  EXPECT_EQ(two("name: a", "name: a, count: 7"), "");
  EXPECT_EQ(two("name: a07", "name: a, count: 9"), "");
  EXPECT_NE(two("name: a, count: 20", "name: a1, count: 5"), "") << "a11 is in both";
  EXPECT_EQ(two("name: a, count: 10", "name: a1, count: 5"), "");
}

TEST(Scenario, ElementsOfTheWorldHaveAKindAndANameOfTheirOwn) {
  Diagnostics diagnostics;
  const auto scenario = parse_scenario(
      "version: 1\n"
      "media: [wind, {kind: shout, name: air, speed: 10}]\n"
      "rules:\n"
      "  - {kind: goals, object: ball}\n"
      "markers: [{kind: disc, name: spot}]\n",
      "dir/s.yaml", {}, diagnostics);
  ASSERT_TRUE(scenario) << scenario.error().text();
  const model::Setup& setup = scenario->setup;
  ASSERT_EQ(setup.media.size(), 2u);
  EXPECT_EQ(setup.media[0].kind, "wind");
  EXPECT_EQ(setup.media[0].name, "wind");
  EXPECT_EQ(setup.media[1].name, "air");
  EXPECT_EQ(setup.media[1].config.entries().size(), 1u) << "kind and name are not the kind's own keys";
  EXPECT_EQ(setup.rules.at(0).place.line, 4);
  EXPECT_EQ(setup.markers.at(0).name, "spot");
}

TEST(Scenario, SaysToOtherProgramsWhatThereIs) {
  const auto s = scenario_of_text(
      "version: 1\nrobots: [{name: r, model: m, category: human, description: walks, tags: [tall, slow]}]\n"
      "things: [{name: t, model: m, tags: red}]\n"
      "poses:\n"
      "  - {name: dock, pose: [1, 2, 90 deg], tags: [parking], size: [1, 2, 0.5]}\n"
      "  - {name: goal, pose: {x: 3}, description: there}\n"
      "share: {topics: [/r/laser/ranges, '/t/*'], spectators: topics}\n");
  ASSERT_TRUE(s) << s.error().text();
  EXPECT_EQ(s->robots[0].instance.info.category, model::Category::human);
  EXPECT_EQ(s->robots[0].instance.info.description, "walks");
  EXPECT_EQ(s->robots[0].instance.info.tags, (std::vector<std::string>{"tall", "slow"}));
  EXPECT_EQ(s->things[0].instance.info.tags, std::vector<std::string>{"red"});
  EXPECT_EQ(s->things[0].instance.info.category, model::Category::automatic);
  ASSERT_EQ(s->setup.poses.size(), 2u);
  EXPECT_EQ(s->setup.poses[0].X_WP.p, (Vec3{1, 2, 0}));
  EXPECT_NEAR(s->setup.poses[0].X_WP.q.z, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(s->setup.poses[0].size_m, (Vec3{1, 2, 0.5}));
  EXPECT_EQ(s->setup.poses[1].description, "there");
  EXPECT_FALSE(s->setup.poses[1].size_m);
  const model::Sharing& sharing = s->setup.sharing;
  EXPECT_EQ(sharing.spectators, model::Sharing::Spectators::topics);
  ASSERT_EQ(sharing.topics.size(), 2u);
  EXPECT_EQ(sharing.topics[1].place.line, 7);
  EXPECT_TRUE(sharing.has("/r/laser/ranges") && sharing.has("/t/x/y") && !sharing.has("/r/laser/range"));
  EXPECT_EQ(scenario_of_text("version: 1\n")->setup.sharing.spectators, model::Sharing::Spectators::world);
}

TEST(Scenario, SchemaFollowsFromTheFieldLists) {
  using Json = nlohmann::json;
  const std::vector<KindFields> devices = {
      {"laser", {{"beams", "integer", "1", "Beams.", 1, 10}, {"noise/white", "number", "m", "", 0, 1}}}};
  const std::vector<ElementFields> elements = {{"rules", {{"goals", {{"object", "text", "", "", 0, 1}}}}}};
  const Json schema = Json::parse(scenario_schema(devices, {}, {}, {}, {}, elements));
  const Json& keys = schema["properties"];
  EXPECT_EQ(schema["required"], Json::array({"version"}));
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(keys["time"]["properties"]["substeps"]["maximum"], 1000);
  EXPECT_EQ(keys["time"]["properties"]["step"]["x-unit"], "s");
  EXPECT_EQ(keys["time"]["additionalProperties"], false);
  const Json& robot = keys["robots"]["items"];
  EXPECT_EQ(robot["required"], Json::array({"name", "model"}));
  EXPECT_EQ(robot["properties"]["distribution"]["properties"]["grid"]["properties"]["centre"]["minItems"], 3);
  const Json& device = robot["properties"]["devices"]["additionalProperties"];
  EXPECT_EQ(device["allOf"][0]["if"]["properties"]["kind"]["const"], "laser");
  EXPECT_EQ(device["allOf"][0]["if"]["required"], Json::array({"kind"}));
  const Json& laser = device["allOf"][0]["then"]["properties"];
  EXPECT_EQ(laser["beams"]["maximum"], 10);
  EXPECT_EQ(laser["noise"]["properties"]["white"]["type"], Json::array({"number", "string"}));
  EXPECT_TRUE(laser.contains("pose"));
  EXPECT_FALSE(Json::parse(schema_of(devices[0].second))["properties"].contains("pose"));
  const Json& rule = keys["rules"]["items"]["anyOf"][1]["allOf"][0]["then"]["properties"];
  EXPECT_TRUE(rule.contains("object") && rule.contains("name"));
}

}  // namespace
}  // namespace sandlot::formats
