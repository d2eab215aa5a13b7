/// Scenarios put together from files: search, devices laid upon the model's, placement, names.
#include "sim/load/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/test_folder.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* bot = R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:sandlot="urn:sandlot:sdf"><model name="bot">
  <link name="base"><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
    <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
  <sandlot:device name="eye" kind="laser_scanner" link="base"><beams>11</beams><max_range>3</max_range></sandlot:device>
</model></sdf>)";

struct Files : testing::Test {
  const test::TestFolder test_folder;
  const fs::path& folder = test_folder.path;
  void SetUp() override {
    fs::create_directories(folder / "models" / "bot");
    write("models/bot/model.sdf", bot);
  }
  std::string write(const std::string& name, const std::string& text) const {
    return test_folder.write(name, text);
  }
  Result<model::Setup> load_text(const std::string& robots, std::vector<formats::Override> overrides = {}) {
    const std::string file = write("s.yaml", "version: 1\nname: s\n" + robots);
    return load(file, {overrides, {}, {}}, diagnostics);
  }
  std::string error_of(const std::string& robots) {
    const auto setup = load_text(robots);
    return setup ? "" : setup.error().text();
  }
  Diagnostics diagnostics;
};

TEST_F(Files, AFolderStandsForItsModelAndTheSearchPathIsUsed) {
  EXPECT_EQ(error_of("robots: [{name: a, model: models/bot}]\n"), "");
  EXPECT_EQ(error_of("robots: [{name: a, model: models/bot/model.sdf}]\n"), "");
  EXPECT_THAT(error_of("robots: [{name: a, model: bot}]\n"), HasSubstr("s.yaml:3:"));
  setenv("SANDLOT_PATH", (folder / "models").c_str(), 1);
  EXPECT_EQ(error_of("robots: [{name: a, model: bot}]\n"), "");
  EXPECT_EQ(error_of("robots: [{name: a, model: 'model://bot'}]\n"), "");
  unsetenv("SANDLOT_PATH");
}

TEST_F(Files, AMissingFileIsAnsweredWithTheNearestFileOrModel) {
  const std::string models = (folder / "models").string();
  const std::string scenario = write("yard.yaml", "version: 1\nname: yard\n");
  const auto error = [&](const std::string& path) {
    const std::vector<std::string> paths{models};
    const auto setup = load(path, {.paths = paths}, diagnostics);
    return setup ? "" : setup.error().text();
  };
  EXPECT_EQ(error(folder / "yrad.yaml"),
            (folder / "yrad.yaml").string() + ": no such file; did you mean '" + scenario + "'?");
  EXPECT_EQ(error("bot"), "bot: no such file; the file of that name is '" + models + "/bot/model.sdf'");
  EXPECT_EQ(error("bott"), "bott: no such file; did you mean '" + models + "/bot/model.sdf'?");
  EXPECT_THAT(error("nothing_like_it"), HasSubstr("; files that are read end in .yaml"));
  EXPECT_EQ(error(models), models + ": is a folder; name a file in it");
  setenv("SANDLOT_PATH", models.c_str(), 1);
  EXPECT_THAT(error_of("robots: [{name: a, model: bott}]\n"),
              HasSubstr("'bott' is not there; did you mean 'bot'? looked for "));
  unsetenv("SANDLOT_PATH");
}

TEST_F(Files, APresetGoesBeforeTheModelsKeysAndAfterThoseBesideIt) {
  const auto setup = load_text(
      "robots:\n- name: a\n  model: models/bot\n  devices:\n    eye: {preset: sick_lms200, rate: 5}\n"
      "    back: {kind: laser_scanner, preset: sick_ld, noise: {white: 1 cm}}\n");
  ASSERT_TRUE(setup) << setup.error().text();
  const auto number = [&](std::size_t device, std::initializer_list<const char*> path) {
    const Node* node = &setup->instances.back().devices[device].config;
    for (const char* key : path) node = node ? node->find(key) : nullptr;
    return node ? node->text() : "";
  };
  EXPECT_EQ(number(0, {"beams"}), "181");    // the model says 11
  EXPECT_EQ(number(0, {"max_range"}), "8");  // the model says 3
  EXPECT_EQ(number(0, {"rate"}), "5");
  EXPECT_EQ(number(0, {"preset"}), "");
  EXPECT_EQ(number(1, {"beams"}), "720");
  EXPECT_EQ(number(1, {"noise", "white"}), "1 cm");
  EXPECT_EQ(number(1, {"noise", "systematic"}), "38 mm");
  EXPECT_THAT(
      error_of("robots:\n- name: a\n  model: models/bot\n  devices:\n    eye: {preset: sick_lms20}\n"),
      HasSubstr("s.yaml:7:19: /preset: device kind 'laser_scanner' has no preset 'sick_lms20'; did you mean "
                "'sick_lms200'?"));
}

