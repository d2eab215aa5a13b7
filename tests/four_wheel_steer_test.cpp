/// MARIO on the joystick's course (scenarios/mario_drive.yaml): the figures of docs/four_wheel_steer.md, within the bounds
/// that the paper's Table 1 sets, without and with the latency of a real robot.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "command.h"
#include "statistics/signals.h"

namespace sandlot::test {
namespace {

using MarioLog = std::map<std::string, std::vector<double>>;

MarioLog mario_run(const std::string& settings) {
  const TestFolder scratch;
  const std::string file = scratch.file("drive.csv");
  const Printed printed = sandlot(
      "run scenarios/mario_drive.yaml --headless --log " + file +
      " --log-values 'v_x_command,v_x,v_y_command,v_y,yaw_rate_command,yaw_rate,servo1,mario.pose.x,"
      "mario.pose.y,mario/base/odometry.pose.pose.position.x,mario/base/odometry.pose.pose.position.y,"
      "mario/base/state.residual' " +
      settings);
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
  std::ifstream in(file);
  std::string line, cell;
  std::getline(in, line);
  std::vector<std::string> names;
  for (std::istringstream row(line); std::getline(row, cell, ',');)
    names.push_back(cell.substr(0, cell.find(' ')));
  MarioLog log;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    for (const std::string& name : names) {
      std::getline(row, cell, ',');
      log[name].push_back(cell.empty() ? 0 : std::stod(cell));  // none yet: it stands
    }
  }
  return log;
}

double mario_error(MarioLog& log, const std::string& axis) {
  const auto error = statistics::percent_error(log[axis + "_command"], log[axis]);
  EXPECT_TRUE(error) << (error ? "" : error.error().text());
  return error ? *error : 1e9;
}

/// Within a factor of 1.5 of the paper's.
void expect_near_the_papers(MarioLog& log, double v_x, double v_y, double yaw_rate) {
  const double x = mario_error(log, "v_x"), y = mario_error(log, "v_y"), turn = mario_error(log, "yaw_rate");
  const auto near = [](double ours, double paper) { return ours > paper / 1.5 && ours < paper * 1.5; };
  EXPECT_TRUE(near(x, v_x)) << x;
  EXPECT_TRUE(near(y, v_y)) << y;
  EXPECT_TRUE(near(turn, yaw_rate)) << turn;
  EXPECT_LT(y, x);
  EXPECT_LT(x, turn);
}

TEST(MarioDrive, ErrorsAndLagAreNearThePapers) {
  MarioLog ideal = mario_run("");
  MarioLog slow = mario_run("--set delay=80ms --set servo_lag=115ms --set steer_first=85deg");
  expect_near_the_papers(ideal, 4.36, 1.39, 5.99);
  expect_near_the_papers(slow, 7.38, 3.34, 13.29);
  const auto lag = statistics::lag(ideal["servo1"], slow["servo1"], 0.01, 0.6);
  ASSERT_TRUE(lag) << lag.error().text();
  EXPECT_NEAR(lag->lag_s, 0.19, 0.01);
  EXPECT_GT(lag->correlation, 0.99);

  // The odometry sees joints alone. 25 m of way: 0.1 m is 0.4 % of it.
  for (MarioLog* const log : {&ideal, &slow})
    for (const char* const axis : {"x", "y"})
      EXPECT_NEAR((*log)[std::string("mario/base/odometry.pose.pose.position.") + axis].back(),
                  (*log)[std::string("mario.pose.") + axis].back(), 0.1);
}

}  // namespace
}  // namespace sandlot::test
