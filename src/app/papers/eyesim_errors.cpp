/// Section 5 of the paper, driving and radio: what error models do to programs, beside their formulas.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "app/papers/eyesim.h"
#include "base/math.h"
#include "draw/interval_plot.h"

namespace sandlot::app::eyesim {

Status driving_errors(const Report& report) {
  constexpr double v_mps = 0.2, v_std = 0.02, omega_std = 10 * std::numbers::pi / 180, step_s = 0.05;
  constexpr int steps = 100, robots = 10;
  constexpr double begin_s = 0.5;
  const double n = steps;
  std::vector<std::string> values;
  for (int i = 1; i <= robots; ++i)
    for (const std::string& each : pose_values(i == 1 ? "Bare" : fmt::format("Bare_{}", i)))
      values.push_back(each);
  const ProgramRunSpec spec{
      .file = "eyesim_paper/driving.sim", .duration_s = begin_s + n * step_s + step_s, .values = values};
  SL_ASSIGN(const std::vector<ProgramRun> all, report.runs.repeated(spec, report.context.repeat));
  statistics::Sample driven, turned, aside;
  for (const ProgramRun& run : all)
    for (std::size_t robot = 0; robot < robots; ++robot) {
      const std::vector<Pose2> poses = poses_of(run, 3 * robot);
      const std::size_t first = index_of(run, begin_s);
      double way_m = 0;
      for (std::size_t i = first; i < first + steps; ++i)
        way_m += twist_through(std::span(poses).subspan(i, 2), 1).x_mps;
      const Pose2 end = relative(poses[first], poses[first + steps]);
      driven.add(way_m);
      turned.add(end.yaw_rad);
      aside.add(end.y_m);
    }
  constexpr double degrees = 180 / std::numbers::pi;
  const std::vector<Check> checks{
      mean_check("way, mean", "mm", 1000 * v_mps * n * step_s, driven, 1000),
      deviation_check("way, deviation: sigma_v T sqrt(n)", "mm", 1000 * v_std * step_s * std::sqrt(n), driven,
                      1000),
      mean_check("heading, mean", "deg", 0, turned, degrees),
      deviation_check("heading, deviation: sigma_w T sqrt(n)", "deg",
                      degrees * omega_std * step_s * std::sqrt(n), turned, degrees),
      mean_check("sideways, mean", "mm", 0, aside, 1000),
      deviation_check("sideways, deviation: v sigma_w T^2 sqrt(n^3/3 - n/12)", "mm",
                      1000 * v_mps * omega_std * step_s * step_s * std::sqrt(n * n * n / 3 - n / 12), aside,
                      1000)};
  report.page.heading("Section 5: errors of the driving interface");
  report.page.paragraph(fmt::format(
      "`error v 20` and `error omega 10`: in each step of T = 50 ms normal numbers with deviations of "
      "sigma_v "
      "= 20 mm/s and sigma_w = 10 deg/s are added to the speeds that "
      "a program has ordered, here 200 mm/s straight ahead. Where {} robots are after n = {} steps, over {} "
      "runs:",
      robots, steps, report.context.repeat));
  check_table(report.page, checks);
  ProgramRunSpec drawn = spec;
  drawn.draws = true;
  SL_ASSIGN(const ProgramRun run, report.runs.run(drawn));
  report.page.figure(run.drawing,
                     "The ways of ten robots that drive straight ahead, by their programs: the first seed.");
  report.page.table(
      {"the paper", "here"},
      {{"f(i) = s(i) + n(i) for the v-omega interface, n white, normal, of zero mean; no values are given.",
        "The same, once in each step of the world. Errors add up along the way, since what a robot orders in "
        "a step it drives in it. The manoeuvres of VWStraight and the like correct what the wheels measure, "
        "and "
        "take no errors of speeds."}});
  return report.context.write("driving.csv", csv_of(checks));
}

Status radio_errors(const Report& report) {
  struct Channel {
    double bits, packets;
  };
  constexpr std::array<Channel, 6> channels{{{0, 0}, {0.001, 0}, {0.01, 0}, {0, 0.1}, {0, 0.3}, {0.01, 0.1}}};
  constexpr double bits_of_message = 32 * 8;
  report.page.heading("Section 5.1: errors of wireless communication");
  report.page.paragraph(fmt::format(
      "`error radio P_b P_p`: robot 1 sends 2000 messages of 32 bytes, all of whose bits robot 2 knows. {} "
      "runs for each pair of probabilities. Rates with Wilson's intervals; a message arrives unharmed with "
      "the probability (1 - P_p) (1 - P_b)^256.",
      report.context.repeat));
  std::vector<Check> checks;
  std::vector<draw::IntervalRow> plot;
  for (const Channel& channel : channels) {
    const ProgramRunSpec spec{.file = "eyesim_paper/radio.sim",
                              .duration_s = 8,
                              .stop_when = "Bare_2/controller.ended > 0",
                              .settings = {{"media.bit_error_rate", fmt::format("{}", channel.bits)},
                                           {"media.drop", fmt::format("{}", channel.packets)}}};
    SL_ASSIGN(const std::vector<ProgramRun> all, report.runs.repeated(spec, report.context.repeat));
    std::uint64_t sent = 0, received = 0, wrong = 0, unharmed = 0;
    for (const ProgramRun& run : all) {
      const auto lines = run.numbers("Bare_2", "radio");
      if (lines.size() != 1 || lines[0].size() != 4) return missing_line("radio.sim", "radio");
      sent += static_cast<std::uint64_t>(lines[0][0]);
      received += static_cast<std::uint64_t>(lines[0][1]);
      wrong += static_cast<std::uint64_t>(lines[0][2]);
      unharmed += static_cast<std::uint64_t>(lines[0][3]);
    }
    const std::string name = fmt::format("P_b {:g}, P_p {:g}: ", channel.bits, channel.packets);
    checks.push_back(rate_check(name + "wrong bits", channel.bits, wrong,
                                received * static_cast<std::uint64_t>(bits_of_message)));
    checks.push_back(rate_check(name + "lost messages", channel.packets, sent - received, sent));
    checks.push_back(rate_check(name + "unharmed messages",
                                (1 - channel.packets) * math::pow(1 - channel.bits, bits_of_message),
                                unharmed, sent));
    const Check& last = checks.back();
    plot.push_back({name + "formula", last.predicted, {}, {}, 6});
    plot.push_back({"measured", last.measured, last.low, last.high, 0});
  }
  check_table(report.page, checks);
  report.page.figure(
      draw::draw_intervals(plot, {.title = "Messages of 256 bits that arrive unharmed",
                                  .x_label = "%",
                                  .range = {{0, 100}},
                                  .mark = {}}),
      "The channel of Figure 6 at work. Black: (1 - P_p) (1 - P_b)^256; blue: measured, with Wilson's 99.9 % "
      "intervals.");
  report.page.table(
      {"the paper", "here"},
      {{"A binary symmetric channel with a bit error rate P_b; a whole package is dropped with the "
        "probability "
        "P_p.",
        "The same. Sender and length of a message are never wrong; a program receives its bytes as they "
        "came."},
       {"This allows the evaluation of the error stability of a protocol.",
        fmt::format("Of messages of 32 bytes without a protocol {:.1f} % arrive unharmed at P_b = 0.01.",
                    checks[8].measured)}});
  return report.context.write("radio.csv", csv_of(checks));
}

}  // namespace sandlot::app::eyesim
