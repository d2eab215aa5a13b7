/// Sections 6 to 8 of the paper: virtual time, time slots, fairness, nothing from the future, tasks; and how fast it runs here.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/papers/eyesim.h"
#include "base/math.h"
#include "draw/plot.h"
#include "messages/messages.h"
#include "sim/world/simulation.h"

namespace sandlot::app::eyesim {
namespace {

constexpr double slot_ms = 50;

Status costs(const Report& report) {
  SL_ASSIGN(const ProgramRun run, report.runs.run({.file = "eyesim_paper/costs.sim",
                                                   .duration_s = 30,
                                                   .stop_when = "S4/controller.ended > 0"}));
  const auto words = run.lines("S4", "cost");
  const auto numbers = run.numbers("S4", "cost");
  const auto native = run.numbers("S4", "native");
  if (words.empty() || native.size() != 1) return missing_line("costs.sim", "cost");
  report.page.paragraph(
      "A program calls each function a hundred times and reads its own clock before and after "
      "(SIMGetVirtualTime, whole ms):");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].size() != 3) return missing_line("costs.sim", "cost");
    rows.push_back({words[i][0], fmt::format("{:g} us", numbers[i][1]), fmt::format("{:g} us", numbers[i][2]),
                    std::abs(numbers[i][1] - numbers[i][2]) <= 10
                        ? ""
                        : "waits for a picture that is taken after the call: the next time slot"});
  }
  rows.push_back({"50 million multiplications", "0 us", fmt::format("{:g} us", 1000 * native[0][0]), ""});
  report.page.table({"call", "cost by our table", "by the program's clock", ""}, rows);
  return {};
}

Status slots(const Report& report, std::vector<std::vector<std::string>>& statements) {
  SL_ASSIGN(const ProgramRun run, report.runs.run({.file = "eyesim_paper/slots.sim",
                                                   .duration_s = 20,
                                                   .stop_when = "Bare/controller.ended > 0"}));
  const auto lines = run.numbers("Bare", "slot");
  if (lines.size() != 300) return missing_line("slots.sim", "slot");
  draw::Table table;
  table.names = {"call", "virtual time", "beginning of the time slot"};
  table.units = {"", "ms", "ms"};
  table.columns.resize(3);
  int inside = 0;
  std::string csv = "call,virtual time [ms],beginning of the time slot [ms]\n";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double own = lines[i][0], slot = lines[i][1];
    inside += slot <= own && own < slot + slot_ms && math::fmod(slot, slot_ms) == 0;
    csv += fmt::format("{},{:g},{:g}\n", i + 1, own, slot);
    if (i >= 60) continue;
    table.columns[0].push_back(static_cast<double>(i + 1));
    table.columns[1].push_back(own);
    table.columns[2].push_back(slot);
  }
  SL_TRY(report.context.write("slots.csv", csv));
  SL_ASSIGN(const std::string figure,
            draw::draw_plot({table}, {.x = "call",
                                      .title = "Two clocks of a program",
                                      .x_label = "call",
                                      .y_label = "ms",
                                      .labels = {"virtual time", "simulation time"}}));
  report.page.figure(figure,
                     "After each of 60 calls of random functions and waits: the program's virtual time, and "
                     "the beginning of the time "
                     "slot that the simulation is in.");
  statements.push_back(
      {"A time slot is the largest I with I T <= virtual time; a robot whose virtual time leaves the global "
       "slot "
       "is suspended until it is woken.",
       fmt::format(
           "T = {:g} ms. After {} of {} calls: simulation time <= virtual time < simulation time + T.",
           slot_ms, inside, lines.size())});
  return {};
}

