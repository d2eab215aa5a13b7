/// msl: "A simulation environment for middle-size robots with multi-level abstraction". Models, cameras and the ramp of a speed
/// (Figs. 1 to 3); section 5.1: how erratic the speed of a simulation is (Fig. 4), how far interval timers miss that are set by an
/// estimate of the speed; and the speed of each level (Fig. 5).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>

#include "app/papers/msl_levels.h"
#include "app/papers/msl_models.h"
#include "app/papers/papers.h"
#include "app/papers/step_timers.h"
#include "draw/plot.h"
#include "files/text.h"

namespace sandlot::app {
namespace {

constexpr std::array<double, 8> intervals_s{0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5};
constexpr std::array<std::size_t, 4> windows{5, 10, 20, 50};
constexpr std::size_t shown_steps = 500, least_steps = 200;
constexpr double message_s = 0.02;

struct Trace {
  std::string name;
  Stretch stretch;
};

/// A run whose step times are recorded.
struct Recorded {
  Condition condition;
  double duration_s;
  std::optional<double> rate;
};

std::vector<Recorded> recorded_runs() {
  const auto run = [](const char* name, const char* scenario, double duration_s,
                      std::optional<double> rate = {}) {
    return Recorded{{name, scenario, {{"time.step", "1 ms"}}}, duration_s, rate};
  };
  std::vector<Recorded> out{run("pile", "pile", 4), run("pile_real_time", "pile", 4, 1.0),
                            run("field_images", "msl_field", 2.5), run("field_objects", "msl_field", 2.5)};
  out.back().condition.settings.emplace_back("level", "objects");
  return out;
}

Result<std::vector<Trace>> take_traces(const ReproduceContext& context) {
  std::vector<Trace> out;
  const auto add = [&](const std::string& name, const std::vector<StepTime>& steps) -> Status {
    Stretch stretch = longest_stretch(steps);
    double sim_s = 0;
    for (const double step_s : stretch.step_s) sim_s += step_s;
    if (stretch.size() < least_steps || sim_s < 3 * intervals_s.back())
      return Error{fmt::format("'{}' has no {} steps and {} s without a pause", name, least_steps,
                               3 * intervals_s.back()),
                   "record a longer run"};
    out.push_back({name, std::move(stretch)});
    return {};
  };
  for (const std::string& file : context.traces) {
    SL_ASSIGN(const std::string text, read_text_file(file, std::uint64_t{1} << 28));
    SL_ASSIGN(const std::vector<StepTime> steps, read_step_times(text, file));
    SL_TRY(add(std::filesystem::path(file).stem().string(), steps));
  }
  if (!context.traces.empty()) return out;
  for (const Recorded& each : recorded_runs()) {
    SL_ASSIGN(const std::vector<StepTime> steps,
              context.step_times(each.condition, each.duration_s, each.rate));
    SL_TRY(add(each.condition.name, steps));
  }
  return out;
}

/// Fig. 4: the raw speed and its smoothings over the first steps.
Result<std::string> figure_4(const Trace& trace) {
  draw::Table table;
  draw::PlotOptions options{.x = "step",
                            .title = trace.name + ": speed of the simulation",
                            .x_label = "step",
                            .y_label = "simulated time / wall time",
                            .labels = {"instantaneous"},
                            .colours = {"red"}};
  const std::size_t count = std::min(shown_steps, trace.stretch.size());
  table.names = {"step", "instantaneous"};
  table.units = {"", ""};
  table.columns.resize(2);
  for (std::size_t i = 0; i < count; ++i) {
    table.columns[0].push_back(static_cast<double>(i + 1));
    table.columns[1].push_back(trace.stretch.step_s[i] / trace.stretch.wall_s[i]);
  }
  constexpr std::array<const char*, windows.size()> colours{"sky", "orange", "green", "black"};
  for (std::size_t w = 0; w < windows.size(); ++w) {
    std::vector<double> smooth = smoothed_speeds(trace.stretch, windows[w]);
    smooth.resize(count);
    table.names.push_back(fmt::format("mean of {}", windows[w]));
    table.units.emplace_back();
    table.columns.push_back(std::move(smooth));
    options.labels.push_back(table.names.back());
    options.colours.emplace_back(colours[w]);
  }
  return draw::draw_plot({table}, options);
}

/// A row of the table of errors: how timers are set, and their mean errors by interval.
struct Row {
  const char* timers;  ///< "planned once", "adapting"
  std::string estimate;
  std::vector<double> errors;
};
constexpr std::size_t row_of_planned = 8, row_of_adapting = 17;  ///< of our clock

/// Planned once by the paper's mean, by the other one, by our clock; then adapting by the same; then with a message every 20 ms.
std::vector<Row> errors_of(const Stretch& stretch) {
  std::vector<Row> planned, adapting;
  const auto add = [&](const std::string& name, const std::vector<TimerErrors>& errors) {
    Row once{"planned once", name, {}}, adapts{"adapting", name, {}};
    for (const TimerErrors& each : errors) {
      once.errors.push_back(each.planned);
      adapts.errors.push_back(each.adapting);
    }
    planned.push_back(std::move(once));
    adapting.push_back(std::move(adapts));
  };
  for (const Mean mean : {Mean::speeds, Mean::times})
    for (const std::size_t window : windows)
      add(fmt::format("{} of {} steps", mean == Mean::speeds ? "mean of the speeds" : "mean of the times",
                      window),
          fixed_window_errors(stretch, window, mean, intervals_s));
  add("our clock", timer_errors(stretch, intervals_s));
  std::vector<Row> rows = std::move(planned);
  std::move(adapting.begin(), adapting.end(), std::back_inserter(rows));
  Row batched{"adapting", "our clock, a message every 20 ms", {}};
  for (const TimerErrors& each : timer_errors(stretch, intervals_s, message_s))
    batched.errors.push_back(each.adapting);
  rows.push_back(std::move(batched));
  return rows;
}

std::vector<std::string> head() {
  std::vector<std::string> names{"timers", "estimate"};
  for (const double interval : intervals_s) names.push_back(fmt::format("{:g} ms", 1000 * interval));
  return names;
}

std::vector<std::vector<std::string>> cells_of(const std::vector<Row>& rows) {
  std::vector<std::vector<std::string>> out;
  for (const Row& row : rows) {
    std::vector<std::string>& cells = out.emplace_back();
    cells = {row.timers, row.estimate};
    for (const double error : row.errors) cells.push_back(fmt::format("{:.2f} %", 100 * error));
  }
  return out;
}

std::vector<std::string> character(const Trace& trace) {
  const Stretch& s = trace.stretch;
  double sim_s = 0, wall_s = 0, off_s = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    sim_s += s.step_s[i];
    wall_s += s.wall_s[i];
  }
  const auto count = static_cast<double>(s.size());
  const double mean_s = wall_s / count;
  for (const double each : s.wall_s) off_s += std::abs(each - mean_s);
  std::vector<double> sorted = s.wall_s;
  std::sort(sorted.begin(), sorted.end());
  return {trace.name,
          fmt::format("{}", s.size()),
          fmt::format("{:.3g} ms", 1000 * sim_s / count),
          fmt::format("{:.3g} ms", 1000 * mean_s),
          fmt::format("{:.3g} ms", 1000 * sorted.back()),
          fmt::format("{:.0f} %", 100 * off_s / wall_s),
          fmt::format("{:.2f}", sim_s / wall_s)};
}

}  // namespace

