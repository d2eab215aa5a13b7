/// simulation_interfaces over a socket, against values that are predicted by hand.
#include "base/math.h"
#include "server/test_bridge.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;
using sandlot::test::one_shape;
using sandlot::test::placed;

int code(const json& answer) {
  const json& values = answer["values"];
  return values.is_object() ? values["result"]["result"].get<int>() : -1;
}
std::string why(const json& answer) {
  const json& values = answer["values"];
  return values.is_object() ? values["result"]["error_message"].get<std::string>() : values.dump();
}
json at(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }
json turned(double yaw) { return {{"w", math::cos(yaw / 2)}, {"x", 0}, {"y", 0}, {"z", math::sin(yaw / 2)}}; }
void expect_vector(const json& v, double x, double y, double z, double tolerance, const char* what) {
  EXPECT_NEAR(v["x"].get<double>(), x, tolerance) << what;
  EXPECT_NEAR(v["y"].get<double>(), y, tolerance) << what;
  EXPECT_NEAR(v["z"].get<double>(), z, tolerance) << what;
}

constexpr const char* cube_text =
    "<?xml version='1.0'?><!-- a cube --><sdf version='1.9'><model name='cube'><link name='l'>"
    "<inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
    "<collision name='c'><geometry><box><size>0.4 0.6 1</size></box></geometry></collision>"
    "</link></model></sdf>";

/// Nothing but boxes that fall nowhere: a (0.4 x 0.6 x 1 m), and b.
model::Setup weightless() {
  model::Setup setup;
  setup.name = "space";
  setup.engine = "rigid";
  setup.step = Time::from_s(0.01);
  setup.gravity = {0, 0, 0};
  const auto box = one_shape("box", Box{{0.4, 0.6, 1}}, 2);
  setup.instances.push_back(placed("a", box, {{1, 2, 5}, quat_from_rpy(0, 0, math::pi / 2)}));
  setup.instances.push_back(placed("b", box, {{-3, 0, 5}, {}}));
  setup.instances.push_back(placed("rock", one_shape("rock", Sphere{0.5}, 0), {{0, -9, 0}, {}}));
  return setup;
}

TEST(SimulationServices, FeaturesSayWhatThereIs) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  Bridge bridge(run.url());
  const json features = bridge.call("/get_simulator_features", json::object())["values"]["features"];
  EXPECT_EQ(features["spawn_formats"], json({"sdf", "urdf"}));
  const auto all = features["features"].get<std::vector<int>>();
  for (const int missing : {33, 42, 43}) EXPECT_EQ(std::count(all.begin(), all.end(), missing), 0) << missing;
  // 10 of 0 to 9, 5 of 10 to 14, 7 of 20 to 26, 31, 32, 40, 41, 44, 45, 50.
  EXPECT_EQ(all.size(), 29u);
  EXPECT_EQ(code(bridge.call("/unload_world", json::object())), 0);
}