Status fairness(const Report& report, std::vector<std::vector<std::string>>& statements) {
  const std::array<std::string, 4> robots{"Bare", "Bare_2", "Bare_3", "Bare_4"};
  std::vector<std::string> values;
  std::string all_ended;
  for (const std::string& robot : robots) {
    values.push_back(robot + ".pose.x");
    all_ended += (all_ended.empty() ? "" : " and ") + robot + "/controller.ended > 0";
  }
  SL_ASSIGN(const ProgramRun run,
            report.runs.run({.file = "eyesim_paper/fair.sim", .duration_s = 12, .values = values}));
  report.page.paragraph(
      "A race of ten seconds by the programs' clocks: all order the same speed and call the same functions, "
      "and compute between the calls what costs a real processor very different times.");
  std::vector<std::vector<std::string>> rows;
  bool same = true;
  double first_calls = 0, first_way = 0;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto lines = run.numbers(robots[i], "fair");
    if (lines.size() != 1 || lines[0].size() != 2) return missing_line("fair.sim", "fair");
    const double way_mm = 1000 * (run.values[i].back() - run.values[i].front());
    if (i == 0) first_calls = lines[0][0], first_way = way_mm;
    same = same && lines[0][0] == first_calls && std::abs(way_mm - first_way) < 1e-6;
    rows.push_back({robots[i], fmt::format("{:g}", lines[0][1]), fmt::format("{:g}", lines[0][0]),
                    fmt::format("{:.3f} mm", way_mm)});
  }
  report.page.table({"robot", "multiplications between calls", "rounds in 10 s", "way"}, rows);
  statements.push_back(
      {"A reason for modelling time is fairness in cooperative or competitive applications; "
       "native C calls are neglected.",
       same ? "All four have made the same number of calls and driven the same way."
            : "The robots differ: see the table."});
  return {};
}

Status exchanges(const Report& report, std::vector<std::vector<std::string>>& statements) {
  SL_ASSIGN(const ProgramRun run, report.runs.run({.file = "eyesim_paper/exchange.sim", .duration_s = 133}));
  report.page.paragraph(
      "Four robots send their clocks to each other at random times for 130 s, and compare what arrives with "
      "their own. Age: clock of the receiver less clock of the sender.");
  std::vector<std::vector<std::string>> rows;
  double received = 0, future = 0;
  for (const char* const robot : {"Bare", "Bare_2", "Bare_3", "Bare_4"}) {
    const auto lines = run.numbers(robot, "exchange");
    if (lines.size() != 1 || lines[0].size() != 6) return missing_line("exchange.sim", "exchange");
    const std::vector<double>& n = lines[0];
    received += n[1];
    future += n[2];
    rows.push_back({robot, fmt::format("{:g}", n[0]), fmt::format("{:g}", n[1]), fmt::format("{:g}", n[2]),
                    fmt::format("{:g} ms", n[3]), fmt::format("{:.1f} ms", n[4] / 1000),
                    fmt::format("{:g} ms", n[5])});
  }
  report.page.table({"robot", "sent", "received", "from the future", "youngest", "mean age", "oldest"}, rows);
  statements.push_back({"Without synchronization messages from the future may occur.",
                        fmt::format("{:g} of {:g} messages.", future, received)});
  return {};
}

/// Column of the middle of what differs from an empty view, as film.c finds it; below 0: nothing.
double changed_column(const msg::Image& empty, const msg::Image& image) {
  double sum = 0, changed = 0;
  for (std::size_t i = 0; 3 * i + 2 < image.data.size(); ++i) {
    int apart = 0;
    for (std::size_t c = 0; c < 3; ++c)
      apart += std::abs(static_cast<int>(image.data[3 * i + c]) - static_cast<int>(empty.data[3 * i + c]));
    if (apart <= 40) continue;
    sum += static_cast<double>(i % image.width);
    ++changed;
  }
  return changed > 0 ? sum / changed : -1;
}

