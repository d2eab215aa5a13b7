/// Expected numbers follow from the definition of the format by hand: see docs/eyesim_files.md.
#include "formats/eyesim/sim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "files/yaml.h"

namespace sandlot::formats::eyesim {
namespace {

/// A folder with a maze, a world, a robot and an object.
class EyesimScenario : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("eyesim_sim_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
    // Two cells of 500 mm beside each other; starts in both.
    write("two.maz", " ___\n|s R|\n500\n");
    write("room.wld", "floor 3000 2000\n0 0 3000 0\nposition 250 400 90\n");
    write("scout.robi",
          "drive DIFFERENTIAL_DRIVE\nname Scout\nwheel 54 1800 1100 90\n"
          "psd PSD_FRONT 1 70 0 30 0\ncamera 60 0 60 0 0 60 46.83\n");
    write("post.esObj", "name Post\ncollider box 0 100 0 100 200 300\nfixed\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const char* name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  std::string file() const { return (folder_ / "test.sim").string(); }

  Scenario read(const std::string& text, std::vector<Override> overrides = {}) {
    auto scenario = find_format("x.sim")->scenario(text, file(), options_, overrides, diagnostics_);
    EXPECT_TRUE(scenario) << scenario.error().text();
    return scenario ? std::move(*scenario) : Scenario{};
  }
  /// The first error, without its folder.
  std::string error(const std::string& text) {
    const auto scenario = find_format("x.sim")->scenario(text, file(), options_, {}, diagnostics_);
    return scenario ? "none" : bare(scenario.error());
  }
  std::string bare(const Error& error) const {
    std::string out = error.text();
    const std::string folder = folder_.string() + "/";
    for (std::size_t at = out.find(folder); at != std::string::npos; at = out.find(folder))
      out.erase(at, folder.size());
    return out;
  }
  static std::string key(const Node& map, std::initializer_list<const char*> path) {
    const Node* node = &map;
    for (const char* const each : path)
      if (!(node = node->find(each))) return "";
    return node->text();
  }

  std::filesystem::path folder_;
  ReadOptions options_;
  Diagnostics diagnostics_;
};

TEST_F(EyesimScenario, ProgramsKnowTheNumbersOfTheirRobotsSensors) {
  write("old.robi",
        "drive DIFFERENTIAL_DRIVE\nname Old\nwheel 54 1800 1100 90\n"
        "psd PSD_FRONT -200 70 0 30 0\npsd PSD_LEFT -205 0 70 30 90\n");
  const Scenario s = read(
      "world room.wld\nrobot old.robi\nrobot scout.robi\nOld 500 700 90 a.c\nScout 900 700 0 a.c\n");
  ASSERT_EQ(s.robots.size(), 2u);
  const Node* const distances = s.robots[0].instance.controllers.get().front().config.find("distances");
  ASSERT_TRUE(distances && distances->items().size() == 2);
  EXPECT_EQ(distances->items()[0].text(), "-200=PSD_FRONT");
  EXPECT_EQ(distances->items()[1].text(), "-205=PSD_LEFT");
  EXPECT_FALSE(s.robots[1].instance.controllers.get().front().config.find("distances"));
}

TEST_F(EyesimScenario, HasRobotsObjectsAndMarkersInMetres) {
  const Scenario s = read(
      "# both generations\nworld room.wld\nsettings VIS TRACE\nrobot scout.robi\nobj post.esObj\n"
      "S4 500 700 90 wander.c\nScout 1500 500 -180\nlabbot 1 2 3 chase.py ; a comment\n"
      "Can 1000 1100 30\nCAN 1200 1300 0\nPost 10 20 0\nmarker 1800 1900 255 0 51\nmarker 5 6\n");
  EXPECT_TRUE(diagnostics_.warnings.empty()) << diagnostics_.warnings.front().text();
  EXPECT_EQ(s.world, "room.wld");
  EXPECT_EQ(s.setup.step, Time::from_s(0.05));
  EXPECT_EQ(s.setup.substeps, 10);
  ASSERT_EQ(s.robots.size(), 3u);
  EXPECT_EQ(s.robots[0].name, "S4");
  EXPECT_EQ(s.robots[0].model, "eyesim/s4.robi");
  EXPECT_NEAR(norm(s.robots[0].placement.X_WM.p - Vec3{0.5, 0.7, 0}), 0, 1e-12);
  EXPECT_NEAR(yaw_of(s.robots[0].placement.X_WM.q), M_PI / 2, 1e-12);
  const auto& programs = s.robots[0].instance.controllers.get();
  ASSERT_EQ(programs.size(), 1u);
  EXPECT_EQ(programs[0].kind, "robios");
  EXPECT_EQ(key(programs[0].config, {"program"}), "wander.c");
  EXPECT_EQ(s.robots[1].model, "scout.robi");
  EXPECT_TRUE(s.robots[1].instance.controllers.get().empty());
  EXPECT_EQ(s.robots[2].model, "labbot/labbot.robi");
  EXPECT_EQ(key(s.robots[2].devices, {"radio", "kind"}), "radio");
  EXPECT_EQ(key(s.robots[2].devices, {"radio", "level"}), "bits");
  ASSERT_EQ(s.things.size(), 3u);
  EXPECT_EQ(s.things[0].name, "Can");
  EXPECT_EQ(s.things[1].name, "Can_2");
  EXPECT_NEAR(norm(s.things[1].placement.X_WM.p - Vec3{1.2, 1.3, 0}), 0, 1e-12);
  EXPECT_EQ(s.things[2].model, "post.esObj");
  ASSERT_EQ(s.setup.markers.size(), 2u);
  EXPECT_EQ(key(s.setup.markers[0].config, {"radius"}), "0.05");
  EXPECT_EQ(s.setup.markers[0].config.find("color")->items()[2].text(), "0.2");
  ASSERT_EQ(s.setup.media.size(), 1u);
  EXPECT_EQ(key(s.setup.media[0].config, {"collisions"}), "false");
  EXPECT_EQ(key(s.setup.media[0].config, {"half_duplex"}), "false");
}

TEST_F(EyesimScenario, PutsRobotsOnTheStartsOfTheWorldInTheirOrder) {
  const Scenario s = read("world two.maz\nS4 S first.c\nS4 r 45 second.c\n");
  ASSERT_EQ(s.robots.size(), 2u);
  // Middles of cells of 500 mm; the first looks up, the second as its own number says.
  EXPECT_NEAR(s.robots[0].placement.X_WM.p.x, 0.25, 1e-12);
  EXPECT_NEAR(yaw_of(s.robots[0].placement.X_WM.q), M_PI / 2, 1e-12);
  EXPECT_NEAR(s.robots[1].placement.X_WM.p.x, 0.75, 1e-12);
  EXPECT_NEAR(s.robots[1].placement.X_WM.p.y, 0.25, 1e-12);
  EXPECT_NEAR(yaw_of(s.robots[1].placement.X_WM.q), M_PI / 4, 1e-12);
  EXPECT_EQ(key(s.robots[1].instance.controllers.get()[0].config, {"program"}), "second.c");
  EXPECT_EQ(
      error("world two.maz\nS4 S\nS4 S\nS4 S\n"),
      "test.sim:4: the world has 2 starts for more robots; give the robot x y in mm and an angle in degrees");
}

TEST_F(EyesimScenario, KnowsTheOlderForm) {
  const Scenario s = read("maze two.maz\nrobi Joe scout.robi drive.so joe.ms3d\nposition 100 200 90\n");
  ASSERT_EQ(s.robots.size(), 1u);
  EXPECT_NEAR(norm(s.robots[0].placement.X_WM.p - Vec3{0.1, 0.2, 0}), 0, 1e-12);
  EXPECT_EQ(key(s.robots[0].instance.controllers.get()[0].config, {"program"}), "drive.so");
  ASSERT_EQ(diagnostics_.warnings.size(), 1u);  // the model
}

TEST_F(EyesimScenario, WarnsOnceOfWhatItDoesNotKnow) {
  const Scenario s = read(
      "world room.wld\nsetings VIS\nCrate1 180 5580 90\nsettings VIS FOO\nS4 1 2 3 a.c b\n");
  ASSERT_EQ(diagnostics_.warnings.size(), 4u);
  EXPECT_EQ(bare(diagnostics_.warnings[0]),
            "test.sim:2: 'setings' is not known and left out; did you mean 'settings'?");
  EXPECT_EQ(bare(diagnostics_.warnings[1]),
            "test.sim:3: 'Crate1' is not known and left out; load its file: robot Crate1.robi or object "
            "Crate1.esObj");
  EXPECT_EQ(s.robots.size(), 1u);
}

TEST_F(EyesimScenario, SaysWhatIsWrongWithItsLine) {
  EXPECT_EQ(error("S4 1 2\n"), "test.sim:1: 'S4' lacks an angle in degrees");
  EXPECT_EQ(error("robot\n"), "test.sim:1: 'robot' names no .robi file; write robot scout.robi");
  EXPECT_EQ(error("world a.maz\nworld b.maz\n"),
            "test.sim:2: there are two worlds; the other one is at test.sim:1");
  EXPECT_EQ(error("marker 1 2 256 0 0\n"), "test.sim:1: colours are from 0 to 255");
  EXPECT_EQ(error("error psd -1\n"), "test.sim:1: a standard deviation is not below 0");
  EXPECT_EQ(error("step 0\n"), "test.sim:1: a step is 1 to 50 ms long; EyeSim has 50");
}

TEST_F(EyesimScenario, GivesErrorModelsToTheDevicesThatHaveThem) {
  const Scenario s = read(
      "robot scout.robi\nScout 0 0 0\nerror psd 20\nerror v 30\nerror omega 180\n"
      "error camera salt_and_pepper 0.1\nerror camera hundreds_and_thousands 0.25\nerror radio 0.001 0.5\n");
  const Node& devices = s.robots.at(0).devices;
  const auto stage = [&](const char* device, const char* list, std::size_t i, const char* name,
                         const char* number) -> std::string {
    const Node* const found = devices.find(device);
    const Node* at = found ? found->find(list) : nullptr;
    if (at && std::string(list) == "command_errors") at = at->find(i == 0 ? "linear" : "angular"), i = 0;
    if (!at || at->items().size() <= i) return "nothing";
    return key(at->items()[i], {name, number});
  };
  EXPECT_EQ(stage("PSD_FRONT", "noise", 0, "gaussian", "std"), "0.02");
  EXPECT_EQ(stage("drive", "command_errors", 0, "gaussian", "std"), "0.03");
  EXPECT_NEAR(std::stod(stage("drive", "command_errors", 1, "gaussian", "std")), M_PI, 1e-12);
  EXPECT_EQ(stage("camera", "noise", 0, "salt_and_pepper", "salt"), "0.05");  // half of them white
  EXPECT_EQ(stage("camera", "noise", 1, "hundreds_and_thousands", "rate"), "0.25");
  ASSERT_EQ(s.setup.media.size(), 1u);
  EXPECT_EQ(key(s.setup.media[0].config, {"bit_error_rate"}), "0.001");
  EXPECT_EQ(key(s.setup.media[0].config, {"drop"}), "0.5");
  // Wrong bits are for the program to see, also those that a slider of the page makes.
  EXPECT_EQ(key(devices, {"radio", "level"}), "bits");
  EXPECT_EQ(key(read("S4 0 0 0\n").robots.at(0).devices, {"radio", "level"}), "bits");
}

TEST_F(EyesimScenario, HasEachErrorModelWithStrengthZeroForSliders) {
  const Scenario s = read("robot scout.robi\nScout 0 0 0\nerror camera salt_and_pepper 0.1\n");
  const Node& devices = s.robots.at(0).devices;
  EXPECT_EQ(key(devices.find("PSD_FRONT")->find("noise")->items().at(0), {"gaussian", "std"}), "0");
  const Node& drive = *devices.find("drive")->find("command_errors");
  EXPECT_EQ(key(drive.find("linear")->items().at(0), {"gaussian", "std"}), "0");
  EXPECT_EQ(key(drive.find("angular")->items().at(0), {"gaussian", "std"}), "0");
  const auto& camera = devices.find("camera")->find("noise")->items();
  ASSERT_EQ(camera.size(), 3u);
  EXPECT_EQ(key(camera[0], {"salt_and_pepper", "pepper"}), "0.05");
  EXPECT_EQ(key(camera[1], {"gaussian", "std"}), "0");
  EXPECT_EQ(key(camera[2], {"hundreds_and_thousands", "rate"}), "0");
}

TEST_F(EyesimScenario, CamerasTakePicturesForProgramsThatAsk) {
  const Scenario s = read(
      "LabBot 0 0 0 look.c\nLabBot 500 0 0 controller:wander\nLabBot 900 0 0\nerror camera gaussian 5\n");
  EXPECT_EQ(key(s.robots.at(0).devices, {"camera", "on_request"}), "true");
  EXPECT_NE(s.robots.at(0).devices.find("camera")->find("noise"), nullptr);
  EXPECT_EQ(key(s.robots.at(1).devices, {"camera", "on_request"}), "");
  EXPECT_EQ(key(s.robots.at(2).devices, {"camera", "on_request"}), "");
}

TEST_F(EyesimScenario, FindsTypesInTheFoldersToSearchFirst) {
  std::filesystem::create_directory(folder_ / "types");
  write("types/mover.robi", "drive DIFFERENTIAL_DRIVE\nname Carrier\nwheel 54 1800 1100 90\n");
  const std::string text = "robot mover.robi\nCarrier 1 2 3\n";
  EXPECT_TRUE(read(text).robots.empty());  // the name is in a file that is not found
  options_.path = search_path(std::vector{(folder_ / "types").string()});
  ASSERT_EQ(read(text).robots.size(), 1u);
}

TEST_F(EyesimScenario, TakesValuesFromTheCommandLine) {
  const Scenario s = read("S4 1 2 3\n", {{"time.step", "10 ms"}, {"robots.S4.errors", "2"}});
  EXPECT_EQ(s.setup.step, Time::from_s(0.01));
  EXPECT_EQ(s.robots.at(0).instance.errors, 2);
}

TEST_F(EyesimScenario, WrittenAndReadAgainIsTheSame) {
  const std::string text =
      "world room.wld\nstep 20\nobject post.esObj\nrobot scout.robi\nCan 1000 1100 30\nPost 10.5 20 0\n"
      "S4 500 700 90 \"my program.c\"\nScout 1500 500 -179\nLabBot 1 2 3 "
      "controller:wander?radius=0.1&margin=0\n"
      "marker 1800 1900 255 0 51\n";
  const Scenario s = read(text);
  const auto written = sim_of(s, diagnostics_);
  ASSERT_TRUE(written) << written.error().text();
  EXPECT_EQ(*written, text);
  EXPECT_TRUE(diagnostics_.warnings.empty()) << diagnostics_.warnings.front().text();
  // As YAML it is the same scenario.
  const auto tree = sim_tree(text, file(), options_, diagnostics_);
  ASSERT_TRUE(tree);
  const std::string yaml = yaml_text(*tree);
  const auto back = parse_scenario(yaml, (folder_ / "test.yaml").string(), {}, diagnostics_);
  ASSERT_TRUE(back) << back.error().text() << "\n" << yaml;
  EXPECT_EQ(*sim_of(*back, diagnostics_), text);
}

}  // namespace
}  // namespace sandlot::formats::eyesim
