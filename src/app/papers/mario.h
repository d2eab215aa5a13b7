#pragma once
/// Parts of the report on the paper "Modelling and simulation of a non-holonomic omnidirectional mobile robot ...", its numbers, and
/// the metrics that the report shares with the tests.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "app/papers/papers.h"
#include "draw/graph.h"
#include "model/model.h"
#include "statistics/signals.h"

namespace sandlot::app::mario {

// --- the paper's numbers ---

/// Errors of the velocities in Table 1 [%].
struct VelocityErrors {
  double v_x = 0, v_y = 0, yaw_rate = 0;
  std::array<double, 3> all() const { return {v_x, v_y, yaw_rate}; }
};
inline constexpr VelocityErrors paper_simulation{4.36, 1.39, 5.99}, paper_robot{7.38, 3.34, 13.29};
inline constexpr double paper_lag_s =
    0.19;                                   ///< of servo1: the real robot behind the simulated one (sec. 4.1)
inline constexpr double paper_gap_m = 0.3;  ///< of the filtered odometry at the end of the loop (sec. 4.2)

// --- what ours have to keep ---

inline constexpr double error_factor = 1.5, lag_bound_s = 0.01;

/// Within a factor of the paper's value.
bool is_near(double ours, double paper);
/// v_y below v_x below yaw rate, as in both columns of the table.
bool in_order(const VelocityErrors& errors);

// --- metrics of a run of scenarios/mario_drive.yaml ---

/// Interval of the samples, and the largest lag that is tried.
inline constexpr double drive_step_s = 0.01, most_lag_s = 0.6;
/// Settings of the scenario that stand for the real robot: serial line, speed controllers on board, a controller that does
/// not wait for its wheels.
std::vector<std::pair<std::string, std::string>> latency_settings();
/// Values to log for the functions below.
std::vector<std::string> drive_values();

/// A column; before its first message a signal is 0: the robot stands. Errors name what there is.
Result<std::vector<double>> column_of(const draw::Table& run, const std::string& name);
/// 100 mean|v - v_command| / mean|v_command| of each axis.
Result<VelocityErrors> velocity_errors(const draw::Table& run);
/// Lag of servo1 in `real` behind `simulated`.
Result<statistics::Lag> steering_lag(const draw::Table& simulated, const draw::Table& real);

// --- the page ---

/// What a part of the report writes to. Files are kept until all parts are made: a run that fails leaves none.
struct Report {
  const ReproduceContext& context;
  ReportPage& page;
  std::vector<std::pair<std::string, std::string>> files;  ///< name, text
  /// Rows of results.json: what, unit, the paper's value if it prints one, ours.
  struct Row {
    std::string part, what, unit;
    std::optional<double> paper;
    double ours = 0;
    std::string verdict;
  };
  std::vector<Row> rows;

  /// A figure of the page, and the file of it.
  void figure(const std::string& name, const std::string& svg, const std::string& caption);
};

/// Colours of what returns in several figures.
inline constexpr const char *commanded = "black", *simulated = "blue", *real = "vermilion";

/// A joint and its links, from the model that was read.
struct ChainLink {
  std::string joint, type, parent, child;
  Pose X_PC;  ///< of the child link in its parent, all joints at 0
  bool moves = false;
};
/// Joints in the file's order; those to the world are left out.
std::vector<ChainLink> chain_of(const model::Model& model);
draw::Graph drawing_of(const std::vector<ChainLink>& chain);

/// Figs. 2, 5 and 7: the model, the world's parameters, pictures of the pair of eyes.
Status model_and_eyes(Report& report);
/// Fig. 9: the step of a steering joint.
Status step_of_a_joint(Report& report);
/// Table 1, Figs. 12 to 14: the joystick's course.
Status drive(Report& report);
/// Figs. 15 and 16: the loop through the vineyard, the graph of its topics.
Status loop(Report& report);

/// A plot of columns of tables over `x`, with an axis text.
draw::Table table_of(std::vector<std::string> names, std::vector<std::vector<double>> columns);

}  // namespace sandlot::app::mario
