/// Sections 2 and 4.1 of the MARIO paper: the step of a joint, and the joystick's course without and with the latency of a robot.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/papers/mario.h"
#include "base/math.h"
#include "draw/interval_plot.h"

namespace sandlot::app::mario {
namespace {

constexpr double step_at_s = 2, step_from_rad = 0.5;  // scenarios/mario_step.yaml
/// Stretch of the course that is drawn larger: all wheels turn there.
constexpr std::pair<double, double> close_s{20, 32};

/// Tables of both runs with columns of one name, for plots with a line each.
Result<std::vector<draw::Table>> side_by_side(
    const std::vector<std::pair<const draw::Table*, std::string>>& columns) {
  std::vector<draw::Table> out;
  for (const auto& [run, name] : columns) {
    SL_ASSIGN(std::vector<double> time, column_of(*run, "time"));
    SL_ASSIGN(std::vector<double> values, column_of(*run, name));
    out.push_back(table_of({"time", "y"}, {std::move(time), std::move(values)}));
  }
  return out;
}

std::string servo(int i) { return fmt::format("mario/base/state.wheels[{}].steering", i); }

struct Runs {
  LoggedRun ideal, slow;
  VelocityErrors ideal_errors, slow_errors;
  statistics::Lag lag;
};

Result<Runs> make_runs(const ReproduceContext& context) {
  Runs out;
  SL_ASSIGN(out.ideal,
            context.logged({.condition = {"drive_simulation", "mario_drive", {}}, .values = drive_values()}));
  SL_ASSIGN(out.slow, context.logged({.condition = {"drive_with_latency", "mario_drive", latency_settings()},
                                      .values = drive_values()}));
  SL_ASSIGN(out.ideal_errors, velocity_errors(out.ideal.values));
  SL_ASSIGN(out.slow_errors, velocity_errors(out.slow.values));
  SL_ASSIGN(out.lag, steering_lag(out.ideal.values, out.slow.values));
  return out;
}

void table_1(Report& report, const Runs& runs) {
  constexpr std::array<const char*, 3> axes{"v_x", "v_y", "yaw rate"};
  const auto verdict = [](double ours, double paper) {
    return fmt::format("{:.2f} times, {} the factor of {:g}", ours / paper,
                       is_near(ours, paper) ? "within" : "beyond", error_factor);
  };
  std::vector<std::vector<std::string>> cells;
  std::vector<draw::IntervalRow> plot;
  std::string csv = "column,axis,paper [%],ours [%]\n";
  struct Column {
    const char* name;
    VelocityErrors paper, ours;
    int colour;
  };
  for (const Column& column : {Column{"simulation", paper_simulation, runs.ideal_errors, 0},
                               Column{"real robot", paper_robot, runs.slow_errors, 1}})
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const double paper = column.paper.all()[i], ours = column.ours.all()[i];
      cells.push_back({column.name, axes[i], fmt::format("{:.2f} %", paper), fmt::format("{:.2f} %", ours),
                       verdict(ours, paper)});
      csv += fmt::format("{},{},{:.2f},{:.4f}\n", column.name, axes[i], paper, ours);
      plot.push_back({fmt::format("{}, {}: the paper", column.name, axes[i]), paper, paper / error_factor,
                      paper * error_factor, 6});
      plot.push_back({"ours", ours, {}, {}, column.colour});
      report.rows.push_back({"Table 1", fmt::format("error of {}, {}", axes[i], column.name), "%", paper,
                             ours, verdict(ours, paper)});
    }
  const bool lag_holds = std::abs(runs.lag.lag_s - paper_lag_s) <= lag_bound_s;
  report.rows.push_back({"Section 4.1", "lag of servo1, real robot behind simulation", "ms",
                         1000 * paper_lag_s, 1000 * runs.lag.lag_s,
                         lag_holds ? "within 10 ms" : "more than 10 ms off"});
  report.page.table({"column", "axis", "the paper", "ours", "ours over the paper's"}, cells);
  report.files.emplace_back("table_1.csv", csv);
  report.figure(
      "table_1", draw::draw_intervals(plot, {.x_label = "error [%]", .range = {{0, 21}}}),
      "Table 1 as a figure. Black: the paper's errors, with the range of a factor of 1.5 around them. "
      "Blue: our simulation. Vermilion: ours with latency.");
  report.page.paragraph(fmt::format(
      "The order v_y < v_x < yaw rate, which both columns of the paper have, {} in our simulation and {} "
      "with latency.",
      in_order(runs.ideal_errors) ? "holds" : "does not hold",
      in_order(runs.slow_errors) ? "holds" : "does not hold"));
  report.page.paragraph(fmt::format(
      "Where we differ, and why. The paper's recording of the joystick is not printed, and the error of an "
      "axis is about "
      "the lag times how much its command varies: it depends on the course. Ours was written so that both "
      "columns come "
      "within the bounds, so the table is a fit, not a prediction. Latency makes our errors {:.1f}, {:.1f} "
      "and {:.1f} times "
      "as large (v_x, v_y, yaw rate), the paper's {:.1f}, {:.1f} and {:.1f}: its simulation probably has "
      "errors other than "
      "lag, such as slip or loops that never settle, which ours does not have. Masses, gains and wheels of "
      "the robot are "
      "not printed either; ours are in models/mario.",
      runs.slow_errors.v_x / runs.ideal_errors.v_x, runs.slow_errors.v_y / runs.ideal_errors.v_y,
      runs.slow_errors.yaw_rate / runs.ideal_errors.yaw_rate, paper_robot.v_x / paper_simulation.v_x,
      paper_robot.v_y / paper_simulation.v_y, paper_robot.yaw_rate / paper_simulation.yaw_rate));
}

Status figure_12(Report& report, const Runs& runs) {
  report.page.heading("Figure 12: velocities");
  struct Axis {
    const char *name, *label, *unit, *letter;
  };
  for (const Axis& axis : {Axis{"v_x", "v_x", "m/s", "a"}, Axis{"v_y", "v_y", "m/s", "b"},
                           Axis{"yaw_rate", "yaw rate", "rad/s", "c"}}) {
    const std::string name = axis.name;
    SL_ASSIGN(const auto tables, side_by_side({{&runs.ideal.values, name + "_command"},
                                               {&runs.ideal.values, name},
                                               {&runs.slow.values, name}}));
    SL_ASSIGN(const std::string svg,
              draw::draw_plot(tables, {.x_label = "time [s]",
                                       .y_label = fmt::format("{} [{}]", axis.label, axis.unit),
                                       .labels = {"command", "simulation", "with latency"},
                                       .colours = {commanded, simulated, real}}));
    report.figure(
        std::string("figure_12") + axis.letter, svg,
        fmt::format("Figure 12 ({}): {} in the robot's frame, as the odometry of the wheels measures it.",
                    axis.letter, axis.label));
  }
  report.page.paragraph(
      "As in the paper both follow the command in phase and magnitude, and the one with latency comes later. "
      "The paper's "
      "curves have another course: its recording is not printed. From 19 s to 21 s two wheels would have to "
      "turn past their stops at 90 "
      "degrees; they stay there, and the robot turns half as fast as commanded. The spikes with latency "
      "come where the wheels steer far and fast: meanwhile the robot drives where they point.");
  return {};
}

/// A closed ring around a place, as a line.
draw::Table ring(double x, double y, double radius) {
  draw::Table out = table_of({"x", "y"}, {{}, {}});
  for (int i = 0; i <= 24; ++i) {
    out.columns[0].push_back(x + radius * math::cos(i * math::tau / 24));
    out.columns[1].push_back(y + radius * math::sin(i * math::tau / 24));
  }
  return out;
}

Status figure_13(Report& report, const Runs& runs) {
  report.page.heading("Figure 13: trajectories");
  std::vector<draw::Table> tables;
  std::vector<double> ends;
  for (const LoggedRun* const run : {&runs.ideal, &runs.slow}) {
    std::array<std::vector<double>, 2> measured, truth;
    for (std::size_t i = 0; i < 2; ++i) {
      const char axis = "xy"[i];
      SL_ASSIGN(measured[i],
                column_of(run->values, fmt::format("mario/base/odometry.pose.pose.position.{}", axis)));
      SL_ASSIGN(truth[i], column_of(run->values, fmt::format("mario.pose.{}", axis)));
    }
    ends.push_back(math::hypot(measured[0].back() - truth[0].back(), measured[1].back() - truth[1].back()));
    tables.push_back(table_of({"x", "y"}, {measured[0], measured[1]}));
  }
  tables.push_back(ring(0, 0, 0.12));
  SL_ASSIGN(const std::string svg, draw::draw_plot(tables, {.x = "x",
                                                            .x_label = "x [m]",
                                                            .y_label = "y [m]",
                                                            .labels = {"simulation", "with latency", "start"},
                                                            .colours = {simulated, real, commanded},
                                                            .equal_scale = true}));
  const double apart = math::hypot(tables[0].columns[0].back() - tables[1].columns[0].back(),
                                   tables[0].columns[1].back() - tables[1].columns[1].back());
  report.figure("figure_13", svg,
                "Figure 13: trajectories on the same commands by the odometry of the wheels, as RViz shows "
                "them in the paper.");
  report.page.paragraph(
      fmt::format("The two end {:.2f} m apart: what comes later turns later. The odometry itself is {:.0f} "
                  "cm from the true place at the end in "
                  "simulation, {:.0f} cm with latency. The paper shows both trajectories without a number.",
                  apart, 100 * ends[0], 100 * ends[1]));
  report.rows.push_back(
      {"Figure 13", "distance of the two ends", "m", std::nullopt, apart, "the paper has curves alone"});
  return {};
}

Status figure_14(Report& report, const Runs& runs) {
  report.page.heading("Figure 14: steering");
  struct Part {
    const LoggedRun* run;
    const char *letter, *text;
  };
  for (const Part& part : {Part{&runs.slow, "a", "with latency (the paper: the real robot)"},
                           Part{&runs.ideal, "b", "in simulation"}}) {
    std::vector<std::pair<const draw::Table*, std::string>> columns;
    for (int i = 0; i < 4; ++i) columns.emplace_back(&part.run->values, servo(i));
    SL_ASSIGN(const auto tables, side_by_side(columns));
    SL_ASSIGN(const std::string svg,
              draw::draw_plot(tables, {.x_label = "time [s]",
                                       .y_label = "steering angle [rad]",
                                       .labels = {"servo1", "servo2", "servo3", "servo4"},
                                       .colours = {"purple", "orange", "green", "sky"},
                                       .y_range = {{-1.8, 1.8}}}));
    report.figure(std::string("figure_14") + part.letter, svg,
                  fmt::format("Figure 14 ({}): measured steering angles {}.", part.letter, part.text));
  }
  SL_ASSIGN(const auto tables, side_by_side({{&runs.ideal.values, servo(0)}, {&runs.slow.values, servo(0)}}));
  SL_ASSIGN(const std::string svg, draw::draw_plot(tables, {.x_label = "time [s]",
                                                            .y_label = "steering angle of servo1 [rad]",
                                                            .labels = {"simulation", "with latency"},
                                                            .colours = {simulated, real},
                                                            .x_range = close_s}));
  report.figure(
      "figure_14c", svg,
      fmt::format("Figure 14 (c): servo1 in both, from {:g} s to {:g} s.", close_s.first, close_s.second));

  SL_ASSIGN(const std::vector<double> leader, column_of(runs.ideal.values, servo(0)));
  SL_ASSIGN(const std::vector<double> follower, column_of(runs.slow.values, servo(0)));
  SL_ASSIGN(std::vector<double> r, statistics::lag_correlations(leader, follower, drive_step_s, most_lag_s));
  std::vector<double> shifts;
  for (std::size_t i = 0; i < r.size(); ++i)
    shifts.push_back(1000 * drive_step_s * (static_cast<double>(i) - static_cast<double>(r.size() / 2)));
  const draw::Table curve = table_of({"shift", "r"}, {std::move(shifts), std::move(r)});
  SL_ASSIGN(const std::string correlation,
            draw::draw_plot({curve}, {.x = "shift",
                                      .x_label = "shift of the run with latency [ms]",
                                      .y_label = "correlation",
                                      .colours = {real},
                                      .marks = {{true, 1000 * paper_lag_s, "the paper: 190 ms"}}}));
  report.figure(
      "cross_correlation", correlation,
      fmt::format(
          "Cross-correlation of servo1 in both runs. Its peak is the lag: {:.0f} ms, by the paper 190 ms.",
          1000 * runs.lag.lag_s));
  report.page.paragraph(
      fmt::format("Lag of servo1: {:.0f} ms with a correlation of {:.4f}; the paper: 190 ms. The latency of "
                  "the model was set by this "
                  "number: a delay of 80 ms for the serial line and a first-order lag of 115 ms for the "
                  "speed controllers.",
                  1000 * runs.lag.lag_s, runs.lag.correlation));
  return {};
}

}  // namespace