constexpr const char* arm = R"(<?xml version="1.0"?>
<sdf version="1.9"><model name="arm"><static>false</static>
  <link name="base"/><link name="boom"><pose>0 0 1 0 0 0</pose></link>
  <joint name="lift" type="revolute"><parent>base</parent><child>boom</child><axis><xyz>0 1 0</xyz></axis></joint>
  PLUGIN
</model></sdf>)";

std::string arm_with(const std::string& plugin) {
  std::string text = arm;
  return text.replace(text.find("PLUGIN"), 6, plugin);
}

constexpr const char* controllers = R"(
controller_manager: {ros__parameters: {hold: {type: position_controllers/JointGroupPositionController}}}
hold: {ros__parameters: {joints: [lift]}}
)";

TEST_F(Files, JointControllersComeFromTheScenarioOrAPluginAndCanBeChanged) {
  write("c.yaml", controllers);
  write("arm.sdf", arm_with(""));
  auto setup = load_text(
      "robots:\n- {name: a, model: arm.sdf, joint_controllers: c.yaml, devices: {hold: {max_effort: 7}}}\n");
  ASSERT_TRUE(setup) << setup.error().text();
  const auto& devices = setup->instances.back().devices;
  ASSERT_EQ(devices.size(), 1u);
  EXPECT_EQ(devices[0].kind, "joint_motor");
  EXPECT_EQ(devices[0].name, "hold");
  EXPECT_EQ(devices[0].config.find("max_effort")->text(), "7");

  write("plugged.sdf",
        arm_with("<plugin name='gz_ros2_control::GazeboSimROS2ControlPlugin' "
                 "filename='gz_ros2_control-system'><parameters>c.yaml</parameters></plugin>"));
  setup = load_text("robots: [{name: a, model: plugged.sdf}]\n");
  ASSERT_TRUE(setup) << setup.error().text();
  ASSERT_EQ(setup->instances.back().devices.size(), 1u);
  EXPECT_EQ(setup->instances.back().devices[0].name, "hold");
  EXPECT_THAT(error_of("robots: [{name: a, model: plugged.sdf, joint_controllers: c.yaml}]\n"),
              HasSubstr("the robot has a device named 'hold' already"));
  EXPECT_THAT(error_of("robots: [{name: a, model: arm.sdf, joint_controllers: d.yaml}]\n"),
              HasSubstr("s.yaml:3:"));
}

TEST_F(Files, AControlPluginWithoutItsFileIsWarnedOf) {
  write("bare.sdf", arm_with("<plugin name='c' filename='libgazebo_ros_control.so'/>"));
  write("lost.sdf", arm_with("<plugin name='c' filename='libgazebo_ros2_control.so'>"
                             "<parameters>nowhere.yaml</parameters></plugin>"));
  for (const char* model : {"bare.sdf", "lost.sdf"}) {
    const std::size_t before = diagnostics.warnings.size();
    const auto setup = load_text(std::string("robots: [{name: a, model: ") + model + "}]\n");
    ASSERT_TRUE(setup) << setup.error().text();
    const auto said = [&](const char* what) {
      return std::any_of(
          diagnostics.warnings.begin() + static_cast<std::ptrdiff_t>(before), diagnostics.warnings.end(),
          [&](const Error& warning) { return warning.text().find(what) != std::string::npos; });
    };
    EXPECT_TRUE(said(std::string(model) == "bare.sdf" ? "joint_controllers: FILE" : "nowhere.yaml")) << model;
  }
}