Status pictures_of_the_past(const Report& report, std::vector<std::vector<std::string>>& statements) {
  struct View {
    double time_ms, column;
  };
  std::vector<View> views;
  msg::Image empty;
  std::uint64_t seen = 0;
  ProgramRunSpec spec{.file = "eyesim_paper/film.sim",
                      .duration_s = 12,
                      .stop_when = "S4/controller.ended > 0",
                      .values = {"Bare.pose.y"}};
  // Each picture of the camera by the time at which the world looked like that.
  spec.watch = [&](const Simulation& simulation) {
    const auto* const topic = dynamic_cast<const Topic<msg::Image>*>(
        simulation.find_topic("/S4/camera/image"));
    if (!topic || topic->count == seen) return;
    seen = topic->count;
    if (empty.data.empty()) empty = topic->message;
    views.push_back({1000 * topic->message.header.stamp.s(), changed_column(empty, topic->message)});
  };
  SL_ASSIGN(const ProgramRun run, report.runs.run(spec));
  const auto lines = run.numbers("S4", "picture");
  if (lines.empty()) return missing_line("film.sim", "picture");
  int found = 0, future = 0;
  double least = 1e9, most = 0;
  statistics::Sample off_mm;
  for (const auto& line : lines) {
    const auto view = std::find_if(views.begin(), views.end(), [&](const View& each) {
      return std::abs(each.column - line[2]) < 0.006;  // printed with two digits
    });
    if (view == views.end()) continue;
    ++found;
    const double age_ms = line[1] - view->time_ms;
    future += age_ms < 0;
    least = std::min(least, age_ms);
    most = std::max(most, age_ms);
    // Where the true place at that time is seen: 160 pixels are tan(30 deg), from 70 mm ahead of the looking robot's middle.
    const double truth_m = run.values[0][index_of(run, view->time_ms / 1000)];
    const double seen_m = (159.5 - view->column) / 160 * math::tan(math::pi / 6) * (1.0 - 0.07);
    off_mm.add(1000 * (seen_m - truth_m));
  }
  report.page.paragraph(fmt::format(
      "A robot takes pictures of another one that drives by at 300 mm/s. Where the other one is in a picture "
      "tells when the world looked like that: {} of {} pictures are known by it. When the call returned, "
      "which "
      "waits for a picture of the next time slot, their ages were {}. The true place at that time lies "
      "{:.1f} mm "
      "beside the middle of what is seen on average, with a deviation of {:.1f} mm; in a time slot the robot "
      "drives 15 mm.",
      found, lines.size(),
      least == most ? fmt::format("{:g} ms", least) : fmt::format("{:g} to {:g} ms", least, most),
      off_mm.mean(), off_mm.deviation()));
  statements.push_back(
      {"A robot might record the image of another one at a position where it will be in the "
       "future.",
       fmt::format("{} of {} pictures.", future, found)});
  return {};
}

std::string joined(const std::vector<Words>& lines) {
  std::string out;
  for (const Words& line : lines) {
    if (!out.empty()) out += ", ";
    for (std::size_t i = 0; i < line.size(); ++i) out += (i ? " " : "") + line[i];
  }
  return out;
}

}  // namespace

Status time_model(const Report& report) {
  report.page.heading("Section 6: time");
  std::vector<std::vector<std::string>> statements{
      {"Virtual time adds up execution times that were measured on the EyeBot and stored in a table.",
       "The measured times were not published: our table has estimates (docs/robios.md)."},
      {"Native C calls are neglected.", "They take no virtual time."}};
  SL_TRY(costs(report));
  SL_TRY(slots(report, statements));
  SL_TRY(fairness(report, statements));
  SL_TRY(exchanges(report, statements));
  SL_TRY(pictures_of_the_past(report, statements));
  statements.push_back(
      {"Time lapse and slow motion by suspending the core; intermediate steps for a fluent display.",
       "The speed of the page, from 0.1 to 50, and `--video-speed` of films: what is shown is interpolated "
       "between two steps, and the run stays the same."});
  report.page.table({"the paper", "here"}, statements);
  return {};
}

