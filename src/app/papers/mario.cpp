/// mario: "Modelling and simulation of a non-holonomic omnidirectional mobile robot for offline programming and system performance
/// analysis". Its table, lag, figures and loop, by the scenarios mario_step, mario_drive and vineyard_loop.
#include "app/papers/mario.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sandlot::app {
namespace {

void add_summary(mario::Report& report) {
  std::vector<std::vector<std::string>> rows;
  for (const mario::Report::Row& row : report.rows)
    rows.push_back({row.part, row.what,
                    row.paper ? fmt::format("{:g} {}", *row.paper, row.unit) : "no number",
                    fmt::format("{:.3g} {}", row.ours, row.unit), row.verdict});
  report.page.heading("All numbers");
  report.page.table({"part", "quantity", "the paper", "ours", ""}, rows);
}

/// Data beside the page, with links.
void add_data_files(const mario::Report& report) {
  constexpr std::array<std::pair<const char*, const char*>, 7> contents{
      {{"step.csv", "angle of servo1 during the step of Figure 9"},
       {"table_1.csv", "Table 1, both columns"},
       {"drive_simulation.csv",
        "velocities, steering angles and places of the joystick's course, in each tick"},
       {"drive_with_latency.csv", "the same with latency"},
       {"loop.csv", "places, errors and covariances of the loop, ten times a second"},
       {"topics.json", "nodes and topics of Figure 16"},
       {"results.json", "the table above"}}};
  std::vector<std::vector<ReportPage::Cell>> rows;
  for (const auto& [name, content] : contents)
    for (const auto& file : report.files)
      if (file.first == name) rows.push_back({{name, name}, {content}});
  report.page.heading("Data");
  report.page.rich_table({"file", "content"}, rows);
  report.page.paragraph("Each figure is a file of its own, too (SVG).");
}

std::string results_json(const mario::Report& report) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const mario::Report::Row& row : report.rows) {
    nlohmann::ordered_json& entry = out.emplace_back();
    entry["part"] = row.part;
    entry["quantity"] = row.what;
    entry["unit"] = row.unit;
    entry["paper"] = row.paper ? nlohmann::ordered_json(*row.paper) : nlohmann::ordered_json();
    entry["ours"] = row.ours;
    entry["verdict"] = row.verdict;
  }
  return out.dump(1) + "\n";
}

}  // namespace

Status make_mario(const ReproduceContext& context, ReportPage& page) {
  mario::Report report{context, page, {}, {}};
  page.paragraph(
      "M. Sharifi, X. Chen, C. Pretty, D. Clucas, E. Cabon-Lunel describe MARIO, a robot with four driven "
      "and steered "
      "wheels, in Gazebo and ROS, and compare its simulation with the robot. The figures below are made by "
      "runs of "
      "Sandlot's scenarios mario_step, mario_drive and vineyard_loop; they are numbered as in the paper and "
      "have its "
      "numbers beside ours. All are the same in each run. Nobody drove a robot for this page: \"with "
      "latency\" is our "
      "model of the real one.");
  SL_TRY(mario::model_and_eyes(report));
  SL_TRY(mario::step_of_a_joint(report));
  SL_TRY(mario::drive(report));
  SL_TRY(mario::loop(report));
  add_summary(report);
  page.heading("Figures of the paper that are not shown");
  page.table(
      {"figure", "why not"},
      {{"1, 6, 8, 10, 11: general structure, a joint, low-level control, notation, overview",
        "Drawings that explain, without results. docs/four_wheel_steer.md has the equations (the sign of "
        "W_ix "
        "in the paper's equation 5 is a misprint); Figure 16 shows the same parts as 8 and 11, running."},
       {"3 and 4: photograph, CAD model, one wheel module",
        "The robot was not at hand; Figure 5 has the chain of all four modules, Figure 15 (b) the model."},
       {"12 to 14, the real robot's curves and its recording",
        "Not published; \"with latency\" stands for them."}});
  report.files.emplace_back("results.json", results_json(report));
  add_data_files(report);
  for (const auto& [name, text] : report.files) SL_TRY(context.write(name, text));
  return {};
}

namespace mario {

bool is_near(double ours, double paper) { return ours > paper / error_factor && ours < paper * error_factor; }

bool in_order(const VelocityErrors& errors) {
  return errors.v_y < errors.v_x && errors.v_x < errors.yaw_rate;
}

std::vector<std::pair<std::string, std::string>> latency_settings() {
  return {{"delay", "80ms"}, {"servo_lag", "115ms"}, {"steer_first", "85deg"}};
}

std::vector<std::string> drive_values() {
  std::vector<std::string> out{"v_x_command", "v_x", "v_y_command", "v_y", "yaw_rate_command", "yaw_rate"};
  for (int i = 0; i < 4; ++i) {
    out.push_back(fmt::format("mario/base/state.wheels[{}].steering_target", i));
    out.push_back(fmt::format("mario/base/state.wheels[{}].steering", i));
  }
  for (const char* const axis : {"x", "y"}) {
    out.push_back(fmt::format("mario.pose.{}", axis));
    out.push_back(fmt::format("mario/base/odometry.pose.pose.position.{}", axis));
  }
  return out;
}

Result<std::vector<double>> column_of(const draw::Table& run, const std::string& name) {
  for (std::size_t i = 0; i < run.names.size(); ++i) {
    if (run.names[i] != name) continue;
    std::vector<double> out = run.columns[i];
    for (double& each : out) {
      if (std::isfinite(each)) break;
      each = 0;
    }
    return out;
  }
  return Error{run.file + " has no column '" + name + "'"};
}

Result<VelocityErrors> velocity_errors(const draw::Table& run) {
  const auto error = [&](const std::string& axis) -> Result<double> {
    SL_ASSIGN(const std::vector<double> command, column_of(run, axis + "_command"));
    SL_ASSIGN(const std::vector<double> measured, column_of(run, axis));
    return statistics::percent_error(command, measured);
  };
  VelocityErrors out;
  SL_ASSIGN(out.v_x, error("v_x"));
  SL_ASSIGN(out.v_y, error("v_y"));
  SL_ASSIGN(out.yaw_rate, error("yaw_rate"));
  return out;
}

Result<statistics::Lag> steering_lag(const draw::Table& simulated_run, const draw::Table& real_run) {
  const std::string servo1 = "mario/base/state.wheels[0].steering";
  SL_ASSIGN(const std::vector<double> leader, column_of(simulated_run, servo1));
  SL_ASSIGN(const std::vector<double> follower, column_of(real_run, servo1));
  return statistics::lag(leader, follower, drive_step_s, most_lag_s);
}

void Report::figure(const std::string& name, const std::string& svg, const std::string& caption) {
  files.emplace_back(name + ".svg", svg);
  page.figure(svg, caption);
}

draw::Table table_of(std::vector<std::string> names, std::vector<std::vector<double>> columns) {
  std::vector<std::string> units(names.size());
  return {"", std::move(names), std::move(units), std::move(columns)};
}

}  // namespace mario
}  // namespace sandlot::app