TEST(SimulationServices, FiltersChooseByNameCategoryTagsAndBounds) {
  for (const char* engine : {"rigid", "planar"}) {
    model::Setup setup = arena(engine, 1, "");
    for (model::Instance& each : setup.instances) {
      if (each.name == "crate1") each.info.tags = {"red", "heavy"};
      if (each.name == "crate2") each.info.tags = {"heavy"}, each.info.category = model::Category::human;
    }
    Running run(std::move(setup), {.paused = true});
    run.go();
    Bridge bridge(run.url());
    const auto found = [&](const json& filters) {
      const json answer = bridge.call("/get_entities", {{"filters", filters}});
      EXPECT_EQ(code(answer), 1) << why(answer);
      return answer["values"]["entities"];
    };
    EXPECT_EQ(found({{"filter", "^(crate|rover)1$"}}), json({"crate1", "rover1"}));
    EXPECT_EQ(found({{"categories", {{{"category", 2}}}}}), json({"crate2"}));
    EXPECT_EQ(found({{"categories", {{{"category", 4}}, {{"category", 1}}}}}), json({"crate1", "rover1"}));
    EXPECT_EQ(found({{"tags", {{"tags", {"red", "heavy"}}}}}), json({"crate1", "crate2"}));
    EXPECT_EQ(found({{"tags", {{"tags", {"red", "heavy"}}, {"filter_mode", 1}}}}), json({"crate1"}));
    // crate1: a cylinder of radius 0.2 m at (0.4, -2.1), 0 to 0.4 m high.
    const auto sphere = [](double x, double y, double z, double r) {
      return json{{"bounds", {{"type", 3}, {"points", {at(x, y, z), at(r, 0, 0)}}}}};
    };
    EXPECT_EQ(found(sphere(0.7, -2.1, 0.2, 0.101)), json({"crate1"}));
    EXPECT_EQ(found(sphere(0.7, -2.1, 0.2, 0.099)), json::array());
    const auto box = [](const json& upper, const json& lower) {
      return json{{"bounds", {{"type", 1}, {"points", {upper, lower}}}}};
    };
    EXPECT_EQ(found(box(at(0.9, -2, 0.3), at(0.599, -2.2, 0.1))), json({"crate1"}));
    EXPECT_EQ(found(box(at(0.9, -2, 0.3), at(0.601, -2.2, 0.1))), json::array());
    // Its corner is 0.15 * sqrt(2) = 0.212 m from the axis: in the box around the crate, and not in the crate.
    EXPECT_EQ(found(box(at(0.9, -1.7, 0.3), at(0.55, -1.95, 0.1))), json::array());
    EXPECT_EQ(found(box(at(0.9, -1.7, 0.3), at(0.54, -1.96, 0.1))), json({"crate1"}));
    const json triangle{at(0.4, -2.1, 0.2), at(0.4, 9, 0.2), at(0.5, 9, 0.2)};
    const json met = found({{"bounds", {{"type", 2}, {"points", triangle}}}});
    EXPECT_EQ(met, json({"wall2", "crate1"})) << engine;
    // With states, in the same order.
    const json states = bridge.call("/get_entities_states", {{"filters", {{"filter", "crate"}}}})["values"];
    EXPECT_EQ(states["entities"], json({"crate1", "crate2"}));
    expect_vector(states["states"][1]["pose"]["position"], -2.2, 1.9, 0.2, 1e-9, engine);
    EXPECT_EQ(states["states"][1]["header"]["frame_id"], "world");
    for (const json& wrong : {json{{"filter", "("}}, json{{"tags", {{"tags", {"a"}}, {"filter_mode", 7}}}},
                              json{{"bounds", {{"type", 3}, {"points", json::array()}}}},
                              json{{"bounds", {{"type", 3}, {"points", {at(0, 0, 0), at(-1, 0, 0)}}}}},
                              json{{"bounds", {{"type", 2}, {"points", {at(0, 0, 0), at(1, 0, 0)}}}}}})
      EXPECT_EQ(code(bridge.call("/get_entities", {{"filters", wrong}})), 4) << wrong;
    EXPECT_EQ(code(bridge.call("/get_entities", {{"filters", {{"bounds", {{"type", 9}}}}}})), 0);
  }
}

TEST(SimulationServices, BoundsAreThoseOfTheShapesInTheFrameOfTheCanonicalLink) {
  Running run(weightless(), {.paused = true});
  run.go();
  Bridge bridge(run.url());
  const json a = bridge.call("/get_entity_bounds", {{"entity", "a"}})["values"];
  EXPECT_EQ(a["bounds"]["type"], 1);
  expect_vector(a["bounds"]["points"][0], 0.2, 0.3, 0.5, 1e-12, "upper");
  expect_vector(a["bounds"]["points"][1], -0.2, -0.3, -0.5, 1e-12, "lower");
  EXPECT_EQ(code(bridge.call("/get_entity_bounds", {{"entity", "c"}})), 2);

  Running other(arena("rigid", 1, ""), {.paused = true});
  other.go();
  Bridge rover(other.url());
  // Base: a cylinder of radius 0.17 and length 0.12 about its origin at 0.12 m; wheels: balls of 0.07 m at y = +-0.15,
  // 0.05 m below; casters: balls of 0.03 m, 0.09 m below.
  const json bounds = rover.call("/get_entity_bounds", {{"entity", "rover1"}})["values"]["bounds"];
  expect_vector(bounds["points"][0], 0.17, 0.22, 0.06, 1e-9, "upper");
  expect_vector(bounds["points"][1], -0.17, -0.22, -0.12, 1e-9, "lower");
  EXPECT_EQ(rover.call("/get_entity_bounds", {{"entity", "ground"}})["values"]["bounds"]["type"], 0)
      << "a plane has no end";
}