TEST_F(Files, DevicesOfTheScenarioAreLaidUponTheModelsOwn) {
  const auto setup = load_text(
      "robots:\n- name: a\n  model: models/bot\n  devices:\n    eye: {max_range: 50 cm}\n"
      "    truth: {kind: ground_truth, link: base, pose: [1, 0, 0, 0, 0, 90 deg]}\n");
  ASSERT_TRUE(setup) << setup.error().text();
  const model::Instance& robot = setup->instances.back();
  ASSERT_EQ(robot.devices.size(), 2u);
  EXPECT_EQ(robot.devices[0].config.find("beams")->text(), "11") << "the model's key stays";
  EXPECT_EQ(robot.devices[0].config.find("max_range")->text(), "50 cm") << "the scenario's key replaces";
  EXPECT_EQ(robot.devices[1].kind, "ground_truth");
  EXPECT_NEAR(yaw_of(robot.devices[1].X_LS.q), 1.5707963, 1e-6);
  EXPECT_THAT(error_of("robots:\n- name: a\n  model: models/bot\n  devices:\n    eya: {beams: 3}\n"),
              HasSubstr("'eye'"));
  EXPECT_THAT(
      error_of(
          "robots:\n- name: a\n  model: models/bot\n  devices:\n    t: {kind: ground_truth, link: bas}\n"),
      HasSubstr("did you mean 'base'?"));
}

TEST_F(Files, AGroupInAGridIsCentredAndSpaced) {
  const auto setup = load_text(
      "robots: [{name: a, model: models/bot, count: 6, distribution: {grid: {centre: [10, 0, 0], spacing: 2 "
      "m}}}]\n");
  ASSERT_TRUE(setup) << setup.error().text();
  ASSERT_EQ(setup->instances.size(), 7u);  // the ground first
  EXPECT_EQ(setup->instances[1].name, "a1");
  EXPECT_EQ(setup->instances[6].name, "a6");
  Vec3 mean;
  for (std::size_t i = 1; i < 7; ++i) mean += setup->instances[i].X_WM.p / 6;
  EXPECT_NEAR(mean.x, 10, 1e-12);  // 3 x 2
  EXPECT_NEAR(mean.y, 0, 1e-12);
  EXPECT_NEAR(norm(setup->instances[2].X_WM.p - setup->instances[1].X_WM.p), 2, 1e-12);
}

TEST_F(Files, AnEmptyGroupIsLeftOutAndMovesNobody) {
  for (const std::string place : {"pose: [1, 2, 0]", "distribution: {grid: {spacing: 1}}",
                                  "distribution: {uniform: {width: 3, height: 3}}"}) {
    const std::string others =
        "- {name: b, model: models/bot, count: 3, distribution: {uniform: {width: 9, height: 9}}}\n";
    const auto with = load_text("robots:\n- {name: a, model: models/bot, count: 0, " + place + "}\n" +
                                others);
    const auto without = load_text("robots:\n" + others);
    ASSERT_TRUE(with) << with.error().text();
    ASSERT_EQ(with->instances.size(), 4u) << place;
    for (std::size_t i = 1; i < 4; ++i)
      EXPECT_EQ(with->instances[i].X_WM.p, without->instances[i].X_WM.p) << place;
  }
}

TEST_F(Files, ARandomGroupKeepsItsClearanceAndDependsOnTheSeedAlone) {
  const std::string robots =
      "robots: [{name: a, model: models/bot, count: 40, distribution: {uniform: {centre: [0, 0, 0], width: "
      "10, height: 10, clearance: 60 cm}}}]\n";
  const auto first = load_text(robots), second = load_text(robots), other = load_text(robots + "seed: 2\n");
  ASSERT_TRUE(first && second && other);
  for (std::size_t i = 1; i <= 40; ++i) {
    const Vec3 p = first->instances[i].X_WM.p;
    EXPECT_EQ(p, second->instances[i].X_WM.p);
    EXPECT_NE(p, other->instances[i].X_WM.p);
    EXPECT_LE(std::abs(p.x), 5);
    EXPECT_LE(std::abs(p.y), 5);
    for (std::size_t k = 1; k < i; ++k) EXPECT_GE(norm(p - first->instances[k].X_WM.p), 0.6);
  }
  EXPECT_THAT(error_of("robots: [{name: a, model: models/bot, count: 40, distribution: {uniform: {centre: "
                       "[0, 0, 0], width: 2, height: 2, clearance: 1}}}]\n"),
              HasSubstr("no room"));
}