Status make_msl(const ReproduceContext& context, ReportPage& page) {
  if (context.traces.empty()) SL_TRY(add_models(context, page));
  SL_ASSIGN(const std::vector<Trace> traces, take_traces(context));
  page.heading("Figure 4: the speed of the simulation and its smoothings");
  page.paragraph(context.traces.empty() ? "Step times of real runs of scenarios that come with Sandlot, made "
                                          "for this page. They are wall times: they differ from "
                                          "machine to machine and from run to run, and so does every number "
                                          "below. The files beside this page hold "
                                          "them; --traces makes the same page again."
                                        : "Step times of runs, from files of `sandlot run --step-times`.");
  std::vector<std::vector<std::string>> rows;
  for (const Trace& trace : traces) rows.push_back(character(trace));
  page.table({"trace", "steps", "step", "wall time of a step", "the longest",
              "mean deviation of the wall time", "speed"},
             rows);

  for (const Trace& trace : traces) {
    SL_ASSIGN(const std::string figure, figure_4(trace));
    SL_TRY(context.write("speed_" + trace.name + ".svg", figure));
    page.figure(
        figure,
        fmt::format(
            "{}: step over wall time of each step (red), and its means over the last 5, 10, 20 and 50 steps; "
            "the first {} steps.",
            trace.name, std::min(shown_steps, trace.stretch.size())));
  }

  page.heading("Section 5.1: interval timers");
  page.paragraph(
      "A timer is set for an interval of simulated time by an estimate of the speed. Error: how far the "
      "simulated time at which it fires misses the one it was set for, as a share of the interval; means "
      "over timers that begin at moments "
      "spread over all steps. "
      "Planned once: it fires when the first estimate says. Adapting: it plans again at each step. Our clock "
      "picks its "
      "window by the errors of recent predictions.");
  std::string csv = "trace,timers,estimate";
  for (const double interval : intervals_s) csv += fmt::format(",{:g} ms", 1000 * interval);
  csv += "\n";
  std::vector<Row> mean;
  for (const Trace& trace : traces) {
    const std::vector<Row> errors = errors_of(trace.stretch);
    if (mean.empty()) mean = errors;
    else
      for (std::size_t r = 0; r < errors.size(); ++r)
        for (std::size_t i = 0; i < intervals_s.size(); ++i) mean[r].errors[i] += errors[r].errors[i];
    for (const Row& row : errors) {
      csv += fmt::format("\"{}\",{},\"{}\"", trace.name, row.timers, row.estimate);
      for (const double error : row.errors) csv += fmt::format(",{:.5f}", error);
      csv += "\n";
    }
  }
  for (Row& row : mean)
    for (double& error : row.errors) error /= static_cast<double>(traces.size());
  SL_TRY(context.write("timers.csv", csv));
  auto all = cells_of(mean);
  std::vector<std::string>& paper = all.emplace_back();
  paper = {"the paper", "mean of speeds, window not given"};
  for (const double interval : intervals_s) paper.emplace_back(interval < 0.12 ? "< 2 %" : "< 4 %");
  page.paragraph("Means over all traces:");
  page.table(head(), all);
  for (const Trace& trace : traces) {
    page.paragraph(trace.name + ":");
    page.table(head(), cells_of(errors_of(trace.stretch)));
  }
  const Row &ours = mean[row_of_adapting], &planned = mean[row_of_planned];
  const auto most = [](const Row& row, std::size_t first, std::size_t last) {
    return 100 * *std::max_element(row.errors.begin() + static_cast<std::ptrdiff_t>(first),
                                   row.errors.begin() + static_cast<std::ptrdiff_t>(last));
  };
  const auto both = [&](std::size_t first, std::size_t last) {
    return fmt::format("Our clock, adapting: at most {:.2f} %. Planned once: at most {:.1f} %.",
                       most(ours, first, last), most(planned, first, last));
  };
  page.table(
      {"the paper", "here"},
      {{"Intervals of 10 ms to 100 ms: the average prediction error is less than two percent.", both(0, 4)},
       {"Intervals of 150 ms to 500 ms: less than four percent.", both(4, 8)},
       {"The accuracy of the prediction decreases with the length of the interval.",
        fmt::format("Planned once by our clock: {:.1f} % at 10 ms, {:.1f} % at 500 ms. A timer that "
                    "plans again at each step "
                    "misses by less than a step, whatever its length.",
                    100 * planned.errors.front(), 100 * planned.errors.back())}});
  if (context.traces.empty()) {
    page.heading("Figure 5: levels of abstraction, and the speed of one match at each");
    page.paragraph(
        "Figure 5 (a) shows a camera whose higher level gives found objects instead of pictures and takes "
        "commands such as \"search\" and \"look at\": here the levels image, objects and world of a camera, "
        "and of "
        "a pan-tilt head the levels joints and view. (b) a laser whose higher level gives the pose that "
        "localisation "
        "would find: here ranges, segments and pose. Each device has a level of its own and can change it "
        "during a "
        "run (docs/sensor_levels.md).");
    if (context.quick)
      page.paragraph("--quick leaves out twelve games, whose speeds tell what each level costs.");
    else SL_TRY(add_level_table(context, page));
  }
  page.heading("Said in the paper, not shown here");
  page.table(
      {"the paper", "why not"},
      {{"One connection of each module to the server slowed it down noticeably; one for all did not (section "
        "5).",
        "No numbers there; ours are of another protocol: docs/clients.md."},
       {"The system runs on several machines, server and clients.",
        "One machine was at hand; programs run as processes of their own (docs/clients.md)."},
       {"Localisation and collision avoidance on the simulated scanner showed a good approximation of "
        "reality "
        "(section 4).",
        "It takes their robot and their software."}});
  return {};
}

}  // namespace sandlot::app
