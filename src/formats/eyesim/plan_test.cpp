/// Expected numbers follow from the definition of the formats by hand: see docs/eyesim_files.md.
#include "formats/eyesim/plan.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandlot::formats::eyesim {
namespace {

Plan wld(std::string_view text, Diagnostics& diagnostics) {
  auto plan = read_wld(text, "room.wld", diagnostics);
  EXPECT_TRUE(plan) << plan.error().text();
  return plan ? *plan : Plan{};
}
std::string wld_error(std::string_view text) {
  Diagnostics diagnostics;
  const auto plan = read_wld(text, "room.wld", diagnostics);
  return plan ? "none" : plan.error().text();
}
Plan maze(std::string_view text, Diagnostics& diagnostics) {
  auto plan = read_maze(text, "small.maz", diagnostics);
  EXPECT_TRUE(plan) << plan.error().text();
  return plan ? *plan : Plan{};
}
void expect_wall(const Wall& wall, double x1, double y1, double x2, double y2) {
  EXPECT_NEAR(wall.x1_m, x1, 1e-12);
  EXPECT_NEAR(wall.y1_m, y1, 1e-12);
  EXPECT_NEAR(wall.x2_m, x2, 1e-12);
  EXPECT_NEAR(wall.y2_m, y2, 1e-12);
}

TEST(EyesimMaze, DrawnWithPostsIsTheSameMaze) {
  Diagnostics d;
  const Plan with = maze("/* a comment\no---o---o\n|   |  G|\no   o   o\n| S     |\no---o---o\n180\n", d);
  EXPECT_EQ(d.warnings.size(), 1u);  // the comment
  const Plan without = maze(" ___\n| | |\n|S__|\n180\n", d);
  ASSERT_EQ(with.walls.size(), without.walls.size());
  for (std::size_t i = 0; i < with.walls.size(); ++i) {
    const Wall& wall = without.walls[i];
    expect_wall(with.walls[i], wall.x1_m, wall.y1_m, wall.x2_m, wall.y2_m);
  }
  ASSERT_EQ(with.starts.size(), 1u);
  EXPECT_NEAR(with.starts[0].x_m, 0.09, 1e-12);
  EXPECT_NEAR(with.height_m, 0.36, 1e-12);
}

TEST(EyesimWorld, HasWallsInMillimetresAndTheirUsualSizes) {
  Diagnostics d;
  const Plan plan = wld(
      "; a room\nwidth 3000\nheight 2000\n0 0 3000 0   # below\n0 0 0 2000 50 400\n"
      "1 2 3 4 5 6 255 0 51\n",
      d);
  EXPECT_TRUE(d.warnings.empty());
  EXPECT_EQ(plan.width_m, 3);
  EXPECT_EQ(plan.height_m, 2);
  ASSERT_EQ(plan.walls.size(), 3u);
  expect_wall(plan.walls[0], 0, 0, 3, 0);
  EXPECT_EQ(plan.walls[0].thickness_m, 0.01);
  EXPECT_EQ(plan.walls[0].height_m, 0.2);
  EXPECT_EQ(plan.walls[1].thickness_m, 0.05);
  EXPECT_EQ(plan.walls[1].height_m, 0.4);
  EXPECT_FLOAT_EQ(plan.walls[2].color.r, 1);
  EXPECT_FLOAT_EQ(plan.walls[2].color.b, 0.2f);
}

TEST(EyesimWorld, FramesApplyFromTheInnermostOutward) {
  Diagnostics d;
  // (100, 0) turned by 90 deg is (0, 100), moved to (10, 120); turned by 90 deg (-120, 10), moved to (880, 510).
  const Plan plan = wld("push 1000 500 90\npush 10 20 90\n100 0 0 0\nposition 100 0 0\npop\npop\n100 0 0 0\n",
                        d);
  ASSERT_EQ(plan.walls.size(), 2u);
  expect_wall(plan.walls[0], 0.88, 0.51, 0.98, 0.51);
  expect_wall(plan.walls[1], 0.1, 0, 0, 0);
  ASSERT_EQ(plan.starts.size(), 1u);
  EXPECT_NEAR(plan.starts[0].x_m, 0.88, 1e-12);
  EXPECT_NEAR(plan.starts[0].yaw_rad, M_PI, 1e-12);
}

TEST(EyesimWorld, SaysWhatIsWrongWithItsLine) {
  EXPECT_EQ(wld_error("pop\n"), "room.wld:1: 'pop' has no 'push' before it");
  EXPECT_EQ(wld_error("\n0 0 10 x\n"), "room.wld:2: 'x' is not a number for this place; give one within 1e9");
  EXPECT_EQ(wld_error("width -3\n"),
            "room.wld:1: a floor of this size is none; give its width and height in mm");
  EXPECT_EQ(wld_error("push 1 2\n"), "room.wld:1: 'push' lacks an angle in degrees");
  EXPECT_EQ(wld_error("floor_texture \"grass.png\n"), "room.wld:1: a name has no closing quotation mark");
  EXPECT_EQ(wld_error("0 0 9 9 0 200\n"), "room.wld:1: a wall has a thickness and a height above 0");
}

TEST(EyesimWorld, WhatItDoesNotKnowIsOneWarningEach) {
  Diagnostics d;
  const Plan plan = wld("water_level 20\n1 2 3\n5 5 5 5\n0 0 1 1 1\n", d);
  EXPECT_EQ(plan.walls.size(), 1u);
  ASSERT_EQ(d.warnings.size(), 4u);
  EXPECT_EQ(d.warnings[0].text(), "room.wld:1: 'water_level' is not known and left out");
}

TEST(EyesimMaze, DrawsWallsCellsAndLetters) {
  Diagnostics d;
  // Two cells wide, two high, of 500 mm: an outline, a wall between the lower cells, another below the upper left one.
  const Plan plan = maze(" _ _\n|_ r|\n|S|x|\n    \n500\n", d);
  EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
  EXPECT_EQ(plan.width_m, 1);
  ASSERT_EQ(plan.starts.size(), 2u);
  // The row of S is the last one, its base at 0; r's is above it.
  EXPECT_NEAR(plan.starts[0].x_m, 0.75, 1e-12);
  EXPECT_NEAR(plan.starts[0].y_m, 0.75, 1e-12);
  EXPECT_EQ(plan.starts[0].yaw_rad, 0);
  EXPECT_NEAR(plan.starts[1].x_m, 0.25, 1e-12);
  EXPECT_NEAR(plan.starts[1].y_m, 0.25, 1e-12);
  EXPECT_NEAR(plan.starts[1].yaw_rad, M_PI / 2, 1e-12);
  ASSERT_EQ(plan.boxes.size(), 1u);
  EXPECT_NEAR(plan.boxes[0].x_m, 0.75, 1e-12);
  // Row by row: top of both cells, below the upper left one, below S; then column by column.
  ASSERT_EQ(plan.walls.size(), 6u);
  expect_wall(plan.walls[0], 0, 1, 1, 1);
  expect_wall(plan.walls[1], 0, 0.5, 0.5, 0.5);
  expect_wall(plan.walls[2], 0, 0, 0.5, 0);
  expect_wall(plan.walls[3], 0, 0, 0, 1);
  expect_wall(plan.walls[4], 0.5, 0, 0.5, 0.5);
  expect_wall(plan.walls[5], 1, 0, 1, 1);
}

TEST(EyesimMaze, CellsAreUsually360MillimetresWide) {
  Diagnostics d;
  const Plan plan = maze(" _\n|_|\n", d);
  EXPECT_NEAR(plan.width_m, 0.36, 1e-12);
  EXPECT_NEAR(plan.height_m, 0.36, 1e-12);
}

TEST(EyesimMaze, RefusesWhatIsNone) {
  Diagnostics d;
  const auto none = read_maze("hello\n", "small.maz", d);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().text(), "small.maz: there is no row of a maze; draw it with | and _");
  const auto size = read_maze("|_|\n0.5\n", "small.maz", d);
  ASSERT_FALSE(size);
  EXPECT_EQ(size.error().text(), "small.maz:2: the cells of a maze are 1 to 1e5 mm wide");
}

