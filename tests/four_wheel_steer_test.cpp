/// MARIO on the joystick's course (scenarios/mario_drive.yaml): the figures of docs/four_wheel_steer.md, within the bounds
/// that the paper's Table 1 sets, without and with the latency of a real robot. `sandlot reproduce mario`: one page of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "app/papers/mario.h"
#include "command.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
namespace mario = app::mario;
using testing::HasSubstr;
using testing::Not;

std::string whole_file(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

draw::Table mario_run(const std::vector<std::pair<std::string, std::string>>& settings) {
  const TestFolder scratch;
  const std::string file = scratch.file("drive.csv");
  std::string values, sets;
  for (const std::string& value : mario::drive_values()) values += (values.empty() ? "" : ",") + value;
  for (const auto& [name, value] : settings) sets.append(" --set ").append(name).append("=").append(value);
  const Printed printed = sandlot("run scenarios/mario_drive.yaml --headless --log " + file +
                                  " --log-values '" + values + "'" + sets);
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
  auto table = draw::read_csv(whole_file(file), file);
  EXPECT_TRUE(table) << (table ? "" : table.error().text());
  return table ? std::move(*table) : draw::Table{};
}

void expect_near_the_papers(const draw::Table& run, const mario::VelocityErrors& paper) {
  const auto errors = mario::velocity_errors(run);
  ASSERT_TRUE(errors) << errors.error().text();
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(mario::is_near(errors->all()[i], paper.all()[i])) << i << ": " << errors->all()[i];
  EXPECT_TRUE(mario::in_order(*errors));
}

TEST(MarioDrive, ErrorsAndLagAreNearThePapers) {
  const draw::Table ideal = mario_run({}), slow = mario_run(mario::latency_settings());
  expect_near_the_papers(ideal, mario::paper_simulation);
  expect_near_the_papers(slow, mario::paper_robot);
  const auto lag = mario::steering_lag(ideal, slow);
  ASSERT_TRUE(lag) << lag.error().text();
  EXPECT_NEAR(lag->lag_s, mario::paper_lag_s, mario::lag_bound_s);
  EXPECT_GT(lag->correlation, 0.99);

  // The odometry sees joints alone. 25 m of way: 0.1 m is 0.4 % of it.
  for (const draw::Table* const log : {&ideal, &slow})
    for (const std::string axis : {"x", "y"}) {
      const auto odometry = mario::column_of(*log, "mario/base/odometry.pose.pose.position." + axis);
      const auto truth = mario::column_of(*log, "mario.pose." + axis);
      ASSERT_TRUE(odometry && truth);
      EXPECT_NEAR(odometry->back(), truth->back(), 0.1);
    }
}

TEST(MarioPaper, BoundsAreThoseOfTheTable) {
  // Table 1 of the paper; a value just within and just beyond a factor of 1.5.
  EXPECT_EQ(mario::paper_simulation.all(), (std::array<double, 3>{4.36, 1.39, 5.99}));
  EXPECT_EQ(mario::paper_robot.all(), (std::array<double, 3>{7.38, 3.34, 13.29}));
  for (const double paper : {4.36, 13.29}) {
    EXPECT_TRUE(mario::is_near(1.49 * paper, paper) && mario::is_near(paper / 1.49, paper));
    EXPECT_FALSE(mario::is_near(1.51 * paper, paper) || mario::is_near(paper / 1.51, paper));
  }
  EXPECT_TRUE(mario::in_order({.v_x = 2, .v_y = 1, .yaw_rate = 3}));
  EXPECT_FALSE(mario::in_order({.v_x = 1, .v_y = 2, .yaw_rate = 3}));
  EXPECT_FALSE(mario::in_order({.v_x = 3, .v_y = 1, .yaw_rate = 2}));
}

/// Row of results.json.
nlohmann::json row_of(const nlohmann::json& results, const std::string& part, const std::string& quantity) {
  for (const auto& row : results)
    if (row["part"] == part && row["quantity"] == quantity) return row;
  ADD_FAILURE() << "no row " << part << ", " << quantity;
  return {};
}

/// What the page of a quick and of a whole run have in common.
void expect_page_of_the_paper(const TestFolder& scratch) {
  const std::string html = scratch.read("out/index.html");
  for (const char* const text : {"Figure 5",
                                 "Figure 7",
                                 "Figures of the paper that are not shown",
                                 "Figure 9",
                                 "Table 1",
                                 "Figure 12 (a)",
                                 "Figure 12 (b)",
                                 "Figure 12 (c)",
                                 "Figure 13",
                                 "Figure 14 (a)",
                                 "Figure 14 (b)",
                                 "Figure 14 (c)",
                                 "Figure 15 (b)",
                                 "Figure 16",
                                 "the paper: 190 ms",
                                 "Where we differ",
                                 "time [s]",
                                 "steering angle [rad]",
                                 "data:image/png;base64",
                                 "with latency"})
    EXPECT_THAT(html, HasSubstr(text));
  for (const char* const text :
       {"src=\"http", "href=\"http", "<script", "<link", ">nan", ">inf", "beyond", "does not hold"})
    EXPECT_THAT(html, Not(HasSubstr(text)));

  const nlohmann::json results = read_json(scratch.file("out/results.json"));
  ASSERT_TRUE(results.is_array());
  const char* const axes[] = {"v_x", "v_y", "yaw rate"};
  for (const auto& [column, paper] :
       {std::pair("simulation", mario::paper_simulation), std::pair("real robot", mario::paper_robot)})
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = row_of(results, "Table 1", std::string("error of ") + axes[i] + ", " + column);
      EXPECT_EQ(row["paper"], paper.all()[i]);
      EXPECT_TRUE(mario::is_near(row["ours"], paper.all()[i])) << row;
    }
  const auto lag = row_of(results, "Section 4.1", "lag of servo1, real robot behind simulation");
  EXPECT_EQ(lag["paper"], 190);
  EXPECT_NEAR(lag["ours"].get<double>(), 190, 10);
  EXPECT_EQ(row_of(results, "Figure 5", "joints that move")["ours"], 8);
  EXPECT_EQ(row_of(results, "Figure 5", "links that they join")["ours"], 9);
  // The loop of 61 rad/s rises within some 50 ms and hardly overshoots.
  EXPECT_LT(row_of(results, "Figure 9", "rise time")["ours"].get<double>(), 100);
  EXPECT_LT(row_of(results, "Figure 9", "overshoot")["ours"].get<double>(), 10);

  // A minute of ticks each, and the head.
  for (const char* const file : {"out/drive_simulation.csv", "out/drive_with_latency.csv"}) {
    const std::string csv = scratch.read(file);
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 6201) << file;
  }
  const nlohmann::json graph = read_json(scratch.file("out/topics.json"));
  int orders = 0;
  for (const auto& topic : graph["topics"]) {
    if (topic["publishers"] == nlohmann::json{"mario/base"} && topic["readers"].size() == 1) ++orders;
    if (topic["name"] == "/mario/joystick/cmd_vel") {
      EXPECT_EQ(topic["readers"], nlohmann::json{"mario/base"});
    }
    if (topic["name"] == "/mario/eyes/odometry") {
      EXPECT_EQ(topic["readers"], (nlohmann::json{"mario/estimator", "mario/locator"}));
    }
  }
  EXPECT_EQ(orders, 8);  // four position, four velocity controllers
  for (const auto& entry : fs::directory_iterator(scratch.path / "out"))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST(MarioPaper, QuickIsOnePageWithoutTheLoop) {
  const TestFolder scratch;
  const Printed made = sandlot("reproduce mario --quick --out " + scratch.file("out"));
  ASSERT_EQ(made.exit_code, 0) << made.out;
  expect_page_of_the_paper(scratch);
  EXPECT_THAT(scratch.read("out/index.html"), HasSubstr("--quick leaves out"));
  EXPECT_FALSE(fs::exists(scratch.file("out/loop.csv")));
}