TEST(SimulationServices, StatesAreSetInFramesWithTheirVelocity) {
  Running run(weightless(), {.paused = true});
  run.go();
  Bridge bridge(run.url());
  const auto set = [&](const char* entity, const char* frame, const json& pose, const json& twist) {
    json state{{"header", {{"frame_id", frame}}}};
    if (!pose.is_null()) state["pose"] = pose;
    if (!twist.is_null()) state["twist"] = twist;
    return bridge.call("/set_entity_state", {{"entity", entity},
                                             {"set_pose", !pose.is_null()},
                                             {"set_twist", !twist.is_null()},
                                             {"state", state}});
  };
  const auto step = [&](int steps) {
    EXPECT_EQ(code(bridge.call("/step_simulation", {{"steps", steps}})), 1);
  };
  const auto state = [&](const char* entity) {
    return bridge.call("/get_entity_state", {{"entity", entity}})["values"]["state"];
  };
  const json still{{"linear", at(0, 0, 0)}, {"angular", at(0, 0, 0)}};
  // In the world: 1 m/s for 10 steps of 10 ms.
  EXPECT_EQ(code(set("b", "", {{"position", at(0, 0, 5)}, {"orientation", turned(0)}},
                     {{"linear", at(1, 0.5, 0)}, {"angular", at(0, 0, 2)}})),
            1);
  step(10);
  json b = state("b");
  expect_vector(b["pose"]["position"], 0.1, 0.05, 5, 1e-6, "moved by v t");
  expect_vector(b["twist"]["linear"], 1, 0.5, 0, 1e-6, "v");
  expect_vector(b["twist"]["angular"], 0, 0, 2, 1e-6, "w");
  EXPECT_NEAR(b["pose"]["orientation"]["z"].get<double>(), math::sin(0.1), 1e-6) << "turned by 0.2 rad";
  // In the frame of a, which stands at (1, 2, 5) turned by a quarter: x there is y in the world.
  EXPECT_EQ(code(set("b", "a", {{"position", at(3, 0, 0)}, {"orientation", turned(0)}},
                     {{"linear", at(1, 0, 0)}, {"angular", at(0, 0, 0)}})),
            1);
  step(1);
  b = state("b");
  expect_vector(b["twist"]["linear"], 0, 1, 0, 1e-9, "x of a is y");
  expect_vector(b["pose"]["position"], 1, 2 + 3 + 0.01, 5, 1e-9, "3 m ahead of a, and a step on");
  EXPECT_NEAR(b["pose"]["orientation"]["z"].get<double>(), math::sin(math::pi / 4), 1e-9);
  // What stands still in a frame that turns goes round with it: w x r = (0, 0, 1) x (0, 3, 0).
  EXPECT_EQ(code(set("a", "world", nullptr, {{"linear", at(0, 0, 0)}, {"angular", at(0, 0, 1)}})), 1);
  EXPECT_EQ(code(set("b", "world", {{"position", at(1, 5, 5)}, {"orientation", turned(0)}}, still)), 1);
  step(1);
  EXPECT_EQ(code(set("b", "a/link", nullptr, still)), 1);
  step(1);
  b = state("b");
  expect_vector(b["twist"]["linear"], -3, 0, 0, 0.05, "round with a, which has turned by 0.01 rad");
  EXPECT_NEAR(b["twist"]["angular"]["z"].get<double>(), 1, 1e-9);
  // What is refused has changed nothing.
  EXPECT_EQ(code(set("b", "nowhere", nullptr, still)), 101);
  EXPECT_EQ(code(set("b", "",
                     {{"position", at(0, 0, 0)}, {"orientation", {{"w", 0}, {"x", 0}, {"y", 0}, {"z", 0}}}},
                     nullptr)),
            101);
  EXPECT_EQ(code(set("b", "", {{"position", at(2e6, 0, 0)}}, nullptr)), 101);
  EXPECT_EQ(code(set("c", "", nullptr, still)), 2);
  EXPECT_EQ(code(set("rock", "", nullptr, {{"linear", at(1, 0, 0)}, {"angular", at(0, 0, 0)}})), 4);
  EXPECT_EQ(code(set("rock", "", nullptr, still)), 1) << "no twist at all is what it has";
  EXPECT_EQ(code(bridge.call("/set_entity_state", {{"entity", "b"}})), 1) << "nothing was asked";
}

