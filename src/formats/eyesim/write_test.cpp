/// What is written and read again is the same; what a file shows follows by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "base/text.h"
#include "formats/eyesim/plan.h"
#include "formats/eyesim/robi.h"

namespace sandlot::formats::eyesim {
namespace {

using Ends = std::tuple<long, long, long, long>;
std::vector<Ends> walls_of(const Plan& plan) {
  std::vector<Ends> out;
  const auto mm = [](double m) { return std::lround(m * 1e3); };
  for (const Wall& w : plan.walls) out.emplace_back(mm(w.x1_m), mm(w.y1_m), mm(w.x2_m), mm(w.y2_m));
  std::sort(out.begin(), out.end());
  return out;
}
std::vector<Ends> spots_of(const std::vector<Spot>& spots) {
  std::vector<Ends> out;
  for (const Spot& s : spots)
    out.emplace_back(std::lround(s.x_m * 1e3), std::lround(s.y_m * 1e3), std::lround(s.yaw_rad * 1e6), 0);
  std::sort(out.begin(), out.end());
  return out;
}
Plan maze_plan(std::string_view text) {
  Diagnostics d;
  auto plan = read_maze(text, "small.maz", d);
  EXPECT_TRUE(plan) << plan.error().text();
  for (const Error& warning : d.warnings) ADD_FAILURE() << warning.text();
  return plan ? *plan : Plan{};
}

TEST(EyesimMazeWriter, DrawsWhatWasRead) {
  const std::string text =
      " _________\n"
      "|S|  _  |o|\n"
      "| | | |l|X|\n"
      "|d|_  |_  |\n"
      "|   |_ r|x|\n"
      "|_|_____|_|\n"
      "360\n";
  const Plan plan = maze_plan(text);
  Diagnostics d;
  const auto written = maze_text(plan, d);
  ASSERT_TRUE(written) << written.error().text();
  EXPECT_TRUE(d.warnings.empty());
  EXPECT_EQ(*written, text);
}

TEST(EyesimMazeWriter, KeepsWallsAndSpotsOfBothStyles) {
  // With and without characters between cells; a cell that is open to the right.
  for (const char* const text :
       {" _ _ _\n|  _  |\n|_|_ _\n", " _____\n|  _  |\n|_|___\n100\n", "   _\n  |_|\n"}) {
    SCOPED_TRACE(text);
    const Plan plan = maze_plan(text);
    Diagnostics d;
    const auto written = maze_text(plan, d);
    ASSERT_TRUE(written) << written.error().text();
    const Plan again = maze_plan(*written);
    EXPECT_EQ(walls_of(again), walls_of(plan));
    EXPECT_EQ(spots_of(again.starts), spots_of(plan.starts));
  }
}

TEST(EyesimMazeWriter, RefusesWallsThatLieOnNoGrid) {
  Diagnostics d;
  Plan plan;
  plan.walls.push_back({.x1_m = 0, .y1_m = 0, .x2_m = 1, .y2_m = 1, .place = {}});
  EXPECT_EQ(maze_text(plan, d).error().what, "a wall is neither along x nor along y");
  plan.walls[0] = {.x1_m = 0, .y1_m = 0, .x2_m = 1, .y2_m = 0, .place = {}};
  plan.walls.push_back({.x1_m = 0.307, .y1_m = 0, .x2_m = 0.307, .y2_m = 1, .place = {}});
  EXPECT_EQ(maze_text(plan, d).error().what, "the walls do not lie on a grid of cells of 20 mm or more");
  EXPECT_EQ(maze_text({}, d).error().what, "there is no wall that a maze could have");
}

Robi read_back(std::string_view text, Diagnostics& d) {
  auto robot = read_robi(text, "scout.robi", {}, d);
  EXPECT_TRUE(robot) << robot.error().text();
  return robot ? *robot : Robi{};
}

void expect_same(const model::Model& a, const model::Model& b) {
  ASSERT_EQ(a.links.size(), b.links.size());
  for (std::size_t i = 0; i < a.links.size(); ++i) {
    SCOPED_TRACE(a.links[i].name);
    EXPECT_EQ(a.links[i].name, b.links[i].name);
    EXPECT_NEAR(a.links[i].inertial.mass_kg, b.links[i].inertial.mass_kg, 1e-8);
    const Vec3 p = a.links[i].X_ML.p - b.links[i].X_ML.p,
               c = a.links[i].inertial.X_LCo.p - b.links[i].inertial.X_LCo.p;
    EXPECT_NEAR(norm(p) + norm(c), 0, 1e-8);
    EXPECT_NEAR(norm(a.links[i].inertial.moments - b.links[i].inertial.moments), 0, 1e-8);
    ASSERT_EQ(a.links[i].collisions.size(), b.links[i].collisions.size());
    for (std::size_t k = 0; k < a.links[i].collisions.size(); ++k) {
      const model::Collision &one = a.links[i].collisions[k], &other = b.links[i].collisions[k];
      EXPECT_EQ(one.shape.index(), other.shape.index());
      EXPECT_NEAR(norm(one.X_LC.p - other.X_LC.p), 0, 1e-8);
      EXPECT_NEAR(volume_m3(one.shape), volume_m3(other.shape), 1e-8);
    }
  }
}

TEST(EyesimRobotWriter, WhatWasReadIsTheSameRobot) {
  for (const char* const text :
       {"drive DIFFERENTIAL_DRIVE\nname scout\nmass 2.5 0 20 0\ncollider box 120 60 150 0 35 0\naxis 10 5\n"
        "wheel 54 1800 1100 90\npsd PSD_FRONT 1 70 0 30 0\npsd PSD_LEFT 2 30 45 30 90\n"
        "camera 60 0 60 15 10 60 46.83\nlidar 360 180\n",
        "drive ACKERMANN_DRIVE\nname car\nmass 3\ncollider capsule 40 120 0 60 10\ncollider sphere 30 0 80 "
        "0\n"
        "axel drive 0 -60\naxel turn 0 140\nwheel drive 80 1400 1000 160\nwheel turn 60 900 1000 150\n"
        "lidar 180 91\n",
        "drive OMNI_DRIVE\nname \"my robot\"\ncollider box 160 80 260 0 50 0\nwheel 80 1400 1000 240\n"
        "camera 0 0 60 0 0 60 45\nfisheye 120\n"}) {
    SCOPED_TRACE(text);
    Diagnostics d;
    const Robi one = read_back(text, d);
    const auto written = robi_of(one.instance, d);
    ASSERT_TRUE(written) << written.error().text();
    EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
    const Robi two = read_back(*written, d);
    expect_same(*one.instance.model, *two.instance.model);
    ASSERT_EQ(one.instance.devices.size(), two.instance.devices.size());
    for (std::size_t i = 0; i < one.instance.devices.size(); ++i) {
      const model::DeviceDecl &a = one.instance.devices[i], &b = two.instance.devices[i];
      SCOPED_TRACE(a.name);
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.kind, b.kind);
      EXPECT_NEAR(norm(a.X_LS.p - b.X_LS.p), 0, 1e-8);
      for (const Node::Entry& key : a.config.entries()) {
        const Node* const other = b.config.find(key.key);
        ASSERT_TRUE(other) << key.key;
        double x = 0, y = 0;
        if (parse_number(key.value.text(), x) && parse_number(other->text(), y))
          EXPECT_NEAR(x, y, 1e-7) << key.key;
        else EXPECT_EQ(key.value.text(), other->text()) << key.key;
      }
    }
    // What was written is written the same way again.
    EXPECT_EQ(*robi_of(two.instance, d), *written);
  }
}

TEST(EyesimRobotWriter, RefusesWhatHasNoWheels) {
  Diagnostics d;
  model::Instance none;
  none.name = "arm";
  none.model = std::make_shared<const model::Model>();
  EXPECT_EQ(robi_of(none, d).error().what, "'arm' has no drive that a .robi file knows");
}

TEST(EyesimRobot, OfTheOlderFormHasPolarSensorsAndSpeeds) {
  Diagnostics d;
  const Robi robot = read_back(
      "drive DIFFERENTIAL_DRIVE\ndiameter 200\nspeed 50\nturn 180\nwheel 60 1000 500 150\n"
      "psd PSD_LEFT -205 90 80 0\nir IR_BACK 3 180 90 -10\nbump BUMP -500 -180 180\nerror psd 25\nerror "
      "omega 90\n",
      d);
  EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
  const auto device = [&](std::string_view name) -> const model::DeviceDecl& {
    for (const model::DeviceDecl& each : robot.instance.devices)
      if (each.name == name) return each;
    static const model::DeviceDecl none;
    ADD_FAILURE() << name;
    return none;
  };
  // 90 degrees to the left, 80 mm off the centre, looking the same way.
  const model::DeviceDecl& left = device("PSD_LEFT");
  EXPECT_NEAR(left.X_LS.p.x, 0, 1e-12);
  EXPECT_NEAR(left.X_LS.p.y, 0.08, 1e-12);
  EXPECT_NEAR(rotate(left.X_LS.q, {1, 0, 0}).y, 1, 1e-12);
  EXPECT_EQ(left.config.find("noise")->items().at(0).find("gaussian")->find("std")->text(), "0.025");
  const model::DeviceDecl& back = device("IR_BACK");
  EXPECT_NEAR(yaw_of(back.X_LS.q), 170 * M_PI / 180, 1e-12);
  EXPECT_EQ(back.config.find("max_range")->text(), "0.15");
  EXPECT_EQ(device("BUMP").kind, "contact");
  EXPECT_EQ(device("drive").config.find("max_linear_speed")->text(), "0.5");
  EXPECT_NEAR(std::stod(device("drive").config.find("max_angular_speed")->text()), M_PI, 1e-12);
  EXPECT_TRUE(device("drive").config.find("command_errors"));
  EXPECT_EQ(robot.psds.at(-205), "PSD_LEFT");
}

}  // namespace
}  // namespace sandlot::formats::eyesim
