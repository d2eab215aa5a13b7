/// Levels that a user switches while the robot drives.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <vector>

#include "command.h"

namespace sandlot::test {
namespace {

/// The numbers of a CSV file, line by line, without the line of names.
std::vector<std::vector<double>> numbers(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

struct LevelsEngine {
  const char* name;
  const char* third;  ///< the level at 4 s
};
void PrintTo(const LevelsEngine& engine, std::ostream* out) { *out << engine.name; }
class LevelsOnTheWay : public testing::TestWithParam<LevelsEngine> {};
INSTANTIATE_TEST_SUITE_P(Engines, LevelsOnTheWay,
                         testing::Values(LevelsEngine{"rigid", "rollers"}, LevelsEngine{"planar", "ideal"}));

/// The robot goes round at 0.3 m/s and 0.5 rad/s, 3 mm and 5 mrad per tick, and nobody tells it so again.
/// Place and odometry go on by that in the tick of a switch as in all others. On rollers both swing by some
/// per cent as rollers pass (docs/validation.md): 0.3 mm and 0.8 mrad are twice what is seen, and a lost tick
/// would be ten times as much.
TEST_P(LevelsOnTheWay, KeepPlaceVelocityAndOdometry) {
  const TestFolder scratch;
  const auto [engine, third] = GetParam();
  const std::string run =
      std::string("tests/scenarios/levels.yaml --set physics=") + engine +
      " --command 'at 2s level robot/drive contact' --command 'at 4s level robot/drive " + third +
      "' --command 'at 6s level robot/drive contact' --command 'at 7s level robot/drive ideal'";
  const Printed printed = sandlot("run " + run + " --log " + scratch.file("log.csv") +
                                  " --log-values 'robot.pose.x,robot.pose.y,robot.pose.yaw,"
                                  "robot/drive.odometry.x,robot/drive.odometry.y,robot/drive.odometry.theta,"
                                  "hypot(robot.twist.linear.x,robot.twist.linear.y),robot.twist.angular.z'");
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  const auto rows = numbers(scratch.file("log.csv"));
  ASSERT_EQ(rows.size(), 801u);
  for (std::size_t i = 151; i < rows.size(); ++i) {
    const auto &was = rows[i - 1], &is = rows[i];
    for (const std::size_t at : {1u, 4u}) {
      SCOPED_TRACE((at == 1 ? "place at " : "odometry at ") + std::to_string(is[0]));
      EXPECT_NEAR(std::hypot(is[at] - was[at], is[at + 1] - was[at + 1]), 3e-3, 3e-4);
      EXPECT_NEAR(std::remainder(is[at + 2] - was[at + 2], 6.283185307179586), 5e-3, 8e-4);
    }
    EXPECT_NEAR(is[7], 0.3, 0.03) << is[0];
    EXPECT_NEAR(is[8], 0.5, 0.08) << is[0];
  }
}

TEST_P(LevelsOnTheWay, EndInTheSameStateFor12And4Threads) {
  const auto [engine, third] = GetParam();
  std::string hash;
  for (const char* threads : {"1", "2", "4"}) {
    const auto summary = summary_of(std::string("tests/scenarios/levels.yaml --duration 5s --set physics=") +
                                    engine +
                                    " --command 'at 2s level robot/drive contact' --command 'at 4s "
                                    "level robot/drive " +
                                    third + "' --threads " + threads);
    ASSERT_FALSE(summary.contains("failed")) << summary["failed"];
    if (hash.empty()) hash = summary["state_hash"];
    EXPECT_EQ(summary["state_hash"], hash) << threads << " threads";
  }
}

TEST(MslField, OneSettingSwitchesEverySenseOfEveryRobot) {
  struct Level {
    const char *set, *eyes, *laser;
  };
  for (const Level& level : {Level{"image", "image", "ranges"}, Level{"objects", "objects", "segments"},
                             Level{"world", "world", "pose"}}) {
    const Printed printed = sandlot(std::string("check scenarios/msl_field.yaml --set level=") + level.set);
    EXPECT_EQ(printed.exit_code, 0);
    for (const std::string& part :
         {std::string(" camera ") + level.eyes, std::string(" omni_camera ") + level.eyes,
          std::string(" laser_scanner ") + level.laser})
      EXPECT_NE(printed.out.find(part + " (12)"), std::string::npos) << part << "\n" << printed.out;
  }
  const Printed wrong = sandlot("check scenarios/msl_field.yaml --set level=imge");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.out.find("did you mean 'image'?"), std::string::npos) << wrong.out;
}

}  // namespace
}  // namespace sandlot::test
