/// Section 4.2 of the MARIO paper: the loop through the vineyard by wheels, eyes and filter, and the graph of nodes and topics.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/papers/mario.h"
#include "app/papers/pictures.h"
#include "base/math.h"
#include "draw/graph.h"

namespace sandlot::app::mario {
namespace {

constexpr double glance_s = 0.02;  ///< of a run that is there for its picture and its topics
constexpr double sample_hz = 10;   ///< the rate of the eyes
constexpr double chi2_95 = 5.991;  ///< 95 % of a chi-square of two degrees of freedom
constexpr double between_ellipses_s = 8;
/// The paper's colours: wheels blue, eyes green, filter red.
constexpr const char *wheels = "blue", *eyes = "green", *fused = "red", *true_place = "black",
                     *uncertain = "#e8a0a0", *satellites = "purple";

/// Sensors of the filters, by the names that a reader knows, and where their records stand. Not the wheels: their latest comparison is that
/// of the velocity upwards, which is 0.
struct Compared {
  const char *name, *record;
};
constexpr Compared compared[] = {{"eyes", "mario/estimator.sensors[1]."},
                                 {"inertial unit", "mario/estimator.sensors[2]."},
                                 {"satellites", "mario/locator.sensors[3]."}};

std::vector<std::string> loop_values() {
  std::vector<std::string> out{"x",     "y",         "eyes_x",  "wheels",           "eyes",
                               "fused", "deviation", "located", "located_deviation"};
  const auto add = [&](const std::string& topic) {
    for (const char* const axis : {"x", "y"})
      out.push_back(fmt::format("{}.pose.pose.position.{}", topic, axis));
  };
  add("mario/base/odometry");
  add("mario/eyes/odometry");
  add("mario/estimator/odometry");
  for (const int i : {0, 6, 7}) out.push_back(fmt::format("mario/estimator/odometry.pose.covariance[{}]", i));
  for (const Compared& each : compared)
    for (const char* const number : {"squared_distance", "components"})
      out.push_back(std::string(each.record) + number);
  return out;
}

/// The loop's columns by names of their own.
struct Loop {
  std::vector<double> time, x, y, wheels_x, wheels_y, eyes_x, eyes_y, fused_x, fused_y, xx, xy, yy;
  std::vector<double> wheels, eyes, fused, deviation, located, located_deviation;  ///< errors, deviations [m]
};

Result<Loop> loop_of(const draw::Table& run) {
  Loop out;
  const std::string base = "mario/base/odometry.pose.pose.position.",
                    eye = "mario/eyes/odometry.pose.pose.position.",
                    filter = "mario/estimator/odometry.pose.";
  struct Column {
    std::vector<double>& to;
    std::string name;
  };
  for (const Column& column :
       {Column{out.time, "time"}, Column{out.x, "x"}, Column{out.y, "y"}, Column{out.wheels_x, base + "x"},
        Column{out.wheels_y, base + "y"}, Column{out.eyes_x, "eyes_x"}, Column{out.eyes_y, eye + "y"},
        Column{out.fused_x, filter + "pose.position.x"}, Column{out.fused_y, filter + "pose.position.y"},
        Column{out.xx, filter + "covariance[0]"}, Column{out.xy, filter + "covariance[6]"},
        Column{out.yy, filter + "covariance[7]"}, Column{out.wheels, "wheels"}, Column{out.eyes, "eyes"},
        Column{out.fused, "fused"}, Column{out.deviation, "deviation"}, Column{out.located, "located"},
        Column{out.located_deviation, "located_deviation"}}) {
    SL_ASSIGN(column.to, column_of(run, column.name));
  }
  if (out.time.size() < 2) return Error{"the run through the vineyard has no samples"};
  return out;
}

/// Ellipses that hold the true place with 95 %, one every few seconds, as one line with gaps.
draw::Table ellipses(const Loop& loop) {
  draw::Table out = table_of({"x", "y"}, {{}, {}});
  double next_s = between_ellipses_s;
  for (std::size_t i = 0; i < loop.time.size(); ++i) {
    const bool last = i + 1 == loop.time.size();
    if (loop.time[i] < next_s && !last) continue;
    next_s += between_ellipses_s;
    // Square root of the covariance, by Cholesky: a circle through it is the ellipse.
    const double a = std::sqrt(std::max(loop.xx[i], 1e-12)), b = loop.xy[i] / a,
                 c = std::sqrt(std::max(loop.yy[i] - b * b, 0.0)), size = std::sqrt(chi2_95);
    for (int k = 0; k <= 48; ++k) {
      const double x = size * math::cos(k * math::tau / 48), y = size * math::sin(k * math::tau / 48);
      out.columns[0].push_back(loop.fused_x[i] + a * x);
      out.columns[1].push_back(loop.fused_y[i] + b * x + c * y);
    }
    for (auto& column : out.columns) column.push_back(std::nan(""));
  }
  return out;
}

double rms(const std::vector<double>& errors) {
  double sum = 0;
  for (const double each : errors) sum += each * each;
  return std::sqrt(sum / static_cast<double>(errors.size()));
}

/// Normalised squared errors of the filters: of the place (NEES), and of each sensor's innovations (NIS), one sample in 0.1 s.
Status consistency(Report& report, const LoggedRun& run, const Loop& loop) {
  std::vector<std::vector<std::string>> rows;
  double place = 0, located = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < loop.time.size(); ++i) {
    const double determinant = loop.xx[i] * loop.yy[i] - loop.xy[i] * loop.xy[i];
    if (!(determinant > 0) || !(loop.located_deviation[i] > 0)) continue;  // it has not begun
    const double x = loop.fused_x[i] - loop.x[i], y = loop.fused_y[i] - loop.y[i];
    place += (loop.yy[i] * x * x - 2 * loop.xy[i] * x * y + loop.xx[i] * y * y) / determinant;
    const double share = loop.located[i] / loop.located_deviation[i];
    located += 2 * share * share;
    ++n;
  }
  if (n == 0) return Error{"the filters of the vineyard's run have no covariance"};
  const auto add = [&](std::string what, double value, const char* expected, const char* unit) {
    rows.push_back({what, fmt::format("{:.3g}", value), expected});
    report.rows.push_back({"Figure 15", std::move(what), unit, std::nullopt, value, "not in the paper"});
  };
  add("NEES of the filter's place", place / static_cast<double>(n), "2", "1");
  add("NEES of the place with GPS, both axes alike", located / static_cast<double>(n), "2", "1");
  for (const Compared& each : compared) {
    SL_ASSIGN(const auto distance, column_of(run.values, std::string(each.record) + "squared_distance"));
    SL_ASSIGN(const auto components, column_of(run.values, std::string(each.record) + "components"));
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < distance.size(); ++i)
      if (components[i] > 0) sum += distance[i], count += components[i];
    if (count > 0) add(fmt::format("NIS of {} per component", each.name), sum / count, "1", "1");
  }
  for (const auto& [name, errors] :
       {std::pair{"wheels", &loop.wheels}, std::pair{"eyes", &loop.eyes}, std::pair{"filter", &loop.fused},
        std::pair{"filter with GPS", &loop.located}})
    add(fmt::format("{}, root mean square on the way", name), rms(*errors), "", "m");
  report.page.table({"on the whole way", "measured", "where errors are as stated"}, rows);
  report.page.paragraph(
      "NEES and NIS are squares of errors and of innovations by their covariances. Below what is expected, a "
      "filter is more cautious than it need be: errors that stay for a time, as those of slip, level and "
      "satellites, count there as much larger ones that are drawn anew with each message.");
  return {};
}