TEST(SimulationServices, DescriptionsAreSetAndFound) {
  Running run(weightless(), {.paused = true});
  run.go();
  Bridge bridge(run.url());
  const json before = bridge.call("/get_entity_info", {{"entity", "rock"}})["values"]["info"];
  EXPECT_EQ(before["category"]["category"], 5);
  EXPECT_EQ(bridge.call("/get_entity_info", {{"entity", "a"}})["values"]["info"]["category"]["category"], 4);
  const json info{{"category", {{"category", 2}}}, {"description", "a walker"}, {"tags", {"tall"}}};
  EXPECT_EQ(code(bridge.call("/set_entity_info", {{"entity", "a"}, {"info", info}})), 1);
  EXPECT_EQ(code(bridge.call("/step_simulation", {{"steps", 1}})), 1);
  EXPECT_EQ(bridge.call("/get_entity_info", {{"entity", "a"}})["values"]["info"], info);
  const json tall = bridge.call("/get_entities", {{"filters", {{"tags", {{"tags", {"tall"}}}}}}});
  EXPECT_EQ(tall["values"]["entities"], json({"a"}));
  EXPECT_EQ(
      code(bridge.call("/set_entity_info", {{"entity", "a"}, {"info", {{"category", {{"category", 3}}}}}})),
      4);
  EXPECT_EQ(code(bridge.call("/set_entity_info", {{"entity", "c"}, {"info", info}})), 2);
  EXPECT_EQ(code(bridge.call("/get_entity_info", {{"entity", "c"}})), 2);
  // A reset takes it back.
  EXPECT_EQ(code(bridge.call("/reset_simulation", {{"scope", 0}})), 1);
  EXPECT_EQ(bridge.call("/get_entity_info", {{"entity", "a"}})["values"]["info"]["description"], "");
}

