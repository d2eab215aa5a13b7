/// Maneuvers in a scenario: pieces of way that a user writes, on both engines, at the levels of a drive.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <tuple>
#include <vector>

#include "command.h"

namespace sandlot::test {
namespace {

constexpr double pi = 3.141592653589793;

/// Numbers of a CSV file by line; NaN for empty cells.
std::vector<std::vector<double>> number_node(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');)
      rows.back().push_back(cell.empty() ? std::nan("") : std::stod(cell));
  }
  return rows;
}

class Maneuvers : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  std::string run() const {
    const auto [engine, level] = GetParam();
    return std::string("tests/scenarios/maneuvers.yaml --set physics=") + engine + " --set level=" + level;
  }
};
INSTANTIATE_TEST_SUITE_P(All, Maneuvers,
                         testing::Combine(testing::Values("rigid", "planar"),
                                          testing::Values("ideal", "contact")));

TEST_P(Maneuvers, EndWhereAndWhenTheyAreExpected) {
  const TestFolder scratch;
  const Printed printed = sandlot(
      "run " + run() + " --log " + scratch.file("log.csv") +
      " --log-values 'walker.pose.x,walker.pose.y,walker.pose.yaw,walker/drive.odometry.x,"
      "walker/drive.odometry.y,walker/drive.odometry.theta,walker/drive/maneuver.done,"
      "walker/drive/maneuver.maneuvers'");
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  const auto rows = number_node(scratch.file("log.csv"));
  ASSERT_EQ(rows.size(), 1601u);
  // When, and where by the odometry, within 1 mm and 1 mrad of each goal; and in truth, where wheels slip in turns by some 2 %.
  // Goals add up.
  const struct {
    double begin_s, takes_s, x, y, heading;
  } ends[] = {
      {0.5, 1 / 0.5 + 0.5 / 2, 1, 0, 0},
      {4, 0.5 * pi / 1 + 1.0 / 10, 1, 0, 0.5 * pi},
      // A quarter of a circle of 0.5 m at 1 m/s and 2 m/s^2.
      {7, 0.25 * pi / 1 + 1.0 / 2, 0.5, 0.5, pi},
      // A turn of 135 degrees at 3 rad/s and 10 rad/s^2, then a triangle of sqrt(0.5) m.
      {10, 0.75 * pi / 3 + 0.3 + 2 * std::sqrt(std::sqrt(0.5) / 2), 1, 0, 1.75 * pi},
  };
  double counted = 0;
  for (const auto& end : ends) {
    ++counted;
    SCOPED_TRACE(counted);
    // The order acts one tick after the step that gives it, and the profile ends a few ticks late.
    const auto at = [&](double s) { return rows[static_cast<std::size_t>(std::lround(s * 100))]; };
    EXPECT_EQ(at(end.begin_s + end.takes_s - 0.05)[7], 0);
    const auto row = at(end.begin_s + end.takes_s + 0.25);
    EXPECT_EQ(row[7], 1);
    EXPECT_EQ(row[8], counted);
    for (const std::size_t k : {1u, 4u}) {
      const bool slips = k == 1 && std::string(std::get<1>(GetParam())) == "contact";
      const double near = k == 4 ? 1e-3 * (counted + 1) : slips ? 0.05 : 0.01;
      EXPECT_NEAR(row[k], end.x, near);
      EXPECT_NEAR(row[k + 1], end.y, near);
      EXPECT_NEAR(std::remainder(row[k + 2] - end.heading, 2 * pi), 0, 2 * near);
    }
  }
}

TEST_P(Maneuvers, AWallStallsBothMotors) {
  const TestFolder scratch;
  const Printed printed = sandlot("run " + run() + " --log " + scratch.file("log.csv") +
                                  " --log-values 'rammer.pose.x,rammer/drive/maneuver.done,"
                                  "rammer/drive/maneuver.remaining_distance,"
                                  "rammer/drive/maneuver.stalled[0],rammer/drive/maneuver.stalled[1]'");
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  const auto rows = number_node(scratch.file("log.csv"));
  const auto& last = rows.back();
  EXPECT_LT(last[1], 4);
  EXPECT_EQ(last[2], 0);
  EXPECT_NEAR(last[3], 3 - (last[1] - 2.5), 0.02);  // by its own odometry
  EXPECT_EQ(last[4], 1);
  EXPECT_EQ(last[5], 2);
  EXPECT_TRUE(std::isnan(rows[200][4])) << "it still rolls";
}

TEST_P(Maneuvers, EndInTheSameStateFor12And4Threads) {
  std::string hash;
  for (const char* threads : {"1", "2", "4"}) {
    const auto summary = summary_of(run() + " --threads " + threads);
    ASSERT_FALSE(summary.contains("failed")) << summary["failed"];
    if (hash.empty()) hash = summary["state_hash"];
    EXPECT_EQ(summary["state_hash"], hash) << threads << " threads";
  }
}

TEST(Maneuver, IsACommandOfTheConsole) {
  const TestFolder scratch;
  const std::string run = "run tests/scenarios/levels.yaml --set robots.robot.controller=null --duration 3s";
  const Printed printed = sandlot(
      run + R"( --command 'at 0.5s command robot/drive DriveManeuver {"kind": 1, "angle": 1}' --log )" +
      scratch.file("log.csv") + " --log-values robot/drive.odometry.theta");
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  EXPECT_NEAR(number_node(scratch.file("log.csv")).back()[1], 1, 1e-3);
  const Printed refused = sandlot(run +
                                  R"( --command 'at 0.5s command robot/drive DriveManeuver {"kind": 7}')");
  EXPECT_NE(refused.out.find("there is no maneuver of kind 7"), std::string::npos) << refused.out;
}

/// A velocity with errors is computed anew in each tick, until a maneuver ends it.
TEST(Maneuver, EndsAVelocityWithErrors) {
  const TestFolder scratch;
  const std::string file = scratch.write("s.yaml", R"(version: 1
name: errors
physics: planar
time: {step: 10 ms, control_interval: 1, stop: 5 s}
robots:
  - name: rover
    model: {builder: diff_robot}
    devices: {drive: {command_errors: {linear: [{gaussian: {std: 0.02}}]}}}
    controller:
      kind: sequence
      steps:
        - {at: 0.1 s, orders: {drive: [0.2]}}
        - {at: 1 s, orders: {drive: {maneuver: straight, distance: 0.4, speed: 0.5}}}
)");
  const Printed printed = sandlot("run " + file + " --log " + scratch.file("log.csv") +
                                  " --log-values rover/drive.odometry.x,rover/drive/maneuver.done");
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  const auto rows = number_node(scratch.file("log.csv"));
  // The order of 1 s acts from then on.
  EXPECT_NEAR(rows.back()[1] - rows[100][1], 0.4, 5e-3);
  EXPECT_EQ(rows.back()[2], 1);
  EXPECT_EQ(rows[150][2], 0);
}

}  // namespace
}  // namespace sandlot::test
