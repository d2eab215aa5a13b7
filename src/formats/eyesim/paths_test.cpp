/// Files as authors on other machines name them. Expected places follow from the rule in paths.h by hand.
#include "formats/eyesim/paths.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "files/yaml.h"
#include "formats/eyesim/plan.h"
#include "formats/eyesim/robi.h"
#include "formats/eyesim/sim.h"
#include "formats/kind.h"

namespace sandlot::formats::eyesim {
namespace {

namespace fs = std::filesystem;

/// home/worlds/small/Room.wld, home/labs/one (where the files that name others lie) and home/labs/one/Post.obj.
class EyesimPaths : public testing::Test {
 protected:
  void SetUp() override {
    top_ = fs::weakly_canonical(fs::path(testing::TempDir())) /
           ("eyesim_paths_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(top_);
    write("home/worlds/small/Room.wld", "floor 3000 2000\n0 0 3000 0\n");
    write("home/labs/one/post.esObj", "name Post\nobj POST.OBJ\ncollider box 0 100 0 100 200 300\nfixed\n");
    write("home/labs/one/chase.c", "int main() { return 0; }\n");
    write("home/labs/one/scout.robi", "drive DIFFERENTIAL_DRIVE\nname Scout\nwheel 54 1800 1100 90\n");
  }
  void TearDown() override { fs::remove_all(top_); }
  void write(const char* name, const std::string& text) const {
    fs::create_directories((top_ / name).parent_path());
    std::ofstream(top_ / name) << text;
  }
  std::string folder() const { return (top_ / "home/labs/one").string(); }
  std::string find(const std::string& written) const { return located(written, folder(), {}); }
  std::string at(const char* name) const { return (top_ / name).string(); }

  fs::path top_;
};

TEST_F(EyesimPaths, AreFoundByTheirLongestEnd) {
  // Two folders up lies `worlds`.
  EXPECT_EQ(find("../../worlds/small/Room.wld"), "../../worlds/small/Room.wld");
  const std::string room = at("home/worlds/small/Room.wld");
  EXPECT_EQ(find("%sim%/worlds/small/Room.wld"), room);
  EXPECT_EQ(find("C:\\Users\\ann\\EyeSim\\worlds\\small\\Room.wld"), room);
  EXPECT_EQ(find("/Users/ann/eyesim/worlds/small/room.wld"), room);
  // A bare name is looked for beside the file alone.
  EXPECT_EQ(find("/Users/ann/Room.wld"), "/Users/ann/Room.wld");
  EXPECT_EQ(find("/Users/ann/scout.robi"), at("home/labs/one/scout.robi"));
  EXPECT_EQ(find("..\\nowhere.wld"), "../nowhere.wld");
  EXPECT_EQ(find(std::string(5000, 'a')), std::string(5000, 'a'));
}

TEST_F(EyesimPaths, CountLettersOfTwoNamesApart) {
  write("home/labs/one/ROOM.WLD", "");
  EXPECT_EQ(find("room.wld"), at("home/labs/one/ROOM.WLD"));
  write("home/labs/one/room.wld", "");
  EXPECT_EQ(find("room.wld"), "room.wld");
}

TEST_F(EyesimPaths, OfProgramsThatAreNotThereMeanTheirSource) {
  EXPECT_EQ(located_program("chase.x", folder(), {}), "chase.c");
  EXPECT_EQ(located_program("/Users/ann/eyesim/examples/chase.exe", folder(), {}),
            at("home/labs/one/chase.c"));
  EXPECT_EQ(located_program("hide.x", folder(), {}), "hide.x");
  write("home/labs/one/chase.x", "");
  EXPECT_EQ(located_program("chase.x", folder(), {}), "chase.x");
}

TEST_F(EyesimPaths, AreRightInAScenarioOfEyeSim6) {
  Diagnostics diagnostics;
  const std::string file = at("home/labs/one/old.sim");
  const auto root = sim_tree(
      "world %sim%/worlds/small/Room.wld\nrobi scout.robi chase.dll 400 800 90\n"
      "object 900 800 0 0.0 %sim%/worlds/objects/can/can.ms3d\n",
      file, {}, diagnostics);
  ASSERT_TRUE(root) << root.error().text();
  EXPECT_EQ(root->find("world")->text(), at("home/worlds/small/Room.wld"));
  const Node& robot = root->find("robots")->items().front();
  EXPECT_EQ(robot.find("pose")->items()[0].text(), "0.4");
  EXPECT_EQ(robot.find("pose")->items()[1].text(), "0.8");
  const Node& controller = *robot.find("controller");
  EXPECT_EQ(controller.find("program")->text(), "chase.c");  // in the folder that it works in
  EXPECT_EQ(controller.find("supervisor")->text(), "true");
  EXPECT_EQ(root->find("things")->items().front().find("name")->text(), "Can");
  ASSERT_EQ(diagnostics.warnings.size(), 2u);
  EXPECT_NE(diagnostics.warnings[0].text().find("Room.wld' is taken"), std::string::npos);
}

TEST_F(EyesimPaths, LeaveRobotsWithoutTheirMeshTheirBody) {
  Diagnostics diagnostics;
  const auto robot = read_robi("drive DIFFERENTIAL_DRIVE\nname Scout\nmodel gone.obj\n", at("home/x.robi"),
                               {}, diagnostics);
  ASSERT_TRUE(robot) << robot.error().text();
  EXPECT_EQ(diagnostics.warnings.size(), 1u);
  // An object without colliders is nothing without its mesh.
  EXPECT_FALSE(read_object("name Post\nobj gone.obj\n", at("home/x.esObj"), {}, diagnostics));
  EXPECT_TRUE(read_object("name Post\nobj gone.obj\ncollider sphere 0 0 0 10\n", at("home/x.esObj"), {},
                          diagnostics));
}

const model::DeviceDecl* device(const Robi& robot, std::string_view name) {
  for (const model::DeviceDecl& each : robot.instance.devices)
    if (each.name == name) return &each;
  return nullptr;
}

TEST(EyesimSix, PsdsHaveNoNumbers) {
  Diagnostics d;
  const auto robot = read_robi(
      "drive DIFFERENTIAL_DRIVE\nname old\naxis 20\nwheel 54 3600 1100 90\n"
      "psd PSD_FRONT 60 20 30 0\npsd PSD_LEFT 56 45 30 90\npsd PSD_RIGHT 56 -45 30 -90\n",
      "old.robi", {}, d);
  ASSERT_TRUE(robot) << robot.error().text();
  EXPECT_EQ(robot->psds.at(1), "PSD_FRONT");
  EXPECT_EQ(robot->psds.at(3), "PSD_RIGHT");
  // x, y and z in mm, z over the robot's point, which is half a wheel above the ground.
  const Vec3 p = device(*robot, "PSD_RIGHT")->X_LS.p;
  EXPECT_NEAR(p.x, 0.056, 1e-12);
  EXPECT_NEAR(p.y, -0.045, 1e-12);
  EXPECT_NEAR(p.z, 0.057, 1e-12);
  // Numbers of sensors do not repeat: polar coordinates, 100 mm to the left.
  const auto polar = read_robi(
      "drive DIFFERENTIAL_DRIVE\nname older\npsd PSD_FRONT -200 0 80 0\npsd PSD_LEFT -205 90 100 0\n",
      "older.robi", {}, d);
  ASSERT_TRUE(polar) << polar.error().text();
  EXPECT_EQ(polar->psds.at(-205), "PSD_LEFT");
  EXPECT_NEAR(device(*polar, "PSD_LEFT")->X_LS.p.y, 0.1, 1e-12);
}

TEST(EyesimSix, CamerasOnServosLookIntoTheMiddle) {
  Diagnostics d;
  const auto robot = read_robi(
      "drive DIFFERENTIAL_DRIVE\nname old\ncamera 45 0 72 SERVO1(-90,+90) SERVO2(-100,+80) 80 60\n",
      "old.robi", {}, d);
  ASSERT_TRUE(robot) << robot.error().text();
  EXPECT_EQ(d.warnings.size(), 2u);
  // -10 degrees of tilt: it looks down.
  const Vec3 ahead = rotate(device(*robot, "camera")->X_LS.q, {1, 0, 0});
  EXPECT_NEAR(ahead.z, -0.17364817766693, 1e-12);
  EXPECT_NEAR(ahead.y, 0, 1e-12);
}

TEST(EyesimMazes, MayMarkTheirGoal) {
  Diagnostics d;
  const auto plan = read_maze(" _ _\n|s F|\n", "goal.maz", d);
  ASSERT_TRUE(plan);
  EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
}

TEST(EyesimMazes, MayHaveCellsOfThreeCharacters) {
  // Two columns of three rows: a floor below the upper left and the middle right cell, a wall between the upper ones.
  Diagnostics d;
  const auto wide = read_maze(" _____\n|__|  |\n|s __ |\n|_____|\n", "wide.maz", d);
  ASSERT_TRUE(wide);
  EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
  ASSERT_EQ(wide->walls.size(), 7u);  // with the four around
  EXPECT_NEAR(wide->width_m, 0.72, 1e-12);
  EXPECT_NEAR(wide->height_m, 1.08, 1e-12);
  ASSERT_EQ(wide->starts.size(), 1u);
  EXPECT_NEAR(wide->starts.front().x_m, 0.18, 1e-12);
  EXPECT_NEAR(wide->starts.front().y_m, 0.54, 1e-12);
}

}  // namespace
}  // namespace sandlot::formats::eyesim