Status tasks(const Report& report) {
  report.page.heading("Section 7: multitasking");
  struct Program {
    const char *file, *name, *expected;
    std::vector<std::pair<std::string, std::string>> settings;
  };
  const std::vector<Program> programs{
      {"robios/tasks_cooperative.sim",
       "cooperative: drive, count, show",
       "side 1, side 2, corner 1, side 3, corner 2, side 4, corner 3, end, corner 4",
       {}},
      {"robios/tasks_preemptive.sim",
       "preemptive, count before drive before two adders, with semaphores",
       "side 1, corner 1, side 2, corner 2, side 3, corner 3, side 4, corner 4, end, sum 4000 of 4000",
       {}},
      {"robios/tasks_preemptive.sim",
       "the same without semaphores: additions are lost",
       "side 1, corner 1, side 2, corner 2, side 3, corner 3, side 4, corner 4, end, sum less than 4000",
       {{"robots.LabBot.controller.flags", "[-DNO_LOCK]"}}}};
  std::vector<std::vector<std::string>> rows;
  for (const Program& program : programs) {
    SL_ASSIGN(const ProgramRun run, report.runs.run({.file = program.file,
                                                     .duration_s = 40,
                                                     .stop_when = "LabBot/controller.ended > 0",
                                                     .settings = program.settings}));
    const auto found = run.printed.find("LabBot");
    if (found == run.printed.end()) return missing_line(program.file, "side");
    std::vector<Words> lines = found->second;
    std::erase_if(lines, [](const Words& line) { return line.front() == "adder"; });
    rows.push_back({program.name, program.expected, joined(lines)});
  }
  report.page.table({"tasks", "expected order", "order"}, rows);
  report.page.table(
      {"the paper", "here"},
      {{"Cooperative tasks begin with reschedule, preemptive ones with permit; priorities, semaphores.",
        "The same calls. Time slices of 10 ms are of virtual time, so that the order is the same in each "
        "run."}});
  return {};
}

Status speed(const Report& report) {
  struct Scene {
    const char *file, *name;
    int labbots, s4s;
  };
  constexpr std::array<Scene, 4> scenes{{{"robios/wander.sim", "one robot, distance sensors", 1, 0},
                                         {"robios/pingpong.sim", "two robots, radio", 0, 2},
                                         {"robios/four.sim", "four robots with cameras", 2, 2},
                                         {"robios/twenty.sim", "twenty robots with cameras", 10, 10}}};
  constexpr double duration_s = 5;
  report.page.heading("Section 8: number of robots, and speed");
  report.page.paragraph(
      fmt::format("Wall times of {:g} s of simulated time on this machine, one thread, starting the programs "
                  "not counted. They "
                  "differ from run to run and are information only; the paper has no such numbers.",
                  duration_s));
  std::vector<std::vector<std::string>> rows;
  std::string csv = "scene,robots,delays,wall time [s],times real time\n";
  for (const Scene& scene : scenes) {
    std::vector<std::string> cells{scene.name, fmt::format("{}", scene.labbots + scene.s4s)};
    for (const bool delays : {true, false}) {
      ProgramRunSpec spec{.file = scene.file, .duration_s = duration_s};
      if (!delays)
        for (const auto& [type, count] : {std::pair("LabBot", scene.labbots), std::pair("S4", scene.s4s)})
          for (int i = 1; i <= count; ++i)
            spec.settings.emplace_back(
                fmt::format("robots.{}{}.controller.delays", type, i == 1 ? "" : fmt::format("_{}", i)),
                "off");
      SL_ASSIGN(const ProgramRun run, report.runs.run(spec));
      const double factor = run.summary.wall_s > 0 ? duration_s / run.summary.wall_s : 0;
      cells.push_back(fmt::format("{:.1f}", factor));
      csv += fmt::format("\"{}\",{},{},{:.4f},{:.2f}\n", scene.name, scene.labbots + scene.s4s,
                         delays ? "on" : "off", run.summary.wall_s, factor);
    }
    rows.push_back(std::move(cells));
  }
  report.page.table({"scene", "robots", "times real time, calls with their costs", "with delays: off"}, rows);
  SL_TRY(report.context.write("speed.csv", csv));
  report.page.table(
      {"the paper", "here"},
      {{"No restrictions in the number of robots with vision systems.", "Twenty with a camera each run."},
       {"To run as fast as possible the delay times of calls are ignored.",
        "`delays: off`; a run without `--rate` goes as fast as it can in both cases."}});
  return {};
}

}  // namespace sandlot::app::eyesim