TEST(EyesimPlan, BecomesAWorldWithAFloorWallsAndThings) {
  Diagnostics d;
  const Plan plan = maze(" _ _\n|o x|\n|_ _|\n", d);
  const auto world = world_of(plan, "small", "small.maz", {}, d);
  ASSERT_TRUE(world) << world.error().text();
  ASSERT_EQ(world->instances.size(), 4u);
  EXPECT_EQ(world->instances[0].name, "ground");
  EXPECT_EQ(world->instances[1].name, "walls");
  EXPECT_TRUE(world->instances[1].model->is_static);
  EXPECT_EQ(world->instances[1].model->links[0].collisions.size(), plan.walls.size());
  EXPECT_EQ(world->instances[2].name, "ball");
  EXPECT_FALSE(world->instances[2].model->is_static);
  const auto& ball = world->instances[2].model->links[0];
  EXPECT_NEAR(ball.inertial.mass_kg, 0.0459, 1e-12);
  // Homogeneous ball: 2/5 m r^2.
  EXPECT_NEAR(ball.inertial.moments.x, 0.4 * 0.0459 * 0.02135 * 0.02135, 1e-12);
}

TEST(EyesimPlan, IsWrittenAsItWasRead) {
  Diagnostics d;
  const std::string text =
      "floor 3000 2000\n0 0 3000 0 10 200 217 217 209\n100 200 100 1500 25 400 255 0 51\n";
  const auto world = world_of(wld(text, d), "room", "room.wld", {}, d);
  ASSERT_TRUE(world);
  model::Setup setup;
  setup.instances = world->instances;
  const auto written = wld_of(setup, d);
  ASSERT_TRUE(written) << written.error().text();
  EXPECT_EQ(*written, text);
  EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
}

TEST(EyesimPlan, LeavesOutWhatAWorldFileCannotSay) {
  Diagnostics d;
  const auto world = world_of(maze(" _ _\n|o x|\n|_ _|\n", d), "small", "small.maz", {}, d);
  ASSERT_TRUE(world);
  model::Setup setup;
  setup.instances = world->instances;
  ASSERT_TRUE(wld_of(setup, d));
  ASSERT_EQ(d.warnings.size(), 2u);
  EXPECT_EQ(d.warnings[0].what, "'ball' is left out: a world of EyeSim has no things that move");
  setup.instances.clear();
  EXPECT_FALSE(wld_of(setup, d));
}

}  // namespace
}  // namespace sandlot::formats::eyesim