TEST(SimulationServices, EntitiesAreSpawnedFromTextsAndAddresses) {
  Running run(weightless(), {.paused = true});
  run.go();
  Bridge bridge(run.url());
  const auto spawn = [&](json request) { return bridge.call("/spawn_entity", request); };
  const json cube{{"resource_string", cube_text}};
  const json made = spawn(
      {{"entity_resource", cube},
       {"initial_pose", {{"header", {{"frame_id", "a"}}}, {"pose", {{"position", at(2, 0, 0)}}}}}});
  EXPECT_EQ(code(made), 1) << why(made);
  EXPECT_EQ(made["values"]["entity_name"], "cube") << "of the text";
  EXPECT_EQ(code(spawn({{"entity_resource", cube}})), 101) << "it waits for the next tick, and has the name";
  EXPECT_EQ(code(bridge.call("/step_simulation", {{"steps", 1}})), 1);
  const json state = bridge.call("/get_entity_state", {{"entity", "cube"}})["values"]["state"];
  expect_vector(state["pose"]["position"], 1, 4, 5, 1e-9, "2 m along the x axis of a");
  const json bounds = bridge.call("/get_entity_bounds", {{"entity", "cube"}})["values"]["bounds"];
  expect_vector(bounds["points"][0], 0.2, 0.3, 0.5, 1e-12, "half of 0.4 x 0.6 x 1");

  EXPECT_EQ(code(spawn({{"name", "cube"}, {"entity_resource", cube}})), 101);
  const json second = spawn({{"name", "cube"}, {"allow_renaming", true}, {"entity_resource", cube}});
  EXPECT_EQ(second["values"]["entity_name"], "cube2") << why(second);
  EXPECT_EQ(code(spawn({{"name", "a b"}, {"entity_resource", cube}})), 102);
  EXPECT_EQ(
      spawn({{"name", "a b"}, {"allow_renaming", true}, {"entity_resource", cube}})["values"]["entity_name"],
      "a_b");
  EXPECT_EQ(code(spawn({{"name", std::string(101, 'x')}, {"entity_resource", cube}})), 102);
  EXPECT_EQ(code(spawn({{"name", "x"}, {"entity_resource", {{"resource_string", "solid cube"}}}})), 103);
  EXPECT_EQ(code(spawn({{"name", "x"}, {"entity_resource", {{"uri", "scenarios/indoor.yaml"}}}})), 103);
  EXPECT_EQ(code(spawn({{"name", "x"}})), 104);
  EXPECT_EQ(code(spawn({{"name", "x"}, {"entity_resource", cube}, {"entity_namespace", "9x"}})), 105);
  EXPECT_EQ(code(spawn({{"name", "x"}, {"entity_resource", cube}, {"entity_namespace", "fleet"}})), 0);
  EXPECT_EQ(code(spawn({{"name", "x"},
                        {"entity_resource", {{"resource_string", "<sdf version='1.9'><model name='m'>"}}}})),
            106);
  const std::string meshy =
      "<sdf version='1.9'><model name='m'><link name='l'><collision "
      "name='c'><geometry><mesh><uri>nothing.stl</uri>"
      "</mesh></geometry></collision></link></model></sdf>";
  EXPECT_EQ(code(spawn({{"name", "x"}, {"entity_resource", {{"resource_string", meshy}}}})), 107);
  EXPECT_EQ(code(spawn({{"name", "x"},
                        {"entity_resource", cube},
                        {"initial_pose", {{"header", {{"frame_id", "nowhere"}}}}}})),
            109);
  EXPECT_EQ(code(spawn(
                {{"name", "x"},
                 {"entity_resource", cube},
                 {"initial_pose", {{"pose", {{"orientation", {{"w", 0}, {"x", 0}, {"y", 0}, {"z", 0}}}}}}}})),
            109);
  EXPECT_EQ(code(spawn({{"name", "x"}, {"entity_resource", {{"uri", "model://no_such_robot"}}}})), 2);
  EXPECT_EQ(code(spawn({{"name", "x"}, {"entity_resource", {{"uri", "file:///etc/passwd"}}}})), 2);

  const json spawnables = bridge.call("/get_spawnables", {{"sources", {"moon"}}})["values"];
  EXPECT_EQ(spawnables["result"]["result"], 1);
  EXPECT_NE(spawnables["result"]["error_message"].get<std::string>().find("'moon'"), std::string::npos);
  const auto offers = [&](const char* uri) {
    for (const json& each : spawnables["spawnables"])
      if (each["entity_resource"]["uri"] == uri) return true;
    return false;
  };
  ASSERT_TRUE(offers("model://rover/model.sdf") && offers("builder:snake"));
  // Several at once, one of which cannot be.
  const json several = bridge.call(
      "/spawn_entities", {{"spawn_requests",
                           {{{"name", "r"}, {"entity_resource", {{"uri", "model://rover/model.sdf"}}}},
                            {{"name", "r"}, {"entity_resource", cube}},
                            {{"name", "s"},
                             {"entity_resource", {{"uri", "builder:snake"}}},
                             {"initial_pose", {{"pose", {{"position", at(0, 3, 0)}}}}}}}}});
  EXPECT_EQ(code(several), 150) << why(several);
  ASSERT_EQ(several["values"]["results"].size(), 3u);
  EXPECT_EQ(several["values"]["results"][0]["result"]["result"], 1) << several;
  EXPECT_EQ(several["values"]["results"][1]["result"]["result"], 101);
  EXPECT_EQ(several["values"]["results"][2]["result"]["result"], 1);
  EXPECT_EQ(code(bridge.call("/step_simulation", {{"steps", 1}})), 1);
  EXPECT_EQ(bridge.call("/get_entity_info", {{"entity", "r"}})["values"]["info"]["category"]["category"], 1);
  // What was spawned goes by itself, or with the whole.
  EXPECT_EQ(code(bridge.call("/reset_simulation", {{"scope", 1}})), 0);
  EXPECT_EQ(code(bridge.call("/reset_simulation", {{"scope", 3}})), 4)
      << "it would take what was spawned along";
  EXPECT_EQ(code(bridge.call("/reset_simulation", {{"scope", 4}})), 1);
  EXPECT_EQ(code(bridge.call("/step_simulation", {{"steps", 1}})), 1);
  const json left = bridge.call("/get_entities", {{"filters", json::object()}})["values"]["entities"];
  EXPECT_EQ(left, json({"a", "b", "rock"}));
  EXPECT_GT(run.session.report().tick, 0u);
  EXPECT_EQ(code(bridge.call("/reset_simulation", {{"scope", 3}})), 1);
  EXPECT_EQ(run.session.report().tick, 0u);
}