TEST_F(Files, NamesAreMadeIntoAddressesAndCollisionsAreErrors) {
  const auto setup = load_text("robots: [{name: 'my robot::1', model: models/bot}]\n");
  ASSERT_TRUE(setup) << setup.error().text();
  EXPECT_EQ(setup->instances.back().name, "my_robot__1");
  EXPECT_EQ(setup->instances.back().original_name, "my robot::1");
  const std::string error = error_of(
      "robots:\n- {name: a b, model: models/bot}\n- {name: a_b, model: models/bot}\n");
  EXPECT_THAT(error, HasSubstr("'a_b'"));
  EXPECT_THAT(error, HasSubstr("s.yaml:5"));
}

TEST_F(Files, WithoutAWorldThereAreAGroundAndASun) {
  const auto bare = load_text("robots: [{name: a, model: models/bot}]\n");
  ASSERT_TRUE(bare) << bare.error().text();
  EXPECT_EQ(bare->instances.front().name, "ground");
  ASSERT_EQ(bare->lights.size(), 1u);
  EXPECT_EQ(bare->lights[0].type, model::Light::Type::directional);
  EXPECT_TRUE(bare->lights[0].cast_shadows);
  EXPECT_LT((bare->lights[0].X_PLight * Vec3{0, 0, -1}).z, bare->lights[0].X_PLight.p.z) << "it shines down";
  const auto model = load((folder / "models/bot/model.sdf").string(), {}, diagnostics);
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->lights.size(), 1u);
  EXPECT_EQ(model->instances.back().name, "ground");
  const std::string dark = write("dark.sdf", "<sdf version='1.9'><world name='w'/></sdf>");
  const auto world = load(dark, {}, diagnostics);
  ASSERT_TRUE(world) << world.error().text();
  EXPECT_TRUE(world->lights.empty()) << "a world has its own lights";
}

TEST_F(Files, AMissingDeviceIsAnErrorThatNamesTheKindsThatWouldDo) {
  auto setup = load_text("robots: [{name: a, model: models/bot, controller: wander}]\n");
  ASSERT_TRUE(setup) << setup.error().text();
  const auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_FALSE(simulation);
  EXPECT_THAT(simulation.error().text(),
              AllOf(HasSubstr("robot 'a' has no actuator of type geometry_msgs/msg/Twist; add a device that "
                              "offers one, of kind ackermann_drive, "),
                    HasSubstr(" or track_drive")));
}

TEST_F(Files, OptionsReplaceSeedAndStop) {
  const std::string file = write("s.yaml", "version: 1\nname: s\nseed: 5\ntime: {stop: 9 s}\n");
  const auto plain = load(file, {}, diagnostics), changed = load(file, {{}, 77, 2.5}, diagnostics);
  ASSERT_TRUE(plain && changed);
  EXPECT_EQ(plain->seed, 5u);
  EXPECT_EQ(plain->stop->s(), 9);
  EXPECT_EQ(changed->seed, 77u);
  EXPECT_EQ(changed->stop->s(), 2.5);
}

TEST_F(Files, FactorsOnErrorsAreTheWorldsAndTheRobots) {
  const std::string file = write("s.yaml",
                                 "version: 1\nname: s\nerrors: 2\nrobots:\n"
                                 "- {name: a, model: models/bot, errors: 3, devices: {eye: {errors: 0.25}}}\n"
                                 "- {name: b, model: models/bot, errors: 0}\n"
                                 "- {name: c, model: models/bot, devices: {turn: {kind: body_velocity}}}\n");
  const auto errors_of = [&](const model::Setup& setup, std::string_view robot) {
    for (const model::Instance& instance : setup.instances)
      if (instance.name == robot) return instance.errors;
    return -1.0;
  };
  const auto setup = load(file, {}, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  EXPECT_EQ(setup->errors, 2);
  EXPECT_EQ(errors_of(*setup, "a"), 3);
  EXPECT_EQ(errors_of(*setup, "b"), 0);
  EXPECT_EQ(errors_of(*setup, "c"), 1);
  const auto halved = load(file, {.errors = 0.5}, diagnostics);
  ASSERT_TRUE(halved);
  EXPECT_EQ(halved->errors, 1);
  EXPECT_EQ(errors_of(*halved, "a"), 3);
  EXPECT_THAT(error_of("errors: -1\n"), HasSubstr("/errors: must be in [0, 1000]"));
  EXPECT_THAT(error_of("robots: [{name: a, model: models/bot, errors: x}]\n"),
              HasSubstr("/errors: 'x' is not a number"));
}

constexpr const char* head = R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:sandlot="urn:sandlot:sdf"><model name="head">
  <link name="foot"><inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>
  <link name="eye"><pose>0 0 0.2 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>
  <joint name="neck" type="revolute"><parent>foot</parent><child>eye</child><axis><xyz>0 0 1</xyz></axis></joint>
  <frame name="lens" attached_to="eye"><pose>0.1 0 0 0 0 0</pose></frame>
  <sandlot:device name="turn" kind="joint_motor" link="eye"><joint>neck</joint></sandlot:device>
  <sandlot:device name="look" kind="laser_scanner" link="eye"><beams>5</beams></sandlot:device>
</model></sdf>)";

