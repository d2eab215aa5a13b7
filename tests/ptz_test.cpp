/// models/ptz_camera on a robot, as a user drives it: turned and zoomed by hand, and watching a ball by
/// itself.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <vector>

#include "command.h"

namespace sandlot::test {
namespace {

struct Row {
  double time, focal, zoom, target, status, pan, bearing, range;  ///< NaN: there is none
};

std::vector<Row> run_ptz(const std::string& arguments) {
  const TestFolder scratch;
  const Printed printed = sandlot(
      "run tests/scenarios/ptz.yaml " + arguments + " --log " + scratch.file("log.csv") +
      " --log-values 'guard/head_eye/camera_info.k[0],guard/head_unit/status.zoom,"
      "guard/head_unit/status.zoom_target,guard/head_unit/status.status,guard/head_unit/status.pan,"
      "guard/head_eye/objects.objects[0].bearing,guard/head_eye/objects.objects[0].range'");
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
  std::ifstream in(scratch.file("log.csv"));
  std::string line;
  std::getline(in, line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    double cells[8];
    std::istringstream text(line);
    for (double& cell : cells) {
      std::string word;
      std::getline(text, word, ',');
      cell = word.empty() ? std::nan("") : std::stod(word);
    }
    rows.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7]});
  }
  return rows;
}

const Row& at(const std::vector<Row>& rows, double time_s) {
  return rows.at(static_cast<std::size_t>(std::lround(time_s / 0.01)));
}

/// 32 pixels over 1.134464 rad.
const double shortest = 16 / std::tan(0.567232);
/// From the lens, 0.152 m before the robot's middle, to the ball at (3, 1).
const double bearing = std::atan2(1, 2.848);

TEST(PtzCamera, TurnsAndZoomsByHandAndTheZoomNarrowsItsView) {
  const auto rows = run_ptz(
      "--command 'at 1s command guard/head_unit Float64 {\"data\": 4}' "
      "--command 'at 4s command guard/head_unit JointState {\"name\": [\"pan_joint\"], \"position\": "
      "[0.338]}' "
      "--command 'at 5s command guard/head_unit Float64 {\"data\": 100}'");
  ASSERT_EQ(rows.size(), 801u);
  EXPECT_NEAR(at(rows, 1).focal, shortest, 1e-4);
  EXPECT_NEAR(at(rows, 1).bearing, bearing, 1e-3);
  // Doubled in a second; the camera looks 25 times a second, so it is at most 0.05 s late or early.
  EXPECT_NEAR(std::log2(at(rows, 2).zoom), 1, 0.051);
  EXPECT_NEAR(at(rows, 2).focal, shortest * at(rows, 2).zoom, 1e-4);
  EXPECT_EQ(at(rows, 2).status, 1) << "moving";
  for (std::size_t i = 1; i < rows.size(); ++i)
    EXPECT_LE(std::log2(rows[i].zoom / rows[i - 1].zoom), 0.04 + 1e-9) << rows[i].time;
  // Half of the field of view is atan(tan(32.5 deg) / 4) = 9 deg: the ball, 19 deg to the left, is out of it.
  EXPECT_EQ(at(rows, 3.5).zoom, 4);
  EXPECT_NEAR(at(rows, 3.5).focal, 4 * shortest, 1e-4);
  EXPECT_TRUE(std::isnan(at(rows, 3.5).bearing));
  EXPECT_NEAR(at(rows, 5).pan, 0.338, 1e-3);
  EXPECT_NEAR(at(rows, 5).bearing, 0, 0.02);
  EXPECT_EQ(at(rows, 5).status, 0) << "idle";
  EXPECT_EQ(at(rows, 7).zoom, 10) << "its limit";
  EXPECT_EQ(at(rows, 7).target, 10);
}

TEST(PtzCamera, TracksWithTheZoomThatKeepsTheSize) {
  const auto rows = run_ptz(
      "--set levels=[objects] --set unit_level=view --set zoom_per_m=1 "
      "--command 'at 500ms command guard/head_unit String {\"data\": \"track ball\"}'");
  ASSERT_EQ(rows.size(), 801u);
  EXPECT_EQ(at(rows, 0.4).zoom, 1);
  const Row& end = rows.back();
  EXPECT_EQ(end.status, 4) << "tracking";
  EXPECT_NEAR(end.bearing, 0, 1e-3);
  EXPECT_NEAR(end.zoom, end.range, 1e-3);
}

TEST(PtzCamera, LooksAtAPoint) {
  const auto rows = run_ptz(
      "--set levels=[objects] --set unit_level=view "
      "--command 'at 500ms command guard/head_unit PointStamped {\"header\": {\"frame_id\": \"world\"}, "
      "\"point\": {\"x\": 3, \"y\": 1, \"z\": 0.11}}'");
  ASSERT_EQ(rows.size(), 801u);
  EXPECT_EQ(rows.back().status, 2) << "arrived";
  EXPECT_NEAR(rows.back().bearing, 0, 1e-3);
}

}  // namespace
}  // namespace sandlot::test