TEST(MarioPaper, WrongOptionsAndFoldersLeaveNothing) {
  const TestFolder scratch;
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    const Printed printed = sandlot("reproduce " + arguments);
    EXPECT_EQ(printed.exit_code, 2) << arguments;
    EXPECT_THAT(printed.out, HasSubstr(why));
  };
  const std::string out = " --out " + scratch.file("out");
  refused("mario --slow" + out, "--slow");
  refused("mario --repeat 3" + out, "--repeat: mario repeats no runs; leave it out");
  refused("mario --traces tests/clock/pile.csv" + out, "--traces: mario takes no step times; leave it out");
  refused("eyesim --quick" + out, "--quick: eyesim has no parts to leave out; leave it out");
  EXPECT_FALSE(fs::exists(scratch.file("out")));
  // A file, a device, and a folder that is there but takes no files.
  scratch.write("file", "text");
  refused("mario --quick --out " + scratch.file("file"), "name a folder that can be written");
  EXPECT_EQ(scratch.read("file"), "text");
  refused("mario --quick --out /dev/null/out", "name a folder that can be written");
  refused("mario --quick --out /proc/self",
          "no file can be written there; name a folder that can be written");
}

TEST(LongReproduce, MarioClosesTheLoop) {
  const TestFolder scratch;
  const Printed made = sandlot("reproduce mario --out " + scratch.file("out"));
  ASSERT_EQ(made.exit_code, 0) << made.out;
  expect_page_of_the_paper(scratch);
  EXPECT_THAT(scratch.read("out/index.html"), HasSubstr("Figure 15 (a)"));
  const nlohmann::json results = read_json(scratch.file("out/results.json"));
  const auto filter = row_of(results, "Figure 15", "filter at the end of the loop");
  EXPECT_EQ(filter["paper"], 0.3);
  EXPECT_LE(filter["ours"].get<double>(), 0.3);
  EXPECT_GT(row_of(results, "Figure 15", "wheels at the end")["ours"], filter["ours"]);
  const std::string csv = scratch.read("out/loop.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 841);  // 84 s at 10 Hz
}

}  // namespace
}  // namespace sandlot::test