TEST(SimulationServices, ARunIsStoppedPausedAndPlayed) {
  Running run(weightless(), {.pace = {1.0}});
  run.go();
  Bridge bridge(run.url());
  const auto set = [&](int state) {
    return code(bridge.call("/set_simulation_state", {{"state", {{"state", state}}}}));
  };
  const auto get = [&] {
    return bridge.call("/get_simulation_state", json::object())["values"]["state"]["state"].get<int>();
  };
  EXPECT_EQ(get(), 1);
  EXPECT_EQ(set(1), 101);
  EXPECT_EQ(set(0), 1);
  EXPECT_EQ(get(), 0);
  EXPECT_EQ(run.session.report().tick, 0u);
  EXPECT_EQ(set(0), 101);
  EXPECT_EQ(set(2), 1) << "paused at its beginning";
  EXPECT_EQ(get(), 2);
  EXPECT_EQ(set(2), 101);
  EXPECT_EQ(set(1), 1);
  EXPECT_EQ(get(), 1);
  EXPECT_EQ(set(4), 103);
  EXPECT_EQ(set(2), 1);
  EXPECT_EQ(get(), 2);
}

TEST(SimulationServices, NamedPosesComeFromTheScenario) {
  model::Setup setup = weightless();
  setup.poses.push_back(
      {"dock", {{1, 2, 0}, quat_from_rpy(0, 0, math::pi / 2)}, "by the door", {"parking"}, Vec3{1, 2, 0.5}});
  setup.poses.push_back({"goal", {{3, 4, 0}, {}}, "", {"goal", "parking"}, {}});
  Running run(std::move(setup), {.paused = true});
  run.go();
  Bridge bridge(run.url());
  const auto names = [&](const json& tags) {
    std::vector<std::string> out;
    const json answer = bridge.call("/get_named_poses", {{"tags", tags}});
    for (const json& each : answer["values"]["poses"]) out.push_back(each["name"]);
    return out;
  };
  EXPECT_EQ(names(json::object()), (std::vector<std::string>{"dock", "goal"}));
  EXPECT_EQ(names({{"tags", {"goal"}}}), (std::vector<std::string>{"goal"}));
  const json dock = bridge.call("/get_named_poses", json::object())["values"]["poses"][0];
  EXPECT_EQ(dock["description"], "by the door");
  EXPECT_NEAR(dock["pose"]["orientation"]["z"].get<double>(), math::sin(math::pi / 4), 1e-12);
  const json bounds = bridge.call("/get_named_pose_bounds", {{"name", "dock"}})["values"]["bounds"];
  expect_vector(bounds["points"][0], 0.5, 1, 0.25, 1e-12, "half of 1 x 2 x 0.5");
  expect_vector(bounds["points"][1], -0.5, -1, -0.25, 1e-12, "half of 1 x 2 x 0.5");
  EXPECT_EQ(bridge.call("/get_named_pose_bounds", {{"name", "goal"}})["values"]["bounds"]["type"], 0);
  const json missing = bridge.call("/get_named_pose_bounds", {{"name", "gaol"}});
  EXPECT_EQ(code(missing), 2);
  EXPECT_EQ(why(missing), "there is no pose 'gaol'; did you mean 'goal'?");
  // They outlive a reset.
  EXPECT_EQ(code(bridge.call("/reset_simulation", {{"scope", 0}})), 1);
  EXPECT_EQ(names(json::object()).size(), 2u);
}

