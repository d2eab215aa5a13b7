/// eyesim: "Mobile Robot Simulation with Realistic Error Models". Its matrices, error models, time slots and tasks, measured by RoBIOS
/// programs in EyeSim's files.
#include "app/papers/eyesim.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/math.h"
#include "statistics/intervals.h"

namespace sandlot::app {

Status make_eyesim(const ReproduceContext& context, ReportPage& page) {
  const ProgramRuns runs(context.out, context.at_a_time);
  const eyesim::Report report{context, runs, page};
  page.paragraph(
      "Programs in C by RoBIOS's functions, in EyeSim's files (examples/eyesim_paper), measure what the "
      "paper "
      "states; true poses come "
      "from the simulator. The paper gives models and formulas, no measured numbers: each prediction below "
      "is "
      "its formula with our values in it. All numbers but those of the last section are the same in each "
      "run.");
  SL_TRY(eyesim::drives(report));
  SL_TRY(eyesim::sensor_errors(report));
  SL_TRY(eyesim::driving_errors(report));
  SL_TRY(eyesim::radio_errors(report));
  SL_TRY(eyesim::time_model(report));
  SL_TRY(eyesim::tasks(report));
  SL_TRY(eyesim::speed(report));
  page.heading("Figures of the paper that are not shown");
  page.table({"figure", "why not"},
             {{"1, the real robot", "None was at hand."},
              {"3: the user interface, and the screen with its buttons",
               "The page of a run (--port 8765) has them: docs/page.md, docs/panels.md."},
              {"4: beams, camera frustum and radio messages in the 3D view",
               "The drawing in section 4 above has beams; the page of a run has all of them."},
              {"6: the drawing of the channel", "Its probabilities are measured in section 5.1."}});
  return {};
}

namespace eyesim {

Pose2 relative(const Pose2& a, const Pose2& b) {
  const double c = math::cos(a.yaw_rad), s = math::sin(a.yaw_rad), x = b.x_m - a.x_m, y = b.y_m - a.y_m;
  return {c * x + s * y, c * y - s * x, math::wrap_angle(b.yaw_rad - a.yaw_rad)};
}

Twist twist_through(std::span<const Pose2> poses, double duration_s) {
  double turned = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) turned += relative(poses[i - 1], poses[i]).yaw_rad;
  const Pose2 way = relative(poses.front(), poses.back());
  // The chord of an arc in the frame of its beginning is the velocity times sin(h)/h, turned by h, half the angle.
  const double h = turned / 2, k = std::abs(h) < 1e-9 ? 1 : h / math::sin(h);
  const double c = math::cos(h) * k, s = math::sin(h) * k;
  return {(c * way.x_m + s * way.y_m) / duration_s, (c * way.y_m - s * way.x_m) / duration_s,
          turned / duration_s};
}

Twist paper_differential(double c, double d, double left, double right) {
  return {c / 2 * (left + right), 0, c / d * (right - left)};
}

Twist paper_mecanum(double c, double d, const std::array<double, 4>& w) {
  return {c / 4 * (w[0] + w[1] + w[2] + w[3]), c / 4 * (-w[0] + w[1] + w[2] - w[3]),
          c / (4 * d) * (-w[0] + w[1] + w[2] - w[3])};
}

Twist rolling_mecanum(double c, double d, const std::array<double, 4>& w) {
  return {c / 4 * (w[0] + w[1] + w[2] + w[3]), c / 4 * (-w[0] + w[1] + w[2] - w[3]),
          c / (4 * d) * (-w[0] + w[1] - w[2] + w[3])};
}

Check mean_check(std::string what, std::string unit, double predicted, const statistics::Sample& sample,
                 double scale) {
  const statistics::Interval i = statistics::mean_interval(sample, confidence);
  return {std::move(what), std::move(unit), predicted,      scale * sample.mean(),
          scale * i.low,   scale * i.high,  sample.count(), predicted == 0 ? 3 : 5};
}

Check deviation_check(std::string what, std::string unit, double predicted, const statistics::Sample& sample,
                      double scale) {
  const statistics::Interval i = statistics::deviation_interval(sample, confidence);
  return {std::move(what), std::move(unit), predicted,     scale * sample.deviation(),
          scale * i.low,   scale * i.high,  sample.count()};
}

Check rate_check(std::string what, double predicted, std::uint64_t successes, std::uint64_t trials) {
  const statistics::Interval i = statistics::wilson_interval(successes, trials, confidence);
  const double rate = trials == 0 ? 0 : static_cast<double>(successes) / static_cast<double>(trials);
  return {std::move(what), "%", 100 * predicted, 100 * rate, 100 * i.low, 100 * i.high, trials};
}

void check_table(ReportPage& page, const std::vector<Check>& checks) {
  std::vector<std::vector<std::string>> rows;
  for (const Check& each : checks) {
    const auto number = [&](double x) { return fmt::format("{:#.{}g}", x, each.digits); };
    rows.push_back({each.what, number(each.predicted) + " " + each.unit,
                    number(each.measured) + " " + each.unit,
                    fmt::format("{} to {}", number(each.low), number(each.high)),
                    fmt::format("{}", each.count), each.holds() ? "inside" : "outside"});
  }
  page.table({"quantity", "by the formula", "measured", "99.9 % interval", "samples", "the formula is"},
             rows);
}

std::string csv_of(const std::vector<Check>& checks) {
  std::string csv = "quantity,unit,predicted,measured,low,high,samples\n";
  for (const Check& each : checks)
    csv += fmt::format("\"{}\",{},{:.7g},{:.7g},{:.7g},{:.7g},{}\n", each.what, each.unit, each.predicted,
                       each.measured, each.low, each.high, each.count);
  return csv;
}

std::vector<Pose2> poses_of(const ProgramRun& run, std::size_t first) {
  std::vector<Pose2> out;
  for (std::size_t i = 0; i < run.times_s.size(); ++i)
    out.push_back({run.values[first][i], run.values[first + 1][i], run.values[first + 2][i]});
  return out;
}

std::size_t index_of(const ProgramRun& run, double time_s) {
  const auto after = std::lower_bound(run.times_s.begin(), run.times_s.end(), time_s - 1e-6);
  return static_cast<std::size_t>(std::min(after, run.times_s.end() - 1) - run.times_s.begin());
}

std::vector<std::string> pose_values(const std::string& robot) {
  return {robot + ".pose.x", robot + ".pose.y", robot + ".pose.yaw"};
}

Error missing_line(const std::string& file, const std::string& first) {
  return Error{file + ": the program has not printed '" + first + "'", "run it by itself: sandlot run"};
}

}  // namespace eyesim
}  // namespace sandlot::app