TEST_F(Files, ModulesAreFixedToARobotWithTheirOwnNamesPlacesAndRates) {
  fs::create_directories(folder / "models" / "head");
  write("models/head/model.sdf", head);
  const std::string text =
      "robots:\n- name: a\n  model: models/bot\n  modules:\n"
      "  - {id: front, model: models/head, pose: [1, 2, 3, 0, 0, 90 deg], devices: {look: {rate: 20}}}\n"
      "  - {id: back, model: models/head, pose: [-1, 0, 0, 0, 0, 0], link: 'front::eye'}\n"
      "  - {id: nose, model: models/bot}\n"
      "  devices: {back_look: {beams: 7}}\n";
  auto setup = load_text(text);
  ASSERT_TRUE(setup) << setup.error().text();
  const model::Instance& robot = setup->instances.back();
  const model::Model& composed = *robot.model;
  ASSERT_EQ(composed.links.size(), 6u);
  EXPECT_EQ(composed.links[2].name, "front::eye");
  // (1 2 3) and 0.2 above it, turned to the left: x of the eye is y of the robot.
  EXPECT_NEAR(norm(composed.links[2].X_ML.p - Vec3{1, 2, 3.2}), 0, 1e-12);
  EXPECT_NEAR(norm(rotate(composed.links[2].X_ML.q, {1, 0, 0}) - Vec3{0, 1, 0}), 0, 1e-12);
  // One metre behind that eye is one metre along -y; its own eye 0.2 above.
  EXPECT_NEAR(norm(composed.links[4].X_ML.p - Vec3{1, 1, 3.4}), 0, 1e-12);
  EXPECT_EQ(composed.find_joint("front::neck"), 0u);
  EXPECT_EQ(composed.frames.at(1).name, "back::lens");
  const auto device = [&](std::string_view name) -> const model::DeviceDecl* {
    for (const model::DeviceDecl& each : robot.devices)
      if (each.name == name) return &each;
    return nullptr;
  };
  ASSERT_TRUE(device("front_look") && device("back_turn") && device("nose"));
  EXPECT_EQ(device("front_look")->config.find("rate")->text(), "20");
  EXPECT_EQ(device("back_look")->config.find("beams")->text(), "7");
  EXPECT_EQ(device("nose")->link, 5u) << "a module with one device: the device has the module's name";

  // Each motor turns the neck of its own module: `joint: neck` means back::neck there.
  auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_TRUE(simulation) << simulation.error().text();
}

TEST_F(Files, FaultsOfModulesHaveTheirLines) {
  fs::create_directories(folder / "models" / "head");
  write("models/head/model.sdf", head);
  const std::string robot = "robots:\n- name: a\n  model: models/bot\n  modules:\n  - ";
  EXPECT_THAT(error_of(robot + "{id: h, model: models/hat}\n"), HasSubstr("s.yaml:7:"));
  EXPECT_THAT(error_of(robot + "{id: h, model: models/head, link: bas}\n"),
              HasSubstr("did you mean 'base'?"));
  EXPECT_THAT(error_of(robot + "{id: h, model: models/head, pos: [1, 2, 3]}\n"),
              HasSubstr("did you mean 'pose'?"));
  EXPECT_THAT(
      error_of(robot + "{id: h, model: models/head}\n  - {id: h, model: models/head}\n"),
      AllOf(HasSubstr("s.yaml:8:10: "), HasSubstr("two modules are called 'h'; the other one is at")));
  EXPECT_THAT(error_of(robot + "{id: eye, model: models/bot}\n"),
              HasSubstr("two devices have the address 'eye'"));
}

}  // namespace
}  // namespace sandlot