TEST(SimulationServices, WorldsAreLoadedByAddressAndAsText) {
  ServerOptions options;
  options.world = "scenarios/space.yaml";
  Running run(weightless(), {.pace = {1.0}}, options);
  run.go();
  Bridge bridge(run.url());
  const json current = bridge.call("/get_current_world", json::object())["values"]["world"];
  EXPECT_EQ(current["name"], "space");
  const std::string uri = current["world_resource"]["uri"];
  EXPECT_EQ(uri.substr(0, 8), "file:///");
  EXPECT_EQ(uri.substr(uri.size() - 20), "scenarios/space.yaml");
  const json worlds = bridge.call("/get_available_worlds", json::object())["values"]["worlds"];
  const auto offered = [&](const char* name) {
    return std::any_of(worlds.begin(), worlds.end(), [&](const json& each) { return each["name"] == name; });
  };
  EXPECT_TRUE(offered("indoor") && offered("materials"));
  EXPECT_EQ(code(bridge.call("/get_available_worlds", {{"filter", {{"tags", {"x"}}}}})), 0);
  EXPECT_EQ(code(bridge.call("/get_available_worlds", {{"additional_sources", {"https://x"}}})), 4);

  const auto load = [&](const json& resource, bool strict = false) {
    return bridge.call("/load_world",
                       {{"world_resource", resource}, {"fail_on_unsupported_element", strict}});
  };
  EXPECT_EQ(code(load(json::object())), 102);
  EXPECT_EQ(code(load({{"resource_string", "<world/>"}})), 101);
  EXPECT_EQ(code(load({{"resource_string", "version: 1\nrobotz: []\n"}})), 103);
  EXPECT_EQ(code(load({{"resource_string", "version: 1\nrobots: [{name: r, model: no/such/model.sdf}]\n"}})),
            103);
  EXPECT_EQ(code(load({{"resource_string", "version: 1\nplugins: [x.so]\n"}})), 103) << "it is not there";
  EXPECT_EQ(code(load({{"uri", "file:///etc/passwd"}})), 2);
  EXPECT_EQ(code(load({{"uri", "no_such_world"}})), 2);
  EXPECT_EQ(bridge.call("/get_simulation_state", json::object())["values"]["state"]["state"], 1)
      << "a world that cannot be loaded leaves the run as it is";
  const json loaded = load(
      {{"resource_string", "version: 1\nname: hall\nthings: [{name: snake, model: {builder: snake}}]\n"}});
  EXPECT_EQ(code(loaded), 1) << why(loaded);
  EXPECT_EQ(loaded["values"]["world"]["name"], "hall");
  // The state is that of the latest report, which may come behind the answer.
  EXPECT_TRUE(soon(
      [&] { return bridge.call("/get_simulation_state", json::object())["values"]["state"]["state"] == 0; }));
  EXPECT_EQ(bridge.call("/get_entities", {{"filters", json::object()}})["values"]["entities"],
            json({"ground", "snake"}));
  EXPECT_EQ(bridge.call("/get_current_world", json::object())["values"]["world"]["name"], "hall");
  // A reset returns to the world that was loaded.
  EXPECT_EQ(code(bridge.call("/reset_simulation", {{"scope", 0}})), 1);
  EXPECT_EQ(code(bridge.call("/get_entity_state", {{"entity", "snake"}})), 1);
  EXPECT_EQ(code(load({{"uri", "indoor"}})), 1);
}

TEST(SimulationServices, ADeletedRobotsClientIsToldAndTheRunGoesOn) {
  Running run(arena("planar", 2, ""), {.pace = {1.0}});
  run.go();
  Bridge client(run.url()), admin(run.url());
  EXPECT_EQ(client.claim({{"robot", "rover1"}})["op"], "sandlot.claimed");
  client.send({{"op", "subscribe"}, {"topic", "/rover1/laser/ranges"}});
  EXPECT_EQ(client.next("publish")["topic"], "/rover1/laser/ranges");
  EXPECT_EQ(code(admin.call("/delete_entity", {{"entity", "rover1"}})), 1);
  std::string refused;
  for (int i = 0; i < 50 && refused.empty(); ++i) {
    client.send({{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", json::object()}});
    const json status = client.next("status", 0.1);
    if (!status.is_null()) refused = status["msg"];
  }
  EXPECT_NE(refused.find("rover1/drive"), std::string::npos) << refused;
  EXPECT_EQ(code(admin.call("/delete_entity", {{"entity", "rover1"}})), 2);
  EXPECT_EQ(code(admin.call("/get_entity_state", {{"entity", "rover2"}})), 1);
  EXPECT_EQ(run.session.report().state, Session::State::playing);
}

}  // namespace
}  // namespace sandlot::server::test