Status figure_15a(Report& report, const LoggedRun& run) {
  SL_ASSIGN(const Loop loop, loop_of(run.values));
  const auto path = [](const std::vector<double>& x, const std::vector<double>& y) {
    return table_of({"x", "y"}, {x, y});
  };
  SL_ASSIGN(const std::string map,
            draw::draw_plot({ellipses(loop), path(loop.x, loop.y), path(loop.wheels_x, loop.wheels_y),
                             path(loop.eyes_x, loop.eyes_y), path(loop.fused_x, loop.fused_y)},
                            {.x = "x",
                             .x_label = "x from the start [m]",
                             .y_label = "y from the start [m]",
                             .labels = {"95 % ellipses of the filter", "truth", "wheels", "eyes", "filter"},
                             .colours = {uncertain, true_place, wheels, eyes, fused},
                             .equal_scale = true}));
  report.figure("figure_15a", map,
                "Figure 15 (a): the loop through the vineyard by the odometry of the wheels (blue), of the "
                "pair of eyes (green) and "
                "by the filter (red), as in the paper; in black the truth, which the paper does not have. "
                "Ellipses: where the filter "
                "expects the robot with 95 %, every 8 s.");

  const auto over_time = [&](const std::vector<double>& values) {
    return table_of({"time", "y"}, {loop.time, values});
  };
  SL_ASSIGN(
      const std::string errors,
      draw::draw_plot(
          {over_time(loop.wheels), over_time(loop.eyes), over_time(loop.fused), over_time(loop.deviation)},
          {.x_label = "time [s]",
           .y_label = "distance from the true place [m]",
           .labels = {"wheels", "eyes", "filter", "deviation that the filter states"},
           .colours = {wheels, eyes, fused, uncertain},
           .marks = {{false, paper_gap_m, "the paper: the filter ends 0.3 m from the start"}}}));
  report.figure("loop_errors", errors,
                "Distance of each estimate from the true place, and the deviation (one sigma of the plane) "
                "that the filter states.");
  SL_ASSIGN(const std::string located,
            draw::draw_plot({over_time(loop.located), over_time(loop.located_deviation)},
                            {.x_label = "time [s]",
                             .y_label = "distance from the true place [m]",
                             .labels = {"filter with GPS", "deviation that it states"},
                             .colours = {satellites, "grey"}}));
  report.figure("loop_with_gps", located,
                "The same for a second filter that reads the satellite receiver, too. The paper had none in "
                "its simulation.");

  const double w = loop.wheels.back(), e = loop.eyes.back(), f = loop.fused.back();
  report.page.table(
      {"at the end of the loop", "the paper", "ours: distance from the true place"},
      {{"wheels", "farther than the filter", fmt::format("{:.2f} m", w)},
       {"eyes", "farther than the filter", fmt::format("{:.2f} m", e)},
       {"filter", "0.3 m from the start",
        fmt::format("{:.2f} m; it states a deviation of {:.2f} m", f, loop.deviation.back())},
       {"filter with GPS", "not possible",
        fmt::format("{:.2f} m; it states {:.2f} m", loop.located.back(), loop.located_deviation.back())}});
  const bool closes = f <= paper_gap_m, best = f < w && f < e;
  std::string text = fmt::format("The filter {} within the paper's 0.3 m. ",
                                 closes ? "ends" : "does not end");
  if (best) text += "It is nearer than wheels and eyes alone, as in the paper. ";
  else if (f < w)
    text +=
        "It is nearer than the wheels, but not than the eyes alone: in the paper it is nearer than both. The "
        "errors "
        "of our eyes' calibration are constant, so that they cancel at the end of the loop; on the way the "
        "filter is "
        "nearer in the mean of 20 seeds. ";
  else text += "It is not nearer than the wheels, which it is in the paper. ";
  text +=
      "The paper measures from the start to the end of the estimated path, after a person has steered the "
      "robot back by sight; it had no truth. Ours "
      "is the distance from the truth, which no estimator reads. The vineyard, the ground and the course are "
      "ours: the paper's models are not "
      "published.";
  report.page.paragraph(text);
  SL_TRY(consistency(report, run, loop));
  report.files.emplace_back("loop.csv", run.csv);
  report.rows.push_back({"Figure 15", "filter at the end of the loop", "m", paper_gap_m, f,
                         closes ? "within 0.3 m" : "beyond 0.3 m"});
  report.rows.push_back(
      {"Figure 15", "wheels at the end", "m", std::nullopt, w,
       f < w ? "farther than the filter, as in the paper" : "nearer than the filter, unlike the paper"});
  report.rows.push_back(
      {"Figure 15", "eyes at the end", "m", std::nullopt, e,
       f < e ? "farther than the filter, as in the paper" : "nearer than the filter, unlike the paper"});
  return {};
}