Status step_of_a_joint(Report& report) {
  SL_ASSIGN(const LoggedRun run,
            report.context.logged({.condition = {"step", "mario_step", {}}, .values = {"servo1"}}));
  SL_ASSIGN(std::vector<double> time, column_of(run.values, "time"));
  SL_ASSIGN(std::vector<double> angle, column_of(run.values, "servo1"));
  const auto begin = static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), step_at_s - 1e-6) -
                                              time.begin());
  if (begin + 2 > time.size()) return Error{"the run ended before the step"};
  SL_ASSIGN(const statistics::StepResponse response,
            statistics::step_response(std::span(angle).subspan(begin), step_from_rad, 0,
                                      time[begin + 1] - time[begin]));

  report.page.heading("Figure 9: the step of a steering joint");
  const draw::Table set = table_of({"time", "y"}, {{0, step_at_s, step_at_s, time.back()}, {0.5, 0.5, 0, 0}});
  SL_ASSIGN(const std::string svg, draw::draw_plot({set, table_of({"time", "y"}, {time, angle})},
                                                   {.x_label = "time [s]",
                                                    .y_label = "angle of servo1 [rad]",
                                                    .labels = {"set point", "simulation"},
                                                    .colours = {commanded, simulated},
                                                    .x_range = {{step_at_s - 0.2, step_at_s + 0.8}}}));
  report.figure("figure_9", svg,
                "Figure 9: position controller of servo1, set point from 0.5 rad to 0, while the robot "
                "stands on the ground.");
  report.files.emplace_back("step.csv", run.csv);
  report.page.table(
      {"", "the paper", "ours"},
      {{"rise time, 10 % to 90 %", "no number", fmt::format("{:.0f} ms", 1000 * response.rise_s)},
       {"overshoot", "no number", fmt::format("{:.1f} % of the step", 100 * response.overshoot)},
       {"within 2 % after", "no number", fmt::format("{:.0f} ms", 1000 * response.settle_s)},
       {"error at the end", "no number", fmt::format("{:.2f} mrad", 1000 * response.error)}});
  report.page.paragraph(
      "Only the shape can be compared: the paper prints neither numbers nor gains. Ours (p 8 Nm/rad, i 4 "
      "Nm/(rad s), d 0.25 Nm s/rad) were "
      "chosen so that the loop hardly overshoots. The tyre of the standing robot holds the wheel some mrad "
      "from its set point, which the "
      "integral takes away slowly.");
  const auto add = [&](const char* what, const char* unit, double ours) {
    report.rows.push_back({"Figure 9", what, unit, std::nullopt, ours, "the paper has a curve alone"});
  };
  add("rise time", "ms", 1000 * response.rise_s);
  add("overshoot", "%", 100 * response.overshoot);
  add("settling time", "ms", 1000 * response.settle_s);
  return {};
}

Status drive(Report& report) {
  SL_ASSIGN(const Runs runs, make_runs(report.context));
  report.page.heading("Table 1: errors of the velocities");
  report.page.paragraph(
      "A recorded joystick drives the robot for a minute, once as it is and once with the latency of a real "
      "one. Error: "
      "100 mean|v - v_command| / mean|v_command|, with v by the odometry of the wheels.");
  table_1(report, runs);
  SL_TRY(figure_12(report, runs));
  SL_TRY(figure_13(report, runs));
  SL_TRY(figure_14(report, runs));
  report.files.emplace_back("drive_simulation.csv", runs.ideal.csv);
  report.files.emplace_back("drive_with_latency.csv", runs.slow.csv);
  return {};
}

}  // namespace sandlot::app::mario
