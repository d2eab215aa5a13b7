#pragma once
/// Parts of the report on the paper "Mobile Robot Simulation with Realistic Error Models", and the arithmetic that they share.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "app/papers/papers.h"
#include "app/papers/program_runs.h"
#include "statistics/sample.h"

namespace sandlot::app::eyesim {

struct Report {
  const ReproduceContext& context;
  const ProgramRuns& runs;
  ReportPage& page;
};

/// Section 2: matrices of the drives, ways.
Status drives(const Report& report);
/// Section 5: error models of sensors, driving and radio; figure 5.
Status sensor_errors(const Report& report);
Status driving_errors(const Report& report);
Status radio_errors(const Report& report);
/// Section 6: costs of calls, time slots, fairness, nothing from the future.
Status time_model(const Report& report);
/// Section 7: order of tasks.
Status tasks(const Report& report);
/// Wall time: it differs from run to run.
Status speed(const Report& report);

/// Constant velocity in the frame of the moving robot.
struct Twist {
  double x_mps = 0, y_mps = 0, turn_radps = 0;
};
struct Pose2 {
  double x_m = 0, y_m = 0, yaw_rad = 0;
};
/// `b` in the frame of `a`; its yaw is in (-pi, pi].
Pose2 relative(const Pose2& a, const Pose2& b);
/// The constant twist that leads through poses, by the first and the last one; between neighbours it turns by less than half a turn.
/// @pre at least two poses
Twist twist_through(std::span<const Pose2> poses, double duration_s);

/// Matrices of section 2, wheel speeds in ticks/s, `c` metres a tick, `d` metres.
Twist paper_differential(double c, double d, double left, double right);
/// Front left, front right, back left, back right. The third row as it is printed.
Twist paper_mecanum(double c, double d, const std::array<double, 4>& wheels);
/// The same with the signs that four rolling wheels have in the third row.
Twist rolling_mecanum(double c, double d, const std::array<double, 4>& wheels);

/// A prediction beside a measured value with its interval.
struct Check {
  std::string what, unit;
  double predicted = 0, measured = 0, low = 0, high = 0;
  std::uint64_t count = 0;
  int digits = 4;
  bool holds() const { return low <= predicted && predicted <= high; }
};
/// Confidence of all intervals of the report: of forty rows one in twenty-five pages has one that misses by chance.
inline constexpr double confidence = 0.999;

Check mean_check(std::string what, std::string unit, double predicted, const statistics::Sample& sample,
                 double scale = 1);
Check deviation_check(std::string what, std::string unit, double predicted, const statistics::Sample& sample,
                      double scale = 1);
Check rate_check(std::string what, double predicted, std::uint64_t successes, std::uint64_t trials);
void check_table(ReportPage& page, const std::vector<Check>& checks);
std::string csv_of(const std::vector<Check>& checks);

/// Poses of a run whose values are x, y, yaw of a robot, from `first` on.
std::vector<Pose2> poses_of(const ProgramRun& run, std::size_t first = 0);
/// Index of the time in a run that is nearest.
std::size_t index_of(const ProgramRun& run, double time_s);
std::vector<std::string> pose_values(const std::string& robot);
/// Error of a program that did not print what it should have.
Error missing_line(const std::string& file, const std::string& first);

}  // namespace sandlot::app::eyesim