/// Topics with a node at both ends, and their nodes, without the name of the robot.
draw::Graph drawing_of(const TopicGraph& all) {
  draw::Graph out;
  const auto short_name = [](std::string name) {
    for (const std::string prefix : {"/mario/", "mario/"})
      if (name.starts_with(prefix)) return name.substr(prefix.size());
    return name;
  };
  std::vector<std::size_t> places(all.nodes.size(), ~std::size_t{0});
  const auto place = [&](std::size_t node) {
    if (places[node] == ~std::size_t{0}) {
      places[node] = out.nodes.size();
      out.nodes.push_back({short_name(all.nodes[node].path), draw::Graph::Form::ellipse,
                           all.nodes[node].program ? "#fde5cc" : "#d6eaf8"});
    }
    return places[node];
  };
  for (const TopicGraph::Topic& topic : all.topics) {
    if (topic.publishers.empty() || topic.readers.empty()) continue;
    const std::size_t box = out.nodes.size();
    out.nodes.push_back({short_name(topic.name), draw::Graph::Form::box, "#ffffff"});
    for (const std::size_t node : topic.publishers) out.edges.emplace_back(place(node), box);
    for (const std::size_t node : topic.readers) out.edges.emplace_back(box, place(node));
  }
  return out;
}

std::string json_of(const TopicGraph& graph) {
  nlohmann::ordered_json nodes = nlohmann::ordered_json::array(), topics = nodes;
  for (const TopicGraph::Node& node : graph.nodes)
    nodes.push_back({{"path", node.path}, {"kind", node.kind}, {"program", node.program}});
  for (const TopicGraph::Topic& topic : graph.topics) {
    nlohmann::ordered_json entry{{"name", topic.name}, {"type", topic.type}};
    for (const auto& [key, list] :
         {std::pair("publishers", &topic.publishers), std::pair("readers", &topic.readers)}) {
      entry[key] = nlohmann::ordered_json::array();
      for (const std::size_t node : *list) entry[key].push_back(graph.nodes[node].path);
    }
    topics.push_back(std::move(entry));
  }
  return nlohmann::ordered_json{{"nodes", std::move(nodes)}, {"topics", std::move(topics)}}.dump(1) + "\n";
}

void figure_16(Report& report, const TopicGraph& graph) {
  report.page.heading("Figure 16: nodes and topics");
  report.figure("figure_16", draw::draw_graph(drawing_of(graph)),
                "Figure 16: nodes (ellipses) and topics (boxes) of the running loop. Orange: programs; blue: "
                "devices, whose drivers are nodes "
                "in ROS. All names are below /mario.");
  std::string unread;
  std::size_t count = 0;
  for (const TopicGraph::Topic& topic : graph.topics)
    if (topic.readers.empty()) unread += (count++ ? ", " : "") + topic.name;
  report.page.paragraph(
      fmt::format("{} topics without a reader are left out, as in rqt_graph: {}. topics.json has all of "
                  "them, with types.",
                  count, unread));
  report.page.paragraph(
      "As in the paper, a joystick's velocities go through the model-based controller to four position and "
      "four velocity controllers, whose "
      "joint states come back to it, and wheel odometry, visual odometry and the inertial unit meet in the "
      "filter. The simulator "
      "itself is not a node here, as Gazebo is in ROS. The node joystick follows points along the rows in "
      "place of "
      "the person, and reads the true "
      "place for it; no estimator does. The names of the paper's graph are in a picture that was not at "
      "hand.");
}

}  // namespace

Status loop(Report& report) {
  LoggedRunSpec spec{
      .condition = {"loop", "vineyard_loop", {}}, .values = loop_values(), .rate_hz = sample_hz};
  spec.view = draw::ViewpointOptions{.from = Vec3{-13.5, -2.5, 3.2}, .at = Vec3{-5, 2.5, 0.4}};
  if (report.context.quick) spec.duration_s = glance_s;
  SL_ASSIGN(const LoggedRun run, report.context.logged(spec));
  report.page.heading("Figure 15: a loop through the vineyard");
  if (report.context.quick)
    report.page.paragraph(
        "--quick leaves out the run of 84 s with its paths and errors. In the paper the filtered odometry "
        "ends 0.3 m from the start.");
  else SL_TRY(figure_15a(report, run));
  report.figure("figure_15b", picture_svg({tile_of(run.picture)}, 1),
                "Figure 15 (b): the simulated vineyard with MARIO at the start of the loop.");
  figure_16(report, run.graph);
  report.files.emplace_back("topics.json", json_of(run.graph));
  return {};
}

}  // namespace sandlot::app::mario
